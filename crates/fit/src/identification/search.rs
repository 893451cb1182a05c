//! Bounded search of poles by variable projection: for given poles the coefficients follow from linear least squares,
//! so that only the poles are searched (Golub & Pereyra 1973).
//!
//! One pole: a logarithmic grid, then golden sections. Several: Levenberg–Marquardt on variables that make every point
//! legal — the logarithmic gaps between lower bound, poles and upper bound are shares of what the least ratio of
//! neighbours leaves, and the shares are a softmax of free numbers — from the best points of a grid. Points that do not wait for
//! one another are evaluated on all cores.

use super::form::{Form, PoleSearch};
use super::report::{SearchPoint, SearchReport, best_of};
use crate::error::{Result, counted, ensure};
use crate::numbered::numbered;
use crate::section::Dof;
use crate::state_space::golden_section;
use crate::units::ReducedFrequencyRange;
use aerodeck_core::threads;
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{DMatrix, DVector, Dyn, Owned};

/// Widest bracket left by golden sections, in `ln p`: the root of the rounding error of the objective.
const GOLDEN_TOLERANCE: f64 = 1e-8;
/// Grid points from which Levenberg–Marquardt starts.
const STARTS: usize = 3;

/// Step of the central differences of the residuals, in variables of order one; error about its square.
const DIFFERENCE_STEP: f64 = 1e-5;

/// Bounds of a search.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bounds {
    pub min: f64,
    pub max: f64,
    pub min_ratio: f64,
    /// The least that a pole may be: `min`, or more.
    pub least: f64,
}

impl Bounds {
    /// Stated bounds, or those of the form to twice the highest tested `K`.
    pub(crate) fn resolve(
        options: &PoleSearch,
        tested: ReducedFrequencyRange,
        form: &Form,
    ) -> Result<Self> {
        let count = form.free_poles();
        let lowest = tested.min.full_width();
        let min = options.min.unwrap_or(0.5 * lowest);
        let max = options.max.unwrap_or(2.0 * tested.max.full_width());
        let least = options.min.unwrap_or(form.least_pole() * lowest);
        let bounds = Self {
            min,
            max,
            min_ratio: options.min_ratio,
            // a stated upper bound may leave no room above it
            least: if least < max { least } else { min },
        };
        let ratio = bounds.min_ratio;
        ensure(
            bounds.slack(count) > 0.0,
            "poles.min, poles.max",
            format_args!("room for {} a factor {ratio} apart", counted(count, "pole")),
            format_args!("{min} to {max}"),
        )?;
        Ok(bounds)
    }

    /// Logarithmic room that the least ratios leave.
    fn slack(&self, count: usize) -> f64 {
        (self.max / self.min).ln() - (count as f64 - 1.0) * self.min_ratio.ln()
    }

    /// Ordered poles from free variables.
    pub(crate) fn poles(&self, free: &[f64]) -> Vec<f64> {
        let slack = self.slack(free.len());
        // the largest share is scaled to one, so that none overflows
        let top = free.iter().copied().fold(0.0, f64::max);
        let shares: Vec<f64> = free.iter().map(|x| (x - top).exp()).collect();
        let total: f64 = (-top).exp() + shares.iter().sum::<f64>();
        let mut at = self.min.ln() - self.min_ratio.ln();
        let pole = |share: &f64| {
            at += self.min_ratio.ln() + slack * share / total;
            at.exp()
        };
        shares.iter().map(pole).collect()
    }

    /// Free variables of ordered poles; poles on or beyond a bound are taken a little inside.
    pub(crate) fn free(&self, poles: &[f64]) -> Vec<f64> {
        let slack = self.slack(poles.len());
        let mut before = self.min.ln() - self.min_ratio.ln();
        let share = |p: &f64| {
            let share = (p.ln() - before - self.min_ratio.ln()) / slack;
            before = p.ln();
            share.max(1e-3)
        };
        let mut shares: Vec<f64> = poles.iter().map(share).collect();
        let used: f64 = shares.iter().sum();
        let last = (1.0 - used).max(1e-3);
        shares.iter_mut().for_each(|s| *s = (*s / last).ln());
        shares
    }

    /// `points` values from bound to bound, logarithmic.
    fn axis(&self, points: usize) -> Vec<f64> {
        let step = (self.max / self.min).ln() / (points as f64 - 1.0);
        let all = (0..points).map(|i| self.min * (step * i as f64).exp());
        all.filter(|p| *p >= self.least * (1.0 - 1e-12)).collect()
    }

