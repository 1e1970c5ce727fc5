//! Laws of the whole march, through the interface of the core alone.

use std::sync::Arc;

use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use runway_modal::{profile::Profile, readout::Quantity, run::Run};

mod f4e;

const SPEED: f64 = 405.0744; // 20 kt in in/s

fn run(tracks: [&Profile; 3], zeta: f64, damping_input: bool) -> Run {
    let tracks = tracks.map(|profile| Arc::new(profile.clone()));
    Run::new(f4e::modes(20.0, zeta), &tracks, SPEED, damping_input).unwrap()
}

/// Three numbers a time: one a gear or one a freedom.
fn read(run: &Run, quantity: &Quantity, times: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; 3 * times.len()];
    run.read(quantity, times, &mut out, &mut || Ok(())).unwrap();
    out
}

fn every_tenth() -> Vec<f64> {
    (0..60).map(|i| 0.1 * f64::from(i)).collect()
}

/// Breakpoints up to 50 in apart, elevations within 2 in.
fn profile() -> impl Strategy<Value = Profile> {
    prop::collection::vec((0.01..50.0, -2.0..2.0), 2..40).prop_map(|points| {
        let (gaps, z): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
        let x = gaps.iter().scan(0.0, |x, gap| {
            *x += gap;
            Some(*x)
        });
        Profile::new(x.collect(), z).unwrap()
    })
}

/// Agreement as a share of the largest load.
fn assert_close(found: &[f64], expected: &[f64], share: f64) {
    let peak = expected.iter().fold(0.0_f64, |peak, value| peak.max(value.abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= share * peak, "{found:?} {expected:?}, peak {peak:?}");
    }
}

#[test]
fn a_constant_slope_ends_in_its_static_limit() {
    let climb = Profile::new(vec![0.0, 1e5], vec![0.0, 1e3]).unwrap();
    let run = run([&climb; 3], 0.2, false);
    let late = [200.0];
    assert_close(&read(&run, &Quantity::CgRate, &late), &[0.01 * SPEED, 0.0, 0.0], 1e-12);
    for acceleration in read(&run, &Quantity::CgAcceleration, &late) {
        assert!(acceleration.abs() < 1e-10);
    }
    // Level again, higher up, and at rest.
    let above = [400.0];
    assert_close(&read(&run, &Quantity::Load, &above), run.modes().aircraft().static_load(), 1e-15);
    assert_close(&read(&run, &Quantity::GearDisplacement, &above), &[1e3; 3], 1e-14);
}

#[test]
fn a_level_runway_at_any_height_gives_static_loads() {
    for height in [0.0, 1.0, -3e4, 1e5 + 0.1] {
        let level = Profile::new(vec![0.0, 100.0], vec![height; 2]).unwrap();
        let run = run([&level; 3], 0.01, false);
        for row in read(&run, &Quantity::Load, &every_tenth()).chunks_exact(3) {
            assert_close(row, run.modes().aircraft().static_load(), 2.0 * f64::EPSILON);
        }
    }
}

