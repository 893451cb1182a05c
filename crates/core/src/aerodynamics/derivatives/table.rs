//! A table of measured derivatives, each with its own reduced velocities.

mod points;

pub use points::{DerivativePoint, check_point_count, check_points};

use super::{Derivative, Part, TransferSample};
use crate::aerodynamics::Transfer;
use crate::error::{Error, Result, positive, without_control_characters};
use crate::section::Dof;
use crate::units::{ReducedFrequency, ReducedFrequencyRange, SAME_SPEED, near_groups};
use points::{check_complete, check_speeds_agree};
use std::collections::BTreeMap;

/// Where a table comes from.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TableHeader {
    /// Where the figures come from.
    pub source: String,
    /// Licence notice of the figures.
    pub licence: String,
    /// What wrote the table.
    pub generator: String,
    /// Length of the section model, m, if known.
    pub model_length_m: Option<f64>,
    /// Mean angle of the section in the tests, deg, nose-up positive; `None` where it is not stated.
    pub angle_deg: Option<f64>,
    /// Largest amplitude of rotation in the tests, deg; `None` where it is not stated.
    pub rotation_amplitude_deg: Option<f64>,
    /// What was assumed in reading the table.
    pub notes: Vec<String>,
    /// What the measurements contradict of what was stated of them: nothing may rest on the table before it is cleared.
    pub doubts: Vec<String>,
}

/// Measured derivatives of one deck.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::derivatives::{Derivative, DerivativePoint, DerivativeTable, TableHeader};
///
/// let point = |v_hat, value| DerivativePoint { mean_speed_m_s: None, v_hat, value };
/// let of_heave_and_rotation = |d: &Derivative| !d.to_string().contains(['P', '5', '6']);
/// let eight = Derivative::ALL.into_iter().filter(of_heave_and_rotation);
/// let points = eight.map(|d| (d, vec![point(2.0, -0.5), point(4.0, -1.2)])).collect();
/// let table = DerivativeTable::new("a deck", 0.5, TableHeader::default(), points)?;
/// let first = table.points(Derivative::H1)[0];
/// assert!(first.v_hat > 0.0 && first.value < 0.0); // heave is damped
/// # Ok::<(), aerodeck::Error>(())
/// ```
///
/// There are 18 (or the eight of heave and rotation), each at its own points in test order.
#[derive(Debug, Clone, PartialEq)]
pub struct DerivativeTable {
    /// Name of the deck.
    pub name: String,
    /// Width `B` of the section model, m.
    pub width_m: f64,
    /// Where the table comes from.
    pub header: TableHeader,
    points: BTreeMap<Derivative, Vec<DerivativePoint>>,
}

impl DerivativeTable {
    /// A table after checking it: positive width; the eight derivatives of heave and rotation present, others in pairs; `V̂` positive
    /// and strictly monotone in each speed group of each derivative; finite values; mean speeds everywhere or nowhere.
    ///
    /// # Errors
    /// [`Error::Input`] naming the derivative and the point.
    pub fn new(
        name: impl Into<String>,
        width_m: f64,
        header: TableHeader,
        points: BTreeMap<Derivative, Vec<DerivativePoint>>,
    ) -> Result<Self> {
        let name = name.into();
        without_control_characters("name", &name)?;
        positive("width_m", width_m)?;
        check_complete(&points)?;
        for (derivative, of_one) in &points {
            check_point_count(derivative.name(), of_one.len())?;
            check_points(of_one, |i| format!("{derivative}, point {}", i + 1))?;
        }
        check_speeds_agree(&points)?;
        Ok(Self {
            name,
            width_m,
            header,
            points,
        })
    }

    /// The derivatives of a model at every pair of speed and frequency, as a test of a deck of `width_m` would find them.
    pub fn sampled(
        name: impl Into<String>,
        model: &dyn Transfer,
        width_m: f64,
        speeds_m_s: &[f64],
        frequencies_hz: &[f64],
    ) -> Result<Self> {
        let dofs = model.dofs();
        let mut points = BTreeMap::<_, Vec<_>>::new();
        let tests = speeds_m_s.iter();
        let tests = tests.flat_map(|v| frequencies_hz.iter().map(move |f| (*v, *f)));
        for (speed, frequency) in tests {
            let k = ReducedFrequency::from_hertz(frequency, width_m, speed);
            let g = model.transfer(k)?;
            for (place, z) in g.iter().enumerate() {
                let (i, j) = (place % dofs.len(), place / dofs.len());
                for (part, value) in [(Part::Real, z.re), (Part::Imaginary, z.im)] {
                    let of_one = points.entry(Derivative::from_entry(dofs[i], dofs[j], part));
                    of_one.or_default().push(DerivativePoint {
                        mean_speed_m_s: Some(speed),
                        v_hat: k.v_hat(),
                        value: value * k.v_hat() * k.v_hat(),
                    });
                }
            }
        }
        Self::new(name, width_m, TableHeader::default(), points)
    }

