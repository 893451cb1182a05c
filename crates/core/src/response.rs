//! Time response of the coupled section by exact steps.
//!
//! A step of any size is exact for wind and forces that are held or run on a straight line over it. At constant wind
//! speed it is one product with a matrix exponential, cached per wind speed and step; where the wind changes, within the
//! step or since the last one, a Taylor series of the motion, which needs no matrix. With the discrete Laguerre model the
//! dimensionless force is sampled every `Δt = Δs B/V`; between samples the section moves exactly under that force and
//! the present dynamic pressure.

mod gusts;
mod lanes;
mod linked;
mod matrix_polynomial;
mod packed;
mod rates;
mod sampled;
mod sampling;
mod series;
mod step_cache;
mod values;

pub use lanes::LANES;
pub use linked::Sparse;
pub use values::{Inputs, Outputs, SectionState, wind_at_rest};

use crate::aerodynamics::{GustForce, RationalAdmittance, Realization};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result, finite_numbers, positive};
use crate::state_space::{StateEquation, step_matrix};
use gusts::Gusts;
use matrix_polynomial::MatrixPolynomial;
use nalgebra::{DMatrix, DVector};
use packed::{advanced, flush_subnormals};
use sampling::Sampling;
use series::{Drive, PowerSeries, overgrown};
use step_cache::{StepCache, active_columns, load};

/// Samples of the force, or parts of a changing wind, that one step may take: beyond, it is refused at once. Each costs
/// about a microsecond.
const MAX_SUBSTEPS: f64 = 1e4;
/// What a sample costs, in sub-steps, where its way is one product with a matrix.
const SAMPLE_BY_MATRIX: f64 = 0.125;
/// Parts of a series that cost as much as a matrix exponential.
const PARTS_OF_A_MATRIX: f64 = 32.0;
/// States at most whose step becomes a matrix: that of more takes seconds to make and leaves the caches of any processor.
const STATES_OF_A_MATRIX: usize = 800;

/// Steps a coupled section.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::RationalModel;
/// use aerodeck::aeroelastic::CoupledSection;
/// use aerodeck::section::SectionModel;
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
/// # Ok::<(), aerodeck::Error>(())
/// ```
///
/// A step is a pure function of state, inputs and step size: the cache only saves time.
#[derive(Debug, Clone)]
pub struct Stepper {
    section: CoupledSection,
    /// Matrices by wind speed and step size: of the whole continuous system (of a sampled one the structure alone), of that with
    /// its lagging gusts, and of many samples, also by their number.
    steps: StepCache<2>,
    steps_in_gusts: StepCache<2>,
    samples: StepCache<3>,
    /// Size (s) of the last step, where it was one by the newest matrix, and how many columns of that meet something other than zero.
    repeatable: Option<(f64, usize)>,
    series: PowerSeries,
    /// Of the discrete model.
    sampling: Option<Sampling>,
    /// Of the structure alone.
    structure: Option<MatrixPolynomial>,
    /// `[z, w, ẇ]` of the step at hand.
    operand: Vec<f64>,
    /// State after it.
    next: Vec<f64>,
    /// Both under gusts.
    in_gusts: [Vec<f64>; 2],
    /// Output equations, once they have been asked for.
    rows: Option<MatrixPolynomial>,
    /// Accelerations and forces of the outputs at hand.
    both: Vec<f64>,
    /// Outputs at the instant of the rates at hand.
    now: Outputs,
    /// State of a sampled model in the step at hand.
    sampled: SectionState,
}

impl Stepper {
    /// A stepper with an empty cache.
    pub fn new(section: CoupledSection) -> Self {
        Self::in_gusts(section, None)
    }

    /// A stepper on whose section gusts act with these forces.
    pub fn in_gusts(section: CoupledSection, force: Option<&GustForce>) -> Self {
        let gusts = force.map(|force| Gusts::new(force, section.structure()));
        Self::with_gusts(section, gusts)
    }

