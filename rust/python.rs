//! The Python face: conversions and nothing else. The only file that names pyo3 or numpy.

use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};
use numpy::ndarray::{Array2, Array3, ArrayView, ArrayView1, Dim, Dimension, IntoDimension};
use numpy::{
    PyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyReadonlyArray3, PyReadwriteArray3,
};
use pyo3::create_exception;
use pyo3::exceptions::{PyArithmeticError, PyMemoryError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyTuple;

use crate::aircraft::{self, Inertia};
use crate::ensemble::{Case, Shape, Source};
use crate::error::{Error, Place, Result};
use crate::extremes::Extreme;
use crate::modes::Damping;
use crate::readout::Quantity;
use crate::roughness::Stretch;
use crate::spectrum::PowerLaw;
use crate::watch::Pulse;
use crate::worst::{SpeedRange, Target};
use crate::{ensemble, modes, parallel, profile, roughness, run, spectrum, sweep};

create_exception!(
    runway_modal,
    InputError,
    PyValueError,
    "Input that cannot be used; the message names argument, index and value."
);
create_exception!(
    runway_modal,
    NumericalError,
    PyArithmeticError,
    "Arithmetic that failed on input that was in order."
);

impl From<Error> for PyErr {
    fn from(error: Error) -> Self {
        let message = error.to_string();
        match error {
            Error::NoRoom { .. } => PyMemoryError::new_err(message),
            error if error.is_numerical() => NumericalError::new_err(message),
            _ => InputError::new_err(message),
        }
    }
}

/// Runs `work` without the interpreter lock; lets Ctrl-C through.
#[expect(clippy::redundant_closure_for_method_calls, reason = "the method's lifetime is not general enough")]
fn detached<T: Send>(py: Python, work: impl FnOnce(Pulse) -> Result<T> + Send) -> PyResult<T> {
    let mut signal = None;
    parallel::read_environment();
    let result = py.detach(|| {
        work(&mut || {
            Python::attach(|py| py.check_signals()).map_err(|raised| {
                signal = Some(raised);
                Error::Interrupted
            })
        })
    });
    match signal {
        Some(raised) => Err(raised),
        None => Ok(result?),
    }
}

/// Rows of equal length as a matrix.
fn matrix<'py>(py: Python<'py>, rows: &[Vec<f64>]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    Ok(PyArray2::from_vec2(py, rows)?)
}

fn square<'py>(py: Python<'py>, matrix: &Matrix3<f64>) -> Bound<'py, PyArray2<f64>> {
    PyArray2::from_owned_array(py, Array2::from_shape_fn((3, 3), |(i, j)| matrix[(i, j)]))
}

/// Points (x, y) from an array of two columns.
fn points(array: &PyReadonlyArray2<f64>) -> Vec<(f64, f64)> {
    array.as_array().rows().into_iter().map(|row| (row[0], row[1])).collect()
}

#[pyclass(frozen, module = "runway_modal._core")]
struct Gear(aircraft::Gear);

#[pymethods]
impl Gear {
    #[new]
    fn new(name: &str, x: f64, y: f64, stiffness: f64, damping: f64) -> PyResult<Self> {
        Ok(Self(aircraft::Gear::new(name, x, y, stiffness, damping)?))
    }
}

#[pyclass(frozen, module = "runway_modal._core")]
struct Aircraft(Arc<aircraft::Aircraft>);

#[pymethods]
impl Aircraft {
    #[new]
    fn new(
        mass: f64,
        pitch_inertia: f64,
        roll_inertia: f64,
        gravity: f64,
        gears: Vec<Py<Gear>>,
    ) -> PyResult<Self> {
        let inertia = Inertia { mass, pitch: pitch_inertia, roll: roll_inertia, gravity };
        let gears = gears.iter().map(|gear| gear.get().0.clone()).collect();
        Ok(Self(Arc::new(aircraft::Aircraft::new(inertia, gears)?)))
    }

    fn stiffness_matrix<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        square(py, &self.0.stiffness_matrix())
    }

    fn damping_matrix<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        square(py, &self.0.damping_matrix())
    }

    fn static_load<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.0.static_load())
    }

    /// Number of modes.
    fn rank(&self) -> usize {
        self.0.rank()
    }
}

/// One per mode, or one number for all. Arrays are tried first: some NumPys take one of a single entry for
/// a number.
#[derive(FromPyObject)]
enum DampingRatio<'py> {
    Each(PyReadonlyArray1<'py, f64>),
    All(f64),
}

