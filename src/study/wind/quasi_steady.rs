//! Quasi-steady theory of a wind file: equilibria, linear model, onset, a nonlinear run.

use super::{SimulationBlock, WindStudy};
use crate::aerodynamics::GustSeries;
use crate::aerodynamics::quasi_steady::{CoefficientRow, CoefficientsAt, LinearQuasiSteady};
use crate::aeroelastic::{
    CoupledSection, EquilibriumEnd, EquilibriumPath, StaticEquilibrium, static_equilibria,
};
use crate::buffeting::NonlinearSection;
use crate::buffeting::{BuffetingProblem, turbulence_field};
use crate::error::{Error, Result, ensure};
use crate::files::gusts::read_gusts;
use crate::flutter::{FlutterCurves, QuasiSteadyOnset, quasi_steady_modes, quasi_steady_onset};
use crate::response::{Inputs, Stepper};
use crate::section::{Dof, Structure};
use crate::verdict::{Divergence, Evidence, FlutterReading, ForceBasis, Verdict};
use serde::Serialize;

/// Agreement that halving the step has to reach.
const STEP_TOLERANCE: f64 = 1e-6;
/// Mean of a series of gusts over the mean wind from which it holds that wind; of a gust that stays, a half is a lot.
const MEAN_AT_MOST: f64 = 0.5;
/// Angles of the line through the coefficients in the figure.
const LINE_POINTS: usize = 161;

/// Results of quasi-steady theory over wind speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct QuasiSteadyStudy {
    /// Name of the coefficients.
    pub coefficients: String,
    /// Degrees of freedom, in the order of all vectors.
    pub dofs: Vec<Dof>,
    /// Static equilibria.
    pub equilibria: EquilibriumPath,
    /// The linear model at the equilibrium of each speed.
    pub linear: Vec<LinearQuasiSteady>,
    /// Frequencies and damping about the equilibria.
    pub curves: FlutterCurves,
    /// Onset.
    pub onset: QuasiSteadyOnset,
    /// What it amounts to.
    pub verdict: Verdict,
    /// Rows of the table, for the figure.
    #[serde(skip)]
    pub rows: Vec<CoefficientRow>,
    /// The line through them: angle (deg) and coefficients.
    #[serde(skip)]
    pub line: Vec<(f64, CoefficientsAt)>,
}

/// Equilibria, linear models, modes and onset of a wind file.
pub(crate) fn quasi_steady_study(study: &WindStudy) -> Result<QuasiSteadyStudy> {
    let structure = study.section()?.structure()?;
    let theory = study.quasi_steady()?;
    let table = theory.coefficients();
    let range = study.speed_range()?;
    let speeds = range.curve_speeds_m_s();
    let equilibria = static_equilibria(&structure, &theory, &speeds)?;
    let name = format!("quasi-steady, {}", table.name);
    let points = equilibria.points.iter();
    let linear = points.map(|p| theory.linearised(p.rotation_rad));
    let linear = linear.collect::<Result<_>>()?;
    let (low, high) = table.range_rad();
    let line = (0..LINE_POINTS).map(|i| {
        let angle = low + (high - low) * i as f64 / (LINE_POINTS - 1) as f64;
        Ok((angle.to_degrees(), table.at(angle)?))
    });
    let line = line.collect::<Result<_>>()?;
    let onset = quasi_steady_onset(&name, &structure, &theory, &range.search())?;
    let mut known = evidence(study, &onset);
    known.searched_to_m_s = Some(range.searched_to_m_s);
    Ok(QuasiSteadyStudy {
        verdict: Verdict::judge(&known),
        coefficients: table.name.clone(),
        dofs: structure.dofs.clone(),
        curves: quasi_steady_modes(&name, &structure, &theory, &equilibria)?,
        onset,
        rows: table.rows().to_vec(),
        linear,
        equilibria,
        line,
    })
}

/// What quasi-steady theory says of a section, as evidence: no test of it stands behind.
pub(super) fn evidence(study: &WindStudy, onset: &QuasiSteadyOnset) -> Evidence {
    let forces = "quasi-steady theory";
    let mut evidence = Evidence {
        required: study.speeds.required(),
        flutter: vec![FlutterReading {
            forces: forces.to_owned(),
            search: onset.search.clone(),
            basis: ForceBasis::Stated,
        }],
        implausible: study.findings(),
        ..Evidence::default()
    };
    match onset.equilibrium_end {
        Some(EquilibriumEnd::Divergence { speed_m_s, .. }) => {
            let at = Divergence::at(forces, Some(speed_m_s));
            evidence.divergence.push(at);
        }
        Some(end @ EquilibriumEnd::OutsideTable { .. }) => evidence.remarks.push(end.explain()),
        None => {}
    }
    evidence
}

/// One run with nonlinear forces, and the same with the linear ones.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct SimulatedMotion {
    /// Mean wind speed, m/s.
    pub speed_m_s: f64,
    /// Degrees of freedom.
    pub dofs: Vec<Dof>,
    /// Where it starts from, apart from the release.
    pub equilibrium: StaticEquilibrium,
    /// Time between rows, s.
    pub step_s: f64,
    /// Displacements (n) and rates (n): m, rad, m/s, rad/s.
    pub nonlinear: Vec<Vec<f64>>,
    /// The same with forces linear about the equilibrium.
    pub linear: Vec<Vec<f64>>,
    /// Steps of the nonlinear run between two rows.
    pub substeps: usize,
    /// Largest relative difference to a run with half as many.
    pub step_error: f64,
    /// The gusts: `u`, `w` at each row, m/s.
    pub gusts_m_s: Vec<(f64, f64)>,
}

