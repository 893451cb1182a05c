//! Wind speeds of curves and searches: stated in the file, else from the section.

use crate::error::{Error, Result, counted, ensure, positive};
use crate::flutter::{OnsetSearch, curve_speeds_m_s};
use crate::section::{Dof, SectionModel};
use crate::verdict::RequiredSpeed;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// More wind speeds than anybody draws.
const MOST_SPEEDS: usize = 10_000;
/// Highest wind speed that a file may state, m/s: about the speed of sound, beyond which no theory here holds.
const HIGHEST_SPEED_M_S: f64 = 340.0;
/// Factor of the handbook formula for the flat plate, `V = 3.72 f B √(m r/(ρB³) (1 − γ²))`; here without `γ`, which is an
/// upper bound and exists for rotation slower than heave as well.
const SELBERG: f64 = 3.72;
/// Light sections: at least this reduced velocity `V/(fB)`.
const LEAST_REDUCED_VELOCITY: f64 = 10.0;
/// The search reaches this much beyond the flat plate.
const BEYOND_THE_PLATE: f64 = 1.75;
/// Lowest wind speed of the curves as a part of the highest.
const LOWEST_PART: f64 = 1.0 / 12.0;
/// A section without springs has no frequency to go by, m/s.
const WITHOUT_SPRINGS_M_S: f64 = 60.0;

/// Wind speeds of a search at least: with fewer, growth that ends again between two is missed.
pub(super) const SEARCHED_AT_LEAST: usize = 50;

/// Wind speeds of curves and search as a file states them; what is left out follows from the section.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FlutterBlock {
    /// Highest wind speed of curves and search, m/s. Where a speed is required, the search goes at least as far as without this one.
    pub speed_max_m_s: Option<f64>,
    /// Lowest wind speed of the curves, m/s.
    pub speed_min_m_s: Option<f64>,
    /// Number of wind speeds.
    pub speeds: usize,
    /// Nothing critical may begin below this wind speed, m/s: the criterion of a code. The search always reaches it.
    pub required_speed_m_s: Option<f64>,
}

impl Default for FlutterBlock {
    fn default() -> Self {
        Self {
            speed_max_m_s: None,
            speed_min_m_s: None,
            speeds: 120,
            required_speed_m_s: None,
        }
    }
}

/// Wind speeds of curves and search.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SpeedRange {
    /// Lowest wind speed of the curves, m/s.
    pub speed_min_m_s: f64,
    /// Highest wind speed of the curves, m/s.
    pub speed_max_m_s: f64,
    /// Highest wind speed of the search, m/s.
    pub searched_to_m_s: f64,
    /// Number of wind speeds.
    pub speeds: usize,
    /// Whether the highest speed follows from the section and was not stated.
    pub from_section: bool,
}

impl FlutterBlock {
    /// The range for a section.
    pub fn range(&self, section: &SectionModel) -> SpeedRange {
        let usual = usual_highest_m_s(section).max(self.speed_min_m_s.unwrap_or(0.0) * 2.0);
        let usual = rounded_up(usual).min(HIGHEST_SPEED_M_S);
        let required = self.required();
        let speed_max_m_s = reaching(self.speed_max_m_s.unwrap_or(usual), required);
        SpeedRange {
            speed_min_m_s: self.speed_min_m_s.unwrap_or(LOWEST_PART * speed_max_m_s),
            speed_max_m_s,
            // whether something is met does not depend on what is drawn
            searched_to_m_s: required.map_or(speed_max_m_s, |_| speed_max_m_s.max(usual)),
            speeds: self.speeds,
            from_section: self.speed_max_m_s.is_none(),
        }
    }

    /// What is required.
    pub(crate) fn required(&self) -> Option<RequiredSpeed> {
        let speed = self.required_speed_m_s;
        speed.map(|speed_m_s| RequiredSpeed { speed_m_s })
    }

    /// Checks what is stated; `place` is the table it stands in.
    ///
    /// # Errors
    /// [`Error::Input`] for a speed that is none.
    pub fn validate(&self, place: &str) -> Result<()> {
        for (key, speed) in [
            ("speed_max_m_s", self.speed_max_m_s),
            ("speed_min_m_s", self.speed_min_m_s),
            ("required_speed_m_s", self.required_speed_m_s),
        ] {
            let Some(speed) = speed else { continue };
            let key = format!("{place}.{key}");
            if positive(&key, speed)? > HIGHEST_SPEED_M_S {
                let expected = format!("a wind speed of at most {HIGHEST_SPEED_M_S} m/s");
                return Err(Error::input(key, expected, speed.to_string()));
            }
        }
        if let (Some(low), Some(high)) = (self.speed_min_m_s, self.speed_max_m_s) {
            let expected = format_args!("a speed below speed_max_m_s, {high}");
            ensure(low < high, format!("{place}.speed_min_m_s"), expected, low)?;
        }
        let expected = format_args!("a number from 2 to {MOST_SPEEDS}");
        let several = (2..=MOST_SPEEDS).contains(&self.speeds);
        ensure(several, format!("{place}.speeds"), expected, self.speeds)
    }
}

