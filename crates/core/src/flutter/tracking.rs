//! Modes followed over wind speed by continuation: prediction, correction, shape agreement, step halving.
//!
//! The correction is Newton's method on the small nonlinear eigenvalue problem where there is one (continuous models),
//! else the nearest eigenvalue of the whole state matrix.

use super::characteristic::Characteristic;
use super::clusters::{Root, by_shapes};
use super::critical_point::OnsetMethod;
use super::following::{
    Continued, EigenvalueTrend, Follower, MIN_ASSURANCE, Mode, Modes, SEPARATION, assurance,
    dimensionless, oscillates,
};
use super::modal_characteristic::ModalCharacteristic;
use super::onset::Onset;
use super::still_air::{modes_of_many, natural_modes, start_speed};
use crate::aeroelastic::{CoupledSection, CoupledSystem};
use crate::error::{Error, Result};
use crate::section::{Dof, Structure};
use crate::state_space::{damping_ratio, eigenvector};
use nalgebra::{Complex, DVector};
use std::sync::Arc;

/// "Clearly nearest": the second candidate is this many times farther away.
const DISTANCE_RATIO: f64 = 3.0;
/// Relative distance of the second speed of a slope.
pub(super) const SLOPE_STEP: f64 = 1e-5;
/// Modal assurance above which two shapes are one.
const SAME_SHAPE: f64 = 0.99;
/// A mode with more damping than this, as a ratio to critical, may stop oscillating.
const NEARLY_CRITICAL: f64 = 0.8;

/// Follows the structural modes of a section.
///
/// A mode that stops oscillating (its pair of eigenvalues meets on the negative real axis) is not followed any further:
/// it can diverge, which is found in closed form elsewhere, but not flutter.
#[derive(Debug)]
pub(super) struct Tracker<'a> {
    section: &'a CoupledSection,
    correction: Correction,
}

/// How a predicted mode is corrected.
#[derive(Debug)]
enum Correction {
    /// Newton's method on the determinant, up to three degrees of freedom.
    Determinant(Box<Characteristic>),
    /// Inverse iteration from the shape before, for modes of a whole bridge.
    Shapes(Arc<ModalCharacteristic>),
    /// The nearest eigenvalue of the state matrix.
    Nearest,
}

impl<'a> Tracker<'a> {
    pub(super) fn new(section: &'a CoupledSection) -> Self {
        let small = Characteristic::new(section).map(|c| Correction::Determinant(Box::new(c)));
        let shapes = || ModalCharacteristic::new(section).map(|c| Correction::Shapes(Arc::new(c)));
        Self {
            section,
            correction: small.or_else(shapes).unwrap_or(Correction::Nearest),
        }
    }

    /// With a problem that has been made of `section` before.
    pub(super) fn by_shapes(
        section: &'a CoupledSection,
        problem: Arc<ModalCharacteristic>,
    ) -> Self {
        Self {
            section,
            correction: Correction::Shapes(problem),
        }
    }

    /// Modes at the lowest speed at which they are the structure's own: still air, or for the sampled system the
    /// speed with enough samples per period.
    pub(super) fn start(&self) -> Result<Modes> {
        if let Some(all) = modes_of_many(self.section) {
            return Ok(Modes { speed: 0.0, all });
        }
        let all = natural_modes(self.section)?;
        let speed = start_speed(self.section, &all);
        self.matched(&Modes { speed, all }, speed)?.ok_or_else(|| {
            Error::NotDistinct(format!(
                "mode tracking: the structural modes are not distinct at {speed:.3} m/s"
            ))
        })
    }

    /// The modes at `speed`, followed from the start.
    pub(super) fn at(&self, speed: f64) -> Result<Modes> {
        self.advance(&self.start()?, speed)
    }