#[pyclass(frozen, module = "runway_modal._core")]
struct Modes(Arc<modes::Modes>);

#[pymethods]
impl Modes {
    #[staticmethod]
    #[pyo3(signature = (aircraft, damping_ratio))]
    fn natural(py: Python, aircraft: &Aircraft, damping_ratio: Option<DampingRatio>) -> PyResult<Self> {
        let damping = match &damping_ratio {
            None => Damping::Dampers,
            Some(DampingRatio::All(ratio)) => Damping::All(*ratio),
            Some(DampingRatio::Each(ratios)) => Damping::Each(ratios.as_slice()?),
        };
        let aircraft = Arc::clone(&aircraft.0);
        let modes = py.detach(|| modes::Modes::natural(aircraft, damping))?;
        Ok(Self(Arc::new(modes)))
    }

    #[staticmethod]
    fn measured(
        aircraft: &Aircraft,
        omega: PyReadonlyArray1<f64>,
        damping_ratio: PyReadonlyArray1<f64>,
        shapes: PyReadonlyArray2<f64>,
        static_correction: bool,
    ) -> PyResult<Self> {
        let columns = shapes.as_array();
        let columns = columns.columns().into_iter().map(|c| Vector3::new(c[0], c[1], c[2])).collect();
        let (omega, ratio) = (omega.as_array().to_vec(), damping_ratio.as_array().to_vec());
        let aircraft = Arc::clone(&aircraft.0);
        let modes = modes::Modes::measured(aircraft, omega, &ratio, columns, static_correction)?;
        Ok(Self(Arc::new(modes)))
    }

    fn omega<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.0.omega())
    }

    fn damping_ratio<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.0.damping_ratio())
    }

    fn shapes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let row = |i: usize| self.0.shapes().iter().map(|shape| shape[i]).collect();
        matrix(py, &[row(0), row(1), row(2)])
    }

    fn node<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.0.node())
    }

    fn damping_coupling<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, &self.0.damping_coupling())
    }
}

#[pyclass(frozen, module = "runway_modal._core")]
struct Profile(Arc<profile::Profile>);

impl Profile {
    /// A read-only view of this object's own memory.
    fn view<'py>(slf: &Bound<'py, Self>, values: &[f64]) -> Bound<'py, PyArray1<f64>> {
        // SAFETY: `values` lies in the Arc that `slf` holds; the class is frozen, the profile
        // never changes, and the array keeps `slf` alive as its base.
        read_only(unsafe { PyArray1::borrow_from_array(&ArrayView1::from(values), slf.clone().into_any()) })
    }
}

#[pymethods]
impl Profile {
    #[new]
    fn new(x: PyReadonlyArray1<f64>, z: PyReadonlyArray1<f64>) -> PyResult<Self> {
        Ok(Self(Arc::new(profile::Profile::new(x.as_array().to_vec(), z.as_array().to_vec())?)))
    }

    #[staticmethod]
    fn level() -> Self {
        Self(Arc::new(profile::Profile::level()))
    }

    #[staticmethod]
    fn one_minus_cosine(length: f64, height: f64, segments: usize, start: f64) -> PyResult<Self> {
        Ok(Self(Arc::new(profile::Profile::one_minus_cosine(length, height, segments, start)?)))
    }

    fn x<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyArray1<f64>> {
        Self::view(slf, slf.get().0.x())
    }

    fn z<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyArray1<f64>> {
        Self::view(slf, slf.get().0.z())
    }

    fn elevation<'py>(&self, py: Python<'py>, stations: PyReadonlyArray1<f64>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, stations.as_array().iter().map(|&x| self.0.elevation(x)))
    }

    fn shifted(&self, dx: f64) -> PyResult<Self> {
        Ok(Self(Arc::new(self.0.shifted(dx)?)))
    }

    fn sum(&self, other: &Self) -> PyResult<Self> {
        Ok(Self(Arc::new(self.0.sum(&other.0)?)))
    }

    fn footprint(&self, py: Python, length: f64, tolerance: f64) -> PyResult<Self> {
        let profile = py.detach(|| self.0.footprint(length, tolerance))?;
        Ok(Self(Arc::new(profile)))
    }
}

/// Values to spare in the larger block of results, at most: see [`Run::sample`].
const TO_SPARE: usize = 1 << 14;

/// See [`Run::sample`].
type Sampled<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);

/// See [`Run::states`].
type States<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);