impl SpeedRange {
    /// The search, in which crossings are seen whatever is drawn.
    pub fn search(&self) -> OnsetSearch {
        OnsetSearch::new(self.searched_to_m_s, self.speeds.max(SEARCHED_AT_LEAST))
    }

    /// The range in words.
    pub(crate) fn explain(&self) -> String {
        let why = match self.from_section {
            true => ", from the section's frequencies, width and mass",
            false => "",
        };
        let (low, high) = ((1e3 * self.speed_min_m_s).round() / 1e3, self.speed_max_m_s);
        format!(
            "{low} to {high} m/s in {}{why}",
            counted(self.speeds, "step")
        )
    }

    /// Wind speeds of the curves, m/s.
    pub fn curve_speeds_m_s(&self) -> Vec<f64> {
        curve_speeds_m_s(self.speed_min_m_s, self.speed_max_m_s, self.speeds)
    }
}

/// The highest speed of a search that does not end below the required one, m/s.
pub(super) fn reaching(speed_max_m_s: f64, required: Option<RequiredSpeed>) -> f64 {
    required.map_or(speed_max_m_s, |r| {
        speed_max_m_s.max(rounded_up(r.searched_to_m_s()))
    })
}

/// Well beyond the onset of a flat plate with this structure, m/s.
fn usual_highest_m_s(section: &SectionModel) -> f64 {
    let Ok(structure) = section.structure() else {
        return WITHOUT_SPRINGS_M_S;
    };
    let at = |dof: Dof| structure.dofs.iter().position(|d| *d == dof).unwrap_or(0);
    let (y, theta) = (at(Dof::Vertical), at(Dof::Torsion));
    let hertz = |i: usize| (structure.stiffness[(i, i)] / structure.mass[(i, i)]).sqrt() / TAU;
    let fastest_hz = hertz(y).max(hertz(theta));
    if !(fastest_hz.is_finite() && fastest_hz > 0.0) {
        return WITHOUT_SPRINGS_M_S;
    }
    let (mass, inertia) = (structure.mass[(y, y)], structure.mass[(theta, theta)]);
    let width = structure.width_m;
    let heaviness = (mass * inertia).sqrt() / (structure.air_density_kg_m3 * width.powi(3));
    let reduced = (SELBERG * heaviness.sqrt()).max(LEAST_REDUCED_VELOCITY);
    BEYOND_THE_PLATE * reduced * fastest_hz * width
}

/// The next number with two digits.
fn rounded_up(value: f64) -> f64 {
    let unit = 10f64.powf(value.log10().floor() - 1.0);
    // what is a number of two digits but for rounding stays one
    (value / unit - 1e-9).ceil() * unit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_range_follows_the_section() {
        let range = |section: &SectionModel| FlutterBlock::default().range(section).speed_max_m_s;
        // onsets of the flat plate: about 38 and 77 m/s
        assert_eq!(range(&SectionModel::table_4_1()), 74.0);
        assert_eq!(range(&SectionModel::iabse_1_1a()), 160.0);
        let mut slow = SectionModel::table_4_1();
        slow.vertical.frequency_hz = Some(0.2);
        slow.torsion.frequency_hz = Some(0.5);
        assert_eq!(range(&slow), 7.4);
    }

    #[test]
    fn what_is_stated_stands() {
        let block = FlutterBlock {
            speed_max_m_s: Some(60.0),
            ..FlutterBlock::default()
        };
        let range = block.range(&SectionModel::table_4_1());
        assert_eq!((range.speed_min_m_s, range.speed_max_m_s), (5.0, 60.0));
        assert!(!range.from_section);
        assert_eq!(range.curve_speeds_m_s().len(), 120);
        assert_eq!(range.curve_speeds_m_s().last(), Some(&60.0));
    }

    #[test]
    fn the_search_reaches_what_is_required() {
        let section = SectionModel::table_4_1();
        let highest = |speed_max_m_s, required| {
            let block = FlutterBlock {
                speed_max_m_s,
                required_speed_m_s: Some(required),
                ..FlutterBlock::default()
            };
            block.range(&section).speed_max_m_s
        };
        assert_eq!(highest(Some(54.0), 62.0), 130.0);
        assert_eq!(highest(None, 30.0), 74.0);
        assert_eq!(highest(None, 200.0), 400.0);
    }

    #[test]
    fn absurd_ranges_are_refused_by_key() {
        let speeds = FlutterBlock {
            speeds: 10_000_000,
            ..FlutterBlock::default()
        };
        let message = speeds.validate("flutter").unwrap_err().to_string();
        assert_eq!(
            message,
            "flutter.speeds: expected a number from 2 to 10000, found 10000000"
        );
        let fast = FlutterBlock {
            speed_max_m_s: Some(5e5),
            ..FlutterBlock::default()
        };
        let message = fast.validate("flutter").unwrap_err().to_string();
        assert!(message.contains("at most 340 m/s"), "{message}");
    }
}
