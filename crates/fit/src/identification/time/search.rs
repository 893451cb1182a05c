//! Search of poles over records: every pass evaluates many candidates, the grid shrinks around the best.

use super::continuous::{RecordFit, padded};
use super::systems::{ForceSystems, Systems};
use crate::error::{Error, Result};
use crate::identification::basis::Basis;
use crate::identification::dissipative::FitRequirements;
use crate::identification::form::{Form, PoleSearch};
use crate::identification::least_squares::Factor;
use crate::identification::own::{EntryForm, entry_forms, search_for, searched_together};
use crate::identification::report::{SearchPoint, SearchReport, best_of};
use crate::identification::search::Bounds;
use crate::section::Dof;
use crate::units::ReducedFrequencyRange;
use std::rc::Rc;

/// Passes over the records: a grid, its refinements, and the fit itself.
pub(crate) const PASSES: usize = 5;
/// Points of the first grid for one pole: a factor 1.4 apart over the widest usual range.
const FIRST_POINTS: usize = 13;

/// A set of poles that is searched: of the transfer functions that share it, or of one.
struct PoleGroup {
    /// Places of its transfer functions, row by row.
    members: Vec<usize>,
    /// Force and motion, when it is one with poles of its own.
    entry: Option<(usize, usize)>,
    form: Form,
    options: PoleSearch,
    bounds: Bounds,
    points: Vec<SearchPoint>,
    /// Logarithmic distance of neighbours in the last grid.
    step: f64,
    /// What is asked besides, where the objective is that of the fit under its constraints.
    constrained: Option<FitRequirements>,
}

/// Poles of the filters of every transfer function, row by row, and how they were found.
pub(crate) type EntryPoles = (Vec<Vec<f64>>, Vec<SearchReport>);

/// Poles of every transfer function, by least squares alone and, where constraints are asked for, under these. Both searches
/// share their passes. Poles that only some transfer functions share are those of least squares in either case: under
/// constraints each of their candidates would have to be tried with all candidates of the others.
///
/// # Errors
/// [`Error::Input`] for bounds without room, for own filters and limits of degrees of freedom that are not there, and for poles
/// per transfer function from records that move two degrees of freedom at once.
pub(crate) fn choose_poles(
    task: &RecordFit<'_>,
    tested: ReducedFrequencyRange,
) -> Result<Vec<EntryPoles>> {
    let (fit, dofs) = (task.fit, &task.records.dofs);
    let entries = entry_forms(dofs, &fit.form, &fit.poles, &fit.own)?;
    let requirements = fit.requirements(dofs, tested)?;
    let group = |members| PoleGroup::new(&fit.poles, &entries, tested, members);
    let groups = searched_together(&entries).into_iter().map(group);
    let mut groups = groups.collect::<Result<Vec<_>>>()?;
    let unconstrained = groups.len();
    if requirements.any() && unconstrained == 1 && groups[0].members.len() == entries.len() {
        let members = groups[0].members.clone();
        groups.push(PoleGroup {
            constrained: Some(requirements.clone()),
            ..group(members)?
        });
    }
    let filters = entries.iter().map(|e| e.form.filters());
    let longest = filters.max().unwrap_or(0);
    for pass in 1..PASSES {
        if groups.is_empty() {
            break;
        }
        task.evaluate(&mut groups, pass, longest)?;
    }
    let constrained = groups.split_off(unconstrained);
    let mut chosen = vec![choice(&entries, dofs, groups)?];
    if !constrained.is_empty() {
        chosen.push(choice(&entries, dofs, constrained)?);
    } else if requirements.any() {
        chosen.push(chosen[0].clone());
    }
    Ok(chosen)
}

impl RecordFit<'_> {
    /// One pass over the records for the poles that every group wants to know of.
    fn evaluate(&self, groups: &mut [PoleGroup], pass: usize, longest: usize) -> Result<()> {
        let mut candidates: Vec<Vec<f64>> = Vec::new();
        let mut trials: Vec<(usize, Vec<f64>, usize)> = Vec::new();
        for (g, group) in groups.iter_mut().enumerate() {
            for poles in group.wanted(pass)? {
                let chain = padded(&group.form.expand(&poles), longest);
                let known = candidates.iter().position(|c| *c == chain);
                let at = known.unwrap_or(candidates.len());
                if known.is_none() {
                    candidates.push(chain);
                }
                trials.push((g, poles, at));
            }
        }
        let everywhere = |chain: &Vec<f64>| -> Result<Vec<Basis>> {
            let basis = Basis::orthonormal(&self.fit.form, chain)?;
            Ok(vec![basis; self.records.dofs.len()])
        };
        let bases: Vec<_> = candidates.iter().map(everywhere).collect::<Result<_>>()?;
        let passed = self.pass(&bases, self.thinning(), 0, pass, PASSES)?;
        let systems = passed.systems();
        for (g, poles, at) in trials {
            let objective = groups[g].objective(&poles, &systems[at])?;
            groups[g].points.push(SearchPoint { poles, objective });
        }
        Ok(())
    }
}

