//! Sections: width, air, masses, frequencies, damping, each by itself and against the others.

use super::limits::{DECK_WIDTH, FREQUENCIES, Limits, beyond, significant};
use super::{Finding, FindingKind, FindingSeverity};
use crate::section::SectionModel;
use std::f64::consts::TAU;
use std::ops::RangeInclusive;

/// Air between a high mountain and a cold day, kg/m³.
const AIR: Limits = Limits {
    unit: "kg/m³",
    usual: (0.7, 1.6),
    meant: &[("g/m³", 1e-3), ("kg/l", 1e3)],
};
/// Ratio to critical damping: bridges and rigs have 0.001 to 0.01, and rigs with dampers up to 0.02. Less is on the safe side, zero
/// an idealisation.
const LEAST_DAMPING: f64 = 5e-4;
pub(super) const USUAL_DAMPING: f64 = 0.01;
const DAMPING_OF_MODELS: f64 = 0.02;
/// From here on it is no ratio of a structure.
const MOST_DAMPING: f64 = 0.1;
/// Decks narrower than this are models, m …
pub const WIDEST_MODEL_M: f64 = 2.0;
/// … and those wider than this carry roads: long bridges, with low frequencies, m.
const NARROWEST_ROAD_M: f64 = 10.0;
/// Less than any code asks of a bridge with a road, m/s.
const LEAST_REQUIRED_M_S: f64 = 10.0;
/// Mass over that of the air in a square of the width, `m/(ρB²)`: steel boxes have 10 to 30, concrete decks to 100, footbridges to
/// 200; models may be as heavy as their rig.
const MASS_RATIOS: RangeInclusive<f64> = 3.0..=300.0;
const MASS_RATIOS_OF_MODELS: RangeInclusive<f64> = 1.5..=1000.0;
/// Radius of gyration over the width, `√(J/m)/B`: 0.289 for a uniform plate, 0.5 for all mass in both edges.
const RADII: RangeInclusive<f64> = 0.2..=0.45;
/// Nothing inside the width has more; less than the other only a girder without a deck.
const POSSIBLE_RADII: RangeInclusive<f64> = 0.15..=0.5;
/// Frequency of torsion over that of heave.
const FREQUENCY_RATIOS: RangeInclusive<f64> = 1.3..=4.0;
/// Flutter of a flat plate with these numbers above this is that of no long bridge and of no model, m/s …
const FASTEST_PLATE_M_S: f64 = 200.0;
/// … and of no footbridge, which are stiff.
const FASTEST_FOOTBRIDGE_M_S: f64 = 350.0;

/// What is odd about a section. One cause is said once: ratios are judged only where width and density are usual.
///
/// ```
/// # mod aerodeck { pub use aerodeck_core::*; pub use aerodeck_judgement::*; }
/// use aerodeck::plausibility::of_section;
/// use aerodeck::section::SectionModel;
///
/// let section = SectionModel::iabse_1_1a();
/// assert!(of_section(&section).is_empty());
/// let in_millimetres = SectionModel { width_m: 1e3 * section.width_m, ..section };
/// assert!(!of_section(&in_millimetres).is_empty());
/// ```
pub fn of_section(section: &SectionModel) -> Vec<Finding> {
    let width = beyond("section.width_m", section.width_m, &DECK_WIDTH);
    let air = unusual_air("section.air_density_kg_m3", section.air_density_kg_m3);
    let mut found: Vec<Finding> = width.into_iter().chain(air).collect();
    let scale_is_usual = found.is_empty();
    let sway = section.lateral.as_ref();
    let sway = sway.map(|s| ("lateral", s.damping_ratio));
    let ratios = [
        ("vertical", section.vertical.damping_ratio),
        ("torsion", section.torsion.damping_ratio),
    ];
    let most = match section.width_m < WIDEST_MODEL_M {
        true => DAMPING_OF_MODELS,
        false => USUAL_DAMPING,
    };
    found.extend(ratios.into_iter().chain(sway).filter_map(|(name, ratio)| {
        unusual_damping(&format!("section.{name}.damping_ratio"), ratio, most)
    }));
    if scale_is_usual {
        found.extend(axis_beyond_edge(section));
        let of_mass = masses(section);
        let masses_are_usual = of_mass.iter().all(|f| f.severity < FindingSeverity::Doubt);
        found.extend(of_mass);
        found.extend(frequencies(section, masses_are_usual));
    }
    found
}

