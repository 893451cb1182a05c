//! Modes followed over wind speed by continuation: prediction, correction, shape agreement, step halving.
//!
//! The correction is Newton's method on the small nonlinear eigenvalue problem where there is one (continuous models),
//! else the nearest eigenvalue of the whole state matrix.

use super::characteristic::Characteristic;
use crate::aeroelastic::{CoupledSection, CoupledSystem};
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::state_space::{eigenvalues, eigenvector};
use nalgebra::{Complex, DVector};

/// A step is halved until every mode is clearly nearest to one eigenvalue, at most this many times.
const MAX_HALVINGS: usize = 14;
/// "Clearly nearest": the second candidate is this many times farther away.
const DISTANCE_RATIO: f64 = 3.0;
/// Modal assurance between neighbouring speeds below which a step is halved.
const MIN_ASSURANCE: f64 = 0.9;
/// Two modes closer than this, relatively, are one root found twice.
const SEPARATION: f64 = 1e-9;
/// Sampled systems start where this many samples fall into one period, below which frequencies would alias.
const SAMPLES_PER_PERIOD: f64 = 5.0;

/// One mode at one wind speed.
#[derive(Debug, Clone)]
pub(super) struct TrackedMode {
    /// Eigenvalue, rad/s.
    pub(super) lambda: Complex<f64>,
    /// Displacements of the mode (n): m, rad; unit norm in `(y/B, x/B, θ)`.
    pub(super) shape: DVector<Complex<f64>>,
}

/// The structural modes at one wind speed, with what is needed to predict the next.
#[derive(Debug, Clone)]
pub(super) struct Tracker<'a> {
    section: &'a CoupledSection,
    characteristic: Option<std::rc::Rc<Characteristic>>,
    pub(super) speed: f64,
    pub(super) modes: Vec<TrackedMode>,
    /// `dλ/dV` of each mode from the last step.
    slopes: Vec<Complex<f64>>,
}

impl<'a> Tracker<'a> {
    /// Modes at the lowest speed at which they are the structure's own: still air, or for the sampled system the
    /// speed with enough samples a period.
    pub(super) fn start(section: &'a CoupledSection) -> Result<Self> {
        let natural = natural_modes(section)?;
        let speed = start_speed(section, &natural);
        let slopes = vec![Complex::new(0.0, 0.0); natural.len()];
        let still = Self {
            section,
            characteristic: Characteristic::new(section).map(std::rc::Rc::new),
            speed,
            modes: natural,
            slopes,
        };
        still.matched(speed)?.ok_or_else(|| {
            Error::Numerical(format!(
                "mode tracking: the structural modes are not distinct at {speed} m/s"
            ))
        })
    }

    /// The modes at `speed`, by as many intermediate speeds as continuity needs.
    pub(super) fn advance(&self, speed: f64) -> Result<Self> {
        let mut at = self.clone();
        let mut step = speed - at.speed;
        let mut halvings = 0;
        while at.speed != speed {
            let target = if (at.speed + step - speed) * step.signum() >= 0.0 {
                speed
            } else {
                at.speed + step
            };
            if let Some(next) = at.matched(target)? {
                at = next;
                continue;
            }
            if halvings == MAX_HALVINGS {
                return Err(Error::Numerical(format!(
                    "mode tracking: two modes cannot be told apart near {target:.4} m/s"
                )));
            }
            halvings += 1;
            step *= 0.5;
        }
        Ok(at)
    }

    /// Modes at `speed` if each is clearly the continuation of one here.
    fn matched(&self, speed: f64) -> Result<Option<Self>> {
        let predicted: Vec<_> = self
            .modes
            .iter()
            .zip(&self.slopes)
            .map(|(mode, slope)| mode.lambda + slope * (speed - self.speed))
            .collect();
        let corrected = match &self.characteristic {
            Some(problem) => newton(self.section, problem, &predicted, speed),
            None => nearest(self.section, &predicted, speed)?,
        };
        let Some(modes) = corrected else {
            return Ok(None);
        };
        let continuous = modes
            .iter()
            .zip(&self.modes)
            .all(|(new, old)| assurance(&new.shape, &old.shape) >= MIN_ASSURANCE);
        if !continuous {
            return Ok(None);
        }
        let slopes = if speed == self.speed {
            self.slopes.clone()
        } else {
            let rise = |(new, old): (&TrackedMode, &TrackedMode)| {
                (new.lambda - old.lambda) / (speed - self.speed)
            };
            modes.iter().zip(&self.modes).map(rise).collect()
        };
        Ok(Some(Self {
            section: self.section,
            characteristic: self.characteristic.clone(),
            speed,
            modes,
            slopes,
        }))
    }
}

/// Corrects every prediction by Newton's method; `None` when one fails, turns real, or two meet.
fn newton(
    section: &CoupledSection,
    problem: &Characteristic,
    predicted: &[Complex<f64>],
    speed: f64,
) -> Option<Vec<TrackedMode>> {
    let mut work = Vec::new();
    let mut modes: Vec<TrackedMode> = Vec::with_capacity(predicted.len());
    for start in predicted {
        let (lambda, shape) = problem.solve(*start, speed, &mut work)?;
        let distinct = |m: &TrackedMode| (m.lambda - lambda).norm() > SEPARATION * lambda.norm();
        if lambda.im < 0.0 || !modes.iter().all(distinct) {
            return None;
        }
        let size = dimensionless(section, &shape).norm();
        modes.push(TrackedMode {
            lambda,
            shape: shape.unscale(size),
        });
    }
    Some(modes)
}

