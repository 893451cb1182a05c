//! Grids over the number of filters and their pole or decay factor, in one pass over the records.
//!
//! Columns are nested in `L`, so one factorisation of the largest number of filters serves all smaller ones; and every
//! segment is factored by itself, so that leaving segments out costs no further pass.

mod columns;
mod discrete_pass;

use super::basis::{Basis, assemble};
use super::least_squares::Factor;
use super::options::{Form, TimeFit, TimeWeights, number_of_filters};
use super::records::{Joint, OnProgress, Task, tested_range, wishes};
use super::time::accumulate::{Factored, Plan};
use super::time::filters::ContinuousColumns;
use super::time::layout::Layout;
use super::time::selection::Selection;
use super::time::slices::{Scaled, scale_all};
use super::time::stretches::{Closed, stretches};
use crate::aerodynamics::DiscreteLaguerre;
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::trained_model::Model;
use crate::units::ReducedFrequencyRange;
use crate::wind_tunnel::RecordSource;
use discrete_pass::{discrete_pass, report};
use nalgebra::DMatrix;
use std::rc::Rc;

/// What a grid is laid over.
#[derive(Debug, Clone, PartialEq)]
pub enum GridAxis {
    /// Discrete Laguerre filters: decay factors `α`, and the weights of the fit.
    Discrete(Vec<f64>, TimeWeights),
    /// Continuous Laguerre filters with feed-through: poles `p`; form, weights and low-pass are those of the fit.
    Continuous(Vec<f64>, Box<TimeFit>),
}

/// A stretch of a record that was kept apart.
#[derive(Debug, Clone, PartialEq)]
pub struct StretchLabel {
    /// Mean speed of the record, m/s.
    pub mean_speed_m_s: f64,
    /// Frequency of the motion, Hz; `None` for other motions.
    pub frequency_hz: Option<f64>,
}

/// Factors of all candidates and stretches.
pub struct Grid {
    axis: GridAxis,
    dofs: Vec<Dof>,
    filters_max: usize,
    tested: ReducedFrequencyRange,
    delta_s: f64,
    layout: Layout,
    closed: Vec<Closed>,
    labels: Vec<StretchLabel>,
}

/// Fit of one cell.
#[derive(Debug, Clone, PartialEq)]
pub struct CellFit {
    /// The model.
    pub model: Model,
    /// Root mean square, over the transfer functions, of the relative residuals, as in the search of poles.
    pub objective: f64,
    /// Largest single term over the norm of the fit, of any transfer function.
    pub cancellation: f64,
    coefficients: Vec<DMatrix<f64>>,
}

impl Grid {
    /// One pass over the records.
    ///
    /// # Errors
    /// [`Error::Input`] for an axis without values, no filters, records that do not fit together or move several
    /// degrees of freedom at once; those of reading.
    pub fn new(
        records: &[&dyn RecordSource],
        axis: GridAxis,
        filters_max: usize,
        progress: OnProgress<'_>,
    ) -> Result<Self> {
        if axis.values().is_empty() || filters_max == 0 {
            return Err(Error::input(
                "grid",
                "at least one value and one filter",
                "none",
            ));
        }
        number_of_filters("grid.filters", filters_max)?;
        let (dofs, scaled) = scale_all(records)?;
        let tested = tested_range(&scaled)?;
        let delta_s = scaled.iter().map(Scaled::delta_s).fold(0.0, f64::max);
        let (layout, closed) = match &axis {
            GridAxis::Discrete(alphas, weights) => discrete_pass(
                &scaled,
                dofs.len(),
                (alphas, *weights),
                (filters_max, delta_s),
                progress,
            )?,
            GridAxis::Continuous(poles, fit) => {
                let task = Task {
                    fit,
                    dofs: &dofs,
                    records: &scaled,
                    // the grid itself says which filters there are
                    entries: &[],
                    progress,
                };
                continuous_pass(&task, poles, filters_max)?
            }
        };
        let label = |c: &Closed| StretchLabel {
            mean_speed_m_s: records[c.record].header().mean_speed_m_s,
            frequency_hz: c
                .segment
                .map(|s| scaled[c.record].segments()[s].frequency_hz),
        };
        let labels = closed.iter().map(label).collect();
        if closed.iter().any(|c| c.set.len() > 1) {
            return Err(Error::input(
                "records",
                "one moving degree of freedom a record",
                "several that move at once",
            ));
        }
        Ok(Self {
            labels,
            axis,
            dofs,
            filters_max,
            tested,
            delta_s,
            layout,
            closed,
        })
    }

