//! A derivative table as a model: `G` between the points of each derivative.

use super::interpolation::{Curve, Interpolation};
use super::{Derivative, DerivativePoint, DerivativeTable, Part};
use crate::aerodynamics::{Transfer, TransferMatrix};
use crate::error::{Error, Result, ensure};
use crate::section::Dof;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use nalgebra::{Complex, DMatrix};
use serde::{Deserialize, Serialize};

/// What an interpolated table says outside the tested range.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::derivatives::Extrapolation;
///
/// assert_eq!(Extrapolation::default(), Extrapolation::Refuse);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Extrapolation {
    /// Nothing: an error.
    #[default]
    Refuse,
    /// What is interpolated keeps its value at the nearest point: to move a section or to follow a mode through, not to
    /// answer from (see [`Transfer::known_range`]).
    Hold,
}

/// A measured table between its points. Each derivative is interpolated at its own points; `G` follows from (1.17).
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::Transfer;
/// use aerodeck::aerodynamics::derivatives::{
///     Derivative, DerivativePoint, DerivativeTable, Extrapolation, InterpolatedTable, TableHeader,
/// };
/// use aerodeck::section::Dof;
/// use aerodeck::units::ReducedFrequency;
///
/// let point = |v_hat, value| DerivativePoint { mean_speed_m_s: None, v_hat, value };
/// let eight = Derivative::ALL.into_iter().filter(|d| !d.to_string().contains(['P', '5', '6']));
/// let points = eight.map(|d| (d, vec![point(2.0, -0.5), point(4.0, -1.2)])).collect();
/// let table = DerivativeTable::new("a deck", 0.5, TableHeader::default(), points)?;
/// let between = InterpolatedTable::new(&table, &Dof::TWO, Extrapolation::Refuse)?;
/// // G = K² (H4* + i H1*) at a tested point, where K = 1/V̂
/// let lift_by_heave = between.transfer(ReducedFrequency::from_v_hat(2.0))?[(0, 0)];
/// assert!((lift_by_heave.im + 0.5 / 4.0).abs() < 1e-12);
/// assert!(between.transfer(ReducedFrequency::from_v_hat(9.0)).is_err());
/// # Ok::<(), aerodeck::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InterpolatedTable {
    name: String,
    dofs: Vec<Dof>,
    extrapolation: Extrapolation,
    tested_range: ReducedFrequencyRange,
    /// Real and imaginary part of each entry, row by row.
    entries: Vec<(Curve, Curve)>,
}

impl InterpolatedTable {
    /// The table among `dofs`, interpolated as by default.
    pub fn new(
        table: &DerivativeTable,
        dofs: &[Dof],
        extrapolation: Extrapolation,
    ) -> Result<Self> {
        Self::by(Interpolation::default(), table, dofs, extrapolation)
    }

    /// The table among `dofs`. Points of one derivative at the same `V̂` (at two speeds), and for all but the polygon over
    /// `V̂` those of different speed groups within 10 % in `K`, count with their mean.
    ///
    /// # Errors
    /// [`Error::Input`] when the table lacks a derivative of `dofs`.
    pub fn by(
        interpolation: Interpolation,
        table: &DerivativeTable,
        dofs: &[Dof],
        extrapolation: Extrapolation,
    ) -> Result<Self> {
        table.require(dofs)?;
        let groups = table.speed_groups_end();
        let curve = |force, motion, part| {
            let points = table.points(Derivative::from_entry(force, motion, part));
            let with_group = |p: &DerivativePoint| {
                let speed = p.mean_speed_m_s.unwrap_or(0.0);
                (*p, groups.partition_point(|end| *end < speed))
            };
            let points: Vec<_> = points.iter().map(with_group).collect();
            Curve::new(interpolation, part, &points)
        };
        let forces = dofs.iter();
        let pairs = forces.flat_map(|force| dofs.iter().map(move |motion| (*force, *motion)));
        let entry = |(f, m)| (curve(f, m, Part::Real), curve(f, m, Part::Imaginary));
        Ok(Self {
            name: table.name.clone(),
            dofs: dofs.to_vec(),
            extrapolation,
            tested_range: table.tested_range(dofs),
            entries: pairs.map(entry).collect(),
        })
    }