/// The same cases on every machine; the variable PROPTEST_CASES asks for more of them.
fn cases() -> ProptestConfig {
    ProptestConfig { rng_seed: RngSeed::Fixed(1980), failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(cases())]

    #[test]
    fn a_segment_split_anywhere_changes_nothing(
        profile in profile(), share in 0.0..1.0, zeta in 0.0..2.0, damping_input: bool,
    ) {
        // A breakpoint on the line is only as exact as its elevation: split by hand.
        let (mut x, mut z) = (profile.x().to_vec(), profile.z().to_vec());
        let after = x.len() / 2;
        let station = x[after - 1] + share * (x[after] - x[after - 1]);
        z.insert(after, profile.elevation(station));
        x.insert(after, station);
        let split = Profile::new(x, z).unwrap();
        let loads = |profile| {
            let run = run([profile; 3], zeta, damping_input);
            // Between knots; a slope of a very short piece carries its elevation's last bit.
            read(&run, &Quantity::GearDisplacement, &every_tenth())
        };
        assert_close(&loads(&split), &loads(&profile), 1e-13);
    }

    #[test]
    fn left_and_right_mirror(
        nose in profile(), left in profile(), right in profile(), zeta in 0.0..2.0, damping_input: bool,
    ) {
        let load = |tracks| read(&run(tracks, zeta, damping_input), &Quantity::Load, &every_tenth());
        let mut mirrored = load([&nose, &right, &left]);
        for row in mirrored.chunks_exact_mut(3) {
            row.swap(1, 2);
        }
        assert_close(&mirrored, &load([&nose, &left, &right]), 1e-13);
    }

    #[test]
    fn extremes_hold_every_sample(profile in profile(), zeta in 0.0..0.5) {
        let run = run([&profile; 3], zeta, false);
        let times = every_tenth();
        let span = (times[0], times[times.len() - 1]);
        let extremes = run.extremes(&[Quantity::Load], span, &mut || Ok(())).unwrap();
        for row in read(&run, &Quantity::Load, &times).chunks_exact(3) {
            for (load, extreme) in row.iter().zip(&extremes) {
                let room = 1e-12 * extreme.max.abs();
                prop_assert!(extreme.min - room <= *load && *load <= extreme.max + room);
            }
        }
    }

    #[test]
    fn extremes_stretch_by_stretch(profile in profile(), zeta in 0.0..0.5, damping_input: bool) {
        let run = run([&profile; 3], zeta, damping_input);
        let quantities = [Quantity::Load, Quantity::Acceleration(vec![(100.0, 20.0)])];
        // Before the first knot, in the midst of segments, an empty stretch, beyond the last knot.
        let times = [-1.0, 0.013, 0.9, 0.91, 0.91, 3.3, 40.0];
        let found = run.extremes_between(&quantities, &times, &mut || Ok(())).unwrap();
        prop_assert_eq!(found.len(), times.len() - 1);
        for (times, found) in times.windows(2).zip(&found) {
            let alone = run.extremes(&quantities, (times[0], times[1]), &mut || Ok(())).unwrap();
            prop_assert_eq!(&alone, found);
        }
        let whole = run.extremes(&quantities, (times[0], times[6]), &mut || Ok(())).unwrap();
        for (output, whole) in whole.iter().enumerate() {
            let most = found.iter().map(|stretch| stretch[output].max).fold(f64::NEG_INFINITY, f64::max);
            let least = found.iter().map(|stretch| stretch[output].min).fold(f64::INFINITY, f64::min);
            let room = 1e-12 * whole.max.abs().max(whole.min.abs());
            prop_assert!((most - whole.max).abs() <= room && (least - whole.min).abs() <= room);
        }
    }

    #[test]
    fn mean_squares_of_spans_add_up(profile in profile(), zeta in 0.0..3.0, damping_input: bool) {
        let run = run([&profile; 3], zeta, damping_input);
        let quantities = [Quantity::DynamicLoad, Quantity::Acceleration(vec![(100.0, 20.0)])];
        let squares = |begin: f64, end: f64| -> Vec<f64> {
            let roots = run.root_mean_squares(&quantities, (begin, end), &mut || Ok(())).unwrap();
            roots.into_iter().map(|root| (end - begin) * root * root).collect()
        };
        // Before the first knot, in the midst of segments, a single time, beyond the last knot.
        let times = [-1.0, 0.013, 0.9, 0.91, 0.91, 3.3, 40.0];
        let mut sums = vec![0.0; 4];
        for span in times.windows(2) {
            sums.iter_mut().zip(squares(span[0], span[1])).for_each(|(sum, part)| *sum += part);
        }
        for (sum, whole) in sums.into_iter().zip(squares(times[0], times[6])) {
            prop_assert!((sum - whole).abs() <= 1e-12 * whole, "{sum:?} {whole:?}");
        }
        // All at once, also where a stretch ends at a knot or is a single one.
        let middle = profile.x()[profile.x().len() / 2] / SPEED;
        for times in [&times[..], &[0.0, middle, middle, 2.0 * middle + 1.0], &[middle, middle]] {
            let found = run.root_mean_squares_between(&quantities, times, &mut || Ok(())).unwrap();
            prop_assert_eq!(found.len(), times.len() - 1);
            for (span, found) in times.windows(2).zip(found) {
                let alone =
                    run.root_mean_squares(&quantities, (span[0], span[1]), &mut || Ok(())).unwrap();
                prop_assert_eq!(alone, found);
            }
        }
    }
}

#[test]
fn spans_of_time_out_of_order_are_refused() {
    let run = run([&Profile::new(vec![0.0, 12.0], vec![0.0, 1.5]).unwrap(); 3], 0.01, false);
    let within = |span| run.extremes(&[Quantity::Load], span, &mut || Ok(()));
    assert!(within((0.0, 8.0)).is_ok());
    for span in [(0.0, f64::INFINITY), (8.0, 0.0), (f64::NAN, 8.0), (0.0, 1e300)] {
        assert!(within(span).is_err(), "{span:?}");
    }
    for times in [vec![], vec![1.0], vec![0.0, 2.0, 1.0], vec![0.0, f64::NAN, 1.0]] {
        assert!(run.extremes_between(&[Quantity::Load], &times, &mut || Ok(())).is_err(), "{times:?}");
        let roots = run.root_mean_squares_between(&[Quantity::Load], &times, &mut || Ok(()));
        assert!(roots.is_err(), "{times:?}");
    }
}