    /// Values along the axis.
    pub fn values(&self) -> &[f64] {
        self.axis.values()
    }

    /// Symbol of the axis.
    pub fn symbol(&self) -> &'static str {
        self.axis.symbol()
    }

    /// Greatest number of filters.
    pub fn filters_max(&self) -> usize {
        self.filters_max
    }

    /// Reduced frequencies of the records.
    pub fn tested_range(&self) -> ReducedFrequencyRange {
        self.tested
    }

    /// Degrees of freedom of rows and columns.
    pub fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    /// The stretches, in the order in which `keep` sees them.
    pub fn labels(&self) -> &[StretchLabel] {
        &self.labels
    }

    /// All numbers of filters, from one to the greatest, of one value of the axis, fitted to the stretches for which
    /// `keep` is true.
    ///
    /// # Errors
    /// Stretches that do not determine the coefficients: as an entry of the list.
    pub fn fits(&self, value: usize, keep: &dyn Fn(usize) -> bool) -> Vec<Result<CellFit>> {
        let chosen = self.closed.iter().enumerate().filter(|(s, _)| keep(*s));
        let systems = Factored::from_stretches(self.layout, chosen.map(|(_, c)| c), value);
        let systems = Rc::new(systems);
        (1..=self.filters_max)
            .map(|filters| self.cell(&systems, value, filters))
            .collect()
    }

    fn leading(&self, filters: usize) -> usize {
        let feed = self.layout.per_input - self.filters_max;
        feed + filters
    }

    fn cell(&self, systems: &Rc<Factored>, value: usize, filters: usize) -> Result<CellFit> {
        let per_input = self.leading(filters);
        let leading = self.layout.leading(per_input);
        let mut coefficients = systems
            .whole
            .iter()
            .map(|factor| factor.solve(leading))
            .collect::<Result<Vec<_>>>()?;
        let mut objective = systems.objective(per_input, &|_, _| true);
        if let Some(held) = self.constrained(systems, value, filters)? {
            objective = held.objective();
            for (i, all) in coefficients.iter_mut().enumerate() {
                for j in 0..self.dofs.len() {
                    for (c, x) in held.values(i * self.dofs.len() + j).iter().enumerate() {
                        all[self.layout.index(c, j)] = *x;
                    }
                }
            }
        }
        let mut cancellation: f64 = 0.0;
        for (set, factors) in systems.sets.iter().filter(|(set, _)| !set.is_empty()) {
            for (factor, all) in factors.iter().zip(&coefficients) {
                let own = self.own(set[0], per_input, all);
                cancellation = cancellation.max(factor.cancellation(&own, 0));
            }
        }
        Ok(CellFit {
            model: self.model(value, filters, &coefficients)?,
            objective,
            cancellation,
            coefficients,
        })
    }

    /// The fit under its constraints, where these are asked for and bind.
    fn constrained(
        &self,
        systems: &Rc<Factored>,
        value: usize,
        filters: usize,
    ) -> Result<Option<Joint>> {
        let GridAxis::Continuous(poles, fit) = &self.axis else {
            return Ok(None);
        };
        let wishes = wishes(fit, &self.dofs, self.tested)?;
        if !wishes.any() {
            return Ok(None);
        }
        let entries = self.dofs.len() * self.dofs.len();
        let form = with_filters(&fit.form, filters);
        let basis = Basis::orthonormal(&form, &vec![poles[value]; filters])?;
        let selection = Selection {
            counts: vec![self.leading(filters); entries],
            systems: vec![Rc::clone(systems)],
        };
        let joint = Joint::new(&selection, &vec![basis; entries], &wishes)?;
        Ok(Some(joint).filter(|j| j.held.is_some()))
    }

    /// Coefficients that a system of input `j` alone takes: the constant, if any, then that input's.
    fn own(&self, j: usize, per_input: usize, all: &DMatrix<f64>) -> Vec<f64> {
        let constant = self.layout.constant.then(|| all[0]);
        let columns = (0..per_input).map(|c| all[self.layout.index(c, j)]);
        constant.into_iter().chain(columns).collect()
    }

    fn model(&self, value: usize, filters: usize, all: &[DMatrix<f64>]) -> Result<Model> {
        let n = self.dofs.len();
        let per_input = self.leading(filters);
        match &self.axis {
            GridAxis::Discrete(alphas, _) => {
                let of_motion =
                    |j| DMatrix::from_fn(n, filters, |i, l| all[i][self.layout.index(l, j)]);
                let model = DiscreteLaguerre::shared(
                    self.dofs.clone(),
                    alphas[value],
                    self.delta_s,
                    (0..n).map(of_motion).collect(),
                    all.iter().map(|c| c[0]).collect(),
                );
                model.validate()?;
                Ok(Model::DiscreteLaguerre(model))
            }
            GridAxis::Continuous(poles, fit) => {
                let form = with_filters(&fit.form, filters);
                let chain = vec![vec![vec![poles[value]; filters]; n]; n];
                let coefficients: Vec<Vec<Vec<f64>>> = (0..n)
                    .map(|i| {
                        (0..n)
                            .map(|j| {
                                (0..per_input)
                                    .map(|c| all[i][self.layout.index(c, j)])
                                    .collect()
                            })
                            .collect()
                    })
                    .collect();
                assemble(&form, &self.dofs, &chain, &coefficients)
            }
        }
    }

    /// Sum of squared residuals and of squared data of every force, weighted, in one stretch; `None` in one at rest.
    pub fn residuals(
        &self,
        stretch: usize,
        value: usize,
        fit: &CellFit,
    ) -> Option<Vec<(f64, f64)>> {
        let closed = &self.closed[stretch];
        let &j = closed.set.first()?;
        let factor: &Factor = &closed.factors[value];
        let sums = fit.coefficients.iter().enumerate().map(|(i, all)| {
            let per_input = (all.len() - usize::from(self.layout.constant)) / self.dofs.len();
            let mut own = self.own(j, per_input, all);
            own.resize(factor.columns(), 0.0);
            let square = closed.weights[i].powi(2);
            let residual = factor.residual_sum_of(&own, i);
            (square * residual, square * factor.total_sum(i))
        });
        Some(sums.collect())
    }

    /// Input that moves in a stretch.
    pub fn motion(&self, stretch: usize) -> Option<Dof> {
        self.closed[stretch].set.first().map(|j| self.dofs[*j])
    }
}

