//! Turbulence of a file against the modes that it is to move and the wind that it is to be part of.

use super::super::limits::significant;
use super::super::{Finding, FindingKind};
use crate::bridge::BridgeMode;

/// Standard deviation over the mean wind above which nothing is the turbulence of a wind: cities have 0.4.
const MOST_INTENSE: f64 = 0.5;
/// Factor between an intensity that is stated and that of a file, either way: a record of finite length has less.
const INTENSITIES_WITHIN: f64 = 2.0;
/// Samples that a period of the slowest mode needs, and its periods that a record needs.
const SAMPLES_PER_PERIOD: f64 = 4.0;
const PERIODS: f64 = 10.0;
/// Nobody samples the wind along a bridge faster, s.
const LEAST_STEP_S: f64 = 0.02;

/// What is odd about the turbulence of a file of some duration: times that move no mode as turbulence does, and gusts as no wind has
/// them, of these standard deviations of `u` and `w`, in a mean wind of `speed_m_s`, m/s, and beside the intensities that are `stated`,
/// where these are known.
pub fn of_turbulence(
    modes: &[BridgeMode],
    step_s: f64,
    duration_s: f64,
    deviations_m_s: [f64; 2],
    speed_m_s: Option<f64>,
    stated: [Option<f64>; 2],
) -> Vec<Finding> {
    let mut found: Vec<Finding> = of_times(modes, step_s, duration_s).into_iter().collect();
    if let Some(speed_m_s) = speed_m_s {
        let components = ["u", "w"].into_iter().zip(stated);
        let each = components.zip(deviations_m_s);
        found.extend(each.filter_map(|((name, stated), deviation_m_s)| {
            of_intensity(name, stated, deviation_m_s, speed_m_s)
        }));
    }
    found
}

fn of_times(modes: &[BridgeMode], step_s: f64, duration_s: f64) -> Option<Finding> {
    let by_frequency = |a: &&BridgeMode, b: &&BridgeMode| a.frequency_hz.total_cmp(&b.frequency_hz);
    let slowest = modes.iter().min_by(by_frequency)?;
    let (number, period_s) = (slowest.number, slowest.frequency_hz.recip());
    if step_s * SAMPLES_PER_PERIOD > period_s {
        let text = format!(
            "a period of mode {number}, the slowest, is {} s: gusts that far apart do not move it as they would",
            significant(period_s)
        );
        let in_ms = step_s / 1e3;
        let meant =
            (in_ms > LEAST_STEP_S).then(|| format!("in ms it would be {} s", significant(in_ms)));
        return Some(Finding::unit("time_s: step", step_s, text).otherwise(meant));
    }
    (duration_s < PERIODS * period_s).then(|| {
        let text = format!(
            "the record is {} s long, {} periods of mode {number}, the slowest, which does not come into motion in it",
            significant(duration_s),
            significant(duration_s / period_s)
        );
        Finding::doubt(FindingKind::Contradiction, "time_s", text)
    })
}

fn of_intensity(
    name: &str,
    stated: Option<f64>,
    deviation_m_s: f64,
    speed_m_s: f64,
) -> Option<Finding> {
    let intensity = deviation_m_s / speed_m_s;
    let beyond = |intensity: f64, stated: f64| {
        let ratio = intensity / stated;
        !(INTENSITIES_WITHIN.recip()..=INTENSITIES_WITHIN).contains(&ratio)
    };
    let against = match stated.filter(|stated| beyond(intensity, *stated)) {
        Some(stated) => format!("the intensity that is stated is {}", significant(stated)),
        None if intensity > MOST_INTENSE => "0.05 to 0.3 is usual".to_owned(),
        None => return None,
    };
    let in_km_h = intensity / 3.6;
    let is_usual = in_km_h < MOST_INTENSE && stated.is_none_or(|stated| !beyond(in_km_h, stated));
    let text = format!(
        "that is {} of the mean wind of {} m/s; {against}",
        significant(intensity),
        significant(speed_m_s)
    );
    let meant = || {
        format!(
            "in km/h it would be {} m/s",
            significant(deviation_m_s / 3.6)
        )
    };
    let rounded = (1e3 * deviation_m_s).round() / 1e3;
    let place = format!("{name}: standard deviation");
    Some(Finding::unit(place, rounded, text).otherwise(is_usual.then(meant)))
}