/// Takes for every prediction the eigenvalue of the state matrix that is clearly nearest; `None` when one is not.
fn nearest(
    section: &CoupledSection,
    predicted: &[Complex<f64>],
    speed: f64,
) -> Result<Option<Vec<TrackedMode>>> {
    let system = section.at(speed)?;
    let all = system.eigenvalues()?;
    let candidates: Vec<usize> = (0..all.len()).filter(|i| all[*i].im >= 0.0).collect();
    let mut taken = vec![false; all.len()];
    let mut modes = Vec::with_capacity(predicted.len());
    for start in predicted {
        let Some(i) = clearly_nearest(*start, &candidates, &all).filter(|i| !taken[*i]) else {
            return Ok(None);
        };
        taken[i] = true;
        modes.push(TrackedMode {
            lambda: all[i],
            shape: mode_shape(section, &system, all[i])?,
        });
    }
    Ok(Some(modes))
}

/// Index of the candidate nearest to `predicted`, unless another is nearly as near.
fn clearly_nearest(
    predicted: Complex<f64>,
    candidates: &[usize],
    all: &[Complex<f64>],
) -> Option<usize> {
    let mut nearest = (f64::INFINITY, None);
    let mut second = f64::INFINITY;
    for &i in candidates {
        let distance = (all[i] - predicted).norm();
        if distance < nearest.0 {
            second = nearest.0;
            nearest = (distance, Some(i));
        } else if distance < second {
            second = distance;
        }
    }
    nearest
        .1
        .filter(|_| nearest.0 * DISTANCE_RATIO < second || nearest.0 == 0.0)
}

/// Displacement part of the eigenvector, scaled to unit norm in dimensionless motion.
pub(super) fn mode_shape(
    section: &CoupledSection,
    system: &CoupledSystem,
    lambda: Complex<f64>,
) -> Result<DVector<Complex<f64>>> {
    let s = section.structure();
    let n = s.dofs.len();
    let vector = eigenvector(system.state_matrix(), system.matrix_eigenvalue(lambda))?;
    let mut shape = vector.rows(0, n).into_owned();
    let size = dimensionless(section, &shape).norm();
    if size == 0.0 {
        return Err(Error::Numerical(
            "mode shape: the eigenvector does not move the section".into(),
        ));
    }
    shape.unscale_mut(size);
    Ok(shape)
}

fn dimensionless(section: &CoupledSection, shape: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
    let s = section.structure();
    DVector::from_fn(shape.len(), |i, _| {
        shape[i] * s.dofs[i].motion_scale(s.width_m)
    })
}

/// Modal assurance criterion of two shapes: 1 for the same shape.
fn assurance(a: &DVector<Complex<f64>>, b: &DVector<Complex<f64>>) -> f64 {
    let scale = a.norm_squared() * b.norm_squared();
    a.dotc(b).norm_sqr() / scale
}

/// Modes of the structure with its added mass in still air, in the order of the degrees of freedom they move most.
fn natural_modes(section: &CoupledSection) -> Result<Vec<TrackedMode>> {
    let s = section.structure();
    let n = s.dofs.len();
    let (a, _) = section.structure_alone();
    let mut modes = Vec::with_capacity(n);
    for lambda in eigenvalues(&a)?.into_iter().filter(|z| z.im > 0.0) {
        let vector = eigenvector(&a, lambda)?;
        let shape = vector.rows(0, n).into_owned();
        let size = dimensionless(section, &shape).norm();
        modes.push(TrackedMode {
            lambda,
            shape: shape.unscale(size),
        });
    }
    if modes.len() != n {
        return Err(Error::Numerical(
            "mode tracking: a degree of freedom does not oscillate in still air".into(),
        ));
    }
    order_by_dof(section, &mut modes);
    Ok(modes)
}

/// Puts the modes into the order of the degrees of freedom they move most.
fn order_by_dof(section: &CoupledSection, modes: &mut [TrackedMode]) {
    let n = modes.len();
    for dof in 0..n {
        let strongest = (dof..n)
            .max_by(|i, j| {
                let share = |m: usize| dimensionless(section, &modes[m].shape)[dof].norm();
                share(*i).total_cmp(&share(*j))
            })
            .unwrap_or(dof);
        modes.swap(dof, strongest);
    }
}

fn start_speed(section: &CoupledSection, modes: &[TrackedMode]) -> f64 {
    let crate::aerodynamics::Realization::Discrete(d) = section.aerodynamics() else {
        return 0.0;
    };
    let highest_hz = modes.iter().map(|m| m.lambda.im).fold(0.0, f64::max) / std::f64::consts::TAU;
    SAMPLES_PER_PERIOD * highest_hz * d.delta_s * section.structure().width_m
}

/// Name of the branch that starts as the mode of `dof`.
pub(super) fn branch_name(dof: Dof) -> String {
    dof.name().to_owned()
}