/// A new array whose values are yet to be written: callers hand out none that they have not written.
/// NumPy makes it, and knows the error to raise where there is no room.
fn blank<const N: usize>(
    py: Python<'_>,
    shape: [usize; N],
) -> PyResult<Bound<'_, PyArray<f64, Dim<[usize; N]>>>>
where
    [usize; N]: IntoDimension<Dim = Dim<[usize; N]>> + for<'a> IntoPyObject<'a>,
    Dim<[usize; N]>: Dimension,
{
    // To look up a module takes longer than to make an array.
    static EMPTY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let shape = PyTuple::new(py, shape)?;
    Ok(EMPTY.import(py, "numpy", "empty")?.call1((shape,))?.cast_into()?)
}

/// A part of a read-only array in a shape of its own.
fn part<'py, const N: usize>(
    base: &Bound<'py, PyArray1<f64>>,
    begin: usize,
    shape: [usize; N],
) -> PyResult<Bound<'py, PyArray<f64, Dim<[usize; N]>>>>
where
    [usize; N]: IntoDimension<Dim = Dim<[usize; N]>>,
    Dim<[usize; N]>: Dimension,
{
    let view = {
        let values = base.readonly();
        let values = &values.as_slice()?[begin..begin + shape.iter().product::<usize>()];
        let view = ArrayView::from_shape(shape.into_dimension(), values)
            .map_err(|error| PyValueError::new_err(error.to_string()))?;
        // SAFETY: the array keeps `base`, which owns the memory, alive; neither is written to.
        unsafe { PyArray::borrow_from_array(&view, base.clone().into_any()) }
    };
    Ok(read_only(view))
}

/// Marks an array that belongs to a result as read-only.
fn read_only<D: Dimension>(array: Bound<'_, PyArray<f64, D>>) -> Bound<'_, PyArray<f64, D>> {
    let _ = array.readwrite().make_nonwriteable();
    array
}

#[pyclass(frozen, module = "runway_modal._core")]
struct Run(run::Run);

#[pymethods]
impl Run {
    #[new]
    fn new(modes: &Modes, profiles: Vec<Py<Profile>>, speed: f64, damping_input: bool) -> PyResult<Self> {
        let profiles: Vec<_> = profiles.iter().map(|profile| Arc::clone(&profile.get().0)).collect();
        Ok(Self(run::Run::new(Arc::clone(&modes.0), &profiles, speed, damping_input)?))
    }

    fn speed(&self) -> f64 {
        self.0.speed()
    }

    /// Default times, modal displacements and rates there.
    #[pyo3(signature = (duration))]
    fn sample<'py>(&self, py: Python<'py>, duration: Option<f64>) -> PyResult<Sampled<'py>> {
        let (grid, columns) = (self.0.grid(duration)?, self.0.modes().omega().len());
        // How many rows there are is known when they are there; what they leave of the memory is
        // hardly touched. Fetching memory from the system anew would cost a run more than the march:
        // so the blocks are not shrunk, and the next run asks for just as much, and they are two
        // rather than three, one with room to spare, as glibc keeps up to twice the largest block.
        let most = grid.most;
        let first = blank(py, [most * (1 + columns) + TO_SPARE.min(4 * most)])?;
        let second = blank(py, [most * columns])?;
        let rows = {
            let (mut first, mut second) = (first.readwrite(), second.readwrite());
            let (time, modal) = first.as_slice_mut()?.split_at_mut(most);
            let rate = second.as_slice_mut()?;
            detached(py, |pulse| self.0.sample(grid, time, modal, rate, pulse))?
        };
        let (first, second) = (read_only(first), read_only(second));
        let shape = [rows, columns];
        Ok((part(&first, 0, [rows])?, part(&first, most, shape)?, part(&second, 0, shape)?))
    }

    /// Modal displacements and rates.
    fn states<'py>(&self, py: Python<'py>, times: PyReadonlyArray1<f64>) -> PyResult<States<'py>> {
        let times = times.as_slice()?;
        let shape = [times.len(), self.0.modes().omega().len()];
        let (modal, rate) = (blank(py, shape)?, blank(py, shape)?);
        {
            let (mut modal, mut rate) = (modal.readwrite(), rate.readwrite());
            let (modal, rate) = (modal.as_slice_mut()?, rate.as_slice_mut()?);
            detached(py, |pulse| self.0.states(times, modal, rate, pulse))?;
        }
        Ok((read_only(modal), read_only(rate)))
    }

    /// `quantity`: "cg", "cg_rate", "cg_acceleration", "gear_displacement", "load", "elevation",
    /// or "acceleration" at `stations`. A column a coordinate, gear or station.
    fn read<'py>(
        &self,
        py: Python<'py>,
        quantity: &str,
        stations: Vec<(f64, f64)>,
        times: PyReadonlyArray1<f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let times = times.as_slice()?;
        let gears = self.0.modes().aircraft().gears().len();
        let (columns, quantity) = match quantity {
            "elevation" => (gears, None),
            "cg" => (3, Some(Quantity::Cg)),
            "cg_rate" => (3, Some(Quantity::CgRate)),
            "cg_acceleration" => (3, Some(Quantity::CgAcceleration)),
            "gear_displacement" => (gears, Some(Quantity::GearDisplacement)),
            "load" => (gears, Some(Quantity::Load)),
            "acceleration" => (stations.len(), Some(Quantity::Acceleration(stations))),
            other => return Err(PyValueError::new_err(format!("no quantity '{other}'"))),
        };
        let values = blank(py, [times.len(), columns])?;
        {
            let mut out = values.readwrite();
            let out = out.as_slice_mut()?;
            detached(py, |pulse| match &quantity {
                None => self.0.elevations(times, out, pulse),
                Some(quantity) => self.0.read(quantity, times, out, pulse),
            })?;
        }
        Ok(read_only(values))
    }

    /// See [`Run::extremes_between`] and [`extremes_of`].
    fn extremes<'py>(
        &self,
        py: Python<'py>,
        stations: Vec<(f64, f64)>,
        times: PyReadonlyArray1<f64>,
    ) -> PyResult<Extremes<'py>> {
        let times = times.as_slice()?;
        let (gears, points) = (self.0.modes().aircraft().gears().len(), stations.len());
        let quantities = [Quantity::Load, Quantity::Acceleration(stations)];
        let found = detached(py, |pulse| self.0.extremes_between(&quantities, times, pulse))?;
        Ok(extremes_of(py, &found, gears, points))
    }

    /// See [`Run::root_mean_squares_between`]: of dynamic loads, then of accelerations at `stations`; a
    /// row a stretch.
    fn root_mean_squares<'py>(
        &self,
        py: Python<'py>,
        stations: Vec<(f64, f64)>,
        times: PyReadonlyArray1<f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let times = times.as_slice()?;
        let columns = self.0.modes().aircraft().gears().len() + stations.len();
        let quantities = [Quantity::DynamicLoad, Quantity::Acceleration(stations)];
        let found = detached(py, |pulse| self.0.root_mean_squares_between(&quantities, times, pulse))?;
        let rows = Array2::from_shape_fn((found.len(), columns), |(row, column)| found[row][column]);
        Ok(read_only(PyArray2::from_owned_array(py, rows)))
    }
}

