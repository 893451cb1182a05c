//! Units of the variables, in SI base units and with display units.

/// Exponents of the SI base units that occur here (radian counted as one, as FMI does).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct BaseExponents {
    /// Kilogram.
    pub kg: i8,
    /// Metre.
    pub m: i8,
    /// Second.
    pub s: i8,
    /// Radian.
    pub rad: i8,
}

/// Another unit in which a tool may show a value: `shown = factor · value`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplayUnit {
    /// Name.
    pub name: &'static str,
    /// `shown = factor · value`.
    pub factor: f64,
}

/// A unit: `value in base units = factor · value`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SiUnit {
    /// Name.
    pub name: &'static str,
    /// Dimension.
    pub base: BaseExponents,
    /// Factor to base units.
    pub factor: f64,
    /// Units for showing.
    pub display: &'static [DisplayUnit],
}

const fn coherent(
    name: &'static str,
    base: BaseExponents,
    display: &'static [DisplayUnit],
) -> SiUnit {
    SiUnit {
        name,
        base,
        factor: 1.0,
        display,
    }
}

const fn exponents(kg: i8, m: i8, s: i8, rad: i8) -> BaseExponents {
    BaseExponents { kg, m, s, rad }
}

const DEGREES_PER_RADIAN: f64 = 57.295_779_513_082_32;

/// Length, m.
pub(crate) static METRE: SiUnit = coherent("m", exponents(0, 1, 0, 0), &[]);
/// Speed, m/s, shown in km/h on request.
pub(crate) static METRE_PER_SECOND: SiUnit = coherent(
    "m/s",
    exponents(0, 1, -1, 0),
    &[DisplayUnit {
        name: "km/h",
        factor: 3.6,
    }],
);
/// Rate of a dimensionless number, 1/s.
pub(crate) static PER_SECOND: SiUnit = coherent("1/s", exponents(0, 0, -1, 0), &[]);
/// Acceleration, m/s².
pub(crate) static METRE_PER_SECOND2: SiUnit = coherent("m/s2", exponents(0, 1, -2, 0), &[]);
/// Angle, rad, shown in degrees on request.
pub(crate) static RADIAN: SiUnit = coherent(
    "rad",
    exponents(0, 0, 0, 1),
    &[DisplayUnit {
        name: "deg",
        factor: DEGREES_PER_RADIAN,
    }],
);
/// Angular rate, rad/s.
pub(crate) static RADIAN_PER_SECOND: SiUnit = coherent(
    "rad/s",
    exponents(0, 0, -1, 1),
    &[DisplayUnit {
        name: "deg/s",
        factor: DEGREES_PER_RADIAN,
    }],
);
/// Angular acceleration, rad/s².
pub(crate) static RADIAN_PER_SECOND2: SiUnit = coherent(
    "rad/s2",
    exponents(0, 0, -2, 1),
    &[DisplayUnit {
        name: "deg/s2",
        factor: DEGREES_PER_RADIAN,
    }],
);
/// Force, N.
pub(crate) static NEWTON: SiUnit = coherent("N", exponents(1, 1, -2, 0), &[]);
/// Moment, N·m.
pub(crate) static NEWTON_METRE: SiUnit = coherent("N.m", exponents(1, 2, -2, 0), &[]);
/// Force per length, N/m.
pub(crate) static NEWTON_PER_METRE: SiUnit = coherent("N/m", exponents(1, 0, -2, 0), &[]);
/// Moment per length, N·m/m.
pub(crate) static NEWTON_METRE_PER_METRE: SiUnit = coherent("N.m/m", exponents(1, 1, -2, 0), &[]);
/// Density, kg/m³.
pub(crate) static KILOGRAM_PER_METRE3: SiUnit = coherent("kg/m3", exponents(1, -3, 0, 0), &[]);
/// Mass per length, kg/m.
pub(crate) static KILOGRAM_PER_METRE: SiUnit = coherent("kg/m", exponents(1, -1, 0, 0), &[]);
/// Mass moment of inertia per length, kg·m²/m.
pub(crate) static KILOGRAM_METRE2_PER_METRE: SiUnit =
    coherent("kg.m2/m", exponents(1, 1, 0, 0), &[]);
/// Mass, kg.
pub(crate) static KILOGRAM: SiUnit = coherent("kg", exponents(1, 0, 0, 0), &[]);
/// Force per speed, N·s/m.
pub(crate) static NEWTON_SECOND_PER_METRE: SiUnit = coherent("N.s/m", exponents(1, 0, -1, 0), &[]);
/// Moment per angular rate, N·m·s/rad.
pub(crate) static NEWTON_METRE_SECOND_PER_RADIAN: SiUnit =
    coherent("N.m.s/rad", exponents(1, 2, -1, -1), &[]);
/// Frequency, Hz: one cycle is 2π rad.
pub(crate) static HERTZ: SiUnit = SiUnit {
    name: "Hz",
    base: BaseExponents {
        kg: 0,
        m: 0,
        s: -1,
        rad: 1,
    },
    factor: std::f64::consts::TAU,
    display: &[],
};
