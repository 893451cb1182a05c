//! Lag between motion and force channels, from the inertia in still air.
//!
//! In still air the force on the cells by a model that moves as `x = X e^{iωt}` is `F = (μω² − κ − icω) X`: inertia in antiphase
//! with the acceleration, a stiffness of gravity, a little damping. Channels that are late by τ say `F e^{−iωτ}`. Over the test
//! frequencies weighted least squares of `Im(F/X)/ω` on `Re(F/X)` and a constant gives τ and c, repeated until the turned-back
//! ratio gives none; of one or two frequencies c is left out. μ and κ then follow from the real part.

use super::body::{self, StillAirInertia};
use super::cells::sum_about_centre;
use super::signals::HarmonicSegment;
use crate::error::{Error, Result, ensure};
use crate::section::Dof;
use crate::signal::fit_sine;
use crate::wind_tunnel::{RawRecording, Rig};
use nalgebra::{Complex, Matrix2, Vector2};
use std::f64::consts::TAU;

/// `F/X` at one frequency with the variance of either part.
struct Ratio {
    omega: f64,
    value: Complex<f64>,
    variance: f64,
}

/// Inertia of a cell up to this part of that of the model is rounding, which has no scatter to be judged by.
const ROUNDING: f64 = 1e-9;

/// Lag and inertia of `still` in `dof`, the one that moves; `None` without harmonic segments.
///
/// # Errors
/// [`Error::Input`] naming `run` when the inertia says that a channel has the wrong sign or that two are exchanged.
pub(crate) fn still_air_inertia(
    run: &str,
    still: &RawRecording,
    rig: &Rig,
    dof: Dof,
    segments: &[HarmonicSegment],
) -> Result<Option<StillAirInertia>> {
    let motion = &still.motion[super::index(dof)];
    let rates = still.sampling_hz;
    // a lag of the axes behind the model would be of second order here
    let at_rest = vec![0.0; still.sample_count()];
    let cells = super::cells::to_global(still, rig, &at_rest);
    let total = sum_about_centre(&cells, rig, &at_rest);
    let of = |force: &[f64]| Ok(solve(dof, &ratios(motion, force, rates, segments)?));
    let Some(result) = of(&total[super::index(dof)])? else {
        return Ok(None);
    };
    let others: &[Dof] = match dof {
        Dof::Torsion => &[Dof::Vertical, Dof::Lateral],
        _ => &[Dof::Torsion],
    };
    for other in others {
        let force = &total[super::index(*other)];
        if let Some(across) = solve(*other, &ratios(motion, force, rates, segments)?) {
            body::check_motion(run, rig, &result, &across)?;
        }
    }
    if result.is_certain() && result.inertia < 0.0 {
        return Err(wrong_sign(run, "sum of the cells", dof, &result));
    }
    // of a translation the other force, and the channel of each cell that measures it
    let (other, channel) = match dof {
        Dof::Vertical => (Dof::Lateral, 1),
        Dof::Lateral => (Dof::Vertical, 0),
        Dof::Torsion => return Ok(Some(result)),
    };
    if let Some(across) = of(&total[super::index(other)])? {
        refuse_exchanged(run, &result, &across, other)?;
    }
    // a cell of which one channel is turned round takes from the sum what it should add
    for (place, cell) in rig.cells.iter().zip(&cells) {
        if let Some(one) = of(&cell[channel])?
            && one.is_certain()
            && one.inertia < -ROUNDING * result.inertia.abs()
        {
            return Err(wrong_sign(run, &format!("cell {}", place.name), dof, &one));
        }
    }
    Ok(Some(result))
}

/// Refuses more inertia `across`, in the force of `other`, than in that of the motion itself.
fn refuse_exchanged(
    run: &str,
    own: &StillAirInertia,
    across: &StillAirInertia,
    other: Dof,
) -> Result<()> {
    let name = own.dof.name();
    ensure(
        !across.is_certain() || across.inertia.abs() <= own.inertia.abs(),
        format_args!("run {run}, still air"),
        format_args!("inertia of the {name} motion in the {name} force"),
        format_args!(
            "{:.4} kg there and {:.4} kg in the {} force: force or motion channels are exchanged",
            own.inertia,
            across.inertia,
            other.name()
        ),
    )
}

fn wrong_sign(run: &str, what: &str, dof: Dof, found: &StillAirInertia) -> Error {
    Error::input(
        format!("run {run}, still air, {what}"),
        format!(
            "a {} force in antiphase with the acceleration, as inertia is",
            dof.name()
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
    segments
        .iter()
        .map(|s| {
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
        })
        .collect()
}

fn solve(dof: Dof, ratios: &[Ratio]) -> Option<StillAirInertia> {
    if ratios.is_empty() {
        return None;
    }
    let full = ratios.len() > 2;
    let (mut lag, mut damping, mut variance) = (0.0, 0.0, 0.0);
    for _ in 0..6 {
        let rows = ratios.iter().map(|r| {
            let turned = r.value * Complex::from_polar(1.0, r.omega * lag);
            let weight = r.omega * r.omega / r.variance;
            ([-turned.re, -1.0], turned.im / r.omega, weight)
        });
        let (step, covariance) = weighted_fit(rows, full)?;
        lag += step[0];
        damping = step[1];
        variance = covariance;
    }
    let rows = ratios.iter().map(|r| {
        let turned = r.value * Complex::from_polar(1.0, r.omega * lag);
        ([r.omega * r.omega, -1.0], turned.re, 1.0 / r.variance)
    });
    let (real, inertia_variance) = weighted_fit(rows, ratios.len() > 1)?;
    Some(StillAirInertia {
        dof,
        lag_s: lag,
        lag_standard_error_s: variance.sqrt(),
        inertia: real[0],
        inertia_standard_error: inertia_variance.sqrt(),
        stiffness: real[1],
        damping,
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
    if !both {
        let variance = 1.0 / gram[(0, 0)];
        return variance
            .is_finite()
            .then_some(([moments[0] * variance, 0.0], variance));
    }
    // columns differ by orders of magnitude
    let scale = Vector2::new(gram[(0, 0)].sqrt(), gram[(1, 1)].sqrt());
    let scaled = Matrix2::from_fn(|i, j| gram[(i, j)] / (scale[i] * scale[j]));
    let inverse = scaled.try_inverse()?;
    let solution = inverse * moments.component_div(&scale);
    let result = solution.component_div(&scale);
    let variance = inverse[(0, 0)] / (scale[0] * scale[0]);
    variance
        .is_finite()
        .then_some(([result[0], result[1]], variance))
}

/// Lag of the force channels of a campaign behind its motion.
pub(crate) struct CommonLag {
    pub lag_s: f64,
    pub standard_error_s: f64,
}

/// One lag for a campaign: the mean of its runs by inverse variance; `None` when no run tells it.
pub(crate) fn common_lag(runs: &[StillAirInertia], sampling_hz: f64) -> Option<CommonLag> {
    let telling = || runs.iter().filter(|r| r.tells_lag(sampling_hz));
    let weight = |r: &StillAirInertia| r.lag_standard_error_s.max(1e-12).powi(-2);
    let sum: f64 = telling().map(weight).sum();
    let mean = telling().map(|r| weight(r) * r.lag_s).sum::<f64>() / sum;
    (sum > 0.0).then(|| CommonLag {
        lag_s: mean,
        standard_error_s: sum.sqrt().recip(),
    })
}
