//! V-g and V-f curves and the onset of any `G(K)` by the p-k iteration.
//!
//! At every wind speed each mode is iterated until the forces are taken at its own frequency
//! ([`quasi_pk_mode`](super::quasi_pk_mode)); from one speed to the next it starts from the mode before. Needs no
//! realisation, so it draws measured tables and Theodorsen's function. Exact at an onset; between onsets its damping
//! means what measured derivatives mean.

use super::curves::{FlutterCurves, ModeBranch, ModePoint, damping_ratio};
use super::determinant::damping_slope;
use super::onset::{FlutterSearch, Onset, OnsetMethod, choose};
use super::quasi_pk::{PkMode, pk_mode};
use super::search::{OnsetSearch, root};
use super::tracking::branch_name;
use crate::aerodynamics::AerodynamicModel;
use crate::error::{Error, Result, non_negative, positive};
use crate::section::Structure;
use crate::units::ReducedFrequencyRange;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// A step is halved until every mode changes little, at most this many times.
const MAX_HALVINGS: usize = 8;
/// Relative change of an eigenvalue over one step above which the step is halved.
const MAX_CHANGE: f64 = 0.05;
/// Modal assurance between neighbouring speeds below which a step is halved.
const MIN_ASSURANCE: f64 = 0.9;

/// The modes that still oscillate at one speed, by the index of the degree of freedom they move in still air.
#[derive(Debug, Clone)]
struct Modes {
    speed: f64,
    all: Vec<(usize, PkMode)>,
}

/// Damping at a refined crossing above which it is none.
const JUMP: f64 = 1e-6;
/// Two modes closer than this, relatively, are one root found twice.
const SEPARATION: f64 = 1e-9;

struct Iteration<'a> {
    structure: &'a Structure,
    model: &'a dyn AerodynamicModel,
}

/// Frequencies, damping ratios and shapes over the increasing `speeds_m_s` by the p-k iteration. A branch ends where
/// its mode stops oscillating.
///
/// A table has to answer at every reduced frequency that occurs
/// ([`Extrapolation::Hold`](crate::aerodynamics::derivatives::Extrapolation::Hold)).
///
/// # Errors
/// [`Error::Input`] for speeds that do not increase from above zero; those of the model.
pub fn pk_curves(
    name: &str,
    structure: &Structure,
    model: &dyn AerodynamicModel,
    speeds_m_s: &[f64],
) -> Result<FlutterCurves> {
    let iteration = Iteration { structure, model };
    let mut branches: Vec<ModeBranch> = structure
        .dofs
        .iter()
        .map(|dof| ModeBranch {
            name: branch_name(*dof),
            points: Vec::with_capacity(speeds_m_s.len()),
        })
        .collect();
    let mut modes = iteration.still_air();
    for &speed in speeds_m_s {
        if non_negative("wind speeds", speed)? <= modes.speed {
            return Err(Error::input(
                "wind speeds",
                "increasing numbers above zero",
                format!("{speed} after {}", modes.speed),
            ));
        }
        modes = iteration.advance(&modes, speed)?;
        for (branch, mode) in &modes.all {
            branches[*branch].points.push(ModePoint {
                speed_m_s: speed,
                eigenvalue: mode.lambda.into(),
                frequency_hz: mode.lambda.im / TAU,
                damping_ratio: damping_ratio(mode.lambda),
                shape: iteration.scaled(mode),
            });
        }
    }
    Ok(FlutterCurves {
        model: name.to_owned(),
        branches,
    })
}

/// First wind speed at which a mode of the p-k iteration loses its damping; `tested` as in
/// [`find_onset`](super::find_onset).
///
/// # Errors
/// Those of [`pk_curves`]; [`Error::Input`] for a search range that is none.
pub fn pk_onset(
    name: &str,
    structure: &Structure,
    model: &dyn AerodynamicModel,
    search: &OnsetSearch,
    tested: Option<ReducedFrequencyRange>,
) -> Result<FlutterSearch> {
    let speed_max = positive("flutter.speed_max_m_s", search.speed_max_m_s)?;
    let iteration = Iteration { structure, model };
    let mut modes = iteration.still_air();
    let mut crossings = Vec::new();
    for i in 1..=search.speeds {
        let speed = speed_max * i as f64 / search.speeds as f64;
        let next = iteration.advance(&modes, speed)?;
        for (branch, after) in &next.all {
            let before = modes.mode(*branch).filter(|m| m.lambda.re < 0.0);
            if let (Some(before), true) = (before, after.lambda.re >= 0.0) {
                let ends = (before.lambda.re, after.lambda.re);
                crossings.extend(iteration.refine(name, (&modes, &next), *branch, ends)?);
            }
        }
        modes = next;
    }
    Ok(choose(crossings, tested, speed_max))
}

fn same_root(a: &PkMode, b: &PkMode) -> bool {
    (a.lambda - b.lambda).norm() <= SEPARATION * a.lambda.norm()
}

impl Modes {
    fn mode(&self, branch: usize) -> Option<&PkMode> {
        self.all.iter().find(|m| m.0 == branch).map(|m| &m.1)
    }
}

