//! Onsets by the ten thousand: every crossing of a section with two or three degrees of freedom, without allocation.
//!
//! At a fixed reduced frequency `K` the speed follows from the frequency, `V = ωB/K`, and the determinant is a
//! polynomial in `ω` ([`pencil`]). Its roots are followed from still air (`K = 1000`) downwards over a fixed grid
//! on which the functions of the force model are tabulated once; a root that passes the real axis is a crossing, of
//! whatever mode, and is refined with exact derivatives ([`crossing`]). As all crossings are found, the first one is the
//! first, and a switch of modes between samples is no special case. Where two roots come too close to be told apart the
//! answer is "not resolved", for [`find_onset`](super::find_onset) to decide.

mod basis;
mod choice;
mod crossing;
mod pencil;
mod samples;

pub use basis::LinearForces;
pub use samples::at_samples;
pub use samples::stands_at_samples;

use crate::error::{Result, ensure, positive};
use crate::section::{Dof, SectionModel, Structure};
use crate::state_space::Complex64;
use pencil::{K_MAX, Pencil, Supports, grid, supports};

/// Growth up to this part of the frequency is rounding.
const ROUNDING: f64 = 1e-9;
/// The slowest natural frequency may fall to this part before the highest speed is reached.
const LOWEST_PART: f64 = 0.3;
/// Roots beyond the highest speed, or the first onset, by this factor are not followed any further.
const BEYOND: f64 = 1.1;
/// A step is halved until every root moves less than this part of the distance to its neighbour.
const MAX_PART: f64 = 0.3;
const MAX_HALVINGS: usize = 6;
/// Steps from no static unbalance to all of it.
const COUPLING_STEPS: u32 = 8;
/// More crossings than this below the highest speed are no section that anybody would build.
const MAX_CROSSINGS: usize = 8;

/// Answer for one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SweepOutcome {
    /// The section flutters.
    Onset(SweptOnset),
    /// A mode grows already where it enters the tested range, or in still air where there is none: the onset lies at
    /// this speed or below.
    UnstableAtOrBelow(SweptOnset),
    /// No flutter up to the highest speed.
    Stable {
        /// Highest speed at which every mode was inside the tested range, m/s: the highest of all, or less.
        judged_to_m_s: f64,
    },
    /// Two roots come too close, or Newton's method fails: to be searched in full.
    Unresolved,
}

impl SweepOutcome {
    /// The onset, or the start that grows already.
    pub fn onset(&self) -> Option<&SweptOnset> {
        match self {
            Self::Onset(at) | Self::UnstableAtOrBelow(at) => Some(at),
            Self::Stable { .. } | Self::Unresolved => None,
        }
    }

    /// Whether it answers for every wind speed up to this one, m/s: with an onset, or with none as far as that.
    pub fn is_judged_to(&self, speed_m_s: f64) -> bool {
        match self {
            Self::Stable { judged_to_m_s } => *judged_to_m_s >= speed_m_s,
            Self::Onset(_) | Self::UnstableAtOrBelow(_) => true,
            Self::Unresolved => false,
        }
    }
}

/// The onset of one sample; chosen among all crossings as [`find_onset`](super::find_onset) does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SweptOnset {
    /// m/s.
    pub speed_m_s: f64,
    /// Hz.
    pub frequency_hz: f64,
    /// Whether `K` lies in the tested range; true when there is none.
    pub in_tested_range: bool,
    /// Crossings below this one outside the tested range.
    pub spurious: usize,
}

/// Finds onsets of many sections with one kind of force model.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::flutter::{LinearForces, OnsetSweep, SweepOutcome};
/// use aerodeck::aerodynamics::RationalModel;
/// use aerodeck::section::SectionModel;
///
/// let nominal = SectionModel::iabse_1_1a();
/// let forces = LinearForces::of_rational(&RationalModel::jones_flat_plate(), None);
/// let sweep = OnsetSweep::new(forces, &nominal.structure()?, 160.0)?;
/// let SweepOutcome::Onset(onset) = sweep.onset(&nominal, sweep.forces().coefficients())? else {
///     panic!("the plate flutters")
/// };
/// assert!((onset.speed_m_s - 76.679).abs() < 0.001);
/// # Ok::<(), aerodeck::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct OnsetSweep {
    forces: LinearForces,
    speed_max: f64,
    /// Reduced frequencies, falling.
    grid: Vec<f64>,
    /// Those of them at which modes leave the tested range.
    lower_ends: Vec<f64>,
    /// Functions of the force model at each of them.
    table: Vec<Complex64>,
}

