//! A derivative table as a model: each derivative interpolated linearly in its own `V̂`.

use super::{Derivative, DerivativeTable, Part};
use crate::aerodynamics::{AerodynamicModel, Realization, TransferMatrix};
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use nalgebra::{Complex, DMatrix};
use serde::{Deserialize, Serialize};

/// What an interpolated table says outside the tested range.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Extrapolation {
    /// Nothing: an error.
    #[default]
    Refuse,
    /// Each derivative keeps the value of its nearest point.
    Hold,
}

/// One derivative as a polygon over rising `V̂`.
#[derive(Debug, Clone, PartialEq)]
struct Polygon {
    v_hat: Vec<f64>,
    value: Vec<f64>,
}

/// A measured table between its points. Each derivative is linear in its own `V̂`; `G` follows from (1.17).
#[derive(Debug, Clone, PartialEq)]
pub struct InterpolatedTable {
    name: String,
    dofs: Vec<Dof>,
    extrapolation: Extrapolation,
    tested_range: ReducedFrequencyRange,
    /// Real and imaginary part of each entry, row by row.
    entries: Vec<(Polygon, Polygon)>,
}

impl InterpolatedTable {
    /// The table among `dofs`. Points of one derivative with exactly the same `V̂` (at two speeds) count with
    /// their mean value.
    ///
    /// # Errors
    /// [`Error::Input`] when the table lacks a derivative of `dofs`.
    pub fn new(
        table: &DerivativeTable,
        dofs: &[Dof],
        extrapolation: Extrapolation,
    ) -> Result<Self> {
        table.require(dofs)?;
        let polygon =
            |force, motion, part| Polygon::new(table, Derivative::of(force, motion, part));
        let entries = dofs
            .iter()
            .flat_map(|force| dofs.iter().map(move |motion| (*force, *motion)))
            .map(|(f, m)| (polygon(f, m, Part::Real), polygon(f, m, Part::Imaginary)))
            .collect();
        Ok(Self {
            name: table.name.clone(),
            dofs: dofs.to_vec(),
            extrapolation,
            tested_range: table.tested_range(dofs),
            entries,
        })
    }

    /// The range of `K` in which every derivative was tested; outside it the policy of extrapolation holds.
    pub fn tested_range(&self) -> ReducedFrequencyRange {
        self.tested_range
    }
}

impl Polygon {
    fn new(table: &DerivativeTable, derivative: Derivative) -> Self {
        let mut points = table.points(derivative).to_vec();
        points.sort_by(|a, b| a.v_hat.total_cmp(&b.v_hat));
        let (v_hat, value) = points
            .chunk_by(|a, b| a.v_hat == b.v_hat)
            .map(|same| {
                let mean = same.iter().map(|p| p.value).sum::<f64>() / same.len() as f64;
                (same[0].v_hat, mean)
            })
            .unzip();
        Self { v_hat, value }
    }

    /// Linear between the points, constant outside them.
    fn at(&self, v_hat: f64) -> f64 {
        let above = self.v_hat.partition_point(|v| *v < v_hat);
        if above == 0 {
            return self.value[0];
        }
        if above == self.v_hat.len() {
            return self.value[above - 1];
        }
        let (x0, x1) = (self.v_hat[above - 1], self.v_hat[above]);
        let t = (v_hat - x0) / (x1 - x0);
        self.value[above - 1] * (1.0 - t) + self.value[above] * t
    }
}

impl AerodynamicModel for InterpolatedTable {
    fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        let k_full = k.full_width();
        let allowed = match self.extrapolation {
            Extrapolation::Refuse => self.tested_range.contains(k),
            Extrapolation::Hold => k_full.is_finite() && k_full >= 0.0,
        };
        if !allowed {
            let (min, max) = (self.tested_range.min, self.tested_range.max);
            return Err(Error::input(
                format!("table {}", self.name),
                format!(
                    "a reduced frequency K in the tested range {:.4} to {:.4}",
                    min.full_width(),
                    max.full_width()
                ),
                format!("K = {k_full:.4}"),
            ));
        }
        let n = self.dofs.len();
        let entry = |i: usize, j: usize| {
            let (re, im) = &self.entries[i * n + j];
            Complex::new(re.at(k.v_hat()), im.at(k.v_hat())) * (k_full * k_full)
        };
        Ok(DMatrix::from_fn(n, n, entry))
    }

    fn realize(&self) -> Option<Realization> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::super::table::tests::flat_plate_table;
    use super::*;
    use crate::aerodynamics::FlatPlate;

    #[test]
    fn exact_at_the_points_and_linear_in_v_hat_between_them() {
        let table = flat_plate_table(&[4.0], &[10.0, 5.0, 2.0]);
        let model = InterpolatedTable::new(&table, &Dof::TWO, Extrapolation::Refuse).unwrap();
        let plate = |v| {
            FlatPlate::default()
                .transfer(ReducedFrequency::from_v_hat(v))
                .unwrap()
        };
        let at = |v| model.transfer(ReducedFrequency::from_v_hat(v)).unwrap();
        assert!((at(5.0) - plate(5.0)).camax() < 1e-15);
        // Half way between V̂ = 5 and 10 every derivative G V̂² is the mean of the two.
        let expected = (plate(5.0) * Complex::from(25.0) + plate(10.0) * Complex::from(100.0))
            * Complex::from(0.5 / (7.5 * 7.5));
        assert!((at(7.5) - expected).camax() < 1e-14);
    }

    #[test]
    fn outside_the_range_the_policy_holds() {
        let table = flat_plate_table(&[4.0], &[10.0, 5.0, 2.0]);
        let refusing = InterpolatedTable::new(&table, &Dof::TWO, Extrapolation::default()).unwrap();
        let k = ReducedFrequency::from_full_width(1.0);
        assert_eq!(
            refusing.transfer(k).unwrap_err().to_string(),
            "table flat plate: expected a reduced frequency K in the tested range 0.1000 to 0.5000, found K = 1.0000"
        );
        let holding = InterpolatedTable::new(&table, &Dof::TWO, Extrapolation::Hold).unwrap();
        let edge = holding
            .transfer(ReducedFrequency::from_full_width(0.5))
            .unwrap();
        let outside = holding.transfer(k).unwrap();
        assert!((outside - edge * Complex::from(4.0)).camax() < 1e-14);
        let still = holding
            .transfer(ReducedFrequency::from_full_width(0.0))
            .unwrap();
        assert_eq!(still.camax(), 0.0);
    }

    #[test]
    fn points_at_equal_v_hat_are_averaged() {
        let table = flat_plate_table(&[4.0, 8.0], &[6.0, 3.0]);
        let model = InterpolatedTable::new(&table, &Dof::TWO, Extrapolation::Refuse).unwrap();
        let k = ReducedFrequency::from_v_hat(3.0);
        let plate = FlatPlate::default().transfer(k).unwrap();
        assert!((model.transfer(k).unwrap() - plate).camax() < 1e-15);
    }
}