impl Iteration<'_> {
    /// The degrees of freedom by themselves; an undamped one counts as damped, so that it can lose its damping.
    fn still_air(&self) -> Modes {
        let s = self.structure;
        let n = s.dofs.len();
        let mode = |i: usize| {
            let (mass, stiffness) = (s.mass[(i, i)], s.stiffness[(i, i)]);
            let decay = s.damping[(i, i)] / (2.0 * mass);
            let omega = (stiffness / mass - decay * decay).max(0.0).sqrt();
            let mut shape = nalgebra::DVector::zeros(n);
            shape[i] = Complex::new(1.0, 0.0);
            let lambda = Complex::new((-decay).min(-f64::MIN_POSITIVE), omega);
            (i, PkMode { lambda, shape })
        };
        Modes {
            speed: 0.0,
            all: (0..n).map(mode).filter(|m| m.1.lambda.im > 0.0).collect(),
        }
    }

    /// The modes at `speed`, by as many intermediate speeds as continuity needs.
    fn advance(&self, from: &Modes, speed: f64) -> Result<Modes> {
        let mut at = from.clone();
        let mut step = speed - at.speed;
        let mut halvings = 0;
        while at.speed != speed {
            let target = if at.speed + step >= speed {
                speed
            } else {
                at.speed + step
            };
            let next = self.at(&at, target)?;
            if next.all.len() == at.all.len() && self.continuous(&at, &next) {
                at = next;
            } else if halvings < MAX_HALVINGS {
                halvings += 1;
                step *= 0.5;
            } else {
                at = self.without_lost(&at, next);
            }
        }
        Ok(at)
    }

    /// Where a step cannot be made smooth: the modes that went on; of two on one root the one that moved less.
    fn without_lost(&self, before: &Modes, after: Modes) -> Modes {
        let moved = |(branch, mode): &(usize, PkMode)| {
            before
                .mode(*branch)
                .map_or(f64::INFINITY, |old| (mode.lambda - old.lambda).norm())
        };
        let nearest = |m: &(usize, PkMode)| {
            let rivals = after.all.iter().filter(|o| same_root(&o.1, &m.1));
            rivals.map(moved).fold(f64::INFINITY, f64::min) >= moved(m)
        };
        let all = after.all.iter().filter(|m| nearest(m)).cloned().collect();
        Modes {
            speed: after.speed,
            all,
        }
    }

    /// The modes at `speed` that settle and oscillate.
    fn at(&self, from: &Modes, speed: f64) -> Result<Modes> {
        let mut all: Vec<(usize, PkMode)> = Vec::with_capacity(from.all.len());
        for (branch, mode) in &from.all {
            if let Some(next) = pk_mode(self.structure, self.model, speed, mode)? {
                all.push((*branch, next));
            }
        }
        Ok(Modes { speed, all })
    }

    fn continuous(&self, before: &Modes, after: &Modes) -> bool {
        let still = before.speed == 0.0;
        let doubled = (0..after.all.len())
            .any(|i| (0..i).any(|j| same_root(&after.all[i].1, &after.all[j].1)));
        !doubled
            && before.all.iter().zip(&after.all).all(|((_, a), (_, b))| {
                let change = (b.lambda - a.lambda).norm() / a.lambda.norm();
                let (u, v) = (self.dimensionless(a), self.dimensionless(b));
                let assurance = u.dotc(&v).norm_sqr() / (u.norm_squared() * v.norm_squared());
                // the added mass of the air changes the modes at once, however slow the wind
                still || change < MAX_CHANGE && assurance > MIN_ASSURANCE
            })
    }

    fn dimensionless(&self, mode: &PkMode) -> nalgebra::DVector<Complex<f64>> {
        let s = self.structure;
        nalgebra::DVector::from_fn(mode.shape.len(), |i, _| {
            mode.shape[i] * s.dofs[i].motion_scale(s.width_m)
        })
    }

    /// Displacements with unit norm in dimensionless motion.
    fn scaled(&self, mode: &PkMode) -> Vec<super::curves::Complex64> {
        let size = self.dimensionless(mode).norm();
        mode.shape.iter().map(|z| (z / size).into()).collect()
    }

    fn refine(
        &self,
        name: &str,
        (low, high): (&Modes, &Modes),
        branch: usize,
        (before, after): (f64, f64),
    ) -> Result<Option<Onset>> {
        let mode_at = |speed: f64| -> Result<PkMode> {
            self.advance(low, speed)?
                .mode(branch)
                .cloned()
                .ok_or_else(|| Error::Numerical(format!("p-k: the mode is lost at {speed} m/s")))
        };
        let speed = root((low.speed, before), (high.speed, after), |speed| {
            Ok(mode_at(speed)?.lambda.re)
        })?;
        let mode = mode_at(speed)?;
        if mode.lambda.re.abs() > JUMP * mode.lambda.norm() {
            // the damping jumps through zero: the iteration changed to another root
            return Ok(None);
        }
        let s = self.structure;
        let at = (speed, mode.lambda.im);
        let branch = branch_name(s.dofs[branch]);
        let mut onset = Onset::new(name, OnsetMethod::PkIteration, s, at, &mode.shape, branch);
        onset.damping_slope_s_m = damping_slope(s, self.model, speed, mode.lambda.im);
        Ok(Some(onset))
    }
}
