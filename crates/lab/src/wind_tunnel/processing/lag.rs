//! Lag between motion and force channels, from the inertia in still air.
//!
//! In still air the force on the cells by a model that moves as `x = X e^{iωt}` is `F = (μω² − κ − icω) X`: inertia in antiphase
//! with the acceleration, a stiffness of gravity, a little damping. Channels that are late by τ say `F e^{−iωτ}`. Over the test
//! frequencies weighted least squares of `Im(F/X)/ω` on `Re(F/X)` and a constant gives τ and c, repeated until the turned-back
//! ratio gives none. μ and κ then follow from the real part. Runs of one or two frequencies take c and κ from all runs of their
//! motion together; where these have one frequency, c and κ are left out: τ may be damping, and μ of a rotation holds the weight.

use super::body::{self, StillAirInertia};
use super::cells::{about_centre, sum_about_centre};
use super::signals::HarmonicSegment;
use crate::error::{Error, Result, ensure};
use crate::section::Dof;
use crate::signal::fit_sine;
use crate::wind_tunnel::{RawRecording, Rig};
use nalgebra::{Complex, Matrix2, Vector2};
use std::f64::consts::TAU;

/// `F/X` at one frequency with the variance of either part.
#[derive(Clone)]
pub(super) struct Ratio {
    pub omega: f64,
    pub value: Complex<f64>,
    pub variance: f64,
}

/// Inertia of a cell up to this part of that of the model is rounding, which has no scatter to be judged by …
const ROUNDING: f64 = 1e-9;
/// … and in rotation up to this part what a force at the arm of a cell gives, of either sign, where another cell takes the moment.
const OF_LEVERS: f64 = 0.05;
/// Frequencies that differ by less are one, met twice.
const ONE_FREQUENCY: f64 = 0.02;

/// Forces over the motion of a run in still air at each frequency: on the model, about its centre of rotation, and of each cell the
/// one in the direction of the motion.
pub(super) struct Ratios {
    run: String,
    pub total: [Vec<Ratio>; 3],
    /// The motions over the driven one; empty where not recorded.
    pub motion: [Vec<Ratio>; 3],
    cells: Vec<Vec<Ratio>>,
}

impl Ratios {
    /// Those of `still`, in which `dof` moves.
    ///
    /// # Errors
    /// [`Error::Input`] of a segment to which no sine can be fitted.
    pub(super) fn new(
        run: &str,
        still: &RawRecording,
        rig: &Rig,
        dof: Dof,
        segments: &[HarmonicSegment],
    ) -> Result<Self> {
        let motion = &still.motion[super::index(dof)];
        // a lag of the axes behind the model would be of second order here
        let at_rest = vec![0.0; still.sample_count()];
        let cells = super::cells::to_global(still, rig, &at_rest);
        let of = |force: &[f64]| ratios(motion, force, still.sampling_hz, segments);
        let besides = |d: usize| match &still.motion[d] {
            none if none.is_empty() => Ok(Vec::new()),
            moves => of(moves),
        };
        let [lift, drag, moment] = sum_about_centre(&cells, rig, &at_rest);
        let places = rig.cells.iter().zip(&cells);
        let cells =
            places.map(|(place, cell)| of(&about_centre(cell, place, &at_rest)[super::index(dof)]));
        Ok(Self {
            run: run.to_owned(),
            total: [of(&lift)?, of(&drag)?, of(&moment)?],
            motion: [besides(0)?, besides(1)?, besides(2)?],
            cells: cells.collect::<Result<_>>()?,
        })
    }
}

/// Lag and inertia of each of the `runs` in which `dof` moves; `None` without harmonic segments, an error naming the run when the
/// inertia says that a channel has the wrong sign or that two are exchanged.
pub(super) fn still_air_inertia(
    rig: &Rig,
    dof: Dof,
    runs: &[&Ratios],
) -> Vec<Result<Option<StillAirInertia>>> {
    let total = Dof::THREE.map(|force| {
        let of_force = runs.iter().map(|r| &r.total[super::index(force)][..]);
        solve_together(force, &of_force.collect::<Vec<_>>())
    });
    let cells = (0..rig.cells.len()).map(|cell| {
        let of_cell = runs.iter().map(|r| &r.cells[cell][..]);
        solve_together(dof, &of_cell.collect::<Vec<_>>())
    });
    let cells: Vec<_> = cells.collect();
    let judged = runs.iter().enumerate().map(|(k, run)| {
        let total = total.each_ref().map(|force| force[k].as_ref());
        let Some(own) = total[super::index(dof)] else {
            return Ok(None);
        };
        let cells = cells.iter().map(|cell| cell[k].as_ref());
        judge(&run.run, rig, own, total, cells)?;
        Ok(Some(own.clone()))
    });
    judged.collect()
}

