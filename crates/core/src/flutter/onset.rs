//! The flutter onset as a result: everything a practitioner wants on the card.

use super::critical_point::CriticalPoint;
use crate::section::Structure;
use crate::units::ReducedFrequencyGap;
use nalgebra::{Complex, DVector};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Half of an interval over the speed above which a headline says how wide it is: its first number alone would mislead.
const WIDE: f64 = 0.1;

/// A flutter onset.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::RationalModel;
/// use aerodeck::aeroelastic::CoupledSection;
/// use aerodeck::flutter::{OnsetSearch, find_onset};
/// use aerodeck::section::SectionModel;
///
/// let structure = SectionModel::iabse_1_1a().structure()?;
/// let section = CoupledSection::with_model(&structure, &RationalModel::jones_flat_plate())?;
/// let found = find_onset("plate", &section, &OnsetSearch::default(), None)?;
/// let onset = found.onset().expect("flutter below 100 m/s");
/// assert_eq!(onset.branch, "torsion");
/// let (at, width_m) = (&onset.at, structure.width_m);
/// assert!((at.speed_m_s / (at.frequency_hz * width_m) / at.reduced_velocity.v_star() - 1.0).abs() < 1e-12);
/// # Ok::<(), aerodeck::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Onset {
    /// Onset speed `V_F` and the frequency there.
    #[serde(flatten)]
    pub at: CriticalPoint,
    /// Heave over rotation; `None` without rotation, as of a deck that gallops in heave alone.
    #[serde(flatten)]
    pub mode: Option<ModeRatio>,
    /// `dζ/dV` at onset, s/m; `None` where the route does not give it.
    pub damping_slope_s_m: Option<f64>,
    /// Branch that loses its damping.
    pub branch: String,
    /// Whether `K` lies in the range in which the model was tested; `None` when there is no such range.
    pub in_tested_range: Option<bool>,
    /// The gap between tests in which `K` lies, where that is why it is not inside.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gap: Option<ReducedFrequencyGap>,
    /// Further crossings below this one that lie outside the tested range, m/s: signs of an over-fitted model.
    pub spurious_speeds_m_s: Vec<f64>,
    /// What a reader must know before using the number.
    pub warnings: Vec<String>,
    /// How far the data leave the speed open.
    pub interval: OnsetInterval,
}

/// Heave over rotation of one motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ModeRatio {
    /// `|y|/(B|θ|)`.
    pub mode_ratio: f64,
    /// Phase of `y` relative to `θ`, degrees in (−180, 180].
    pub phase_deg: f64,
}

impl ModeRatio {
    /// That of `y` and `Bθ`, m; none where the one is not finite in parts of the other.
    pub fn new(y: Complex<f64>, b_theta: Complex<f64>) -> Option<Self> {
        let ratio = y / b_theta;
        ratio.norm().is_finite().then(|| Self {
            mode_ratio: ratio.norm(),
            phase_deg: ratio.arg().to_degrees(),
        })
    }
}

impl fmt::Display for ModeRatio {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (ratio, phase) = (self.mode_ratio, self.phase_deg);
        write!(f, "|y|/(B|θ|) {ratio:.4}, phase of y to θ {phase:.1}°")
    }
}

/// Where the variance between mean speeds is from that an interval holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BetweenSpeeds {
    /// Tests at two mean speeds or more, and measured decks.
    Tests,
    /// Measured decks alone: the tests are at one mean speed, or do not state it.
    Prior,
}

/// What the standard error of an onset is made of.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ErrorParts {
    /// Scatter of the data under the form of the model, m/s.
    pub scatter_m_s: f64,
    /// Spread between the forms that explain the data as well, m/s; none where no other form was asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub form_m_s: Option<f64>,
    /// Where the scatter between mean speeds in it is from; none where it holds none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub between_speeds: Option<BetweenSpeeds>,
}

impl ErrorParts {
    /// Both together, m/s.
    pub fn standard_error_m_s(&self) -> f64 {
        self.scatter_m_s.hypot(self.form_m_s.unwrap_or(0.0))
    }

    /// As it is printed beside an interval: `scatter 0.26, form 0.31 m/s`; the scatter alone where no other form was asked.
    pub fn explain(&self) -> String {
        match self.form_m_s {
            Some(form) => format!("scatter {:.2}, form {form:.2} m/s", self.scatter_m_s),
            None => format!("scatter {:.2} m/s", self.scatter_m_s),
        }
    }
}