impl OnsetSweep {
    /// A sweep up to `speed_max_m_s` for sections like `nominal`.
    ///
    /// # Errors
    /// [`Error::Input`](crate::error::Error::Input) for a speed that is not positive, and for other degrees of freedom than two or three.
    pub fn new(forces: LinearForces, nominal: &Structure, speed_max_m_s: f64) -> Result<Self> {
        let speed_max = positive("speed_max_m_s", speed_max_m_s)?;
        ensure(
            matches!(forces.dofs.len(), 2 | 3) && forces.dofs == nominal.dofs,
            "onset sweep",
            format_args!(
                "two or three degrees of freedom, {}",
                Dof::names(&nominal.dofs)
            ),
            Dof::names(&forces.dofs),
        )?;
        let slowest = nominal.still_air_rad_s().fold(f64::INFINITY, f64::min);
        let k_min = (LOWEST_PART * slowest * nominal.width_m / speed_max).clamp(1e-3, 0.5 * K_MAX);
        let tested = forces.tested.iter();
        let lower = tested.flat_map(|range| range.lower_ends().map(|(k, _)| k.full_width()));
        let lower_ends: Vec<f64> = lower.collect();
        let upper = forces.tested.map(|range| range.max.full_width());
        let grid = grid(k_min, lower_ends.iter().copied().chain(upper));
        let count = forces.count();
        let mut table = vec![Complex64::new(0.0, 0.0); count * grid.len()];
        for (k, row) in grid.iter().zip(table.chunks_mut(count)) {
            forces.values(Complex64::new(0.0, *k), row);
        }
        Ok(Self {
            forces,
            speed_max,
            grid,
            lower_ends,
            table,
        })
    }

    /// The force model, with its nominal coefficients.
    pub fn forces(&self) -> &LinearForces {
        &self.forces
    }

    /// The onset of `section` with these coefficients (as many as [`LinearForces::coefficients`]).
    ///
    /// # Errors
    /// [`Error::Input`](crate::error::Error::Input) for a section that cannot be and coefficients of another number.
    pub fn onset(&self, section: &SectionModel, coefficients: &[f64]) -> Result<SweepOutcome> {
        let (expected, found) = (self.forces.coefficients().len(), coefficients.len());
        let what = "coefficients of the force model";
        ensure(found == expected, what, expected, found)?;
        Ok(match self.forces.dofs.len() {
            2 => Sweep::<2>::new(self, supports(section)?, coefficients).run(),
            _ => Sweep::<3>::new(self, supports(section)?, coefficients).run(),
        })
    }
}

/// The roots at one reduced frequency; those that have left the right half plane are no longer followed.
#[derive(Debug, Clone, Copy)]
struct Roots<const N: usize> {
    k: f64,
    omega: [Complex64; N],
    /// Change for a unit of `ln K`, from the last step.
    slope: [Complex64; N],
    alive: [bool; N],
}

/// A speed at which an oscillating eigenvalue lies on the imaginary axis.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Crossing {
    /// m/s.
    speed: f64,
    /// rad/s.
    omega: f64,
    /// Whether the motion begins to grow there with rising speed.
    destabilises: bool,
}

/// One sample.
struct Sweep<'a, const N: usize> {
    sweep: &'a OnsetSweep,
    supports: Supports<N>,
    coefficients: &'a [f64],
    crossings: [Option<Crossing>; MAX_CROSSINGS],
    found: usize,
    /// The slowest growth where a mode was first judged, in still air and at the upper end of the tested range: speed and
    /// circular frequency.
    still: Option<(f64, f64)>,
    entered: Option<(f64, f64)>,
    /// Lowest speed at which a mode leaves the tested range, at its lower end or into a gap.
    left: f64,
}

impl<'a, const N: usize> Sweep<'a, N> {
    fn new(sweep: &'a OnsetSweep, supports: Supports<N>, coefficients: &'a [f64]) -> Self {
        Self {
            sweep,
            supports,
            coefficients,
            crossings: [None; MAX_CROSSINGS],
            found: 0,
            still: None,
            entered: None,
            left: f64::INFINITY,
        }
    }

    fn run(mut self) -> SweepOutcome {
        match self.follow() {
            Some(()) => self.choose(),
            None => SweepOutcome::Unresolved,
        }
    }

    /// All crossings up to the highest speed; `None` when the roots cannot be followed.
    fn follow(&mut self) -> Option<()> {
        let mut roots = self.start()?;
        self.still = self.slowest_growth(&roots);
        let tested_max = self.sweep.forces.tested.map(|range| range.max.full_width());
        for i in 1..self.sweep.grid.len() {
            let k = self.sweep.grid[i];
            let pencil = Pencil::new(&self.supports, k, &self.tabulated(i));
            roots = match self.step(&roots, k, &pencil) {
                Some(next) => {
                    self.look(&roots, &next)?;
                    next
                }
                None => self.halved(roots, k)?,
            };
            if tested_max == Some(k) {
                self.entered = self.slowest_growth(&roots);
            }
            self.leave(&roots);
            let limit = BEYOND * self.lowest().min(self.sweep.speed_max) * k / self.supports.width;
            let beyond = |i: usize| !roots.alive[i] || roots.omega[i].re > limit;
            if (0..N).all(beyond) {
                break;
            }
        }
        Some(())
    }

    /// The lowest speed at which a mode grows at the reduced frequency of `roots`, with its frequency.
    fn slowest_growth(&self, roots: &Roots<N>) -> Option<(f64, f64)> {
        (0..N)
            .filter(|i| roots.alive[*i])
            .map(|i| roots.omega[i])
            .filter(|omega| omega.im < -ROUNDING * omega.re)
            .map(|omega| (omega.re * self.supports.width / roots.k, omega.re))
            .filter(|(speed, _)| *speed <= self.sweep.speed_max)
            .min_by(|a, b| a.0.total_cmp(&b.0))
    }