/// Loads: max, time of max, min, time of min; a row a list, a column a gear. Accelerations: largest
/// magnitude and its time; a row a station, a column a list.
type Extremes<'py> = (Bound<'py, PyArray3<f64>>, Bound<'py, PyArray3<f64>>);

/// Lists of extremes of `gears` loads, then of accelerations at so many stations.
fn extremes_of<'py>(py: Python<'py>, found: &[Vec<Extreme>], gears: usize, stations: usize) -> Extremes<'py> {
    let part = |e: &Extreme, part| [e.max, e.time_of_max, e.min, e.time_of_min][part];
    let loads = Array3::from_shape_fn((4, found.len(), gears), |(p, row, g)| part(&found[row][g], p));
    let pair = |e: &Extreme, part| <[f64; 2]>::from(e.magnitude())[part];
    let shape = (2, stations, found.len());
    let accelerations = Array3::from_shape_fn(shape, |(p, s, row)| pair(&found[row][gears + s], p));
    let [loads, accelerations] = [loads, accelerations].map(|array| PyArray3::from_owned_array(py, array));
    (read_only(loads), read_only(accelerations))
}

#[pyclass(frozen, module = "runway_modal._core")]
struct Course(sweep::Course);

#[pymethods]
impl Course {
    #[new]
    fn new(modes: &Modes, profiles: Vec<Py<Profile>>, damping_input: bool) -> PyResult<Self> {
        let profiles = profiles.iter().map(|profile| Arc::clone(&profile.get().0)).collect();
        Ok(Self(sweep::Course::new(Arc::clone(&modes.0), profiles, damping_input)?))
    }

