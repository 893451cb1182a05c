//! Time response of the coupled section by exact steps.
//!
//! A step of any size is exact for wind and forces that are held or run on a straight line over it. At constant wind
//! speed it is one product with a matrix exponential, cached per wind speed and step; where the wind changes, within the
//! step or since the last one, a Taylor series of the motion, which needs no matrix. With the discrete Laguerre model the
//! dimensionless force is sampled every `Δt = Δs B/V`; between samples the section moves exactly under that force and
//! the present dynamic pressure.

mod packed;
mod prescribed;
mod quasi_steady;
mod sampled;
mod series;
mod step_cache;

pub use prescribed::{ForceAhead, Given, KnownMotion, PrescribedForces, StripFlow};
pub use quasi_steady::{NonlinearRun, NonlinearSection};

use crate::aerodynamics::Realization;
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result, finite_numbers, non_negative, positive};
use crate::section::Dof;
use nalgebra::{DMatrix, DVector};
use packed::apply;
use sampled::Sampling;
use series::{Drive, Series};
use step_cache::StepCache;

/// Degrees of freedom at most: heave, sway, rotation.
const MAX_DOFS: usize = Dof::THREE.len();
/// Samples of the force, or parts of a changing wind, that one step may take: beyond, it is refused at once. Each costs
/// about a microsecond.
const MAX_SUBSTEPS: f64 = 1e5;
/// Parts of a series that cost as much as a matrix exponential.
const PARTS_OF_A_MATRIX: f64 = 32.0;
/// A wind below zero by this part of the wind before it (of 1 m/s at least) is at rest: what rounding leaves of a ramp
/// of some ten thousand steps.
const REST: f64 = 1e-9;
/// States smaller than this have died out. Numbers below 1e-308 are computed thirty times slower; products with the
/// coefficients of a step stay above.
const DIED_OUT: f64 = 1e-250;

/// `speed_m_s`, or zero where rounding alone has taken a wind that comes to rest below zero; `before_m_s` is the wind
/// it came from.
pub fn wind_at_rest(speed_m_s: f64, before_m_s: f64) -> f64 {
    if (-REST * before_m_s.max(1.0)..0.0).contains(&speed_m_s) {
        0.0
    } else {
        speed_m_s
    }
}

/// Wind speed and external forces at the start of a step, and their constant rates over it.
#[derive(Debug, Clone, PartialEq)]
pub struct Inputs {
    /// Wind speed, m/s.
    pub wind_speed_m_s: f64,
    /// Rate of the wind speed over the step, m/s².
    pub wind_speed_rate_m_s2: f64,
    /// External forces per unit length (n): N/m, N·m/m.
    pub force: Vec<f64>,
    /// Rates of the external forces over the step (n): per second.
    pub force_rate: Vec<f64>,
}

impl Inputs {
    /// Steady wind on a section of `dofs` degrees of freedom without external force.
    pub fn steady(wind_speed_m_s: f64, dofs: usize) -> Self {
        Self {
            wind_speed_m_s,
            wind_speed_rate_m_s2: 0.0,
            force: vec![0.0; dofs],
            force_rate: vec![0.0; dofs],
        }
    }

    fn check(&self, dofs: usize) -> Result<()> {
        non_negative("wind speed", wind_at_rest(self.wind_speed_m_s, 0.0))?;
        let finite = |values: &[f64]| values.len() == dofs && values.iter().all(|x| x.is_finite());
        if finite(&self.force) && finite(&self.force_rate) && self.wind_speed_rate_m_s2.is_finite()
        {
            Ok(())
        } else {
            Err(Error::input(
                "inputs",
                format!("{dofs} finite forces and rates"),
                format!("forces {:?}, rates {:?}", self.force, self.force_rate),
            ))
        }
    }
}

/// State of the section in motion.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SectionState {
    /// `[q, q̇, x]`: displacements (m, rad), rates, filter states (dimensionless).
    pub values: Vec<f64>,
    /// Part of `Δs` that has passed since the last sample of the discrete model, in `[0, 1)`; 0 for continuous models.
    pub phase: f64,
    /// Wind speed at the start of the last step of a continuous model, m/s; none since the release. A wind that stays is
    /// worth a matrix. It is part of the state, so that a step from here always gives the same bits.
    pub last_wind_m_s: Option<f64>,
}

/// What the section does at an instant; vectors in the order of the degrees of freedom.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Outputs {
    /// Displacements: m, rad.
    pub displacement: Vec<f64>,
    /// Rates: m/s, rad/s.
    pub rate: Vec<f64>,
    /// Accelerations: m/s², rad/s².
    pub acceleration: Vec<f64>,
    /// Self-excited forces per unit length: N/m, N·m/m.
    pub self_excited_force: Vec<f64>,
}

impl Outputs {
    /// Displacements, rates, accelerations and self-excited forces.
    pub fn lists(&self) -> [&Vec<f64>; 4] {
        [
            &self.displacement,
            &self.rate,
            &self.acceleration,
            &self.self_excited_force,
        ]
    }
}

