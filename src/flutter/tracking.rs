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

/// A mode with more damping than this, as a ratio to critical, may stop oscillating.
const NEARLY_CRITICAL: f64 = 0.8;

/// One mode at one wind speed.
#[derive(Debug, Clone)]
pub(super) struct TrackedMode {
    /// Place of the degree of freedom that the mode moves in still air.
    pub(super) branch: usize,
    /// Eigenvalue, rad/s.
    pub(super) lambda: Complex<f64>,
    /// Displacements of the mode (n): m, rad; unit norm in `(y/B, x/B, θ)`.
    pub(super) shape: DVector<Complex<f64>>,
    /// `dλ/dV` from the last step.
    slope: Complex<f64>,
}

/// The structural modes at one wind speed, with what is needed to predict the next.
///
/// A mode that stops oscillating (its pair of eigenvalues meets on the negative real axis) is not followed any further:
/// it can diverge, which is found in closed form elsewhere, but not flutter.
#[derive(Debug, Clone)]
pub(super) struct Tracker<'a> {
    pub(super) section: &'a CoupledSection,
    characteristic: Option<std::rc::Rc<Characteristic>>,
    pub(super) speed: f64,
    /// Those that oscillate, in the order of the degrees of freedom.
    pub(super) modes: Vec<TrackedMode>,
}

impl<'a> Tracker<'a> {
    /// Modes at the lowest speed at which they are the structure's own: still air, or for the sampled system the
    /// speed with enough samples a period.
    pub(super) fn start(section: &'a CoupledSection) -> Result<Self> {
        let natural = natural_modes(section)?;
        let speed = start_speed(section, &natural);
        let still = Self {
            section,
            characteristic: Characteristic::new(section).map(std::rc::Rc::new),
            speed,
            modes: natural,
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
            if halvings < MAX_HALVINGS {
                halvings += 1;
                step *= 0.5;
            } else if at.drop_overdamped() {
                halvings = 0;
                step = speed - at.speed;
            } else {
                return Err(Error::Numerical(format!(
                    "mode tracking: two modes cannot be told apart near {target:.4} m/s"
                )));
            }
        }
        Ok(at)
    }

    /// The mode of a branch, unless it has stopped oscillating.
    pub(super) fn mode(&self, branch: usize) -> Option<&TrackedMode> {
        self.modes.iter().find(|m| m.branch == branch)
    }

    /// Stops following the mode with the most damping if that is close to critical; whether there was one.
    fn drop_overdamped(&mut self) -> bool {
        let damping = |m: &TrackedMode| -m.lambda.re / m.lambda.norm();
        let most = self.modes.iter().map(damping).fold(f64::MIN, f64::max);
        let before = self.modes.len();
        if most > NEARLY_CRITICAL {
            self.modes.retain(|m| damping(m) < most);
        }
        self.modes.len() < before
    }

    /// Modes at `speed` if each is clearly the continuation of one here.
    fn matched(&self, speed: f64) -> Result<Option<Self>> {
        let predicted: Vec<_> = self
            .modes
            .iter()
            .map(|mode| mode.lambda + mode.slope * (speed - self.speed))
            .collect();
        let corrected = match &self.characteristic {
            Some(problem) => newton(self.section, problem, &predicted, speed),
            None => nearest(self.section, &predicted, speed)?,
        };
        let Some(roots) = corrected else {
            return Ok(None);
        };
        let mut modes = Vec::with_capacity(roots.len());
        for ((lambda, shape), old) in roots.into_iter().zip(&self.modes) {
            if assurance(&shape, &old.shape) < MIN_ASSURANCE {
                return Ok(None);
            }
            let slope = if speed == self.speed {
                old.slope
            } else {
                (lambda - old.lambda) / (speed - self.speed)
            };
            modes.push(TrackedMode {
                branch: old.branch,
                lambda,
                shape,
                slope,
            });
        }
        Ok(Some(Self {
            section: self.section,
            characteristic: self.characteristic.clone(),
            speed,
            modes,
        }))
    }
}

/// An eigenvalue and its shape, scaled as in [`TrackedMode`].
type Root = (Complex<f64>, DVector<Complex<f64>>);

/// Whether an eigenvalue has an imaginary part above rounding; of a pair the one in the upper half plane.
pub(super) fn oscillates(lambda: &Complex<f64>) -> bool {
    lambda.im > 1e-6 * lambda.norm()
}

/// Corrects every prediction by Newton's method; `None` when one fails, turns real, or two meet.
fn newton(
    section: &CoupledSection,
    problem: &Characteristic,
    predicted: &[Complex<f64>],
    speed: f64,
) -> Option<Vec<Root>> {
    let mut work = Vec::new();
    let mut roots: Vec<Root> = Vec::with_capacity(predicted.len());
    for start in predicted {
        let (lambda, shape) = problem.solve(*start, speed, &mut work)?;
        let distinct = |(other, _): &Root| (other - lambda).norm() > SEPARATION * lambda.norm();
        if !oscillates(&lambda) || !roots.iter().all(distinct) {
            return None;
        }
        let size = dimensionless(section, &shape).norm();
        roots.push((lambda, shape.unscale(size)));
    }
    Some(roots)
}

/// Takes for every prediction the eigenvalue of the state matrix that is clearly nearest; `None` when one is not.
fn nearest(
    section: &CoupledSection,
    predicted: &[Complex<f64>],
    speed: f64,
) -> Result<Option<Vec<Root>>> {
    let system = section.at(speed)?;
    let all = system.eigenvalues()?;
    let candidates: Vec<usize> = (0..all.len()).filter(|i| oscillates(&all[*i])).collect();
    let mut taken = vec![false; all.len()];
    let mut roots = Vec::with_capacity(predicted.len());
    for start in predicted {
        let Some(i) = clearly_nearest(*start, &candidates, &all).filter(|i| !taken[*i]) else {
            return Ok(None);
        };
        taken[i] = true;
        roots.push((all[i], mode_shape(section, &system, all[i])?));
    }
    Ok(Some(roots))
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
            branch: 0,
            lambda,
            shape: shape.unscale(size),
            slope: Complex::new(0.0, 0.0),
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
        modes[dof].branch = dof;
    }
}

/// Lowest speed at which the system can be judged: still air, or for the sampled system the speed with enough samples a
/// period.
pub(super) fn lowest_speed(section: &CoupledSection) -> Result<f64> {
    Ok(start_speed(section, &natural_modes(section)?))
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
