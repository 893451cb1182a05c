//! The modes of a bridge at a wind speed that changes a little at a time, or at many, without the eigenvalue problem of all states.
//!
//! The modes of the structure are followed from the last wind speed by their shapes. That no other eigenvalue has as little damping is
//! counted, not assumed: with the modes `λ_i` that were followed divided out,
//!
//! ```text
//! g(λ) = det D(λ) / (det M · Π (λ − λ_i)(λ − λ̄_i))
//! ```
//!
//! has the poles of the filters, on the left, as its poles, all other eigenvalues as its zeros, and the value 1 at infinity. On the
//! way along a ray `λ = r e^{iφ}` from infinity to zero its argument turns by `π` for each zero in the sector between the ray and its
//! mirror image (the principle of the argument): one that does not turn has none there.

use super::following::{Follower, Mode, Modes, growing};
use super::modal_characteristic::ModalCharacteristic;
use super::nearby_onset::NearbyOnset;
use super::tracking::Tracker;
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::state_space::{damping_ratio, write_eigenvalues};
use nalgebra::{Complex, DMatrix};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// States up to which all eigenvalues are found before a mode is followed.
const MOST_STATES_SOLVED: usize = 40;
/// Damping ratio by which the ray lies beyond the least of the modes: an eigenvalue that comes from far away meets it before it
/// matters. Beyond [`STEEPEST`] the ray would come close to the filters.
const MARGIN: f64 = 0.1;
const STEEPEST: f64 = 0.8;
/// First and last distance on the ray, over the smallest and the largest of frequencies and poles.
const ENDS: [f64; 2] = [0.03, 30.0];
/// Ratio of the distances looked at first.
const FIRST_RATIO: f64 = 3.0;
/// Turn (rad) and ratio of size between neighbours up to which nothing is missed between them.
const SMALL_TURN: f64 = 0.7;
const SMALL_RATIO: f64 = 3.0;
/// Distances looked at before the count is given up.
const MOST_DISTANCES: usize = 200;
/// What is left of a turn at the ends, rad, where it has to be none.
const AT_THE_ENDS: f64 = 0.5;

/// Modes of a bridge at the present wind speed, followed from the last one.
#[derive(Debug)]
pub struct PresentModes {
    problem: Arc<ModalCharacteristic>,
    /// At the last wind speed, all of them.
    last: Option<Modes>,
}

/// The smallest damping ratio of all modes, asked for again and again.
#[derive(Debug)]
pub enum LeastDamping {
    /// Of a few states, by their eigenvalues.
    Solved {
        /// The state matrix as a polynomial of the wind.
        by_wind: [DMatrix<f64>; 3],
        /// Room for it at one wind.
        matrix: DMatrix<f64>,
        /// Room for what is found.
        eigenvalues: Vec<Complex<f64>>,
    },
    /// Of many, by the modes.
    Followed(PresentModes),
}

impl LeastDamping {
    /// That of `section`; `None` for sampled models.
    pub fn new(section: &CoupledSection) -> Option<Self> {
        if let Some(modes) = PresentModes::of_many(section) {
            return Some(Self::Followed(modes));
        }
        let by_wind = section.state_matrix_by_wind()?;
        Some(Self::Solved {
            matrix: by_wind[0].clone(),
            by_wind,
            eigenvalues: Vec::with_capacity(section.states()),
        })
    }

    /// At `wind`, m/s, of the same section; one where nothing oscillates.
    ///
    /// # Errors
    /// As [`smallest_damping`].
    pub fn at(&mut self, section: &CoupledSection, wind: f64) -> Result<f64> {
        let prepared = match self {
            Self::Solved {
                by_wind: [a0, a1, a2],
                matrix,
                eigenvalues,
            } => {
                let entries = a0.iter().zip(&*a1).zip(&*a2);
                for (to, ((a0, a1), a2)) in matrix.iter_mut().zip(entries) {
                    *to = a0 + wind * (a1 + wind * a2);
                }
                // nothing for what is no wind speed, and where the eigenvalues are not found
                let found = write_eigenvalues(matrix, eigenvalues).filter(|()| wind >= 0.0);
                found.map(|()| least(eigenvalues))
            }
            Self::Followed(modes) => modes.smallest_damping(section, wind),
        };
        prepared.map_or_else(|| smallest_damping(section, wind), Ok)
    }

    /// Circular frequency of the slowest of the modes at the last wind, rad/s; `None` where modes are not followed.
    pub fn slowest_rad_s(&self) -> Option<f64> {
        let all = self.last()?.all.iter();
        all.map(|mode| mode.lambda.im).reduce(f64::min)
    }

    fn last(&self) -> Option<&Modes> {
        match self {
            Self::Followed(modes) => modes.last.as_ref(),
            Self::Solved { .. } => None,
        }
    }

    /// The mode of least damping at the last wind, from which its onset can be followed; `None` where modes are not followed.
    pub fn least(&self) -> Option<NearbyOnset> {
        let last = self.last()?;
        let damping = |mode: &&Mode| damping_ratio(mode.lambda);
        let least = last
            .all
            .iter()
            .min_by(|a, b| damping(a).total_cmp(&damping(b)))?;
        Some(NearbyOnset::of_mode(last.speed, least))
    }
}