/// Steps a coupled section.
///
/// ```
/// use aerodeck::prelude::*;
/// use aerodeck::response::{Inputs, Stepper};
///
/// let structure = SectionModel::table_4_1().structure()?;
/// let section = CoupledSection::with_model(&structure, &RationalModel::jones_flat_plate())?;
/// let mut stepper = Stepper::new(section);
/// let mut state = stepper.released(&[0.01, 0.0], &[0.0, 0.0])?; // m, rad
/// for _ in 0..1000 {
///     stepper.advance(&mut state, &Inputs::steady(20.0, 2), 0.01)?;
/// }
/// assert!(state.values[0].abs() < 0.001); // far below the onset the motion dies down
/// # Ok::<(), Error>(())
/// ```
///
/// A step is a pure function of state, inputs and step size: the cache only saves time.
#[derive(Debug, Clone)]
pub struct Stepper {
    section: CoupledSection,
    cache: StepCache,
    series: Series,
    /// Of the discrete model.
    sampling: Option<Sampling>,
    /// `[z, w, ẇ]` of the step at hand.
    operand: Vec<f64>,
}

impl Stepper {
    /// A stepper with an empty cache.
    pub fn new(section: CoupledSection) -> Self {
        let operand = vec![0.0; section.states() + 2 * section.structure().dofs.len()];
        Self {
            series: Series::new(&section),
            sampling: Sampling::of(&section),
            section,
            cache: StepCache::default(),
            operand,
        }
    }

    /// The section that is stepped.
    pub fn section(&self) -> &CoupledSection {
        &self.section
    }

    /// The section held at `displacement` until the flow has settled, then released with `rate`.
    /// The filters hold the value that the constant displacement gives.
    ///
    /// # Errors
    /// [`Error::Input`] when the vectors have not n finite entries.
    pub fn released(&self, displacement: &[f64], rate: &[f64]) -> Result<SectionState> {
        let s = self.section.structure();
        let n = s.dofs.len();
        finite_numbers("initial displacement", displacement, n)?;
        finite_numbers("initial rate", rate, n)?;
        let motion = DVector::from_fn(n, |i, _| {
            displacement[i] * s.dofs[i].motion_scale(s.width_m)
        });
        let (settle, drive) = match self.section.aerodynamics() {
            Realization::Continuous(c) => (-&c.a, &c.b),
            Realization::Discrete(d) => (DMatrix::identity(d.a.nrows(), d.a.nrows()) - &d.a, &d.b),
        };
        let mut values = [displacement, rate].concat();
        if !settle.is_empty() {
            let filters = settle.lu().solve(&(drive * motion)).ok_or_else(|| {
                Error::Numerical("released section: a filter does not settle".into())
            })?;
            values.extend(filters.iter());
        }
        Ok(SectionState {
            values,
            ..SectionState::default()
        })
    }

    /// Advances `state` by `step_s` seconds. On an error the state is as it was.
    ///
    /// # Errors
    /// [`Error::Input`] for a step that is not positive or inputs that are not finite, a wind speed that becomes
    /// negative by more than rounding, a step of more than a hundred thousand sub-steps; [`Error::Numerical`] when the motion has grown beyond what a number can hold.
    pub fn advance(
        &mut self,
        state: &mut SectionState,
        inputs: &Inputs,
        step_s: f64,
    ) -> Result<()> {
        positive("step size", step_s)?;
        inputs.check(self.section.structure().dofs.len())?;
        if inputs.wind_speed_m_s < 0.0 {
            let mut at_rest = inputs.clone();
            at_rest.wind_speed_m_s = 0.0;
            return self.advance(state, &at_rest, step_s);
        }
        if inputs.wind_speed_rate_m_s2 != 0.0 {
            let before = inputs.wind_speed_m_s;
            let end = before + inputs.wind_speed_rate_m_s2 * step_s;
            non_negative(
                "wind speed at the end of the step",
                wind_at_rest(end, before),
            )?;
        }
        if self.sampling.is_some() {
            return self.advance_sampled(state, inputs, step_s);
        }
        let same_wind = state
            .last_wind_m_s
            .is_none_or(|last| last == inputs.wind_speed_m_s);
        if inputs.wind_speed_rate_m_s2 == 0.0 && same_wind {
            self.advance_by_matrix(state, inputs, step_s)?;
        } else {
            self.advance_by_series(state, inputs, step_s)?;
        }
        state.last_wind_m_s = Some(inputs.wind_speed_m_s);
        Ok(())
    }

    fn advance_by_matrix(
        &mut self,
        state: &mut SectionState,
        inputs: &Inputs,
        step: f64,
    ) -> Result<()> {
        let step = self
            .cache
            .full_system(&self.section, inputs.wind_speed_m_s, step)?;
        load(&mut self.operand, &state.values, inputs);
        let columns = active_columns(inputs, state.values.len());
        apply(step, &self.operand[..columns], &mut state.values);
        if settled(&mut state.values) {
            return Ok(());
        }
        let before = &self.operand[..state.values.len()];
        state.values.copy_from_slice(before);
        Err(overgrown())
    }