    /// See [`Course::sweep`](sweep::Course::sweep) and [`extremes_of`].
    fn sweep<'py>(
        &self,
        py: Python<'py>,
        speeds: PyReadonlyArray1<f64>,
        stations: Vec<(f64, f64)>,
    ) -> PyResult<Extremes<'py>> {
        let speeds = speeds.as_slice()?;
        let (gears, points) = (self.0.modes().aircraft().gears().len(), stations.len());
        let quantities = [Quantity::Load, Quantity::Acceleration(stations)];
        let found = detached(py, |pulse| self.0.sweep(speeds, &quantities, pulse))?;
        Ok(extremes_of(py, &found, gears, points))
    }

    /// Speed, value, bound, runs. `quantity`: "max_load" or "min_load" of gear number `gear`, or
    /// "max_acceleration" at `point`.
    #[expect(clippy::too_many_arguments, reason = "a Python signature")]
    fn worst(
        &self,
        py: Python,
        quantity: &str,
        gear: usize,
        point: (f64, f64),
        speeds: (f64, f64),
        tolerance: f64,
        max_runs: usize,
    ) -> PyResult<(f64, f64, f64, usize)> {
        let target = match quantity {
            "max_load" => Target::MaxLoad(gear),
            "min_load" => Target::MinLoad(gear),
            "max_acceleration" => Target::MaxAcceleration(point.0, point.1),
            other => return Err(PyValueError::new_err(format!("no quantity '{other}'"))),
        };
        let range = SpeedRange { low: speeds.0, high: speeds.1, tolerance, max_runs };
        let worst = detached(py, |pulse| self.0.worst(target, range, pulse))?;
        Ok((worst.speed, worst.value, worst.bound, worst.runs))
    }
}

/// Elevations (runs, tracks, stations) of either precision.
#[derive(FromPyObject)]
enum Elevations<'py> {
    Double(PyReadonlyArray3<'py, f64>),
    Single(PyReadonlyArray3<'py, f32>),
}

/// Rows a run: largest, smallest and RMS loads, a column a gear; largest and RMS accelerations, a
/// column a point. And the runs that gave no result, with the reason.
type Many<'py> = ([Bound<'py, PyArray2<f64>>; 5], Vec<(usize, String)>);

fn many<'py, T: numpy::Element + Copy + Into<f64> + Sync>(
    py: Python<'py>,
    plan: &ensemble::Plan,
    elevations: &PyReadonlyArray3<T>,
    mask: bool,
) -> PyResult<Many<'py>> {
    let (runs, tracks, stations) = elevations.as_array().dim();
    let memory = ensemble::Memory::new(elevations.as_slice()?, Shape { runs, tracks, stations })?;
    run_many(py, plan, &memory, mask, |run| memory.fault(run))
}

/// Runs all; `fault` says why one gave no result.
fn run_many<'py>(
    py: Python<'py>,
    plan: &ensemble::Plan,
    source: &impl Source,
    mask: bool,
    fault: impl Fn(usize) -> Error + Sync,
) -> PyResult<Many<'py>> {
    let (found, failed) = detached(py, |pulse| {
        let found = ensemble::simulate(plan, source, pulse)?;
        match found.failed.first() {
            Some(&run) if !mask => return Err(fault(run)),
            _ => (),
        }
        let failed = found.failed.iter().map(|&run| (run, fault(run).to_string())).collect();
        Ok((found, failed))
    })?;
    let columns = |values: Vec<f64>, count: usize| {
        Array2::from_shape_vec((source.shape().runs, count), values)
            .map(|array| PyArray2::from_owned_array(py, array))
            .map_err(|error| PyValueError::new_err(error.to_string()))
    };
    let (gears, points) =
        plan.cases.first().map_or((0, 0), |one| (one.modes.aircraft().gears().len(), one.points.len()));
    let columns = [
        columns(found.max_load, gears)?,
        columns(found.min_load, gears)?,
        columns(found.rms_load, gears)?,
        columns(found.max_acceleration, points)?,
        columns(found.rms_acceleration, points)?,
    ];
    Ok((columns, failed))
}