/// A required wind speed, m/s, that is odd for a deck of this width.
pub fn of_required_speed(speed_m_s: Option<f64>, width_m: f64) -> Option<Finding> {
    let slow = speed_m_s.filter(|v| *v < LEAST_REQUIRED_M_S && width_m >= NARROWEST_ROAD_M)?;
    let text = format!("no deck of {width_m} m is built for less than {LEAST_REQUIRED_M_S} m/s");
    let found = Finding::unit("flutter.required_speed_m_s", slow, text);
    let otherwise = "is it at the scale of a model, or in another unit?".to_owned();
    Some(found.otherwise(otherwise).into_note())
}

/// An axis of rotation beyond the edge of the deck.
fn axis_beyond_edge(section: &SectionModel) -> Option<Finding> {
    let offset = section.axis_offset_m.unwrap_or(0.0);
    let edge = 0.5 * section.width_m;
    (offset.abs() > edge).then(|| {
        let text = format!("the edge of the deck is {edge} m from mid-chord");
        let otherwise = format!("in mm it would be {} m", significant(offset / 1e3));
        Finding::unit("section.axis_offset_m", offset, text).otherwise(otherwise)
    })
}

/// A density that is not that of air.
pub fn unusual_air(key: &str, density_kg_m3: f64) -> Option<Finding> {
    beyond(key, density_kg_m3, &AIR)
}

/// A damping ratio that no structure has, or few: above `most`.
pub(super) fn unusual_damping(key: &str, ratio: f64, most: f64) -> Option<Finding> {
    if ratio == 0.0 || (LEAST_DAMPING..=most).contains(&ratio) {
        return None;
    }
    let otherwise = if ratio < LEAST_DAMPING {
        None
    } else if ratio <= MOST_DAMPING {
        let meant = significant(ratio / TAU);
        Some(format!(
            "as a logarithmic decrement it would be a ratio of {meant}"
        ))
    } else {
        let meant = significant(ratio / 100.0);
        Some(format!("in per cent it would be {meant}"))
    };
    let text = format!("a ratio to critical damping is usually {LEAST_DAMPING} to {most}");
    let found = Finding::unit(key, ratio, text).otherwise(otherwise);
    Some(found.into_note_if(ratio <= MOST_DAMPING))
}

fn masses(section: &SectionModel) -> Vec<Finding> {
    let sway = section.lateral.as_ref();
    let sway = sway.and_then(|s| mass("lateral", s.mass_kg_m, section));
    let heave = mass("vertical", section.vertical.mass_kg_m, section);
    let found: Vec<Finding> = heave.into_iter().chain(sway).collect();
    match found.is_empty() {
        true => radius(section).into_iter().collect(),
        // with a mass in another unit the radius says the same once more
        false => found,
    }
}

fn mass(name: &str, mass_kg_m: f64, section: &SectionModel) -> Option<Finding> {
    let air = section.air_density_kg_m3 * section.width_m.powi(2);
    let usual = match section.width_m < WIDEST_MODEL_M {
        true => MASS_RATIOS_OF_MODELS,
        false => MASS_RATIOS,
    };
    let ratio = mass_kg_m / air;
    if usual.contains(&ratio) {
        return None;
    }
    let (least, most) = usual.clone().into_inner();
    let otherwise = if usual.contains(&(1e3 * ratio)) {
        format!("in t/m it would be {} kg/m", significant(1e3 * mass_kg_m))
    } else if ratio > most {
        "it would be usual as that of the whole model or span".to_owned()
    } else {
        format!("at half the width it would be {:.3} times", 4.0 * ratio)
    };
    let text = format!(
        "that is {ratio:.3} times the air in a square of the width ({least} to {most} is usual)"
    );
    let key = format!("section.{name}.mass_kg_m");
    Some(Finding::unit(key, mass_kg_m, text).otherwise(otherwise))
}

