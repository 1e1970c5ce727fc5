//! The report's aircraft for tests and benches: Tables 1 and 2, in lbf, in, s.

use std::sync::Arc;

use runway_modal::aircraft::{Aircraft, Gear, Inertia};
use runway_modal::modes::{Damping, Modes};

/// With the same damper on each gear, and a damping ratio in every mode.
pub fn modes(damper: f64, zeta: f64) -> Arc<Modes> {
    let inertia = Inertia { mass: 145.5, pitch: 1.92e6, roll: 6.56e5, gravity: 386.0886 };
    let gear = |name, x, y, stiffness| Gear::new(name, x, y, stiffness, damper).unwrap();
    let gears = vec![
        gear("nose", 234.9, 0.0, 1502.0),
        gear("left", -44.35, 109.25, 9102.0),
        gear("right", -44.35, -109.25, 9102.0),
    ];
    let aircraft = Arc::new(Aircraft::new(inertia, gears).unwrap());
    Arc::new(Modes::natural(aircraft, Damping::All(zeta)).unwrap())
}
