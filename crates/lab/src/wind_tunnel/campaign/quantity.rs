//! Units of channels: what each quantity may be stated in, and the factor to SI.

use crate::error::{Error, Result};

/// Kinds of channels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Quantity {
    /// Displacement, m.
    Length,
    /// Rotation, rad.
    Angle,
    /// Force, N.
    Force,
    /// Moment, N·m.
    Moment,
    /// Wind speed, m/s.
    Speed,
    /// Time, s.
    Time,
    /// Density, kg/m³.
    Density,
    /// Temperature, °C.
    Temperature,
    /// Pressure, Pa.
    Pressure,
}

/// Unit, quantity, factor to the unit used here.
const UNITS: &[(&str, Quantity, f64)] = &[
    ("m", Quantity::Length, 1.0),
    ("cm", Quantity::Length, 1e-2),
    ("mm", Quantity::Length, 1e-3),
    ("um", Quantity::Length, 1e-6),
    ("rad", Quantity::Angle, 1.0),
    ("mrad", Quantity::Angle, 1e-3),
    ("deg", Quantity::Angle, std::f64::consts::PI / 180.0),
    ("°", Quantity::Angle, std::f64::consts::PI / 180.0),
    ("N", Quantity::Force, 1.0),
    ("mN", Quantity::Force, 1e-3),
    ("kN", Quantity::Force, 1e3),
    ("Nm", Quantity::Moment, 1.0),
    ("Nmm", Quantity::Moment, 1e-3),
    ("mNm", Quantity::Moment, 1e-3),
    ("Ncm", Quantity::Moment, 1e-2),
    ("kNm", Quantity::Moment, 1e3),
    ("m/s", Quantity::Speed, 1.0),
    ("km/h", Quantity::Speed, 1.0 / 3.6),
    ("s", Quantity::Time, 1.0),
    ("ms", Quantity::Time, 1e-3),
    ("kg/m3", Quantity::Density, 1.0),
    ("C", Quantity::Temperature, 1.0),
    ("°C", Quantity::Temperature, 1.0),
    ("Pa", Quantity::Pressure, 1.0),
    ("hPa", Quantity::Pressure, 1e2),
    ("mbar", Quantity::Pressure, 1e2),
    ("kPa", Quantity::Pressure, 1e3),
];

impl Quantity {
    /// Factor from `unit` to SI (°C for temperatures).
    pub(crate) fn factor(self, place: &str, unit: &str) -> Result<f64> {
        self.factor_of(unit).ok_or_else(|| {
            let own = UNITS.iter().filter(|(_, quantity, _)| *quantity == self);
            let own: Vec<&str> = own.map(|(name, ..)| *name).collect();
            let article = if self == Self::Angle { "an" } else { "a" };
            let name = format!("{self:?}").to_lowercase();
            let expected = format!("a unit of {article} {name}: {}", own.join(", "));
            Error::input(place, expected, format!("`{unit}`"))
        })
    }

    /// The same; `None` for a unit that does not fit.
    pub(crate) fn factor_of(self, unit: &str) -> Option<f64> {
        let plain = normalised(unit);
        let mut units = UNITS.iter();
        let unit = units.find(|(name, quantity, _)| *quantity == self && *name == plain);
        unit.map(|(.., factor)| *factor)
    }
}

/// Whether `unit` is one of any quantity.
pub(super) fn is_known(unit: &str) -> bool {
    let plain = normalised(unit);
    UNITS.iter().any(|(name, ..)| *name == plain)
}

/// The unit that the name of a channel ends with, if it does: `y_mm`, `lift, kN`. Of the units of one letter only N is one beyond doubt.
pub(super) fn unit_in_name(name: &str) -> Option<&str> {
    let (_, ending) = name.rsplit_once(['_', ' ', ',', '/', '-'])?;
    let is_certain = ending == "N" || ending.chars().nth(1).is_some();
    let is_unit = UNITS.iter().any(|(name, ..)| *name == ending);
    (is_certain && is_unit).then_some(ending)
}

/// Spellings of one unit as one: `N·m`, `N m`, `N*m`, `kg/m^3`, `kg/m³`, `degC`.
fn normalised(unit: &str) -> String {
    let letter = |c: char| match c {
        ' ' | '·' | '*' | '.' | '^' => None,
        '³' => Some('3'),
        'µ' | 'μ' => Some('u'),
        c => Some(c),
    };
    let plain: String = unit.trim().chars().filter_map(letter).collect();
    // words for symbols, in any case and number
    let word = plain.to_lowercase();
    let symbol = match word.trim_end_matches('s') {
        "degc" | "celsiu" => "C",
        "degree" | "deg" => "deg",
        "radian" | "rad" => "rad",
        "metre" | "meter" => "m",
        "millimetre" | "millimeter" => "mm",
        "newton" => "N",
        "second" | "sec" => "s",
        _ => return plain,
    };
    symbol.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_those_of_their_quantity() {
        let factor = |q: Quantity, unit: &str| q.factor_of(unit);
        assert_eq!(factor(Quantity::Length, "mm"), Some(1e-3));
        assert_eq!(factor(Quantity::Moment, "N·m"), Some(1.0));
        assert_eq!(factor(Quantity::Moment, "kN m"), Some(1e3));
        assert_eq!(factor(Quantity::Density, "kg/m³"), Some(1.0));
        assert_eq!(factor(Quantity::Temperature, "degC"), Some(1.0));
        let degree = factor(Quantity::Angle, "deg").unwrap();
        assert!((degree * 180.0 / std::f64::consts::PI - 1.0).abs() < 1e-15);
        // mN is a force and never milli of a moment; N is no moment
        assert_eq!(factor(Quantity::Moment, "N"), None);
        assert_eq!(
            Quantity::Force
                .factor("channels.x", "mm")
                .unwrap_err()
                .to_string(),
            "channels.x: expected a unit of a force: N, mN, kN, found `mm`"
        );
    }
}