/// Long enough for many blocks of knots; some lengths come back, among many that never do.
#[test]
fn lengths_that_come_back_are_told_from_others() {
    let mut seed = 1980_u64;
    let mut random = move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 53) as f64
    };
    let (mut x, mut z) = (vec![0.0], vec![0.0]);
    let (mut halved_x, mut halved_z) = (x.clone(), z.clone());
    for _ in 0..3000 {
        // Sixteenths of an inch add up without rounding.
        let length =
            if random() < 0.3 { 1.0 + (4.0 * random()).floor() } else { (160.0 * random()).ceil() / 16.0 };
        let (from, rise) = ((x[x.len() - 1], z[z.len() - 1]), random() - 0.5);
        x.push(from.0 + length);
        z.push(from.1 + rise);
        halved_x.extend([from.0 + 0.5 * length, from.0 + length]);
        halved_z.extend([from.1 + 0.5 * rise, from.1 + rise]);
    }
    let (whole, halved) = (Profile::new(x, z).unwrap(), Profile::new(halved_x, halved_z).unwrap());
    let times: Vec<f64> = (0..1000).map(|i| 0.05 * f64::from(i)).collect();
    for damping_input in [false, true] {
        let loads =
            [&whole, &halved].map(|p| read(&run([p; 3], 0.01, damping_input), &Quantity::Load, &times));
        assert_close(&loads[0], &loads[1], 1e-11);
    }
}

/// Room for results is what a common grid of knots needs, not one row a knot of every gear.
#[test]
fn gears_on_a_common_grid_share_its_knots() {
    // The wheelbase of 279.25 in is 1117 spacings.
    let count = 20_000;
    let x: Vec<f64> = (0..count).map(|i| 0.25 * f64::from(i)).collect();
    let z: Vec<f64> = (0..count).map(|i| f64::from(i * i % 7) * 0.1).collect();
    let track = Arc::new(Profile::new(x, z).unwrap());
    let modes = f4e::modes(20.0, 0.01);
    let tracks = [&track; 3].map(Arc::clone);
    let run = Run::new(modes, &tracks, SPEED, false).unwrap();
    let grid = run.grid(None).unwrap();
    let (mut time, mut modal, mut rate) =
        (vec![0.0; grid.most], vec![0.0; 3 * grid.most], vec![0.0; 3 * grid.most]);
    let rows = run.sample(grid, &mut time, &mut modal, &mut rate, &mut || Ok(())).unwrap();
    assert!(
        rows >= 21_117 && rows <= grid.most && grid.most < rows + rows / 20,
        "{rows} rows, room for {}",
        grid.most
    );
    assert!(time[..rows].is_sorted());
}

/// Spacings about that of the default times, where rounding decides how many rows there are.
#[test]
fn a_state_depends_on_its_time_alone() {
    let level = Profile::level();
    let fastest = run([&level; 3], 0.01, false).modes().omega().iter().copied().fold(0.0, f64::max);
    let step = SPEED * std::f64::consts::TAU / (20.0 * fastest);
    for spacing in [0.3 * step, step.next_down(), step, step.next_up(), 1.5 * step, 40.0 * step] {
        let x = (0..90).map(|i| 1000.0 + spacing * f64::from(i)).collect();
        let profile = Profile::new(x, (0..90).map(|i| f64::from(i * i % 7)).collect()).unwrap();
        for tracks in [[&profile; 3], [&level, &profile, &profile]] {
            let run = run(tracks, 0.01, false);
            let grid = run.grid(None).unwrap();
            // As much room as is said to be enough, and no more.
            let room = || vec![0.0; 3 * grid.most];
            let (mut times, mut modal, mut rate) = (vec![0.0; grid.most], room(), room());
            let rows = run.sample(grid, &mut times, &mut modal, &mut rate, &mut || Ok(())).unwrap();
            assert!(rows > 300 && times[..rows].is_sorted());
            assert!(times[..rows].windows(2).all(|pair| SPEED * (pair[1] - pair[0]) < 1.001 * step));
            for row in 0..rows {
                let (mut p, mut v) = ([0.0; 3], [0.0; 3]);
                run.states(&times[row..=row], &mut p, &mut v, &mut || Ok(())).unwrap();
                assert_eq!((&p[..], &v[..]), (&modal[3 * row..][..3], &rate[3 * row..][..3]), "row {row}");
            }
        }
    }
}