    /// The derivatives in the table, in the order of [`Derivative::ALL`].
    pub fn derivatives(&self) -> impl Iterator<Item = Derivative> + '_ {
        self.points.keys().copied()
    }

    /// Points of one derivative in test order; empty when the table does not hold it.
    pub fn points(&self, derivative: Derivative) -> &[DerivativePoint] {
        self.points.get(&derivative).map_or(&[], Vec::as_slice)
    }

    /// The degrees of freedom that the table covers completely.
    pub fn dofs(&self) -> &'static [Dof] {
        if self.points.len() == Derivative::ALL.len() {
            &Dof::THREE
        } else {
            &Dof::TWO
        }
    }

    /// Checks that the table holds every derivative that couples `dofs`.
    ///
    /// # Errors
    /// [`Error::Input`] listing those that are missing.
    pub fn require(&self, dofs: &[Dof]) -> Result<()> {
        let missing = coupling(dofs).filter(|d| !self.points.contains_key(d));
        let missing: Vec<&str> = missing.map(Derivative::name).collect();
        if missing.is_empty() {
            return Ok(());
        }
        Err(Error::input(
            format!("table {}", self.name),
            format!("the derivatives of {} motion", Dof::names(dofs)),
            format!("none of {}", missing.join(", ")),
        ))
    }

    /// All numbers that the table says about `G` among `dofs`: `K²` times each derivative at its own `K`.
    /// Entries that the table does not hold (see `DerivativeTable::require`) are left out.
    pub fn samples(&self, dofs: &[Dof]) -> Vec<TransferSample> {
        coupling(dofs)
            .flat_map(|d| self.points(d).iter().map(move |point| sample(d, point)))
            .collect()
    }

    /// The range of `K` in which every derivative among `dofs` was tested, with the gaps of any of them.
    pub fn tested_range(&self, dofs: &[Dof]) -> ReducedFrequencyRange {
        let ranges = |d: Derivative| {
            ReducedFrequencyRange::spanning(self.points(d).iter().map(DerivativePoint::k))
        };
        let ranges = coupling(dofs).filter_map(ranges);
        ranges
            .reduce(ReducedFrequencyRange::intersection)
            // Nothing asked for was tested: an empty range, which contains no K.
            .unwrap_or(ReducedFrequencyRange::between(
                ReducedFrequency::from_full_width(f64::INFINITY),
                ReducedFrequency::from_full_width(f64::NEG_INFINITY),
            ))
    }

    /// Mean wind speed of each group of test points, m/s, rising; empty when the source does not give speeds.
    /// Speeds less than 5 % apart belong to one group.
    pub fn speed_groups(&self) -> Vec<f64> {
        let mean = |group: &Vec<f64>| group.iter().sum::<f64>() / group.len() as f64;
        self.grouped_speeds().iter().map(mean).collect()
    }

    /// Highest speed of each group, m/s, rising.
    pub(super) fn speed_groups_end(&self) -> Vec<f64> {
        let highest = |group: &Vec<f64>| group[group.len() - 1];
        self.grouped_speeds().iter().map(highest).collect()
    }

    /// The part of the table that was measured at the `i`-th of [`DerivativeTable::speed_groups`].
    ///
    /// # Errors
    /// [`Error::Input`] when there is no such group, or a derivative was not measured in it. A table without speeds is one
    /// group.
    pub fn at_speed_group(&self, i: usize) -> Result<Self> {
        self.at_speed_groups(&[i])
    }

    /// The part of the table that was measured at any of these groups, numbered as by [`DerivativeTable::at_speed_group`].
    ///
    /// # Errors
    /// As there.
    pub fn at_speed_groups(&self, chosen: &[usize]) -> Result<Self> {
        let groups = self.grouped_speeds();
        if groups.is_empty() && chosen == [0] {
            return Ok(self.clone());
        }
        let mut ranges = Vec::with_capacity(chosen.len());
        for i in chosen {
            let group = groups.get(*i).ok_or_else(|| {
                Error::input(
                    format!("table {}", self.name),
                    format!("a speed group below {}", groups.len()),
                    i.to_string(),
                )
            })?;
            ranges.push(group[0]..=group[group.len() - 1]);
        }
        let of_speed = |v: f64| ranges.iter().any(|range| range.contains(&v));
        let inside = |p: &&DerivativePoint| p.mean_speed_m_s.is_some_and(of_speed);
        let of_one = |(d, all): (&Derivative, &Vec<DerivativePoint>)| {
            (*d, all.iter().filter(inside).copied().collect())
        };
        let points = self.points.iter().map(of_one).collect();
        Self::new(self.name.clone(), self.width_m, self.header.clone(), points)
    }

    /// Mean speeds of all points, sorted and split into groups, none of them empty.
    fn grouped_speeds(&self) -> Vec<Vec<f64>> {
        let all = self.points.values().flatten();
        near_groups(all.filter_map(|p| p.mean_speed_m_s), SAME_SPEED)
    }
}

/// Derivatives whose force and motion are both among `dofs`.
fn coupling(dofs: &[Dof]) -> impl Iterator<Item = Derivative> {
    Derivative::ALL
        .into_iter()
        .filter(move |d| dofs.contains(&d.force()) && dofs.contains(&d.motion()))
}

fn sample(derivative: Derivative, point: &DerivativePoint) -> TransferSample {
    TransferSample {
        force: derivative.force(),
        motion: derivative.motion(),
        part: derivative.part(),
        k: point.k(),
        value: point.value / (point.v_hat * point.v_hat),
        mean_speed_m_s: point.mean_speed_m_s,
    }
}

#[cfg(test)]
pub(crate) mod tests;