    /// Ordered sets of `count` poles from a logarithmic grid that keep the least ratio.
    pub(crate) fn grid(&self, count: usize, points: usize) -> Vec<Vec<f64>> {
        // several axes share what one would have: about a hundred sets
        let points = match count {
            1 => points,
            2 => 13,
            3 => 9,
            _ => count + 5,
        };
        let axis = self.axis(points);
        let mut sets: Vec<Vec<f64>> = vec![Vec::new()];
        for _ in 0..count {
            let apart = |set: &[f64], p: f64| set.last().is_none_or(|q| p >= q * self.min_ratio);
            let longer = sets.iter().flat_map(|set| {
                let next = axis.iter().filter(|p| apart(set, **p));
                next.map(|p| [&set[..], &[*p]].concat())
            });
            sets = longer.collect();
        }
        if sets.is_empty() {
            sets.push(self.poles(&vec![0.0; count]));
        }
        sets
    }

    /// A start, brought between the bounds.
    pub(crate) fn inside(&self, start: &[f64]) -> Vec<f64> {
        let clamped = start.iter().map(|p| p.clamp(self.least, self.max));
        clamped.collect()
    }

    /// Whether the poles are ordered, apart and inside.
    pub(crate) fn admits(&self, poles: &[f64]) -> bool {
        let inside = |p: &f64| *p >= self.least * (1.0 - 1e-12) && *p <= self.max * (1.0 + 1e-12);
        let apart = |w: &[f64]| w[1] >= w[0] * self.min_ratio * (1.0 - 1e-12);
        poles.iter().all(inside) && poles.windows(2).all(apart)
    }
}

/// Searches `count` poles that minimise the norm of `residuals` (weighted and relative, with the best coefficients).
///
/// # Errors
/// When no point of the grid can be fitted (the first such error).
pub(crate) fn search_poles(
    count: usize,
    options: &PoleSearch,
    bounds: Bounds,
    entry: Option<(Dof, Dof)>,
    residuals: PoleResiduals<'_>,
) -> Result<SearchReport> {
    let mut points = Vec::new();
    let starts = match &options.start {
        Some(start) => vec![bounds.inside(start)],
        None => bounds.grid(count, options.grid_points),
    };
    evaluate(starts, residuals, &mut points)?;
    if count == 1 {
        golden(&bounds, options.grid_points, residuals, &mut points)?;
    } else {
        levenberg_marquardt(&bounds, residuals, &mut points)?;
    }
    SearchReport::new(entry, [bounds.least, bounds.max], points)
}

/// Weighted residuals with the best coefficients for these poles.
pub(crate) type PoleResiduals<'a> = &'a (dyn Fn(&[f64]) -> Result<DVector<f64>> + Sync);

fn evaluate(
    sets: Vec<Vec<f64>>,
    residuals: PoleResiduals<'_>,
    points: &mut Vec<SearchPoint>,
) -> Result<()> {
    let objective = |at: usize| Ok(residuals(&sets[at])?.norm());
    let found = numbered(sets.len(), &|_, _| (), objective)?;
    let evaluated = sets.into_iter().zip(found);
    points.extend(evaluated.map(|(poles, objective)| SearchPoint { poles, objective }));
    Ok(())
}

/// Golden sections between the neighbours of the best grid point (or around a stated start).
fn golden(
    bounds: &Bounds,
    grid_points: usize,
    residuals: PoleResiduals<'_>,
    points: &mut Vec<SearchPoint>,
) -> Result<()> {
    let centre = best_of(points)?.poles[0].ln();
    let (low, high) = (bounds.min.ln(), bounds.max.ln());
    let step = match points.len() {
        1 => high - low,
        _ => (high - low) / (grid_points as f64 - 1.0),
    };
    let ends = (centre - step).max(bounds.least.ln())..(centre + step).min(high);
    let at = |x: f64| {
        evaluate(vec![vec![x.exp()]], residuals, points)?;
        Ok(points[points.len() - 1].objective)
    };
    golden_section(ends, at, f64::lt, |width, _, _| width <= GOLDEN_TOLERANCE)?;
    Ok(())
}