    fn advance_by_series(
        &mut self,
        state: &mut SectionState,
        inputs: &Inputs,
        step: f64,
    ) -> Result<()> {
        let (wind, wind_rate) = (inputs.wind_speed_m_s, inputs.wind_speed_rate_m_s2);
        let parts = self.series.parts(wind + wind_rate.abs() * step, step);
        if wind_rate == 0.0 && (parts.is_nan() || parts > PARTS_OF_A_MATRIX) {
            return self.advance_by_matrix(state, inputs, step);
        }
        check_substeps(parts, step)?;
        let mut drive = Drive {
            wind,
            wind_rate,
            force: Default::default(),
        };
        let n = inputs.force.len();
        drive.force[0][..n].copy_from_slice(&inputs.force);
        drive.force[1][..n].copy_from_slice(&inputs.force_rate);
        if self.series.advance(&mut state.values, &drive, step, parts) {
            settled(&mut state.values);
            Ok(())
        } else {
            Err(overgrown())
        }
    }

    /// Motion, accelerations and self-excited forces at the instant of `state`.
    ///
    /// # Errors
    /// [`Error::Input`] for inputs that are not finite.
    pub fn outputs(
        &mut self,
        state: &SectionState,
        inputs: &Inputs,
        outputs: &mut Outputs,
    ) -> Result<()> {
        let n = self.section.structure().dofs.len();
        inputs.check(n)?;
        outputs.displacement.clear();
        outputs.displacement.extend_from_slice(&state.values[..n]);
        outputs.rate.clear();
        outputs.rate.extend_from_slice(&state.values[n..2 * n]);
        outputs.acceleration.resize(n, 0.0);
        outputs.self_excited_force.resize(n, 0.0);
        let rows = self
            .cache
            .output_rows(&self.section, inputs.wind_speed_m_s.max(0.0))?;
        self.operand[..state.values.len()].copy_from_slice(&state.values);
        self.operand[state.values.len()..][..n].copy_from_slice(&inputs.force);
        let columns = state.values.len() + n;
        let mut both = [0.0; 2 * MAX_DOFS];
        let both = &mut both[..2 * n];
        apply(rows, &self.operand[..columns], both);
        outputs.acceleration.copy_from_slice(&both[..n]);
        outputs.self_excited_force.copy_from_slice(&both[n..]);
        Ok(())
    }

    /// `d/dt` of the state values; filters of the discrete model stand still between samples.
    ///
    /// # Errors
    /// [`Error::Input`] for inputs that are not finite.
    pub fn state_derivative(&self, state: &SectionState, inputs: &Inputs) -> Result<Vec<f64>> {
        let n = self.section.structure().dofs.len();
        inputs.check(n)?;
        let z = DVector::from_column_slice(&state.values);
        let w = DVector::from_column_slice(&inputs.force);
        if let Some(sampling) = &self.sampling {
            let force = sampling.force(&state.values, inputs.wind_speed_m_s.max(0.0));
            let force = DVector::from_column_slice(&force[..n]);
            let (a, b) = self.section.structure_alone();
            let motion = a * z.rows(0, 2 * n) + b * (w + force);
            let mut derivative = vec![0.0; state.values.len()];
            derivative[..2 * n].copy_from_slice(motion.as_slice());
            return Ok(derivative);
        }
        let s = self.section.continuous_at(inputs.wind_speed_m_s.max(0.0))?;
        Ok((&s.a * z + &s.b * w).as_slice().to_vec())
    }
}

/// Writes `[z, w, ẇ]`.
fn load(operand: &mut [f64], values: &[f64], inputs: &Inputs) {
    let (z, rest) = operand.split_at_mut(values.len());
    let (w, rate) = rest.split_at_mut(inputs.force.len());
    z.copy_from_slice(values);
    w.copy_from_slice(&inputs.force);
    rate.copy_from_slice(&inputs.force_rate);
}

/// Columns of `[Φ, Γ₀, Γ₁]` that meet something other than zero.
fn active_columns(inputs: &Inputs, states: usize) -> usize {
    let zero = |v: &[f64]| v.iter().all(|x| *x == 0.0);
    let n = inputs.force.len();
    match (zero(&inputs.force), zero(&inputs.force_rate)) {
        (_, false) => states + 2 * n,
        (false, true) => states + n,
        (true, true) => states,
    }
}

/// Whether all values are finite; those that have died out become zero. Looks at all of them without a branch: this is
/// part of every step.
fn settled(values: &mut [f64]) -> bool {
    let (mut finite, mut small) = (true, false);
    for x in values.iter() {
        finite &= x.is_finite();
        small |= x.abs() < DIED_OUT;
    }
    if small {
        for x in values.iter_mut().filter(|x| x.abs() < DIED_OUT) {
            *x = 0.0;
        }
    }
    finite
}

/// Whether a step may take so many sub-steps.
fn check_substeps(count: f64, step: f64) -> Result<()> {
    if count <= MAX_SUBSTEPS {
        return Ok(());
    }
    Err(Error::input(
        "step size",
        format!("a step of at most {MAX_SUBSTEPS} sub-steps"),
        format!("{step} s, {count:.1e} sub-steps"),
    ))
}

fn overgrown() -> Error {
    Error::Numerical("step: the motion has grown beyond the range of numbers".into())
}
