//! Usual ranges of single numbers, and the units in which they are often written instead.

use super::Finding;
use std::f64::consts::TAU;

/// What is usual for one kind of number, and the units in which it is often written instead.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Unit that is expected.
    pub unit: &'static str,
    /// Least and greatest usual value.
    pub usual: (f64, f64),
    /// Other units and their factor to the expected one, the likeliest first.
    pub meant: &'static [(&'static str, f64)],
}

const LENGTHS: &[(&str, f64)] = &[("mm", 1e-3), ("cm", 1e-2), ("m", 1e3)];
pub(super) const FREQUENCIES: &[(&str, f64)] = &[("rad/s", 1.0 / TAU), ("mHz", 1e-3)];

impl Limits {
    const fn of_length(least_m: f64, most_m: f64) -> Self {
        Self {
            unit: "m",
            usual: (least_m, most_m),
            meant: LENGTHS,
        }
    }
}

/// Width or depth of a section model, m.
pub const MODEL_WIDTH: Limits = Limits::of_length(0.02, 5.0);
/// Length of a section model, and places on its rig, m.
pub const MODEL_LENGTH: Limits = Limits::of_length(0.05, 20.0);
/// Width of a deck, model or bridge, m.
pub const DECK_WIDTH: Limits = Limits::of_length(0.02, 100.0);
/// Mean wind speed, m/s.
pub const WIND_SPEED: Limits = Limits {
    unit: "m/s",
    usual: (0.2, 100.0),
    meant: &[("km/h", 1.0 / 3.6), ("mm/s", 1e-3), ("cm/s", 1e-2)],
};
/// Frequency of a forced motion, Hz.
pub const MOTION_FREQUENCY: Limits = Limits {
    unit: "Hz",
    usual: (0.01, 20.0),
    meant: FREQUENCIES,
};
/// Sampling frequency, Hz.
pub const SAMPLING: Limits = Limits {
    unit: "Hz",
    usual: (5.0, 50_000.0),
    meant: &[("kHz", 1e3), ("mHz", 1e-3)],
};

/// What to say of a value beyond its limits; `None` for one within them.
pub fn beyond(key: &str, value: f64, limits: &Limits) -> Option<Finding> {
    let (low, high) = limits.usual;
    let is_usual = |x: f64| (low..=high).contains(&x);
    if is_usual(value) {
        return None;
    }
    let unit = limits.unit;
    let meant = limits.meant.iter().find(|(_, f)| is_usual(f * value));
    let otherwise = meant.map(|(name, factor)| {
        let meant = significant(factor * value);
        format!("in {name} it would be {meant} {unit}")
    });
    let text = format!("{low} to {high} {unit} is usual");
    Some(Finding::unit(key, value, text).otherwise(otherwise))
}

/// A number with four significant digits and no zeros behind them.
pub fn significant(x: f64) -> String {
    let short = format!("{x:.3e}");
    let rounded: f64 = short.parse().unwrap_or(x);
    match (1e-6..1e9).contains(&rounded.abs()) || rounded == 0.0 {
        true => rounded.to_string(),
        false => short,
    }
}

/// What the ratio of a stated to a measured value suggests, as the end of a sentence; empty when nothing.
pub fn ratio_hint(ratio: f64) -> &'static str {
    const KNOWN: [(f64, &str); 8] = [
        (10.0, " (ten times that: a decimal place?)"),
        (0.1, " (a tenth of that: a decimal place?)"),
        (3.6, " (3.6 times that: km/h for m/s?)"),
        (1.0 / 3.6, " (3.6 times less: m/s for km/h?)"),
        (1e3, " (1000 times that: a unit?)"),
        (1e-3, " (1000 times less: a unit?)"),
        (TAU, " (2\u{3c0} times that: rad/s for Hz?)"),
        (1.0 / TAU, " (2\u{3c0} times less: Hz for rad/s?)"),
    ];
    // a mean speed is known to some per cent
    let near = |(known, _): &&(f64, &str)| (ratio / known - 1.0).abs() < 0.05;
    KNOWN.iter().find(near).map_or("", |(_, words)| *words)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_likely_unit_is_named() {
        let said = |key, x, limits| beyond(key, x, &limits).unwrap().to_string();
        assert_eq!(
            said("rig.model_width_m", 502.3, MODEL_WIDTH),
            "rig.model_width_m = 502.3: 0.02 to 5 m is usual; in mm it would be 0.5023 m"
        );
        assert!(said("rig.model_length_m", 2680.0, MODEL_LENGTH).ends_with("it would be 2.68 m"));
        assert!(
            said("tunnel.frequencies_hz", 31.4, MOTION_FREQUENCY)
                .ends_with("in rad/s it would be 4.997 Hz")
        );
        assert!(beyond("b", 0.5, &MODEL_WIDTH).is_none());
        assert!(beyond("b", 31.0, &DECK_WIDTH).is_none());
        assert!(said("b", f64::NAN, MODEL_WIDTH).ends_with("0.02 to 5 m is usual"));
        assert!(ratio_hint(10.1).contains("decimal"));
        assert_eq!(ratio_hint(1.3), "");
    }
}