/// Smallest damping ratio of the modes at a wind speed (m/s), by all eigenvalues; one where nothing oscillates, minus one
/// where something diverges.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::RationalModel;
/// use aerodeck::aeroelastic::CoupledSection;
/// use aerodeck::flutter::{smallest_damping};
/// use aerodeck::section::SectionModel;
///
/// let structure = SectionModel::iabse_1_1a().structure()?;
/// let section = CoupledSection::with_model(&structure, &RationalModel::jones_flat_plate())?;
/// assert!(smallest_damping(&section, 40.0)? > 0.0);
/// assert!(smallest_damping(&section, 90.0)? < 0.0);
/// # Ok::<(), aerodeck::Error>(())
/// ```
///
/// # Errors
/// As [`CoupledSection::at`], and where the eigenvalues are not found.
pub fn smallest_damping(section: &CoupledSection, wind: f64) -> Result<f64> {
    Ok(least(&section.at(wind)?.eigenvalues()?))
}

fn least(eigenvalues: &[Complex<f64>]) -> f64 {
    // what grows without oscillating has a ratio of minus one
    let counted = |z: &&Complex<f64>| z.im > 0.0 || (z.im == 0.0 && z.re > 0.0);
    let damping = eigenvalues
        .iter()
        .filter(counted)
        .map(|z| damping_ratio(*z));
    damping.reduce(f64::min).unwrap_or(1.0)
}

impl PresentModes {
    /// The modes of a section of so many states that all eigenvalues are not found sooner; `None` of others.
    pub(super) fn of_many(section: &CoupledSection) -> Option<Self> {
        let many = section.states() > MOST_STATES_SOLVED;
        many.then(|| Self::new(section)).flatten()
    }

    /// The modes of `section`; `None` where they are not followed by shapes: sections, whose eigenvalues are quickly found, and
    /// sampled models.
    pub fn new(section: &CoupledSection) -> Option<Self> {
        let many = section.structure().is_modal();
        let problem = ModalCharacteristic::new(section).filter(|_| many)?;
        Some(Self {
            problem: Arc::new(problem),
            last: None,
        })
    }

    /// The smallest damping ratio of `section`, that of which they are the modes, at `wind`, m/s; `None` where it has to be
    /// found among all eigenvalues.
    pub fn smallest_damping(&mut self, section: &CoupledSection, wind: f64) -> Option<f64> {
        let now = self.follow(section, wind)?;
        let least = now.iter().map(|z| damping_ratio(*z)).reduce(f64::min)?;
        let alone = self.none_below(&now, wind, (least + MARGIN).min(STEEPEST));
        (alone == Some(true) && least < STEEPEST).then_some(least)
    }

    /// The eigenvalues of all modes of `section` at `wind`, m/s, rad/s; `None` where one is lost.
    pub(super) fn follow(
        &mut self,
        section: &CoupledSection,
        wind: f64,
    ) -> Option<Vec<Complex<f64>>> {
        let tracker = Tracker::by_shapes(section, Arc::clone(&self.problem));
        let from = match self.last.take() {
            Some(last) => last,
            None => tracker.start().ok()?,
        };
        // one that has stopped to oscillate may begin again
        let now = tracker.advance(&from, wind).ok();
        let now = now.filter(|modes| modes.all.len() == section.structure().dofs.len())?;
        let all = now.all.iter().map(|m| m.lambda).collect();
        self.last = Some(now);
        Some(all)
    }

    /// Whether no eigenvalue but the modes has a damping ratio below `ratio`; `None` where it cannot be counted.
    fn none_below(&self, modes: &[Complex<f64>], wind: f64, ratio: f64) -> Option<bool> {
        let at = self.problem.at(wind);
        let ray = Complex::from_polar(1.0, FRAC_PI_2 + ratio.asin());
        let rest = |distance: f64| -> Option<Complex<f64>> {
            let lambda = ray * distance;
            let mut modes = modes.iter();
            let rest = at.determinant(lambda, |pivot| {
                let mode = modes.next().copied().unwrap_or_default();
                pivot / ((lambda - mode) * (lambda - mode.conj()))
            })?;
            (rest.re.is_finite() && rest.im.is_finite()).then_some(rest)
        };
        let sizes = modes.iter().map(|z| z.norm());
        let sizes = sizes.chain(self.problem.filter_rates(wind));
        let (low, high) = sizes.fold((f64::INFINITY, 0.0_f64), |(low, high), size| {
            (low.min(size), high.max(size))
        });
        turn(rest, [ENDS[0] * low, ENDS[1] * high])
    }

    /// Of the `modes` at a wind speed (m/s) the one that decays slowest, where none grows and every other eigenvalue is damped by
    /// [`MARGIN`] at least; `None` where that is not known.
    pub(super) fn slowest_decay(&self, modes: &[Complex<f64>], wind: f64) -> Option<Complex<f64>> {
        let slowest = modes.iter().max_by(|a, b| a.re.total_cmp(&b.re))?;
        let alone = || self.none_below(modes, wind, MARGIN);
        (!growing(slowest) && alone() == Some(true)).then_some(*slowest)
    }
}

/// Whether a number that is real at zero and 1 at infinity turns not at all from the second distance down to the first; `None` where
/// it changes too fast.
fn turn(value: impl Fn(f64) -> Option<Complex<f64>>, [first, last]: [f64; 2]) -> Option<bool> {
    let mut at = (last, value(last)?);
    let mut turned = at.1.arg();
    if turned.abs() > AT_THE_ENDS {
        return None;
    }
    let mut next = last / FIRST_RATIO;
    for _ in 0..MOST_DISTANCES {
        let found = value(next.max(first))?;
        let change = found / at.1;
        let size = change.norm();
        if change.arg().abs() > SMALL_TURN || !(SMALL_RATIO.recip()..SMALL_RATIO).contains(&size) {
            next = (next * at.0).sqrt();
            continue;
        }
        turned += change.arg();
        if next <= first {
            return Some(turned.abs() < AT_THE_ENDS);
        }
        let ratio = (at.0 / next).powi(2).min(FIRST_RATIO);
        at = (next, found);
        next /= ratio;
    }
    None
}

#[cfg(test)]
mod tests;