fn radius(section: &SectionModel) -> Option<Finding> {
    let inertia = section.torsion.inertia_kg_m2_m;
    let ratio = (inertia / section.vertical.mass_kg_m).sqrt() / section.width_m;
    let found = unusual_radius("section.torsion.inertia_kg_m2_m", section.width_m, ratio);
    found.map(|f| f.with_value(inertia))
}

/// A radius of gyration, over the width, that no deck has.
pub(super) fn unusual_radius(key: &str, width_m: f64, ratio: f64) -> Option<Finding> {
    if RADII.contains(&ratio) {
        return None;
    }
    let (least, most) = RADII.into_inner();
    let text = format!(
        "with the mass that is a radius of gyration of {ratio:.3} widths (decks have {least} to {most}; 0.5 is all mass in both edges)"
    );
    let found = Finding::doubt(FindingKind::Unit, key, text);
    if POSSIBLE_RADII.contains(&ratio) {
        return Some(found.into_note());
    }
    let thousand = 1e3_f64.sqrt();
    let width = 2.0 * width_m;
    let semi_chord = format!("were width_m the semi-chord, B would be {width} m and this");
    // the factor on the ratio if it was meant so
    let meant = [
        (0.5, semi_chord.as_str()),
        (thousand, "were J in t·m²/m, it"),
        (1.0 / thousand, "were the mass in t/m, it"),
        (1e-3, "were lengths of J in mm, it"),
    ];
    let meant = meant.map(|(factor, what)| (factor * ratio, what));
    let meant = meant.into_iter().find(|(ratio, _)| RADII.contains(ratio));
    let otherwise = meant.map(|(ratio, what)| format!("{what} would be {ratio:.3} widths"));
    Some(found.otherwise(otherwise))
}

/// Natural frequencies against what the width suggests, by themselves and by the speed at which a flat plate with them flutters.
fn frequencies(section: &SectionModel, masses_are_usual: bool) -> Vec<Finding> {
    let natural = |given: Option<f64>, stiffness: Option<f64>, inertia: f64| {
        given.unwrap_or_else(|| (stiffness.unwrap_or(0.0) / inertia).sqrt() / TAU)
    };
    let (v, t) = (&section.vertical, &section.torsion);
    let heave = natural(v.frequency_hz, v.stiffness_n_m2, v.mass_kg_m);
    let twist = natural(t.frequency_hz, t.stiffness_n, t.inertia_kg_m2_m);
    let sway = section.lateral.as_ref();
    let sway = sway.map(|s| natural(s.frequency_hz, s.stiffness_n_m2, s.mass_kg_m));
    let odd = |name, hertz| unusual_frequency(name, hertz, section.width_m);
    let all = [odd("vertical", heave), odd("torsion", twist)];
    let sway = sway.and_then(|hertz| odd("lateral", hertz));
    let mut found: Vec<Finding> = all.into_iter().flatten().chain(sway).collect();
    if masses_are_usual && found.iter().all(|f| f.severity < FindingSeverity::Doubt) {
        found.extend(fast_plate(section, heave, twist));
    }
    found
}

/// Usual natural frequencies of a motion at a width, and those beyond which it is another unit, Hz.
fn frequency_limits(name: &str, width_m: f64) -> [RangeInclusive<f64>; 2] {
    let limits = if width_m < WIDEST_MODEL_M {
        [(1.0, 20.0), (0.3, 20.0)]
    } else if width_m < NARROWEST_ROAD_M {
        [(0.1, 6.0), (0.05, 10.0)]
    } else {
        [(0.05, 1.0), (0.03, 3.0)]
    };
    let (lower, upper) = match (name, width_m < WIDEST_MODEL_M) {
        // one to four times that of heave, and half of it in sway
        ("torsion", false) => (1.0, 3.0),
        ("lateral", false) => (0.5, 1.0),
        ("lateral", true) => (0.3, 1.0),
        _ => (1.0, 1.0),
    };
    limits.map(|(low, high): (f64, f64)| low * lower..=high * upper)
}

