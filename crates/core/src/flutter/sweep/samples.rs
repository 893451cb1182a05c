//! The onset of a section with the discrete Laguerre model, from that of the same forces without sampling.

use super::SweptOnset;
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::state_space::{ValueAt, secant};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// First step of the secant, relative to the speed; what sampling moves the onset by is of this size.
const FIRST_STEP: f64 = 1e-4;
/// The onset is known when a step is smaller than this part of the speed.
const KNOWN: f64 = 1e-11;
/// It is known to be there when a step is smaller than this part.
const THERE: f64 = 1e-3;
const MAX_STEPS: usize = 8;
/// How far sampling may move the onset.
const NEAR: f64 = 0.01;
/// Growth of other modes up to this part of the frequency is rounding.
const ROUNDING: f64 = 1e-9;

/// `onset`, found without sampling, moved to where the growth of the same mode among the eigenvalues of the sampled
/// section vanishes. `None` when it is not found close by, or another mode grows there.
///
/// # Errors
/// [`crate::Error::Numerical`] when eigenvalues cannot be computed.
pub fn at_samples(section: &CoupledSection, onset: SweptOnset) -> Result<Option<SweptOnset>> {
    moved(section, onset, KNOWN)
}

/// Whether [`at_samples`] finds the onset: its first step tells, where it is as small as sampling makes it, and costs a third
/// less.
///
/// # Errors
/// [`crate::Error::Numerical`] when eigenvalues cannot be computed.
pub fn stands_at_samples(section: &CoupledSection, onset: SweptOnset) -> Result<bool> {
    Ok(moved(section, onset, THERE)?.is_some())
}

/// The onset to this part of the speed.
fn moved(section: &CoupledSection, onset: SweptOnset, known: f64) -> Result<Option<SweptOnset>> {
    let begin = onset.speed_m_s;
    let (start, _) = mode_near(section, begin, TAU * onset.frequency_hz)?;
    let beside = begin * (1.0 - FIRST_STEP.copysign(start.re));
    let (growth, mut omega) = (ValueAt::new(begin, start.re), start.im);
    let ends = [f64::INFINITY, known];
    let found = secant(growth, beside, ends, MAX_STEPS, |speed| -> Result<_> {
        if (speed / begin - 1.0).abs() >= NEAR {
            return Ok(None);
        }
        let (now, others) = mode_near(section, speed, omega)?;
        omega = now.im;
        let alone = others <= ROUNDING * now.norm();
        Ok(alone.then_some(now.re))
    })?;
    Ok(found.map(|speed_m_s| SweptOnset {
        speed_m_s,
        frequency_hz: omega / TAU,
        ..onset
    }))
}

/// The eigenvalue in continuous time, rad/s, that is nearest to `iω` at a wind speed, and the fastest growth, 1/s, of all modes but this
/// one and its conjugate.
fn mode_near(section: &CoupledSection, speed_m_s: f64, omega: f64) -> Result<(Complex<f64>, f64)> {
    let modes = section.at(speed_m_s)?.eigenvalues()?;
    let wanted = Complex::new(0.0, omega);
    let upper = modes.iter().filter(|z| z.im > 0.0);
    let lambda = upper.fold(Complex::new(f64::NAN, f64::NAN), |best, z| {
        if (z - wanted).norm() >= (best - wanted).norm() {
            best
        } else {
            *z
        }
    });
    let own = |z: &&Complex<f64>| **z != lambda && **z != lambda.conj();
    let others = modes.iter().filter(own).map(|z| z.re);
    Ok((lambda, others.fold(f64::NEG_INFINITY, f64::max)))
}
