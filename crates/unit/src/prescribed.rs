//! Self-excited forces on strips of deck whose motion comes from somebody else's structure, point by point.
//!
//! The motion between the points of time at which it is given, and beyond the newest, is a cubic through what is known
//! there: displacements of the last four points, or fewer with rates and accelerations. The filters are carried along
//! it exactly. A force is asked for at the instant at which it will act, which may lie ahead of the newest motion: an
//! explicit partner holds it over a step that has not begun, and late forces put the onset of flutter too high.
//!
//! Displacements alone are enough: rates and accelerations that are not given are derivatives of the cubic, to third
//! and second order in the step.

mod course;
mod filters;
mod flow;
mod gusts;
mod instant;

pub use flow::{Airflow, StripFlow};
pub use gusts::StripGusts;

use crate::aerodynamics::Realization;
use crate::error::{Error, Result};
use crate::response::LANES;
use crate::section::Dof;
use crate::variables::Dual;
use course::{COEFFICIENTS, MotionCubic, NUMBERS, POINTS};
use filters::{FilterAdvance, FilterSeries, StripLanes};
use nalgebra::DMatrix;

/// Numbers of the state that all strips share: points known, wind at the newest, times of the points.
const SHARED: usize = 2 + POINTS;

/// Motion of one coordinate at a point of time, as far as it is given.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct KnownMotion {
    /// Displacement (m or rad), rate, acceleration.
    pub values: [f64; 3],
    /// How many of them are known, one at least.
    pub known: usize,
}

/// Forces of a model on strips with a prescribed motion. The state is one list of numbers: see [`Self::rest`].
#[derive(Debug, Clone)]
pub struct PrescribedForces {
    realization: Realization,
    dofs: Vec<Dof>,
    series: FilterSeries,
    /// Strips at hand.
    group: StripLanes,
    /// State at the point of time that is being taken.
    next: Vec<f64>,
}

impl PrescribedForces {
    /// Forces of a realisation with these degrees of freedom.
    pub fn new(realization: Realization, dofs: Vec<Dof>) -> Self {
        Self {
            series: FilterSeries::new(&realization, dofs.len()),
            group: StripLanes::default(),
            next: Vec::new(),
            realization,
            dofs,
        }
    }

    /// Degrees of freedom in the order of motion and forces.
    pub fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    /// Numbers of the state of one strip: phase of the samples, filters, points of each degree of freedom.
    fn per_strip(&self) -> usize {
        1 + self.realization.states() + self.dofs.len() * POINTS * NUMBERS
    }

    /// The state before any motion has been given: numbers that all strips share, then strip by strip.
    pub fn rest(&self, strips: usize) -> Vec<f64> {
        vec![0.0; SHARED + strips * self.per_strip()]
    }

    /// Points of time at which motion has been given so far, at most those that are kept.
    fn points(state: &[f64]) -> usize {
        // a saved state comes from a file
        (state[0] as usize).min(POINTS)
    }

    /// Time of the newest point, s.
    pub fn newest_s(state: &[f64]) -> Option<f64> {
        (Self::points(state) > 0).then_some(state[2])
    }

    /// Mean wind speed at the newest point, m/s.
    pub fn newest_wind_m_s(state: &[f64]) -> f64 {
        state[1]
    }

    /// As if the deck had not moved so far and no force acted: the points stay, their motion becomes zero.
    pub fn forget(&self, state: &mut [f64]) {
        for strip in state[SHARED..].chunks_mut(self.per_strip()) {
            let first = 1 + self.realization.states();
            strip[1..first].fill(0.0);
            for point in strip[first..].chunks_mut(NUMBERS) {
                point[..3].fill(0.0);
            }
        }
    }

    /// Takes the mean wind speed and the motion, strip by strip in the order of the degrees of freedom, of a new point of time: the
    /// filters go to it along the cubic that now is known. At the first point the flow has settled around the section held there.
    /// On an error the state is as it was.
    ///
    /// # Errors
    /// [`Error::Input`] for a point that is not later than the newest and for a step of more than ten thousand parts over
    /// all strips (a hundred of each at least);
    /// [`Error::Numerical`] for a filter that does not settle, and where numbers overflow.
    pub fn take(
        &mut self,
        state: &mut [f64],
        time_s: f64,
        wind_speed_m_s: f64,
        motion: &[KnownMotion],
        strips: &[StripFlow],
    ) -> Result<()> {
        if Self::points(state) > 0 && time_s <= state[2] {
            let expected = format!("a point of time after {} s", state[2]);
            let found = format!("{time_s} s");
            return Err(Error::input("prescribed motion", expected, found));
        }
        let mut new = std::mem::take(&mut self.next);
        new.clear();
        new.extend_from_slice(state);
        self.enter(&mut new, time_s, wind_speed_m_s, motion);
        let taken = self.go_to_newest(&mut new, state[1], strips);
        if taken.is_ok() {
            state.copy_from_slice(&new);
        }
        self.next = new;
        taken
    }