/// Descents from the best points of the grid.
fn levenberg_marquardt(
    bounds: &Bounds,
    residuals: PoleResiduals<'_>,
    points: &mut Vec<SearchPoint>,
) -> Result<()> {
    let mut starts = points.clone();
    starts.sort_by(|a, b| a.objective.total_cmp(&b.objective));
    starts.truncate(STARTS);
    let end = |start: &SearchPoint| {
        let free = DVector::from_vec(bounds.free(&start.poles));
        let found = descend(free, &|free| residuals(&bounds.poles(free)).ok());
        let finite = found.iter().all(|x| x.is_finite());
        finite.then(|| bounds.poles(found.as_slice()))
    };
    let ends = threads::each(&starts, true, end).into_iter();
    let ends = ends.flatten().collect();
    evaluate(ends, residuals, points)
}

/// Residuals at a point; `None` where there are none.
pub(crate) type Residuals<'a> = &'a (dyn Fn(&[f64]) -> Option<DVector<f64>> + Sync);

/// The point that a descent from `start` ends at; whatever the reason it stopped for, the caller judges it by its
/// residuals.
pub(crate) fn descend(start: DVector<f64>, residuals: Residuals<'_>) -> DVector<f64> {
    let problem = Descent {
        at: start,
        residuals,
    };
    LevenbergMarquardt::new().minimize(problem).0.at
}

struct Descent<'a> {
    at: DVector<f64>,
    residuals: Residuals<'a>,
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Descent<'_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, x: &DVector<f64>) {
        self.at.copy_from(x);
    }

    fn params(&self) -> DVector<f64> {
        self.at.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        (self.residuals)(self.at.as_slice())
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let (at, residuals) = (&self.at, self.residuals);
        let column = |c: usize| {
            let moved_to = |place: f64| {
                let mut x = at.clone();
                x[c] = place;
                residuals(x.as_slice())
            };
            let ahead = at[c] + DIFFERENCE_STEP;
            let behind = ahead - 2.0 * DIFFERENCE_STEP;
            let (ahead, behind) = rayon::join(|| moved_to(ahead), || moved_to(behind));
            Some((ahead? - behind?) / (2.0 * DIFFERENCE_STEP))
        };
        let columns = threads::numbered(at.len(), true, column).into_iter();
        let columns: Option<Vec<_>> = columns.collect();
        Some(DMatrix::from_columns(&columns?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Bounds = Bounds {
        min: 0.05,
        max: 2.0,
        min_ratio: 1.5,
        least: 0.05,
    };

    #[test]
    fn free_variables_and_poles_are_inverse_and_legal() {
        for poles in [vec![0.3], vec![0.1, 0.2], vec![0.06, 0.4, 1.3]] {
            let again = BOUNDS.poles(&BOUNDS.free(&poles));
            for (a, b) in again.iter().zip(&poles) {
                assert!((a / b - 1.0).abs() < 1e-12);
            }
        }
        for free in [[-40.0, 40.0, 0.0], [9.0, -9.0, -30.0], [900.0, 2.0, 800.0]] {
            assert!(BOUNDS.admits(&BOUNDS.poles(&free)));
        }
        for count in 1..4 {
            assert!(BOUNDS.grid(count, 41).iter().all(|set| BOUNDS.admits(set)));
        }
    }

    /// A minimum at known poles is found to the root of rounding.
    #[test]
    fn minima_inside_and_at_bounds_are_found() {
        let options = PoleSearch::default();
        for target in [vec![0.31], vec![0.149, 0.538], vec![0.1, 0.3, 1.1]] {
            let residuals = |p: &[f64]| {
                let misfit = p.iter().zip(&target).map(|(p, t)| (p / t).ln());
                Ok(DVector::from_iterator(
                    target.len() + 1,
                    misfit.chain([0.1]),
                ))
            };
            let found = search_poles(target.len(), &options, BOUNDS, None, &residuals);
            for (p, t) in found.unwrap().chosen.poles.iter().zip(&target) {
                assert!((p / t - 1.0).abs() < 1e-5, "{p} {t}");
            }
        }
        let outside = |p: &[f64]| Ok(DVector::from_element(1, p[0] + 1.0));
        let found = search_poles(1, &options, BOUNDS, None, &outside).unwrap();
        assert!((found.chosen.poles[0] / BOUNDS.min - 1.0).abs() < 1e-6);
    }
}
