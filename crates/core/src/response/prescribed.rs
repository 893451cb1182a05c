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
mod instant;

use crate::aerodynamics::Realization;
use crate::error::{Error, Result};
use crate::section::Dof;
use course::{COEFFICIENTS, MotionCubic, NUMBERS, POINTS};
use filters::{Buffers, MotionInterval, advance_continuous, advance_discrete};
use nalgebra::{DMatrix, DVector};

/// Numbers of the state that all strips share: points known, wind at the newest, times of the points.
const SHARED: usize = 2 + POINTS;

/// The air around one strip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StripFlow {
    /// Width `B`, m.
    pub width_m: f64,
    /// Mean wind speed at the strip over that of [`GivenMotion`].
    pub wind_factor: f64,
}

impl StripFlow {
    /// The air that passes the strip in this mean wind (m/s), of this density (kg/m³).
    pub fn in_air(&self, mean_wind_m_s: f64, density_kg_m3: f64) -> Airflow {
        Airflow {
            wind_m_s: mean_wind_m_s * self.wind_factor,
            width_m: self.width_m,
            density_kg_m3,
        }
    }
}

/// The air that passes a strip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Airflow {
    /// Wind speed there, m/s.
    pub wind_m_s: f64,
    /// Width of the deck, m.
    pub width_m: f64,
    /// kg/m³.
    pub density_kg_m3: f64,
}

/// What is known of the motion of one coordinate at a point of time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct KnownMotion {
    /// Displacement (m or rad), rate, acceleration.
    pub values: [f64; 3],
    /// How many of them are known, one at least.
    pub known: usize,
}

/// Wind and motion of all strips at one point of time.
#[derive(Debug, Clone, Copy)]
pub struct GivenMotion<'a> {
    /// Point of time, s.
    pub time_s: f64,
    /// Mean wind speed, m/s.
    pub wind_speed_m_s: f64,
    /// Motion, strip by strip in the order of the degrees of freedom.
    pub motion: &'a [KnownMotion],
}

/// A force and how fast it changes, per unit length.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ForceAhead {
    /// N/m or N·m/m.
    pub force: f64,
    /// Its rate in steady wind, per second.
    pub rate: f64,
}

/// Forces of a model on strips with a prescribed motion. The state is one list of numbers: see [`Self::rest`].
#[derive(Debug, Clone)]
pub struct PrescribedForces {
    realization: Realization,
    dofs: Vec<Dof>,
    /// Size of the filter matrix, its largest sum over a row.
    size: f64,
    buffers: Buffers,
    courses: Vec<MotionCubic>,
    filters: Vec<f64>,
    /// State at the point of time that is being taken.
    next: Vec<f64>,
}

