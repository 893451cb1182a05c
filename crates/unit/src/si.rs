//! Units of the variables, in SI base units and with display units.

/// A unit: `value in base units = factor · value`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SiUnit {
    /// Name.
    pub name: &'static str,
    /// Exponents of kilogram, metre, second and radian, which FMI counts as a base unit.
    pub base: [i8; 4],
    /// Factor to base units.
    pub factor: f64,
    /// Units in which a tool may show a value, `shown = factor · value`: their names and factors.
    pub display: &'static [(&'static str, f64)],
}

const fn coherent(
    name: &'static str,
    base: [i8; 4],
    display: &'static [(&'static str, f64)],
) -> SiUnit {
    SiUnit {
        name,
        base,
        factor: 1.0,
        display,
    }
}

const DEGREES_PER_RADIAN: f64 = 57.295_779_513_082_32;

/// Length, m.
pub(crate) static METRE: SiUnit = coherent("m", [0, 1, 0, 0], &[]);
/// Speed, m/s, shown in km/h on request.
pub(crate) static METRE_PER_SECOND: SiUnit = coherent("m/s", [0, 1, -1, 0], &[("km/h", 3.6)]);
/// Rate of a dimensionless number, 1/s.
pub(crate) static PER_SECOND: SiUnit = coherent("1/s", [0, 0, -1, 0], &[]);
/// Acceleration, m/s².
pub(crate) static METRE_PER_SECOND2: SiUnit = coherent("m/s2", [0, 1, -2, 0], &[]);
/// Angle, rad, shown in degrees on request.
pub(crate) static RADIAN: SiUnit = coherent("rad", [0, 0, 0, 1], &[("deg", DEGREES_PER_RADIAN)]);
/// Angular rate, rad/s.
pub(crate) static RADIAN_PER_SECOND: SiUnit =
    coherent("rad/s", [0, 0, -1, 1], &[("deg/s", DEGREES_PER_RADIAN)]);
/// Angular acceleration, rad/s².
pub(crate) static RADIAN_PER_SECOND2: SiUnit =
    coherent("rad/s2", [0, 0, -2, 1], &[("deg/s2", DEGREES_PER_RADIAN)]);
/// Force, N.
pub(crate) static NEWTON: SiUnit = coherent("N", [1, 1, -2, 0], &[]);
/// Moment, N·m.
pub(crate) static NEWTON_METRE: SiUnit = coherent("N.m", [1, 2, -2, 0], &[]);
/// Force per length, N/m.
pub(crate) static NEWTON_PER_METRE: SiUnit = coherent("N/m", [1, 0, -2, 0], &[]);
/// Moment per length, N·m/m.
pub(crate) static NEWTON_METRE_PER_METRE: SiUnit = coherent("N.m/m", [1, 1, -2, 0], &[]);
/// Density, kg/m³.
pub(crate) static KILOGRAM_PER_METRE3: SiUnit = coherent("kg/m3", [1, -3, 0, 0], &[]);
/// Mass per length, kg/m.
pub(crate) static KILOGRAM_PER_METRE: SiUnit = coherent("kg/m", [1, -1, 0, 0], &[]);
/// Mass moment of inertia per length, kg·m²/m.
pub(crate) static KILOGRAM_METRE2_PER_METRE: SiUnit = coherent("kg.m2/m", [1, 1, 0, 0], &[]);
/// Mass, kg.
pub(crate) static KILOGRAM: SiUnit = coherent("kg", [1, 0, 0, 0], &[]);
/// Force per speed, N·s/m.
pub(crate) static NEWTON_SECOND_PER_METRE: SiUnit = coherent("N.s/m", [1, 0, -1, 0], &[]);
/// Moment per angular rate, N·m·s/rad.
pub(crate) static NEWTON_METRE_SECOND_PER_RADIAN: SiUnit =
    coherent("N.m.s/rad", [1, 2, -1, -1], &[]);
/// Frequency, Hz: one cycle is 2π rad.
pub(crate) static HERTZ: SiUnit = SiUnit {
    name: "Hz",
    base: [0, 0, -1, 1],
    factor: std::f64::consts::TAU,
    display: &[],
};