    /// Checks what was read from a file: a curve for every part of `G`, each with as many values and slopes as points.
    ///
    /// # Errors
    /// [`Error::Input`] for any other.
    pub fn validate(&self) -> Result<()> {
        let (n, curves) = (self.dofs.len(), &self.entries);
        let whole = curves.iter().all(|(a, b)| a.is_whole() && b.is_whole());
        let expected = format_args!("{n}×{n} pairs of curves, each with as many values as points");
        let place = format_args!("table {}", self.name);
        ensure(whole && curves.len() == n * n, place, expected, "others")
    }

    /// The range of `K` in which every derivative was tested; outside it the policy of extrapolation holds.
    pub fn tested_range(&self) -> ReducedFrequencyRange {
        self.tested_range
    }
}

impl Transfer for InterpolatedTable {
    fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        let k_full = k.full_width();
        let allowed = match self.extrapolation {
            Extrapolation::Refuse => self.tested_range.spans(k),
            Extrapolation::Hold => k_full.is_finite() && k_full >= 0.0,
        };
        if !allowed {
            let tested = [self.tested_range.min, self.tested_range.max];
            let [min, max] = tested.map(ReducedFrequency::full_width);
            return Err(Error::input(
                format!("table {}", self.name),
                format!("a reduced frequency K in the tested range {min:.4} to {max:.4}"),
                format!("K = {k_full:.4}"),
            ));
        }
        let n = self.dofs.len();
        let entry = |i: usize, j: usize| {
            let (re, im) = &self.entries[i * n + j];
            Complex::new(re.at(k), im.at(k))
        };
        Ok(DMatrix::from_fn(n, n, entry))
    }

    fn known_range(&self) -> Option<ReducedFrequencyRange> {
        Some(self.tested_range)
    }
}

#[cfg(test)]
mod tests {
    use super::super::table::tests::flat_plate_table;
    use super::*;
    use crate::aerodynamics::FlatPlate;

    fn plate(v_hat: f64) -> TransferMatrix {
        let k = ReducedFrequency::from_v_hat(v_hat);
        FlatPlate::default().transfer(k).unwrap()
    }

    #[test]
    fn every_way_is_exact_at_the_points() {
        let v_hats = [10.0, 7.0, 5.0, 3.0, 2.0];
        let table = flat_plate_table(&[4.0], &v_hats);
        for by in Interpolation::ALL {
            let model =
                InterpolatedTable::by(by, &table, &Dof::TWO, Extrapolation::Refuse).unwrap();
            for v in v_hats {
                let found = model.transfer(ReducedFrequency::from_v_hat(v)).unwrap();
                assert!((found - plate(v)).camax() < 1e-13, "{by} at {v}");
            }
        }
    }

    #[test]
    fn linear_in_v_hat_between_the_points_when_asked() {
        let table = flat_plate_table(&[4.0], &[10.0, 5.0, 2.0]);
        let by = Interpolation::LinearVHat;
        let model = InterpolatedTable::by(by, &table, &Dof::TWO, Extrapolation::Refuse).unwrap();
        let at = |v| model.transfer(ReducedFrequency::from_v_hat(v)).unwrap();
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
        let edge = |m: &InterpolatedTable| {
            let k = ReducedFrequency::from_full_width(0.5);
            m.transfer(k).unwrap()
        };
        let by = Interpolation::LinearVHat;
        let holding = InterpolatedTable::by(by, &table, &Dof::TWO, Extrapolation::Hold).unwrap();
        let outside = holding.transfer(k).unwrap();
        assert!((outside - edge(&holding) * Complex::from(4.0)).camax() < 1e-14);
        let still = ReducedFrequency::from_full_width(0.0);
        assert_eq!(holding.transfer(still).unwrap().camax(), 0.0);
        // stiffness and damping instead of derivatives: G is affine in iK beyond the points
        let holding = InterpolatedTable::new(&table, &Dof::TWO, Extrapolation::Hold).unwrap();
        let expected = edge(&holding).map(|z| Complex::new(z.re, 2.0 * z.im));
        assert!((holding.transfer(k).unwrap() - expected).camax() < 1e-14);
        assert_eq!(holding.known_range(), Some(holding.tested_range()));
    }

    #[test]
    fn points_at_equal_v_hat_are_averaged() {
        let table = flat_plate_table(&[4.0, 8.0], &[6.0, 3.0]);
        for by in Interpolation::ALL {
            let model =
                InterpolatedTable::by(by, &table, &Dof::TWO, Extrapolation::Refuse).unwrap();
            let k = ReducedFrequency::from_v_hat(3.0);
            assert!((model.transfer(k).unwrap() - plate(3.0)).camax() < 1e-15);
        }
    }
}