    fn start(&self) -> Option<Roots<N>> {
        let k = self.sweep.grid[0];
        let g = self.tabulated(0);
        let mut omega = Pencil::new(&self.supports, k, &g).uncoupled();
        // a static unbalance draws the roots apart: they are followed from none to all of it
        let is_coupled = self.supports.coupling != 0.0;
        let parts = if is_coupled { COUPLING_STEPS } else { 1 };
        for part in 1..=parts {
            let mut supports = self.supports;
            supports.coupling *= f64::from(part) / f64::from(parts);
            let pencil = Pencil::new(&supports, k, &g);
            for root in &mut omega {
                *root = pencil.root(*root)?;
            }
        }
        let roots = Roots {
            k,
            omega,
            slope: [Complex64::new(0.0, 0.0); N],
            alive: [true; N],
        };
        let distinct = |i: usize, j: usize| (omega[i] - omega[j]).norm() > 1e-6 * omega[i].norm();
        (0..N)
            .all(|i| omega[i].re > 0.0 && (0..i).all(|j| distinct(i, j)))
            .then_some(roots)
    }

    /// The step to `k` in smaller ones.
    fn halved(&mut self, from: Roots<N>, k: f64) -> Option<Roots<N>> {
        let mut at = from;
        let mut parts = 2.0_f64;
        let mut halvings = 1;
        while at.k != k {
            let ratio = (k / from.k).powf(1.0 / parts);
            let beyond = at.k * ratio <= k * (1.0 + 1e-9);
            let next_k = if beyond { k } else { at.k * ratio };
            let p = Complex64::new(0.0, next_k);
            let (g, _) = self.sweep.forces.transfer::<N>(p, self.coefficients);
            let pencil = Pencil::new(&self.supports, next_k, &self.supports.at_axis(g));
            if let Some(next) = self.step(&at, next_k, &pencil) {
                self.look(&at, &next)?;
                at = next;
            } else if halvings < MAX_HALVINGS {
                halvings += 1;
                parts *= 2.0;
            } else {
                return None;
            }
        }
        Some(at)
    }

    /// `G` about the axis at a point of the grid.
    fn tabulated(&self, i: usize) -> [[Complex64; N]; N] {
        let forces = &self.sweep.forces;
        let count = forces.count();
        let row = &self.sweep.table[i * count..][..count];
        let mut g = [[Complex64::new(0.0, 0.0); N]; N];
        let values = row.iter().zip(self.coefficients.chunks_exact(N));
        for (b, (value, thetas)) in values.enumerate() {
            let j = usize::from(b >= forces.starts[1]) + usize::from(b >= forces.starts[2]);
            for (row_of_g, theta) in g.iter_mut().zip(thetas) {
                row_of_g[j] += value * theta;
            }
        }
        self.supports.at_axis(g)
    }

    /// The roots at `k`, unless one of them is not clearly the continuation of one before.
    fn step(&self, from: &Roots<N>, k: f64, pencil: &Pencil<N>) -> Option<Roots<N>> {
        let advance = (k / from.k).ln();
        let mut next = Roots { k, ..*from };
        let mut predicted = from.omega;
        for (i, start) in predicted.iter_mut().enumerate() {
            *start += from.slope[i] * advance;
            if from.alive[i] {
                next.omega[i] = pencil.root(*start)?;
            }
        }
        for i in (0..N).filter(|i| from.alive[*i]) {
            let nearest = (0..N)
                .filter(|j| *j != i && from.alive[*j])
                .map(|j| (predicted[i] - predicted[j]).norm_sqr())
                .fold(predicted[i].norm_sqr(), f64::min);
            let miss = (next.omega[i] - predicted[i]).norm_sqr();
            if miss > MAX_PART * MAX_PART * nearest {
                return None;
            }
            next.slope[i] = (next.omega[i] - from.omega[i]) / advance;
            next.alive[i] = next.omega[i].re > 0.0;
        }
        Some(next)
    }

    /// Refines what passed the real axis between two reduced frequencies; `None` when that fails.
    fn look(&mut self, before: &Roots<N>, after: &Roots<N>) -> Option<()> {
        for i in (0..N).filter(|i| after.alive[*i]) {
            let (a, b) = (before.omega[i], after.omega[i]);
            if (a.im > 0.0) == (b.im > 0.0) {
                continue;
            }
            let share = a.im / (a.im - b.im);
            let k = before.k + (after.k - before.k) * share;
            let omega = a.re + (b.re - a.re) * share;
            let speed = omega * self.supports.width / k;
            let crossing = self.refine(speed, omega)?;
            if crossing.speed <= self.sweep.speed_max {
                *self.crossings.get_mut(self.found)? = Some(crossing);
                self.found += 1;
            }
        }
        Some(())
    }
}

#[cfg(test)]
mod tests;