/// Many runs at once; `cases` and `speed` one for all or one a run. A case is modes with points (x, y)
/// where accelerations are wanted. Failed runs raise, or are masked by NaN. `between`: whether extremes are
/// looked for between the gears' stations too.
#[pyfunction]
#[pyo3(signature = (cases, elevations, spacing, speed, damping_input, mask, between=true))]
#[expect(clippy::too_many_arguments, reason = "a plan, spelled out")]
fn simulate_many<'py>(
    py: Python<'py>,
    cases: Vec<(Py<Modes>, PyReadonlyArray2<'py, f64>)>,
    elevations: Elevations<'py>,
    spacing: f64,
    speed: Vec<f64>,
    damping_input: bool,
    mask: bool,
    between: bool,
) -> PyResult<Many<'py>> {
    let case = |(modes, stations): &(Py<Modes>, _)| Case {
        modes: Arc::clone(&modes.get().0),
        points: points(stations),
    };
    let cases = cases.iter().map(case).collect();
    let plan = ensemble::Plan { cases, speed, spacing, damping_input, between };
    match elevations {
        Elevations::Double(array) => many(py, &plan, &array, mask),
        Elevations::Single(array) => many(py, &plan, &array, mask),
    }
}

#[pyclass(frozen, module = "runway_modal._core")]
struct Spectrum(spectrum::Spectrum);

#[pymethods]
impl Spectrum {
    #[staticmethod]
    fn power_law(coefficient: f64, waviness: f64, reference: f64, band: (f64, f64)) -> PyResult<Self> {
        let law = PowerLaw { coefficient, waviness, reference, band };
        Ok(Self(spectrum::Spectrum::power_law(law)?))
    }

    #[staticmethod]
    fn table(n: PyReadonlyArray1<f64>, psd: PyReadonlyArray1<f64>) -> PyResult<Self> {
        Ok(Self(spectrum::Spectrum::table(n.as_slice()?, psd.as_slice()?)?))
    }

    fn band(&self) -> (f64, f64) {
        self.0.band()
    }

    fn variance(&self) -> f64 {
        let (low, high) = self.0.band();
        self.0.variance(low, high)
    }

    fn density<'py>(&self, py: Python<'py>, n: PyReadonlyArray1<f64>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, n.as_array().iter().map(|&n| self.0.density(n)))
    }
}

#[pyclass(frozen, module = "runway_modal._core")]
struct Generator(roughness::Generator);

#[pymethods]
impl Generator {
    #[new]
    fn new(
        py: Python,
        spectrum: &Spectrum,
        length: f64,
        spacing: f64,
        y: PyReadonlyArray1<f64>,
        seed: u64,
    ) -> PyResult<Self> {
        let (stretch, y) = (Stretch { length, spacing }, y.as_slice()?);
        let new = |pulse: Pulse| roughness::Generator::new(&spectrum.0, stretch, y, seed, pulse);
        Ok(Self(detached(py, new)?))
    }

    fn stations(&self) -> usize {
        self.0.stations()
    }

    /// Fills (run, track, station) from the first run on.
    fn elevations(&self, py: Python, first_run: u64, mut out: PyReadwriteArray3<f64>) -> PyResult<()> {
        let out = out.as_slice_mut()?;
        detached(py, |pulse| self.0.elevations(first_run, out, pulse))
    }
}

/// Runs over random profiles: results and `mask` as of `simulate_many`.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "a plan, spelled out")]
fn monte_carlo<'py>(
    py: Python<'py>,
    modes: &Modes,
    generator: &Generator,
    first_run: u64,
    runs: usize,
    speed: Vec<f64>,
    stations: PyReadonlyArray2<f64>,
    damping_input: bool,
    mask: bool,
) -> PyResult<Many<'py>> {
    let plan = ensemble::Plan {
        cases: vec![Case { modes: Arc::clone(&modes.0), points: points(&stations) }],
        speed,
        spacing: generator.0.spacing(),
        damping_input,
        between: true,
    };
    let source = roughness::Runs { generator: &generator.0, first: first_run, count: runs };
    // Elevations that are made are finite: only the motion can leave the range.
    let number = |run| Place::at("run", first_run as usize + run);
    run_many(py, &plan, &source, mask, |run| Error::RunOverflow { place: number(run) })
}

#[pyfunction]
fn series(strut: f64, tire: f64) -> PyResult<f64> {
    Ok(aircraft::series(strut, tire)?)
}

/// The Rust core of runway_modal.
#[pymodule(gil_used = false)]
mod _core {
    #[pymodule_export]
    use super::{
        Aircraft, Course, Gear, Generator, InputError, Modes, NumericalError, Profile, Run, Spectrum,
        monte_carlo, series, simulate_many,
    };

    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "Python's name")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}

/// All that Python's objects hold by value.
type Held = (aircraft::Gear, run::Run, sweep::Course, spectrum::Spectrum, roughness::Generator);

// Python gives its objects memory at multiples of 16 bytes, whatever they hold.
const _: () = assert!(align_of::<Held>() <= 16);