    /// Modes at `speed` if each is clearly the continuation of one before.
    fn matched(&self, before: &Modes, speed: f64) -> Result<Option<Modes>> {
        // shapes take a round less from a better start; a root of the small problem costs next to nothing
        let curved = matches!(self.correction, Correction::Shapes(_));
        let change = |course: &EigenvalueTrend| match curved {
            true => course.curved(before.speed, speed),
            false => course.straight(before.speed, speed),
        };
        let predict = |mode: &Mode| mode.lambda + change(&mode.course);
        let predicted: Vec<_> = before.all.iter().map(predict).collect();
        let corrected = match &self.correction {
            Correction::Determinant(problem) => {
                let mut work = Vec::new();
                let roots = predicted
                    .iter()
                    .map(|l| problem.solve(*l, speed, &mut work));
                distinct(self.section, roots)
            }
            Correction::Shapes(problem) => {
                let roots = by_shapes(&problem.at(speed), &predicted, &before.all);
                distinct(self.section, roots.into_iter())
            }
            Correction::Nearest => nearest(self.section, &predicted, speed)?,
        };
        let Some(roots) = corrected else {
            return Ok(None);
        };
        let mut all = Vec::with_capacity(roots.len());
        // shapes of many modes have been looked at where they were corrected
        let seen = matches!(self.correction, Correction::Shapes(_));
        for ((lambda, shape), old) in roots.into_iter().zip(&before.all) {
            if !seen && assurance(&shape, &old.shape) < MIN_ASSURANCE {
                return Ok(None);
            }
            all.push(Mode {
                branch: old.branch,
                lambda,
                shape,
                course: old.course.to(before.speed, speed, lambda - old.lambda),
            });
        }
        Ok(Some(Modes { speed, all }))
    }
}

impl Follower for Tracker<'_> {
    const METHOD: OnsetMethod = OnsetMethod::Eigenvalues;
    const MAX_HALVINGS: usize = 14;
    const LENGTHENS: bool = false;

    fn structure(&self) -> &Structure {
        self.section.structure()
    }

    fn continued(&self, before: &Modes, speed: f64) -> Result<Continued> {
        let nothing = Modes {
            speed,
            all: Vec::new(),
        };
        Ok(self.matched(before, speed)?.ok_or(nothing))
    }

    fn without_lost(&self, before: &Modes, after: Modes) -> Result<Modes> {
        // the mode with the most damping is not followed further where that is close to critical
        let damping = |m: &Mode| damping_ratio(m.lambda);
        let most = before.all.iter().map(damping).fold(f64::MIN, f64::max);
        if most > NEARLY_CRITICAL {
            let mut left = before.clone();
            left.all.retain(|m| damping(m) < most);
            return Ok(left);
        }
        Err(Error::NotDistinct(format!(
            "mode tracking: two modes cannot be told apart near {:.4} m/s",
            after.speed
        )))
    }

    fn lost(speed: f64) -> Error {
        Error::Numerical(format!("onset: no mode oscillates at {speed:.3} m/s"))
    }

    fn complete(&self, mut onset: Onset, low: &Modes, mode: &Mode) -> Result<Option<Onset>> {
        let speed = onset.at.speed_m_s;
        let nearby = self.mode_at(low, speed * (1.0 - SLOPE_STEP), mode.branch)?;
        let slope = damping_ratio(mode.lambda) - damping_ratio(nearby.lambda);
        onset.damping_slope_s_m = Some(slope / (speed * SLOPE_STEP));
        let s = self.structure();
        let dof = s.dofs[mode.branch];
        if !s.is_modal() && single_dof(dof, onset.mode.map_or(f64::INFINITY, |m| m.mode_ratio)) {
            onset.warnings.push(format!(
                "the mode is almost purely {}: a one-degree-of-freedom instability",
                dof.name()
            ));
        }
        Ok(Some(onset))
    }
}

/// Whether the mode hardly moves any other degree of freedom than its own.
fn single_dof(dof: Dof, mode_ratio: f64) -> bool {
    match dof {
        Dof::Torsion => mode_ratio < 0.05,
        Dof::Vertical => mode_ratio > 20.0,
        Dof::Lateral => false,
    }
}

/// The corrected modes; `None` when a correction failed, turned real, or two meet.
fn distinct(
    section: &CoupledSection,
    corrected: impl Iterator<Item = Option<Root>>,
) -> Option<Vec<Root>> {
    let mut roots: Vec<Root> = Vec::new();
    for root in corrected {
        let (lambda, shape) = root?;
        // modes of one frequency differ by their shapes
        let distinct = |(other, of): &Root| {
            (other - lambda).norm() > SEPARATION * lambda.norm()
                || assurance(of, &shape) < SAME_SHAPE
        };
        if !oscillates(&lambda) || !roots.iter().all(distinct) {
            return None;
        }
        let size = dimensionless(section.structure(), &shape).norm();
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
    let vector = eigenvector(&system.a, system.matrix_eigenvalue(lambda))?;
    let mut shape = vector.rows(0, n).into_owned();
    let size = dimensionless(section.structure(), &shape).norm();
    if size == 0.0 {
        return Err(Error::Numerical(
            "mode shape: the eigenvector does not move the section".into(),
        ));
    }
    shape.unscale_mut(size);
    Ok(shape)
}