/// Refuses what no body shows on the `total` and on the `cells`.
fn judge<'a>(
    run: &str,
    rig: &Rig,
    own: &StillAirInertia,
    total: [Option<&StillAirInertia>; 3],
    cells: impl Iterator<Item = Option<&'a StillAirInertia>>,
) -> Result<()> {
    // the weight of the model may be all that one frequency of rotation shows
    if own.hides_weight() {
        return Ok(());
    }
    for across in total.into_iter().flatten() {
        body::check_motion(run, rig, own, across)?;
    }
    if own.is_certain() && own.inertia < 0.0 {
        return Err(wrong_sign(run, "sum of the cells", own));
    }
    // of a translation the other force
    let other = match own.dof {
        Dof::Vertical => total[super::index(Dof::Lateral)],
        Dof::Lateral => total[super::index(Dof::Vertical)],
        Dof::Torsion => None,
    };
    if let Some(across) = other {
        refuse_exchanged(run, own, across)?;
    }
    // a cell of which one channel is turned round takes from the sum what it should add
    let least = match own.dof {
        Dof::Torsion => OF_LEVERS,
        _ => ROUNDING,
    };
    for (place, one) in rig.cells.iter().zip(cells) {
        if let Some(one) = one
            && one.is_certain()
            && one.inertia < -least * own.inertia.abs()
        {
            return Err(wrong_sign(run, &format!("cell {}", place.name), one));
        }
    }
    Ok(())
}

/// Refuses more inertia `across` than in the force of the motion itself.
fn refuse_exchanged(run: &str, own: &StillAirInertia, across: &StillAirInertia) -> Result<()> {
    let name = own.dof.name();
    ensure(
        !across.is_certain() || across.inertia.abs() <= own.inertia.abs(),
        format_args!("run {run}, still air"),
        format_args!("inertia of the {name} motion in the {name} force"),
        format_args!(
            "{:.4} kg there and {:.4} kg in the {} force: force or motion channels are exchanged",
            own.inertia,
            across.inertia,
            across.dof.name()
        ),
    )
}

fn wrong_sign(run: &str, what: &str, found: &StillAirInertia) -> Error {
    Error::input(
        format!("run {run}, still air, {what}"),
        format!(
            "a {} force in antiphase with the acceleration, as inertia is",
            found.dof.name()
        ),
        format!(
            "one in phase (inertia {:.4} ± {:.4}): the sign of a force or motion channel is reversed, or channels are swapped",
            found.inertia, found.inertia_standard_error
        ),
    )
}

fn ratios(
    motion: &[f64],
    force: &[f64],
    sampling_hz: f64,
    segments: &[HarmonicSegment],
) -> Result<Vec<Ratio>> {
    let ratio = |s: &HarmonicSegment| {
        let range = s.plateau.range();
        let fit = |x: &[f64]| fit_sine(x, range.clone(), sampling_hz, s.segment.frequency_hz);
        let (x, f) = (fit(motion)?, fit(force)?);
        let size = x.fundamental().norm_sqr();
        let noise = f.residual_rms.powi(2) * 2.0 / (range.len() as f64 * size);
        let value = f.fundamental() / x.fundamental();
        Ok(Ratio {
            omega: TAU * s.segment.frequency_hz,
            value,
            // rounding of a noiseless record
            variance: noise.max(1e-24 * value.norm_sqr()).max(f64::MIN_POSITIVE),
        })
    };
    segments.iter().map(ratio).collect()
}

/// The inertia of each of the `runs` of one motion in the force of `dof`. Runs of less than three frequencies do not tell stiffness
/// and damping by themselves: they take those of all runs together.
pub(super) fn solve_together(dof: Dof, runs: &[&[Ratio]]) -> Vec<Option<StillAirInertia>> {
    let all = solve(dof, runs.iter().copied().flatten(), None);
    let tells = |run: &[Ratio]| distinct(run.iter()) > 2;
    let sharing = runs.iter().filter(|run| !tells(run)).count() as f64;
    let solved = runs.iter().map(|run| {
        if tells(run) {
            return solve(dof, run.iter(), None);
        }
        let (all, mut own) = (all.as_ref()?, solve(dof, run.iter(), all.as_ref())?);
        if all.stiffness.is_some() {
            // what they share scatters in all of them: their mean is no better than the fit of all
            let wider = |own: f64, all: f64| own.hypot(all * sharing.sqrt());
            own.lag_standard_error_s = wider(own.lag_standard_error_s, all.lag_standard_error_s);
            own.inertia_standard_error =
                wider(own.inertia_standard_error, all.inertia_standard_error);
        }
        Some(own)
    });
    solved.collect()
}

