//! Search of poles over records: every pass evaluates many candidates, the grid shrinks around the best.

use super::accumulate::Factored;
use crate::error::{Error, Result};
use crate::identification::records::Task;
use crate::identification::report::{SearchPoint, SearchReport};
use crate::identification::search::{Bounds, best_of};
use crate::units::ReducedFrequencyRange;

/// Passes over the records: a grid, its refinements, and the fit itself.
pub(crate) const PASSES: usize = 5;
/// Points of the first grid for one pole: a factor 1.4 apart over the widest usual range.
const FIRST_POINTS: usize = 13;

/// A set of poles that is searched: of all transfer functions, or of one.
struct Group {
    entry: Option<(usize, usize)>,
    points: Vec<SearchPoint>,
    /// Logarithmic distance of neighbours in the last grid.
    step: f64,
}

/// Free poles — one set, or one a transfer function, row by row — and how they were found.
///
/// # Errors
/// [`Error::Input`] for bounds without room, and for poles per transfer function from records that move two degrees of
/// freedom at once.
pub(crate) fn choose_poles(
    task: &Task<'_>,
    tested: ReducedFrequencyRange,
) -> Result<(Vec<Vec<f64>>, Vec<SearchReport>)> {
    let (form, options) = (&task.fit.form, &task.fit.poles);
    if let Some(fixed) = &options.fixed {
        return Ok((vec![fixed.clone()], Vec::new()));
    }
    let count = form.free_poles();
    let bounds = Bounds::resolve(options, tested, count)?;
    let n = task.dofs.len();
    let entries: Vec<Option<(usize, usize)>> = if form.pole_per_transfer_function() {
        (0..n * n).map(|e| Some((e / n, e % n))).collect()
    } else {
        vec![None]
    };
    let range = (bounds.max / bounds.min).ln();
    let mut groups: Vec<Group> = entries
        .into_iter()
        .map(|entry| Group {
            entry,
            points: Vec::new(),
            step: range / (FIRST_POINTS as f64 - 1.0),
        })
        .collect();
    for pass in 1..PASSES {
        let mut candidates: Vec<Vec<f64>> = Vec::new();
        let mut owners: Vec<Vec<usize>> = Vec::new();
        for (g, group) in groups.iter_mut().enumerate() {
            let wanted = match (&options.start, pass) {
                (Some(start), 1) => {
                    group.step = range / 4.0;
                    vec![start.clone()]
                }
                (None, 1) => bounds.grid(count, FIRST_POINTS),
                _ => group.refine(&bounds)?,
            };
            for poles in wanted {
                match candidates.iter().position(|c| *c == poles) {
                    Some(at) => owners[at].push(g),
                    None => {
                        candidates.push(poles);
                        owners.push(vec![g]);
                    }
                }
            }
        }
        let chains: Vec<Vec<f64>> = candidates.iter().map(|c| form.expand(c)).collect();
        let systems = task.pass(&chains, true, (pass, PASSES))?;
        for ((poles, owners), system) in candidates.iter().zip(owners).zip(&systems) {
            for g in owners {
                let objective = objective(system, groups[g].entry)?;
                groups[g].points.push(SearchPoint {
                    poles: poles.clone(),
                    objective,
                });
            }
        }
    }
    let reports = groups
        .into_iter()
        .map(|g| g.report(task, &bounds))
        .collect::<Result<Vec<_>>>()?;
    let chosen = reports.iter().map(|r| r.chosen.poles.clone()).collect();
    Ok((chosen, reports))
}

fn objective(system: &Factored, entry: Option<(usize, usize)>) -> Result<f64> {
    let Some((i, j)) = entry else {
        return Ok(system.objective(system.layout.per_input));
    };
    let own = system
        .alone(i, j)
        .filter(|_| system.single_motions())
        .ok_or_else(|| {
            Error::input(
                "form.pole_per_transfer_function",
                "records that move one degree of freedom each, and every one of them",
                "records that move several at once, or a degree of freedom that never moves",
            )
        })?;
    Ok((own.residual_sum(own.columns(), 0) / own.total_sum(0)).sqrt())
}

impl Group {
    /// Points around the best, on a grid that is finer than the last.
    fn refine(&mut self, bounds: &Bounds) -> Result<Vec<Vec<f64>>> {
        let best = best_of(&self.points)?;
        let count = best.poles.len();
        let (offsets, shrink): (&[f64], f64) = if count == 1 {
            (&[-2.0, -1.0, 1.0, 2.0], 1.0 / 3.0)
        } else {
            (&[-1.0, 0.0, 1.0], 0.5)
        };
        self.step *= shrink;
        let mut sets: Vec<Vec<f64>> = vec![Vec::new()];
        for pole in &best.poles {
            sets = sets
                .iter()
                .flat_map(|set| {
                    offsets.iter().map(|o| {
                        let moved = pole * (o * self.step).exp();
                        let inside = moved.clamp(bounds.min, bounds.max);
                        set.iter().copied().chain([inside]).collect()
                    })
                })
                .collect();
        }
        sets.retain(|set| *set != best.poles && bounds.admits(set));
        sets.dedup();
        Ok(sets)
    }

    fn report(self, task: &Task<'_>, bounds: &Bounds) -> Result<SearchReport> {
        let mut chosen = best_of(&self.points)?;
        if let Some(vertex) = self.vertex(&chosen) {
            chosen.poles = vec![vertex.clamp(bounds.min, bounds.max)];
        }
        Ok(SearchReport {
            entry: self.entry.map(|(i, j)| (task.dofs[i], task.dofs[j])),
            force: None,
            min: bounds.min,
            max: bounds.max,
            points: self.points,
            chosen,
        })
    }

    /// Vertex of the parabola through the best point and its neighbours, for one pole, in `ln p` and the square of the
    /// objective; the parabola's own error is far below the last step.
    fn vertex(&self, best: &SearchPoint) -> Option<f64> {
        if best.poles.len() != 1 {
            return None;
        }
        let at = |p: &SearchPoint| (p.poles[0].ln(), p.objective.powi(2));
        let (x, y) = at(best);
        let near = |below: bool| {
            self.points
                .iter()
                .map(at)
                .filter(|(u, _)| (*u < x) == below && *u != x)
                .min_by(|a, b| (a.0 - x).abs().total_cmp(&(b.0 - x).abs()))
        };
        let ((a, fa), (b, fb)) = (near(true)?, near(false)?);
        let (left, right) = ((y - fa) / (x - a), (fb - y) / (b - x));
        let curvature = (right - left) / (b - a);
        (curvature > 0.0).then(|| {
            let vertex = 0.5 * (x + a) - 0.5 * left / curvature;
            vertex.clamp(a, b).exp()
        })
    }
}