impl PrescribedForces {
    /// Forces of a realisation with these degrees of freedom.
    pub fn new(realization: Realization, dofs: Vec<Dof>) -> Self {
        let size = match &realization {
            Realization::Continuous(c) => row_sum(&c.a),
            Realization::Discrete(_) => 0.0,
        };
        Self {
            courses: Vec::with_capacity(dofs.len()),
            filters: Vec::with_capacity(realization.states()),
            next: Vec::new(),
            realization,
            dofs,
            size,
            buffers: Buffers::default(),
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

    /// Takes the motion of a new point of time: the filters go to it along the cubic that now is known. At the first
    /// point the flow has settled around the section held there. On an error the state is as it was.
    ///
    /// # Errors
    /// [`Error::Input`] for a point that is not later than the newest and for a step of more than ten thousand parts over
    /// all strips (a hundred of each at least);
    /// [`Error::Numerical`] for a filter that does not settle, and where numbers overflow.
    pub fn take(
        &mut self,
        state: &mut [f64],
        given: &GivenMotion,
        strips: &[StripFlow],
    ) -> Result<()> {
        if Self::points(state) > 0 && given.time_s <= state[2] {
            return Err(Error::input(
                "prescribed motion",
                format!("a point of time after {} s", state[2]),
                format!("{} s", given.time_s),
            ));
        }
        let mut new = std::mem::take(&mut self.next);
        new.clear();
        new.extend_from_slice(state);
        let taken = self.take_into(&mut new, state[1], given, strips);
        if taken.is_ok() {
            state.copy_from_slice(&new);
        }
        self.next = new;
        taken
    }

    /// The same in place, from the wind before.
    fn take_into(
        &mut self,
        new: &mut [f64],
        wind_before_m_s: f64,
        given: &GivenMotion,
        strips: &[StripFlow],
    ) -> Result<()> {
        self.enter(new, given);
        let points = Self::points(new);
        for (s, flow) in strips.iter().enumerate() {
            if points == 1 {
                self.settle(new, s, flow)?;
                continue;
            }
            let (now, before) = (new[2], new[3]);
            // to second order in the change of the wind over the step
            let wind = 0.5 * (wind_before_m_s + given.wind_speed_m_s);
            self.load_courses(new, s, flow, before - now);
            let from = self.strip(s);
            let (phase, filters) = new[from].split_at_mut(1);
            let filters = &mut filters[..self.realization.states()];
            let way = MotionInterval {
                courses: &self.courses,
                duration_s: now - before,
                rate_per_s: wind * flow.wind_factor / flow.width_m,
                strips: strips.len(),
            };
            advance(
                &self.realization,
                self.size,
                filters,
                &mut phase[0],
                &way,
                &mut self.buffers,
            )?;
        }
        Ok(())
    }

    /// Forces on strip `s` in the order of the degrees of freedom, `ahead_s` seconds after the newest motion, under its
    /// wind and in air of this density (kg/m³). Before any motion was given they are zero.
    ///
    /// # Errors
    /// [`Error::Input`] for a step of more than ten thousand parts over all strips; [`Error::Numerical`] beyond the range
    /// of numbers.
    pub fn ahead(
        &mut self,
        state: &[f64],
        s: usize,
        flow: &StripFlow,
        ahead_s: f64,
        density: f64,
        forces: &mut [ForceAhead],
    ) -> Result<()> {
        if Self::points(state) == 0 {
            forces.fill(ForceAhead::default());
            return Ok(());
        }
        let air = flow.in_air(state[1], density);
        self.load_courses(state, s, flow, 0.0);
        let strip = &state[self.strip(s)];
        let mut phase = strip[0];
        let mut filters = std::mem::take(&mut self.filters);
        filters.clear();
        filters.extend_from_slice(&strip[1..=self.realization.states()]);
        let way = MotionInterval {
            courses: &self.courses,
            duration_s: ahead_s,
            rate_per_s: air.wind_m_s / air.width_m,
            strips: (state.len() - SHARED) / self.per_strip(),
        };
        if ahead_s > 0.0 {
            let (realization, size) = (&self.realization, self.size);
            let buffers = &mut self.buffers;
            advance(realization, size, &mut filters, &mut phase, &way, buffers)?;
        }
        for course in &mut self.courses {
            *course = course.from(ahead_s);
        }
        self.forces(&filters, air, forces);
        self.filters = filters;
        Ok(())
    }

    fn strip(&self, s: usize) -> std::ops::Range<usize> {
        let per_strip = self.per_strip();
        SHARED + s * per_strip..SHARED + (s + 1) * per_strip
    }

    /// Enters the point in front of the others.
    fn enter(&self, state: &mut [f64], given: &GivenMotion) {
        state.copy_within(2..SHARED - 1, 3);
        state[0] = (Self::points(state) + 1).min(POINTS) as f64;
        (state[1], state[2]) = (given.wind_speed_m_s, given.time_s);
        let n = self.dofs.len();
        for (i, motion) in given.motion.iter().enumerate() {
            let first = self.strip(i / n).end - (n - i % n) * POINTS * NUMBERS;
            state.copy_within(first..first + (POINTS - 1) * NUMBERS, first + NUMBERS);
            let point = &mut state[first..first + NUMBERS];
            point[..3].copy_from_slice(&motion.values);
            point[3] = motion.known as f64;
        }
    }

    /// Dimensionless courses of strip `s`, their time beginning `from` seconds after the newest point.
    fn load_courses(&mut self, state: &[f64], s: usize, flow: &StripFlow, from: f64) {
        let points = Self::points(state);
        let strip = &state[self.strip(s)];
        let of_dofs = &strip[1 + self.realization.states()..];
        self.courses.clear();
        for (dof, known) in self.dofs.iter().zip(of_dofs.chunks(POINTS * NUMBERS)) {
            let course = MotionCubic::through(&state[2..2 + points], &known[..points * NUMBERS]);
            let scaled = course.times(dof.motion_scale(flow.width_m));
            self.courses.push(scaled.from(from));
        }
    }

    /// The filters of a section held where it is until the flow has settled.
    fn settle(&mut self, state: &mut [f64], s: usize, flow: &StripFlow) -> Result<()> {
        self.load_courses(state, s, flow, 0.0);
        let motion = self.courses.iter().map(|c| c.coefficients()[0]);
        let motion = DVector::from_iterator(self.dofs.len(), motion);
        let (matrix, drive) = match &self.realization {
            Realization::Continuous(c) => (-&c.a, &c.b),
            Realization::Discrete(d) => (DMatrix::identity(d.a.nrows(), d.a.nrows()) - &d.a, &d.b),
        };
        if matrix.is_empty() {
            return Ok(());
        }
        let settled = matrix.lu().solve(&(drive * motion));
        let settled = settled.ok_or_else(unsettled)?;
        let first = self.strip(s).start + 1;
        state[first..first + settled.len()].copy_from_slice(settled.as_slice());
        Ok(())
    }

    /// `½ρ s (V²(e₀ r + C z) + V B e₁ ṙ + B² e₂ r̈)` with the scale `s` of each force, and its rate.
    fn forces(&self, filters: &[f64], air: Airflow, forces: &mut [ForceAhead]) {
        let (wind, width) = (air.wind_m_s, air.width_m);
        let mut motion = [[0.0; COEFFICIENTS]; Dof::THREE.len()];
        for (motion, course) in motion.iter_mut().zip(&self.courses) {
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
                    let fed = |order: usize| {
                        wind * wind * row(&c.e0, i, &|j| motion[j][order])
                            + wind * width * row(&c.e1, i, &|j| motion[j][order + 1])
                    };
                    let mass =
                        |order: usize| width * width * row(&c.e2, i, &|j| motion[j][order + 2]);
                    let moves = |k: usize| {
                        flow_rate
                            * (row(&c.a, k, &|m| filters[m]) + row(&c.b, k, &|j| motion[j][0]))
                    };
                    ForceAhead {
                        force: scale
                            * (fed(0) + mass(0) + wind * wind * row(&c.c, i, &|k| filters[k])),
                        rate: scale * (fed(1) + mass(1) + wind * wind * row(&c.c, i, &moves)),
                    }
                }
                // held from sample to sample
                Realization::Discrete(d) => ForceAhead {
                    force: scale * wind * wind * row(&d.c, i, &|k| filters[k]),
                    rate: 0.0,
                },
            };
        }
    }
}

fn unsettled() -> Error {
    Error::Numerical("prescribed motion: a filter does not settle".into())
}

fn advance(
    realization: &Realization,
    size: f64,
    filters: &mut [f64],
    phase: &mut f64,
    way: &MotionInterval,
    buffers: &mut Buffers,
) -> Result<()> {
    match realization {
        Realization::Continuous(c) => advance_continuous(c, size, filters, way, buffers),
        Realization::Discrete(d) => advance_discrete(d, filters, phase, way, buffers),
    }
}

fn row_sum(matrix: &DMatrix<f64>) -> f64 {
    let sum = |row: nalgebra::RowDVector<f64>| row.iter().map(|x| x.abs()).sum::<f64>();
    matrix
        .row_iter()
        .map(|r| sum(r.into_owned()))
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests;