/// Number of different frequencies.
fn distinct<'a>(ratios: impl Iterator<Item = &'a Ratio>) -> usize {
    let mut omegas: Vec<f64> = ratios.map(|r| r.omega).collect();
    omegas.sort_by(f64::total_cmp);
    omegas.dedup_by(|next, kept| *next <= *kept * (1.0 + ONE_FREQUENCY));
    omegas.len()
}

/// Lag and inertia with stiffness and damping, which are those of `known` if there is one; one frequency alone tells neither.
fn solve<'a>(
    dof: Dof,
    ratios: impl Iterator<Item = &'a Ratio> + Clone,
    known: Option<&StillAirInertia>,
) -> Option<StillAirInertia> {
    let both = known.is_none() && distinct(ratios.clone()) > 1;
    let (stiffness, damping) = known.map_or((None, None), |k| (k.stiffness, k.damping));
    let (mut lag, mut found, mut variance) = (0.0, 0.0, 0.0);
    for _ in 0..6 {
        let rows = ratios.clone().map(|r| {
            let turned = r.value * Complex::from_polar(1.0, r.omega * lag);
            let weight = r.omega * r.omega / r.variance;
            let value = turned.im / r.omega + damping.unwrap_or(0.0);
            ([-turned.re, -1.0], value, weight)
        });
        let (step, covariance) = weighted_fit(rows, both)?;
        lag += step[0];
        found = step[1];
        variance = covariance;
    }
    let rows = ratios.map(|r| {
        let turned = r.value * Complex::from_polar(1.0, r.omega * lag);
        let value = turned.re + stiffness.unwrap_or(0.0);
        ([r.omega * r.omega, -1.0], value, 1.0 / r.variance)
    });
    let (real, inertia_variance) = weighted_fit(rows, both)?;
    Some(StillAirInertia {
        dof,
        lag_s: lag,
        lag_standard_error_s: variance.sqrt(),
        inertia: real[0],
        inertia_standard_error: inertia_variance.sqrt(),
        stiffness: if both { Some(real[1]) } else { stiffness },
        damping: if both { Some(found) } else { damping },
        centre_of_mass_m: None,
    })
}

/// Weighted least squares of one or two unknowns and the variance of the first, for weights of inverse variance.
fn weighted_fit(
    rows: impl Iterator<Item = ([f64; 2], f64, f64)>,
    both: bool,
) -> Option<([f64; 2], f64)> {
    let (mut gram, mut moments) = (Matrix2::zeros(), Vector2::zeros());
    for (row, value, weight) in rows {
        let row = Vector2::new(row[0], if both { row[1] } else { 0.0 });
        gram += row * row.transpose() * weight;
        moments += row * (value * weight);
    }
    let finite = |found: ([f64; 2], f64)| found.1.is_finite().then_some(found);
    if !both {
        let variance = 1.0 / gram[(0, 0)];
        return finite(([moments[0] * variance, 0.0], variance));
    }
    // columns differ by orders of magnitude
    let scale = Vector2::new(gram[(0, 0)].sqrt(), gram[(1, 1)].sqrt());
    let scaled = Matrix2::from_fn(|i, j| gram[(i, j)] / (scale[i] * scale[j]));
    let inverse = scaled.try_inverse()?;
    let solution = inverse * moments.component_div(&scale);
    let result = solution.component_div(&scale);
    let variance = inverse[(0, 0)] / (scale[0] * scale[0]);
    finite((result.into(), variance))
}

/// One lag of the force channels behind the motion for a campaign, s, the mean of its runs by inverse variance, and its standard error,
/// `None` where it may be damping as well; nothing when no run tells it. Runs that cannot tell it from
/// damping are asked where there are no others.
pub(crate) fn common_lag(runs: &[StillAirInertia], sampling_hz: f64) -> Option<(f64, Option<f64>)> {
    let told = || runs.iter().filter(|r| r.tells_lag(sampling_hz));
    let is_known = told().any(|r| r.damping.is_some());
    let telling = || told().filter(|r| !is_known || r.damping.is_some());
    let weight = |r: &StillAirInertia| r.lag_standard_error_s.max(1e-12).powi(-2);
    let sum: f64 = telling().map(weight).sum();
    let mean = telling().map(|r| weight(r) * r.lag_s).sum::<f64>() / sum;
    (sum > 0.0).then(|| (mean, is_known.then(|| sum.sqrt().recip())))
}