/// 95 % interval of an onset speed by a standard error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ErrorInterval {
    /// Lower end, m/s.
    pub low_m_s: f64,
    /// Upper end, m/s.
    pub high_m_s: f64,
    /// Standard error, m/s.
    pub standard_error_m_s: f64,
    /// Degrees of freedom of the standard error.
    pub degrees_of_freedom: f64,
    /// What it is made of.
    #[serde(default)]
    pub parts: ErrorParts,
}

/// 95 % interval of an onset speed, or why there is none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum OnsetInterval {
    /// The scatter of the data, carried to the onset, and what the form of the model leaves open.
    Known(ErrorInterval),
    /// The speeds that several ways of reading the same data give, e.g. of interpolating a table: no statement of
    /// probability.
    Spread {
        /// Lowest, m/s.
        low_m_s: f64,
        /// Highest, m/s.
        high_m_s: f64,
        /// Spread between what, and the speed by each way.
        of: String,
    },
    /// The data leave the speed so far open that it is no result: the interval contains zero or is wider than the speed.
    Undetermined {
        /// The interval.
        #[serde(flatten)]
        error: ErrorInterval,
        /// Which of the two, in words.
        reason: String,
    },
    /// There is none.
    None {
        /// Why.
        reason: String,
    },
}

impl OnsetInterval {
    /// The interval of `half_width_m_s` to both sides of a speed.
    pub fn about(
        speed_m_s: f64,
        half_width_m_s: f64,
        degrees_of_freedom: f64,
        parts: ErrorParts,
    ) -> Self {
        let (low_m_s, high_m_s) = (speed_m_s - half_width_m_s, speed_m_s + half_width_m_s);
        let known = Self::Known(ErrorInterval {
            low_m_s,
            high_m_s,
            standard_error_m_s: parts.standard_error_m_s(),
            degrees_of_freedom,
            parts,
        });
        // an error that is not a number is neither, and leaves the speed undetermined
        let above_zero = low_m_s > 0.0;
        let narrow = 2.0 * half_width_m_s <= speed_m_s;
        let why = match (above_zero, narrow) {
            (true, true) => return known,
            (false, _) => "contains zero",
            (true, false) => "is wider than the speed itself",
        };
        let ends = format!("{low_m_s:.3} to {high_m_s:.3} m/s");
        known.undetermined(format!("its 95 % interval, {ends}, {why}"))
    }

    /// Lower and upper end, m/s, of the interval or the spread of a speed that is a result.
    pub fn ends(&self) -> Option<(f64, f64)> {
        match *self {
            Self::Known(error) => Some((error.low_m_s, error.high_m_s)),
            Self::Spread {
                low_m_s, high_m_s, ..
            } => Some((low_m_s, high_m_s)),
            Self::Undetermined { .. } | Self::None { .. } => None,
        }
    }

    /// The same where something besides its width leaves the speed open.
    #[must_use]
    pub fn undetermined(self, why: String) -> Self {
        match self {
            Self::Known(error) => Self::Undetermined {
                error,
                reason: format!("not determined by these data: {why}"),
            },
            other => other,
        }
    }

    /// The interval by a standard error, also one that leaves the speed open.
    pub fn by_error(&self) -> Option<&ErrorInterval> {
        match self {
            Self::Known(error) | Self::Undetermined { error, .. } => Some(error),
            Self::Spread { .. } | Self::None { .. } => None,
        }
    }

    /// Why there are none.
    pub fn reason(&self) -> Option<&str> {
        match self {
            Self::Undetermined { reason, .. } | Self::None { reason } => Some(reason),
            Self::Known(_) | Self::Spread { .. } => None,
        }
    }

    /// No interval, for this reason.
    pub fn none(reason: impl Into<String>) -> Self {
        Self::None {
            reason: reason.into(),
        }
    }
}

impl Onset {
    /// The speed, unless the data do not determine it: what may be printed as a result, m/s.
    pub fn headline_m_s(&self) -> std::result::Result<f64, &str> {
        if let OnsetInterval::Undetermined { reason, .. } = &self.interval {
            return Err(reason);
        }
        Ok(self.at.speed_m_s)
    }