fn unusual_frequency(name: &str, hertz: f64, width_m: f64) -> Option<Finding> {
    let [usual, possible] = frequency_limits(name, width_m);
    // a motion without a spring has none
    if hertz == 0.0 || usual.contains(&hertz) {
        return None;
    }
    let (low, high) = usual.clone().into_inner();
    let mut units = FREQUENCIES.iter();
    let meant = units.find(|(_, f)| usual.contains(&(f * hertz)));
    let otherwise = match meant {
        Some((unit, f)) => Some(format!(
            "in {unit} it would be {} Hz",
            significant(f * hertz)
        )),
        None if hertz < low && width_m < WIDEST_MODEL_M => {
            Some("is it that of the bridge beside the width of a model?".to_owned())
        }
        None => None,
    };
    let text = format!("{low} to {high} Hz is usual at a width of {width_m} m");
    let found = Finding::unit(format!("section.{name}.frequency_hz"), hertz, text);
    let found = found.otherwise(otherwise);
    Some(found.into_note_if(possible.contains(&hertz)))
}

/// A flat plate of these numbers flutters at `V = 3.7 f_t B √(m r/(ρB³) (1 − (f_v/f_t)²))` (Selberg's formula, within some per
/// cent): a speed beyond every bridge says that frequencies, or all masses, stand in another unit.
pub(super) fn fast_plate(section: &SectionModel, heave_hz: f64, twist_hz: f64) -> Option<Finding> {
    let (width, density) = (section.width_m, section.air_density_kg_m3);
    let mass = section.vertical.mass_kg_m;
    let radius = (section.torsion.inertia_kg_m2_m / mass).sqrt();
    if twist_hz <= heave_hz {
        return slow_twist(heave_hz, twist_hz);
    }
    let apart = 1.0 - (heave_hz / twist_hz).powi(2);
    let speed = 3.7 * twist_hz * width * (mass * radius / (density * width.powi(3)) * apart).sqrt();
    let fastest = match (WIDEST_MODEL_M..NARROWEST_ROAD_M).contains(&width) {
        true => FASTEST_FOOTBRIDGE_M_S,
        false => FASTEST_PLATE_M_S,
    };
    if speed <= fastest {
        return None;
    }
    let otherwise = format!(
        "in rad/s the frequencies would be {} and {} Hz, and the plate would flutter at {:.0} m/s",
        significant(heave_hz / TAU),
        significant(twist_hz / TAU),
        speed / TAU
    );
    let text = format!(
        "with these masses and frequencies ({heave_hz:.4} and {twist_hz:.4} Hz) a flat plate flutters near {speed:.0} m/s, above \
         {fastest:.0} m/s as no deck of {width} m"
    );
    let found = Finding::unit("section.torsion.frequency_hz", twist_hz, text);
    Some(found.otherwise(otherwise))
}

/// Torsion no faster than heave, which do not couple into flutter then.
fn slow_twist(heave_hz: f64, twist_hz: f64) -> Option<Finding> {
    // a motion without a spring has no frequency
    if twist_hz == 0.0 {
        return None;
    }
    let (low, high) = FREQUENCY_RATIOS.into_inner();
    let text = format!(
        "it is not above that of heave, {heave_hz:.4} Hz, where decks have {low} to {high} times it"
    );
    let meant = heave_hz / TAU;
    let otherwise = FREQUENCY_RATIOS.contains(&(twist_hz / meant)).then(|| {
        format!(
            "were heave in rad/s, it would have {} Hz",
            significant(meant)
        )
    });
    let found = Finding::unit("section.torsion.frequency_hz", twist_hz, text);
    Some(found.otherwise(otherwise))
}

#[cfg(test)]
mod tests;