/// The run that the wind file asks for; `None` when it asks for none.
pub(crate) fn simulated_motion(study: &WindStudy) -> Result<Option<SimulatedMotion>> {
    let Some(run) = &study.simulation else {
        return Ok(None);
    };
    let structure = study.section()?.structure()?;
    let theory = study.quasi_steady()?;
    let path = static_equilibria(&structure, &theory, &[run.wind_speed_m_s])?;
    let Some(equilibrium) = path.points.first().cloned() else {
        let why = path.end.map_or(String::new(), |end| end.explain());
        let speed = run.wind_speed_m_s;
        return Err(Error::Numerical(format!(
            "simulation at {speed} m/s: {why}"
        )));
    };
    let linear = theory.linearised(equilibrium.rotation_rad)?;
    let gusts = gusts(study, run, &structure, &linear)?;
    let steps = (run.duration_s / run.step_s).round().max(1.0) as usize;
    let n = structure.dofs.len();
    let mut released = vec![0.0; 2 * n];
    released[0] = run.initial_vertical_m;
    released[n - 1] = run.initial_rotation_deg.to_radians();
    let with_rest = |row: &[f64]| -> Vec<f64> {
        let rest = equilibrium.displacement.iter();
        let rest = rest.chain(std::iter::repeat(&0.0));
        row.iter().zip(rest).map(|(a, b)| a + b).collect()
    };
    let start = with_rest(&released);
    let section = NonlinearSection::new(structure.clone(), theory, run.wind_speed_m_s, &gusts)?;
    let nonlinear = section.run(&start, run.step_s, steps, STEP_TOLERANCE)?;
    let about = linear_rows(&structure, &linear, &released, &gusts, run, steps)?;
    let blown = (0..=steps).map(|i| gusts.at(run.step_s * i as f64));
    Ok(Some(SimulatedMotion {
        speed_m_s: run.wind_speed_m_s,
        dofs: structure.dofs.clone(),
        linear: about.iter().map(|row| with_rest(row)).collect(),
        gusts_m_s: blown.collect(),
        step_s: run.step_s,
        substeps: nonlinear.substeps,
        step_error: nonlinear.step_error,
        nonlinear: nonlinear.rows,
        equilibrium,
    }))
}

/// Gusts of the run: from the file named, generated, or none. The last sample is at least at the end of the run.
fn gusts(
    study: &WindStudy,
    run: &SimulationBlock,
    structure: &Structure,
    linear: &LinearQuasiSteady,
) -> Result<GustSeries> {
    if let Some(path) = &run.gusts {
        let path = study.directory.join(path);
        let gusts = read_gusts(&path)?;
        without_mean_wind(&gusts, run.wind_speed_m_s).map_err(|e| e.in_file(&path))?;
        return Ok(gusts);
    }
    let Some(turbulence) = &study.turbulence else {
        return GustSeries::calm(run.duration_s + run.step_s);
    };
    let problem = BuffetingProblem::of_section(structure, linear, Some(linear), turbulence)?;
    // an even number of samples that reaches beyond the end
    let samples = 2 * (0.5 * run.duration_s / run.step_s).ceil() as usize + 2;
    let (speed, step_s) = (run.wind_speed_m_s, run.step_s);
    let gusts = turbulence_field(&problem, speed, step_s, samples.max(16), run.seed)?;
    let [along, vertical] = gusts.map(|rows| rows.concat());
    GustSeries::new(step_s, along, vertical)
}

/// Refuses gusts that hold the mean wind, which would blow twice.
fn without_mean_wind(gusts: &GustSeries, wind_speed_m_s: f64) -> Result<()> {
    let along = gusts.along_m_s();
    let mean = along.iter().sum::<f64>() / along.len() as f64;
    let gusts_alone = mean.abs() < MEAN_AT_MOST * wind_speed_m_s;
    let expected = format_args!("gusts without the mean wind of {wind_speed_m_s} m/s");
    let found = format_args!("a mean of {mean:.3} m/s");
    ensure(gusts_alone, "column u_m_s", expected, found)
}

/// Motion about the equilibrium under linear forces and gusts on straight lines, by exact steps.
fn linear_rows(
    structure: &Structure,
    linear: &LinearQuasiSteady,
    released: &[f64],
    gusts: &GustSeries,
    run: &SimulationBlock,
    steps: usize,
) -> Result<Vec<Vec<f64>>> {
    let (n, step_s) = (structure.dofs.len(), run.step_s);
    let mut stepper = Stepper::new(CoupledSection::with_model(structure, linear)?);
    let mut state = stepper.released(&released[..n], &released[n..])?;
    let half_rho_v = 0.5 * structure.air_density_kg_m3 * run.wind_speed_m_s;
    let buffeting = structure.forces_at_axis(linear.buffeting.clone());
    let force = |time: f64| -> Vec<f64> {
        let (u, w) = gusts.at(time);
        let dofs = structure.dofs.iter();
        let scales = dofs.map(|d| d.force_scale(structure.width_m));
        let rows = buffeting.row_iter().zip(scales);
        rows.map(|(row, scale)| half_rho_v * scale * (row[0] * u + row[1] * w))
            .collect()
    };
    let mut inputs = Inputs::steady(run.wind_speed_m_s, n);
    let mut rows = vec![state.values.clone()];
    for i in 0..steps {
        let (now, next) = (force(step_s * i as f64), force(step_s * (i + 1) as f64));
        let rates = now.iter().zip(&next).map(|(a, b)| (b - a) / step_s);
        inputs.force_rate = rates.collect();
        inputs.force = now;
        stepper.advance(&mut state, &inputs, step_s)?;
        rows.push(state.values.clone());
    }
    Ok(rows)
}
