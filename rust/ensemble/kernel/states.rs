//! Rises, and states and heights at the starts of all legs.

use pulp::Simd;

use super::super::vector::{Part, Vector, parts};
use super::{Ground, March, Push};
use crate::modes::MODES;

impl March {
    /// Rises, states and, where they are needed, heights at the start of every leg; in the tail there
    /// are fewer legs.
    #[inline(always)]
    pub(super) fn find_states<S: Simd>(&mut self, simd: S, count: usize, legs: usize) {
        let tail = legs < self.layout.legs;
        match (legs, self.layout.damped) {
            (0, _) => self.states[0].iter_mut().zip(&self.state).for_each(|(rows, now)| rows[0] = *now),
            (1, false) if !tail => self.march_parts::<S, 1, false>(simd, count, legs),
            (2, false) if !tail => self.march_parts::<S, 2, false>(simd, count, legs),
            (3, false) if !tail => self.march_parts::<S, 3, false>(simd, count, legs),
            (2, true) if !tail => self.march_parts::<S, 2, true>(simd, count, legs),
            (_, false) => self.march_parts::<S, 0, false>(simd, count, legs),
            (_, true) => self.march_parts::<S, 0, true>(simd, count, legs),
        }
        // Gears that the tail leaves out.
        let met = self.layout.members[..legs].last().map_or(0, |members| members.end);
        for Ground { z, rise } in &mut self.ground[met..] {
            rise[1] = z[1] - z[0];
        }
        if self.layout.heights {
            // The tail ends where its next leg begins.
            self.find_heights(count, if tail { legs + 1 } else { legs });
        }
    }

    /// States at the start of every leg; `L` legs, any number for 0.
    #[inline(always)]
    fn march_parts<S: Simd, const L: usize, const DAMPED: bool>(
        &mut self,
        simd: S,
        count: usize,
        legs: usize,
    ) {
        for part in parts(simd) {
            if L == 0 {
                let mut pushes: Vec<_> =
                    (0..self.layout.legs).map(|leg| self.last_push::<S, DAMPED>(part, leg)).collect();
                self.march::<S, DAMPED>(part, count, legs, &mut pushes);
            } else {
                let mut pushes = [[[part.all(0.0); MODES]; 2]; L];
                for (leg, push) in pushes.iter_mut().enumerate() {
                    *push = self.last_push::<S, DAMPED>(part, leg);
                }
                self.march::<S, DAMPED>(part, count, L, &mut pushes);
            }
        }
    }

    /// What the last rises before the block drive the modes with.
    #[inline(always)]
    fn last_push<S: Simd, const DAMPED: bool>(&self, part: Part<S>, leg: usize) -> Push<Vector<S>> {
        let mut push = [[part.all(0.0); MODES]; 2];
        for group in self.layout.members[leg].clone() {
            let rise = part.load(&self.ground[group].rise[0]);
            for mode in 0..MODES {
                push[0][mode] = push[0][mode] + part.load(&self.constants.climb[group][mode]) * rise;
                if DAMPED {
                    push[1][mode] = push[1][mode] + part.load(&self.constants.drag[group][mode]) * rise;
                }
            }
        }
        push
    }

    #[inline(always)]
    fn march<S: Simd, const DAMPED: bool>(
        &mut self,
        part: Part<S>,
        count: usize,
        legs: usize,
        pushes: &mut [Push<Vector<S>>],
    ) {
        let Self { layout, constants, ground, ahead, states, state, .. } = self;
        // Slices: what stands behind a vector would be fetched anew in every period.
        let (ground, climb, drag) = (&mut ground[..], &constants.climb[..], &constants.drag[..]);
        let (members, steps) = (&layout.members[..legs], &constants.steps[..legs]);
        let all = &mut states[..];
        let mut now = part.load_all(state);
        for i in 0..count {
            ahead.ask(i);
            for leg in 0..legs {
                let mut push = [[part.all(0.0); MODES]; 2];
                for group in members[leg].clone() {
                    let Ground { z, rise: rises } = &mut ground[group];
                    let rise = part.load(&z[i + 1]) - part.load(&z[i]);
                    part.store(rise, &mut rises[i + 1]);
                    for mode in 0..MODES {
                        push[0][mode] = push[0][mode] + part.load(&climb[group][mode]) * rise;
                        if DAMPED {
                            push[1][mode] = push[1][mode] + part.load(&drag[group][mode]) * rise;
                        }
                    }
                }
                pushes[leg][0] = push[0];
                if DAMPED {
                    pushes[leg][1] = push[1];
                }
                for (now, rows) in now.iter().zip(&mut all[leg]) {
                    part.store(*now, &mut rows[i]);
                }
                for mode in 0..MODES {
                    let [mut beta, mut gamma] = [pushes[0][0][mode], pushes[0][1][mode]];
                    for [more_beta, more_gamma] in &pushes[1..] {
                        beta = beta + more_beta[mode];
                        if DAMPED {
                            gamma = gamma + more_gamma[mode];
                        }
                    }
                    let step = &steps[leg][mode];
                    let [g, s, w, h] = part.load_all(&[step.g, step.s, step.w, step.h]);
                    let (d, v) = (now[mode], now[MODES + mode]);
                    let mut after_d = (d - h * beta) + (s * v - g * d);
                    let mut after_v = (v + g * beta) - (w * v + s * d);
                    if DAMPED {
                        after_d = after_d + g * gamma;
                        after_v = after_v + s * gamma;
                    }
                    (now[mode], now[MODES + mode]) = (after_d, after_v);
                }
            }
        }
        let (leg, i) = layout.after(legs - 1, count - 1);
        for (k, now) in now.into_iter().enumerate() {
            part.store(now, &mut all[leg][k][i]);
            part.store(now, &mut state[k]);
        }
    }

    /// Elevations at the start of every leg, as heights above that of the group of the first track, and its own rise.
    #[inline(always)]
    fn find_heights(&mut self, count: usize, legs: usize) {
        let Self { layout, constants, ground, heights, origin, .. } = self;
        for leg in 0..legs {
            for (group, out) in heights[leg].iter_mut().enumerate() {
                let met = |group: usize| usize::from(layout.groups[group].leg <= leg);
                let (share, datum) = (&constants.from_station[leg], layout.datum);
                for i in 0..count {
                    let below = share[datum] * ground[datum].rise[i + met(datum)];
                    let climb = share[group] * ground[group].rise[i + met(group)];
                    out[i] = if group == datum {
                        (ground[group].z[i] - *origin) + climb
                    } else {
                        (ground[group].z[i] - ground[datum].z[i]) + (climb - below)
                    };
                }
            }
        }
    }
}