    /// The filters go to the newest point, from the wind before.
    fn go_to_newest(
        &mut self,
        new: &mut [f64],
        wind_before_m_s: f64,
        strips: &[StripFlow],
    ) -> Result<()> {
        let (per_strip, states) = (self.per_strip(), self.realization.states());
        if Self::points(new) == 1 {
            return self.enter_steady_flow_of(new, strips);
        }
        let (now, before) = (new[2], new[3]);
        let step = FilterAdvance {
            flows: strips,
            // to second order in the change of the wind over the step
            wind_m_s: 0.5 * (wind_before_m_s + new[1]),
            duration_s: now - before,
        };
        self.series.prepare(&step)?;
        for (i, flows) in strips.chunks(LANES).enumerate() {
            self.load(new, i * LANES, flows, before - now);
            self.advance(&step, flows)?;
            let each = new[SHARED + i * LANES * per_strip..].chunks_mut(per_strip);
            for (lane, strip) in each.take(flows.len()).enumerate() {
                strip[0] = self.group.phases[lane];
                strip[1..=states].copy_from_slice(&self.group.filters[lane * states..][..states]);
            }
        }
        Ok(())
    }

    /// The filters of the strips at hand go on.
    fn advance(&mut self, step: &FilterAdvance, flows: &[StripFlow]) -> Result<()> {
        let (series, group) = (&mut self.series, &mut self.group);
        match &self.realization {
            Realization::Continuous(_) => series.advance(step, flows, group),
            Realization::Discrete(d) => series.advance_sampled(d, step, flows, group),
        }
    }

    /// Forces on all strips in the order of the degrees of freedom, N/m or N·m/m, with their rates in steady wind, per second: `ahead_s`
    /// seconds after the newest motion, under its wind and in air of this density (kg/m³). Before any motion was given they are zero.
    ///
    /// # Errors
    /// [`Error::Input`] for a step of more than ten thousand parts over all strips; [`Error::Numerical`] beyond the range
    /// of numbers.
    pub fn ahead(
        &mut self,
        state: &[f64],
        strips: &[StripFlow],
        ahead_s: f64,
        density: f64,
        forces: &mut [Dual],
    ) -> Result<()> {
        if Self::points(state) == 0 {
            forces.fill(Dual::default());
            return Ok(());
        }
        let (n, states) = (self.dofs.len(), self.realization.states());
        let step = FilterAdvance {
            flows: strips,
            wind_m_s: state[1],
            duration_s: ahead_s,
        };
        self.series.prepare(&step)?;
        let groups = strips.chunks(LANES).zip(forces.chunks_mut(LANES * n));
        for (i, (flows, forces)) in groups.enumerate() {
            self.load(state, i * LANES, flows, 0.0);
            if ahead_s > 0.0 {
                self.advance(&step, flows)?;
            }
            let each = flows.iter().zip(forces.chunks_mut(n));
            for (lane, (flow, forces)) in each.enumerate() {
                let courses = &mut self.group.courses[lane * n..][..n];
                courses.iter_mut().for_each(|c| *c = c.from(ahead_s));
                let filters = &self.group.filters[lane * states..][..states];
                let air = flow.in_air(state[1], density);
                self.forces(filters, &self.group.courses[lane * n..], air, forces);
            }
        }
        Ok(())
    }

    fn strip(&self, s: usize) -> std::ops::Range<usize> {
        let per_strip = self.per_strip();
        SHARED + s * per_strip..SHARED + (s + 1) * per_strip
    }