    /// A stepper of modes in gusts: see [`Inputs::gust_m_s`]; `per_width` is the wind factor over the width (1/m) of each group
    /// of strips, so many inputs as there are modes for each.
    pub fn in_modal_gusts(
        section: CoupledSection,
        per_width: &[f64],
        admittance: RationalAdmittance,
    ) -> Self {
        let modes = section.structure().dofs.len();
        Self::with_gusts(section, Some(Gusts::on_modes(modes, per_width, admittance)))
    }

    fn with_gusts(section: CoupledSection, gusts: Option<Gusts>) -> Self {
        let (states, n) = (section.states(), section.structure().dofs.len());
        let operand = vec![0.0; states + 2 * n];
        Self {
            next: vec![0.0; states],
            in_gusts: Default::default(),
            rows: None,
            both: vec![0.0; 2 * n],
            now: Outputs::default(),
            sampled: SectionState::default(),
            series: PowerSeries::new(&section, gusts),
            sampling: Sampling::from_section(&section),
            structure: None,
            section,
            steps: StepCache::default(),
            steps_in_gusts: StepCache::default(),
            samples: StepCache::default(),
            repeatable: None,
            operand,
        }
    }

    /// Numbers of the state of the gusts.
    pub fn gust_states(&self) -> usize {
        self.series.gusts.as_ref().map_or(0, Gusts::states)
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
        let (steady_flow, drive) = match self.section.aerodynamics() {
            Realization::Continuous(c) => (-&c.a, &c.b),
            Realization::Discrete(d) => (DMatrix::identity(d.a.nrows(), d.a.nrows()) - &d.a, &d.b),
        };
        let mut values = [displacement, rate].concat();
        if !steady_flow.is_empty() {
            let filters = steady_flow.lu().solve(&(drive * motion)).ok_or_else(|| {
                Error::Numerical("released section: a filter does not settle".into())
            })?;
            values.extend(filters.iter());
        }
        Ok(SectionState {
            values,
            gusts: vec![0.0; self.gust_states()],
            ..SectionState::default()
        })
    }

    /// Advances `state` by `step_s` seconds. On an error the state is as it was.
    ///
    /// # Errors
    /// [`Error::Input`] for a step that is not positive or inputs that are not finite, a wind speed that becomes
    /// negative by more than rounding, a step of more than ten thousand sub-steps; [`Error::Numerical`] when the motion has
    /// grown beyond what a number can hold.
    pub fn advance(
        &mut self,
        state: &mut SectionState,
        inputs: &Inputs,
        step_s: f64,
    ) -> Result<()> {
        self.repeatable = None;
        positive("step size", step_s)?;
        inputs.check(self.series.dofs, step_s)?;
        let (wind, wind_rate) = (inputs.wind_speed_m_s, inputs.wind_speed_rate_m_s2);
        if wind < 0.0 {
            let mut at_rest = inputs.clone();
            at_rest.wind_speed_m_s = 0.0;
            return self.advance(state, &at_rest, step_s);
        }
        if self.sampling.is_some() {
            return self.advance_sampled(state, inputs, step_s);
        }
        let gusts = self.gusts_act(state, inputs);
        let same_wind = state.last_wind_m_s.is_none_or(|last| last == wind);
        let steady = wind_rate == 0.0 && self.next.len() <= STATES_OF_A_MATRIX;
        let alike = steady && same_wind && !gusts;
        let fastest = wind + wind_rate.abs() * step_s;
        // a matrix that is kept has none
        let parts = match alike {
            true => 1.0,
            false => self.series.parts(fastest, step_s, gusts),
        };
        let too_many = parts.is_nan() || parts > MAX_SUBSTEPS;
        let is_long = parts.is_nan() || parts > PARTS_OF_A_MATRIX;
        match &self.series.gusts {
            _ if alike || steady && !gusts && is_long => {
                self.advance_by_matrix(state, inputs, step_s)?;
            }
            Some(of) if of.on_section && steady && same_wind && parts > 1.0 && !too_many => {
                self.advance_in_gusts(state, inputs, step_s)?;
            }
            _ if too_many => return Err(too_long(step_s, parts)),
            _ => {
                let drive = Drive {
                    inputs,
                    after: 0.0,
                    wind,
                    force: [&inputs.force, &inputs.force_rate, &[]],
                };
                let lagging = gusts.then_some(state.gusts.as_mut_slice());
                let values = &mut state.values;
                self.series
                    .advance(values, lagging, &drive, step_s, parts)?;
                flush_subnormals(values);
                flush_subnormals(&mut state.gusts);
            }
        }
        state.last_wind_m_s = Some(wind);
        Ok(())
    }

