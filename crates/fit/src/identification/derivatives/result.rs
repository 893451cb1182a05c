//! Identified derivatives with their standard errors, and the table made of them.

use crate::aerodynamics::derivatives::{Derivative, DerivativePoint, DerivativeTable, TableHeader};
use crate::error::{Result, ensure};
use crate::section::Dof;
use crate::units::{SAME_SPEED, group_of, near_groups};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How test points are taken from records.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DerivativeOptions {
    /// A period is steady when its amplitude is at least this part of the typical one; default 0.99.
    pub full_amplitude: f64,
    /// Speeds within this ratio are one test point, default 1.05 as in the tables.
    pub same_speed: f64,
    /// Frequencies within this ratio are one test point, default 1.03.
    pub same_frequency: f64,
}

impl Default for DerivativeOptions {
    fn default() -> Self {
        Self {
            full_amplitude: 0.99,
            same_speed: SAME_SPEED,
            same_frequency: 1.03,
        }
    }
}

impl DerivativeOptions {
    pub(super) fn validate(&self) -> Result<()> {
        let share = self.full_amplitude;
        let inside = share > 0.0 && share < 1.0;
        ensure(inside, "full_amplitude", "between 0 and 1", share)?;
        for (key, ratio) in [
            ("same_speed", self.same_speed),
            ("same_frequency", self.same_frequency),
        ] {
            ensure(ratio.is_finite() && ratio >= 1.0, key, "at least 1", ratio)?;
        }
        Ok(())
    }
}

/// One derivative at one test point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DerivativeEstimate {
    /// Which one.
    pub derivative: Derivative,
    /// Run that drove its motion.
    pub run: String,
    /// Mean wind speed, m/s.
    pub mean_speed_m_s: f64,
    /// Frequency of the motion, Hz.
    pub frequency_hz: f64,
    /// `V̂ = V/(ωB)`.
    pub v_hat: f64,
    /// The derivative.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Whole periods that were fitted.
    pub periods: usize,
    /// RMS of the residual of the force over that of the force, both without constant and trend.
    pub residual: f64,
}

impl DerivativeEstimate {
    /// Whether another run tested the same point once more, as near as it is set.
    fn is_tested_again(&self, other: &Self) -> bool {
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < SAME_SETTING;
        self.derivative == other.derivative
            && self.run != other.run
            && near(self.v_hat, other.v_hat)
            && near(self.mean_speed_m_s, other.mean_speed_m_s)
    }

    fn is_of_one_point(&self, other: &Self) -> bool {
        self.derivative == other.derivative
            && self.v_hat == other.v_hat
            && self.mean_speed_m_s == other.mean_speed_m_s
    }

    /// Its difference from another run over what runs may differ by, where the greatest magnitude of the derivative is `largest`.
    fn apart(&self, other: &Self, largest: f64) -> f64 {
        let error = self.standard_error.hypot(other.standard_error);
        let allowed = (RUNS_DIFFER * largest).max(4.0 * error);
        // forces per motion, for a derivative goes with the square of the reduced velocity
        let other_value = other.value * (self.v_hat / other.v_hat).powi(2);
        (self.value - other_value).abs() / allowed
    }

    fn contradiction(&self, other: &Self) -> String {
        let (a, b) = (self, other);
        format!(
            "runs {} and {} are of one test point and contradict each other: {} at {:.3} Hz is {:.4} ± {:.4} and {:.4} ± {:.4}; the table has \
             both, as they are or as their mean",
            a.run,
            b.run,
            a.derivative.name(),
            a.frequency_hz,
            a.value,
            a.standard_error,
            b.value,
            b.standard_error
        )
    }
}

/// Reduced velocities and mean speeds of one test point differ by less than this part.
const SAME_SETTING: f64 = 0.01;

/// What two runs of one test point may differ by, of the greatest magnitude of a derivative.
const RUNS_DIFFER: f64 = 0.03;

/// Derivatives of a deck from its records.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct IdentifiedDerivatives {
    /// Width of the section model, m.
    pub width_m: f64,
    /// Degrees of freedom of the forces.
    pub dofs: Vec<Dof>,
    /// Largest amplitude of rotation, deg; `None` where nothing rotates.
    pub rotation_amplitude_deg: Option<f64>,
    /// By derivative and group of speeds, rising; in a group by frequency, rising (V̂ falls).
    pub estimates: Vec<DerivativeEstimate>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

impl IdentifiedDerivatives {
    /// The estimates of one derivative, by speed group and frequency.
    pub fn each(&self, derivative: Derivative) -> impl Iterator<Item = &DerivativeEstimate> {
        let estimates = self.estimates.iter();
        estimates.filter(move |e| e.derivative == derivative)
    }

    /// Mean speeds of all estimates, m/s, rising and in groups of test points.
    pub fn speed_groups(&self) -> Vec<Vec<f64>> {
        near_groups(self.estimates.iter().map(|e| e.mean_speed_m_s), SAME_SPEED)
    }

    /// The table, without standard errors; the header says how it was made.
    ///
    /// # Errors
    /// [`Error::Input`](crate::error::Error::Input) when the runs did not drive both heave and rotation.
    pub fn table(&self, name: &str, header: TableHeader) -> Result<DerivativeTable> {
        let header = TableHeader {
            rotation_amplitude_deg: self.rotation_amplitude_deg,
            ..header
        };
        DerivativeTable::new(name, self.width_m, header, self.points())
    }

    /// The points of every derivative that was identified, in the order of a table; the mean of those at equal `V̂`, as of a test
    /// that was run again at the speed it states.
    pub fn points(&self) -> BTreeMap<Derivative, Vec<DerivativePoint>> {
        let mut points = BTreeMap::<Derivative, Vec<DerivativePoint>>::new();
        for same in self.estimates.chunk_by(DerivativeEstimate::is_of_one_point) {
            let value = same.iter().map(|e| e.value).sum::<f64>() / same.len() as f64;
            let of_derivative = points.entry(same[0].derivative).or_default();
            of_derivative.push(DerivativePoint {
                mean_speed_m_s: Some(same[0].mean_speed_m_s),
                v_hat: same[0].v_hat,
                value,
            });
        }
        points
    }

    /// Runs of one test point that contradict each other, of each pair what differs most: their mean is no better than the worse of them.
    pub fn contradictions(&self) -> Vec<String> {
        let mut worst = BTreeMap::<[&str; 2], (f64, [&DerivativeEstimate; 2])>::new();
        for (i, a) in self.estimates.iter().enumerate() {
            let magnitudes = self.each(a.derivative).map(|e| e.value.abs());
            let largest = magnitudes.fold(0.0, f64::max);
            let later = self.estimates[i + 1..].iter();
            for b in later.filter(|b| a.is_tested_again(b)) {
                let found = (a.apart(b, largest), [a, b]);
                let pair = worst.entry([&a.run, &b.run]).or_insert(found);
                if found.0 > pair.0 {
                    *pair = found;
                }
            }
        }
        let worst = worst.into_values().filter(|(apart, _)| *apart > 1.0);
        worst.map(|(_, [a, b])| a.contradiction(b)).collect()
    }

    pub(super) fn sort(&mut self) {
        let groups = self.speed_groups();
        let group = |e: &DerivativeEstimate| group_of(&groups, e.mean_speed_m_s);
        // within a group V̂ falls steadily, as a table wants it, also when its speeds are not quite one
        self.estimates.sort_by(|a, b| {
            let [own, other] = [a, b].map(|e| (e.derivative, group(e)));
            own.cmp(&other).then(b.v_hat.total_cmp(&a.v_hat))
        });
    }
}