    /// Enters the point in front of the others.
    fn enter(&self, state: &mut [f64], time_s: f64, wind_speed_m_s: f64, motion: &[KnownMotion]) {
        state.copy_within(2..SHARED - 1, 3);
        state[0] = (Self::points(state) + 1).min(POINTS) as f64;
        (state[1], state[2]) = (wind_speed_m_s, time_s);
        let n = self.dofs.len();
        for (i, motion) in motion.iter().enumerate() {
            let first = self.strip(i / n).end - (n - i % n) * POINTS * NUMBERS;
            state.copy_within(first..first + (POINTS - 1) * NUMBERS, first + NUMBERS);
            let point = &mut state[first..first + NUMBERS];
            point[..3].copy_from_slice(&motion.values);
            point[3] = motion.known as f64;
        }
    }

    /// Loads strips from `first` on, the time of their dimensionless courses beginning `from` seconds after the newest point.
    fn load(&mut self, state: &[f64], first: usize, flows: &[StripFlow], from: f64) {
        let (points, states) = (Self::points(state), self.realization.states());
        let (per_strip, group) = (self.per_strip(), &mut self.group);
        group.filters.clear();
        group.courses.clear();
        let each = state[SHARED + first * per_strip..].chunks(per_strip);
        for (lane, (strip, flow)) in each.zip(flows).enumerate() {
            let (filters, of_dofs) = strip[1..].split_at(states);
            group.phases[lane] = strip[0];
            group.filters.extend_from_slice(filters);
            for (dof, known) in self.dofs.iter().zip(of_dofs.chunks(POINTS * NUMBERS)) {
                let known = &known[..points * NUMBERS];
                let course = MotionCubic::through(&state[2..2 + points], known);
                let scaled = course.times(dof.motion_scale(flow.width_m));
                group.courses.push(scaled.from(from));
            }
        }
    }

    /// The filters of sections held where they are until the flow has settled.
    fn enter_steady_flow_of(&self, state: &mut [f64], strips: &[StripFlow]) -> Result<()> {
        let steady_flow = self.steady_flow()?;
        let states = self.realization.states();
        for (strip, flow) in state[SHARED..].chunks_mut(self.per_strip()).zip(strips) {
            let (filters, known) = strip[1..].split_at_mut(states);
            let points = known.chunks(POINTS * NUMBERS);
            let displacement: Vec<f64> = points.map(|newest| newest[0]).collect();
            self.enter_steady_flow(&steady_flow, &displacement, flow.width_m, filters);
        }
        Ok(())
    }

    /// `½ρ s (V²(e₀ r + C z) + V B e₁ ṙ + B² e₂ r̈)` with the scale `s` of each force, and its rate.
    fn forces(&self, filters: &[f64], courses: &[MotionCubic], air: Airflow, forces: &mut [Dual]) {
        let (wind, width) = (air.wind_m_s, air.width_m);
        let mut motion = [[0.0; COEFFICIENTS]; Dof::THREE.len()];
        for (motion, course) in motion.iter_mut().zip(courses) {
            *motion = course.derivatives();
        }
        let flow_rate = wind / width;
        // q V², and its rate
        let row = |c: &DMatrix<f64>, i: usize, z: &dyn Fn(usize) -> f64| -> f64 {
            (0..c.ncols()).map(|k| c[(i, k)] * z(k)).sum()
        };
        for (i, (force, dof)) in forces.iter_mut().zip(&self.dofs).enumerate() {
            let scale = 0.5 * air.density_kg_m3 * dof.force_scale(width);
            *force = match &self.realization {
                Realization::Continuous(c) => {
                    let driven = |order: usize| {
                        wind * wind * row(&c.e0, i, &|j| motion[j][order])
                            + wind * width * row(&c.e1, i, &|j| motion[j][order + 1])
                    };
                    let mass =
                        |order: usize| width * width * row(&c.e2, i, &|j| motion[j][order + 2]);
                    let moves = |k: usize| {
                        flow_rate
                            * (row(&c.a, k, &|m| filters[m]) + row(&c.b, k, &|j| motion[j][0]))
                    };
                    let lagging = |of: &dyn Fn(usize) -> f64| wind * wind * row(&c.c, i, of);
                    Dual {
                        value: scale * (driven(0) + mass(0) + lagging(&|k| filters[k])),
                        slope: scale * (driven(1) + mass(1) + lagging(&moves)),
                    }
                }
                // held from sample to sample
                Realization::Discrete(d) => {
                    Dual::from(scale * wind * wind * row(&d.c, i, &|k| filters[k]))
                }
            };
        }
    }
}

#[cfg(test)]
mod tests;