    /// The answer in one line: speed, interval, and whether the data reach it, such as
    /// `flutter onset 36.9 m/s, 36.6–37.3, inside the tested range`; of a wide interval how wide it is, `26.0 m/s ± 41 %, 15.2–36.8`.
    pub fn headline(&self) -> String {
        if let Err(reason) = self.headline_m_s() {
            return format!("flutter onset {reason}");
        }
        let spread = matches!(self.interval, OnsetInterval::Spread { .. });
        let ends = self.interval.ends();
        let interval = match ends.map(|(low, high)| [low, high].map(shown_m_s)) {
            Some([low, high]) if spread => format!(" [{low}–{high}]"),
            Some([low, high]) => format!(", {low}–{high}"),
            None => ", interval not known".to_owned(),
        };
        let tested = match (self.gap, self.in_tested_range) {
            (Some(gap), _) => format!(", {}", gap.explain()),
            (None, Some(true)) => ", inside the tested range".to_owned(),
            (None, Some(false)) => ", OUTSIDE the tested range".to_owned(),
            (None, None) => String::new(),
        };
        let (speed, wide) = (shown_m_s(self.at.speed_m_s), self.wide());
        format!("flutter onset {speed} m/s{wide}{interval}{tested}")
    }

    /// How wide the interval is, ` ± 41 %`, where it is wide.
    pub fn wide(&self) -> String {
        let OnsetInterval::Known(error) = &self.interval else {
            return String::new();
        };
        let half = 0.5 * (error.high_m_s - error.low_m_s) / self.at.speed_m_s;
        let wide = (half > WIDE).then(|| format!(" ± {:.0} %", 100.0 * half));
        wide.unwrap_or_default()
    }

    /// Heave over rotation in words.
    pub fn mode_in_words(&self) -> String {
        let words = self.mode.map(|mode| mode.to_string());
        words.unwrap_or_else(|| "no rotation".to_owned())
    }

    /// The onset of a motion of a mode shape; nothing about ranges yet.
    pub(super) fn new(
        at: CriticalPoint,
        structure: &Structure,
        shape: &DVector<Complex<f64>>,
        branch: String,
    ) -> Self {
        Self {
            at,
            mode: ModeRatio::new(shape[0], shape[shape.len() - 1] * structure.width_m),
            damping_slope_s_m: None,
            branch,
            in_tested_range: None,
            gap: None,
            spurious_speeds_m_s: Vec::new(),
            warnings: Vec::new(),
            interval: OnsetInterval::none("none was computed by this route"),
        }
    }
}

/// A wind speed for people, m/s: a tenth, below 10 m/s a hundredth, which no measurement surpasses.
pub fn shown_m_s(speed_m_s: f64) -> String {
    let digits = if speed_m_s.abs() < 10.0 { 2 } else { 1 };
    format!("{speed_m_s:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_speed_that_the_data_leave_open_is_undetermined() {
        let about = |speed, half| {
            let parts = ErrorParts {
                scatter_m_s: half / 2.0,
                ..ErrorParts::default()
            };
            OnsetInterval::about(speed, half, 20.0, parts)
        };
        assert_eq!(about(37.0, 1.0).ends(), Some((36.0, 38.0)));
        // the whole width may be the speed, and no more
        assert!(matches!(about(10.0, 5.0), OnsetInterval::Known(_)));
        // one list of keys, whether it is known or not
        let open = about(37.0, 1.0).undetermined("another form".to_owned());
        let text = serde_json::to_string(&open).unwrap();
        assert_eq!(
            text,
            r#"{"kind":"undetermined","low_m_s":36.0,"high_m_s":38.0,"standard_error_m_s":0.5,"degrees_of_freedom":20.0,"parts":{"scatter_m_s":0.5},"reason":"not determined by these data: another form"}"#
        );
        assert_eq!(serde_json::from_str::<OnsetInterval>(&text).unwrap(), open);
        for (speed, half, why) in [
            (10.0, 5.1, "wider than the speed itself"),
            (9.2, 114.0, "contains zero"),
            (9.2, f64::NAN, "contains zero"),
        ] {
            let OnsetInterval::Undetermined { reason, .. } = about(speed, half) else {
                panic!("{speed} ± {half} is determined");
            };
            assert!(reason.starts_with("not determined by these data"));
            assert!(reason.ends_with(why), "{reason}");
        }
    }
}