impl GridAxis {
    /// Values along the axis.
    pub fn values(&self) -> &[f64] {
        match self {
            Self::Discrete(values, _) | Self::Continuous(values, _) => values,
        }
    }

    /// Symbol of the parameter.
    pub fn symbol(&self) -> &'static str {
        match self {
            Self::Discrete(..) => "α",
            Self::Continuous(..) => "p",
        }
    }
}

fn with_filters(form: &Form, filters: usize) -> Form {
    Form::Laguerre {
        filters,
        feed_through: form.feed_through(),
        pole_per_transfer_function: false,
    }
}

fn continuous_pass(
    task: &Task<'_>,
    poles: &[f64],
    filters: usize,
) -> Result<(Layout, Vec<Closed>)> {
    let form = with_filters(&task.fit.form, filters);
    let inputs = task.dofs.len();
    let bases = poles
        .iter()
        .map(|p| Ok(vec![Basis::orthonormal(&form, &vec![*p; filters])?; inputs]))
        .collect::<Result<Vec<_>>>()?;
    let layout = Layout {
        inputs,
        per_input: form.feed_through().count() + filters,
        constant: false,
    };
    let plan = Plan {
        layout,
        weights: task.fit.weights,
        delta_s: None,
        discard_s: task.fit.discard_s,
        stride: task.thinning(),
        stretches: 1,
    };
    let make =
        |record: &Scaled<'_>| ContinuousColumns::new(record, &bases, task.cutoff_hz(record), false);
    let done = report(task.progress, task.records.len());
    Ok((layout, stretches(task.records, &plan, &make, &done)?))
}

#[cfg(test)]
mod tests;
