//! What is refused says where and which value.

use std::sync::Arc;

use runway_modal::aircraft::{Aircraft, Gear, Inertia};
use runway_modal::error::Result;
use runway_modal::modes::{Damping, Modes};
use runway_modal::sweep::Course;
use runway_modal::worst::{SpeedRange, Target};
use runway_modal::{profile::Profile, readout::Quantity, run::Run};

fn inertia() -> Inertia {
    Inertia { mass: 2.0, pitch: 3.0, roll: 4.0, gravity: 9.8 }
}

fn aircraft() -> Arc<Aircraft> {
    Arc::new(Aircraft::new(inertia(), vec![Gear::new("leg", 0.0, 0.0, 50.0, 0.0).unwrap()]).unwrap())
}

fn modes() -> Arc<Modes> {
    Arc::new(Modes::natural(aircraft(), Damping::All(0.01)).unwrap())
}

fn run(speed: f64) -> Result<Run> {
    Run::new(modes(), &[Arc::new(Profile::level())], speed, false)
}

/// The message of what must fail names all `parts`.
fn refused<T>(result: Result<T>, parts: &[&str]) {
    let error = result.err().expect("accepted");
    let message = error.to_string();
    for part in parts {
        assert!(message.contains(part), "'{message}' does not name '{part}'");
    }
    assert!(!error.is_numerical());
}

#[test]
fn gears() {
    refused(Gear::new("leg", f64::NAN, 0.0, 1.0, 0.0), &["x = NaN", "not finite"]);
    refused(Gear::new("leg", 0.0, 0.0, -7.5, 0.0), &["stiffness = -7.5", "not positive"]);
    refused(Gear::new("leg", 0.0, 0.0, 1.0, -0.25), &["damping = -0.25", "negative"]);
}

#[test]
fn aircraft_of_them() {
    let gear = |name, x| Gear::new(name, x, 0.0, 50.0, 0.0).unwrap();
    refused(Aircraft::new(inertia(), vec![]), &["gears", "0"]);
    refused(Aircraft::new(Inertia { mass: 0.0, ..inertia() }, vec![gear("a", 0.0)]), &["mass = 0.0"]);
    let twins = vec![gear("a", 1.0), gear("b", 0.0), gear("a", -1.0)];
    refused(Aircraft::new(inertia(), twins), &["'a'", "gears[0]", "gears[2]"]);
    let soft = Gear { stiffness: 0.0, ..gear("b", 0.0) };
    refused(Aircraft::new(inertia(), vec![gear("a", 1.0), soft]), &["gears[1].stiffness = 0.0"]);
    refused(Aircraft::new(inertia(), vec![gear("a", 1e150)]), &["gears[0].x = 1e150"]);
    // Weight ahead of the only gear.
    refused(Aircraft::new(inertia(), vec![gear("a", -2.0)]), &["pitch", "1 gear(s)", "arm -2"]);
}

#[test]
fn profiles() {
    refused(Profile::new(vec![], vec![]), &["x", "0"]);
    refused(Profile::new(vec![0.0], vec![0.0, 1.0]), &["z", "2", "1"]);
    refused(Profile::new(vec![0.0, 2.0, 1.5], vec![0.0; 3]), &["x[2] = 1.5", "2.0"]);
    refused(Profile::new(vec![0.0, 1.0], vec![0.0, f64::INFINITY]), &["z[1] = inf"]);
    refused(Profile::new(vec![0.0, 1e-300], vec![0.0, 1e300]), &["z[1] = 1e300", "elevations"]);
}

#[test]
fn ratios_and_shapes() {
    refused(Modes::natural(aircraft(), Damping::All(-0.5)), &["damping_ratio = -0.5", "negative"]);
    refused(Modes::natural(aircraft(), Damping::Each(&[0.1, 0.2])), &["damping_ratio", "2", "1"]);
    let shape = modes().shapes()[0];
    let measured = |omega, zeta, shape| Modes::measured(aircraft(), vec![omega], &[zeta], vec![shape], false);
    refused(measured(0.0, 0.0, shape), &["omega[0] = 0.0"]);
    refused(measured(5.0, -1.0, shape), &["damping_ratio[0] = -1.0"]);
    refused(measured(5.0, 0.0, 1.1 * shape), &["shapes", "1.21", "Eq. 7"]);
}

#[test]
fn runs_and_times() {
    refused(run(0.0), &["speed = 0.0", "not positive"]);
    refused(run(f64::NEG_INFINITY), &["speed = -inf"]);
    refused(Run::new(modes(), &[], 1.0, false), &["tracks", "0", "1"]);
    let run = run(10.0).unwrap();
    let read = |times: &[f64]| {
        run.read(&Quantity::Load, times, &mut vec![0.0; times.len()], &mut || Ok(()))?;
        run.elevations(times, &mut vec![0.0; times.len()], &mut || Ok(()))?;
        let [mut modal, mut rate] = [vec![0.0; times.len()], vec![0.0; times.len()]];
        run.states(times, &mut modal, &mut rate, &mut || Ok(()))
    };
    read(&[0.0, 3.0, 3.0]).unwrap();
    refused(read(&[]), &["times", "0"]);
    refused(read(&[f64::NAN, 1.0]), &["times[0] = NaN"]);
    refused(read(&[0.0, 3.0, 2.5]), &["times[2] = 2.5", "3.0"]);
    run.read(&Quantity::Acceleration(Vec::new()), &[0.0], &mut [], &mut || Ok(())).unwrap();
    refused(run.grid(Some(-2.0)), &["duration = -2.0"]);
}

#[test]
fn courses() {
    let level = || Arc::new(Profile::level());
    refused(Course::new(modes(), vec![level(), level()], false), &["tracks has 2", "1 expected"]);
    let course = Course::new(modes(), vec![level()], false).unwrap();
    let range = SpeedRange { low: 1.0, high: 2.0, tolerance: 0.1, max_runs: 1000 };
    refused(course.worst(Target::MaxLoad(1), range, &mut || Ok(())), &["no gear number 1", "1 gear(s)"]);
}