/// Fixed poles, and those that the groups found.
fn choice(entries: &[EntryForm], dofs: &[Dof], groups: Vec<PoleGroup>) -> Result<EntryPoles> {
    let fixed = entries.iter().map(|e| e.fixed.clone());
    let mut poles: Vec<Vec<f64>> = fixed.map(Option::unwrap_or_default).collect();
    let mut search = Vec::with_capacity(groups.len());
    for group in groups {
        let members = group.members.clone();
        let report = group.report(dofs)?;
        for e in members {
            poles[e].clone_from(&report.chosen.poles);
        }
        search.push(report);
    }
    let chains = poles.iter().zip(entries);
    Ok((chains.map(|(p, e)| e.form.expand(p)).collect(), search))
}

impl PoleGroup {
    fn new(
        poles: &PoleSearch,
        entries: &[EntryForm],
        tested: ReducedFrequencyRange,
        members: Vec<usize>,
    ) -> Result<Self> {
        let first = &entries[members[0]];
        let options = search_for(poles, &first.form);
        let bounds = Bounds::resolve(&options, tested, &first.form)?;
        let n = entries.len().isqrt();
        let range = (bounds.max / bounds.min).ln();
        Ok(Self {
            entry: first.alone.then_some((members[0] / n, members[0] % n)),
            form: first.form.clone(),
            points: Vec::new(),
            step: match options.start {
                Some(_) => range / 4.0,
                None => range / (FIRST_POINTS as f64 - 1.0),
            },
            members,
            options,
            bounds,
            constrained: None,
        })
    }

    /// Poles to be tried in a pass.
    fn wanted(&mut self, pass: usize) -> Result<Vec<Vec<f64>>> {
        match (&self.options.start, pass) {
            (Some(start), 1) => Ok(vec![self.bounds.inside(start)]),
            (None, 1) => Ok(self.bounds.grid(self.form.free_poles(), FIRST_POINTS)),
            _ => self.refine(),
        }
    }

    /// Relative weighted residual of its transfer functions with the first columns of a system.
    fn objective(&self, poles: &[f64], system: &Rc<Systems>) -> Result<f64> {
        let columns = self.form.feed_through().count() + self.form.filters();
        // a motion that is missing is named in the last pass
        let determined = |f: &Factor| f.undetermined(f.columns()).is_none();
        let known = system.whole.iter().all(determined);
        if let Some(requirements) = self.constrained.as_ref().filter(|_| known) {
            let basis = Basis::orthonormal(&self.form, &self.form.expand(poles))?;
            let (_, objective) = ForceSystems::held_alike(system, basis, requirements)?;
            return Ok(objective);
        }
        let Some((i, j)) = self.entry else {
            let n = system.order.inputs;
            let among = |i: usize, j: usize| self.members.contains(&(i * n + j));
            return Ok(system.objective(columns, &among));
        };
        let own = system.alone(i, j).ok_or_else(|| {
            Error::input(
                "form.pole_per_transfer_function, own",
                "records that move one degree of freedom each, and every one of them",
                "records that move several at once, or a degree of freedom that never moves",
            )
        })?;
        let leading = system.order.leading(columns, 1);
        Ok((own.residual_sum(leading, 0) / own.total_sum(0)).sqrt())
    }

    /// Points around the best, on a grid that is finer than the last.
    fn refine(&mut self) -> Result<Vec<Vec<f64>>> {
        let bounds = &self.bounds;
        let best = best_of(&self.points)?;
        let (offsets, shrink): (&[f64], f64) = match best.poles.len() {
            1 => (&[-2.0, -1.0, 1.0, 2.0], 1.0 / 3.0),
            _ => (&[-1.0, 0.0, 1.0], 0.5),
        };
        self.step *= shrink;
        let mut sets: Vec<Vec<f64>> = vec![Vec::new()];
        for pole in &best.poles {
            let moved = offsets.iter().map(|o| pole * (o * self.step).exp());
            let inside: Vec<f64> = moved.map(|p| p.clamp(bounds.least, bounds.max)).collect();
            let longer = |set: &Vec<f64>| -> Vec<Vec<f64>> {
                inside.iter().map(|p| [&set[..], &[*p]].concat()).collect()
            };
            sets = sets.iter().flat_map(longer).collect();
        }
        sets.retain(|set| *set != best.poles && bounds.admits(set));
        sets.dedup();
        Ok(sets)
    }

    fn report(self, dofs: &[Dof]) -> Result<SearchReport> {
        let (entry, bounds) = (self.entry.map(|(i, j)| (dofs[i], dofs[j])), self.bounds);
        let vertex = self.vertex(&best_of(&self.points)?);
        let mut report = SearchReport::new(entry, [bounds.least, bounds.max], self.points)?;
        if let Some(vertex) = vertex {
            report.chosen.poles = vec![vertex.clamp(bounds.least, bounds.max)];
        }
        Ok(report)
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
            let others = self.points.iter().map(at);
            let beside = others.filter(|(u, _)| (*u < x) == below && *u != x);
            beside.min_by(|a, b| (a.0 - x).abs().total_cmp(&(b.0 - x).abs()))
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