    /// Whether a gust blows or has not yet passed.
    fn gusts_act(&self, state: &SectionState, inputs: &Inputs) -> bool {
        let blowing = inputs.gust_m_s.iter().chain(&inputs.gust_rate_m_s2);
        self.series.gusts.is_some() && blowing.chain(&state.gusts).any(|x| *x != 0.0)
    }

    /// Inputs or state are others than after the last step, which cannot be repeated.
    pub fn forget_step(&mut self) {
        self.repeatable = None;
    }

    /// Takes the last step once more, where that was one by a matrix and of this size; for callers who
    /// [say](Self::forget_step) when they have touched inputs or state since. Otherwise, and where the motion overflows, false and
    /// a state as it was.
    #[inline(always)]
    pub fn repeat(&mut self, state: &mut SectionState, inputs: &Inputs, step_s: f64) -> bool {
        let (Some((last_s, columns)), Some(matrix)) = (self.repeatable, self.steps.newest()) else {
            return false;
        };
        if last_s != step_s {
            return false;
        }
        let operand = if columns == state.values.len() {
            &state.values
        } else {
            load(&mut self.operand, &state.values, inputs);
            &self.operand[..columns]
        };
        let right = advanced(matrix, operand, &mut self.next);
        if right {
            std::mem::swap(&mut state.values, &mut self.next);
        }
        right
    }

    fn advance_by_matrix(
        &mut self,
        state: &mut SectionState,
        inputs: &Inputs,
        step_s: f64,
    ) -> Result<()> {
        let (section, wind) = (&self.section, inputs.wind_speed_m_s);
        self.steps.get([wind, step_s], || {
            let StateEquation { a, b } = section.equation_at(wind)?;
            step_matrix(&a, &b, step_s)
        })?;
        let columns = active_columns(inputs, state.values.len());
        self.repeatable = Some((step_s, columns));
        if self.repeat(state, inputs, step_s) {
            return Ok(());
        }
        self.repeatable = None;
        Err(overgrown())
    }

    /// A step under gusts by a matrix, of the section with its lagging gusts.
    fn advance_in_gusts(
        &mut self,
        state: &mut SectionState,
        inputs: &Inputs,
        step_s: f64,
    ) -> Result<()> {
        let (section, wind) = (&self.section, inputs.wind_speed_m_s);
        let Some(gusts) = &self.series.gusts else {
            return self.advance_by_matrix(state, inputs, step_s);
        };
        let matrix = self.steps_in_gusts.get([wind, step_s], || {
            let StateEquation { a, b } = gusts.system(section, wind)?;
            step_matrix(&a, &b, step_s)
        })?;
        let [operand, next] = &mut self.in_gusts;
        gusts.load(operand, state, inputs);
        next.resize(state.values.len() + state.gusts.len(), 0.0);
        if !advanced(matrix, operand, next) {
            return Err(overgrown());
        }
        let (values, lagging) = next.split_at(state.values.len());
        state.values.copy_from_slice(values);
        state.gusts.copy_from_slice(lagging);
        Ok(())
    }
}

fn too_long(step: f64, parts: f64) -> Error {
    Error::input(
        "step size",
        format!("a step of at most {MAX_SUBSTEPS} sub-steps"),
        format!("{step} s, {parts:.1e} sub-steps"),
    )
}
