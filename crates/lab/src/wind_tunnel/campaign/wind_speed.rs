//! Whether the channel of the wind speed is of one mean wind, by which all derivatives of a run are divided.

use crate::signal::{mean, mean_and_deviation, median};

/// Mean and median, and the means of the halves, may differ by this part, of which derivatives take twice as much …
const SAME_WIND: f64 = 0.03;
/// … the halves by so many standard errors more, which gusts leave in the means of so many parts of each.
const ERRORS: f64 = 3.0;
const PARTS: usize = 8;

/// What turbulence about one mean wind does not explain, in words.
pub(super) fn other_than_one_wind(wind_m_s: &[f64]) -> Option<String> {
    let (whole, middle) = (mean(wind_m_s), median(wind_m_s));
    if (whole - middle).abs() > SAME_WIND * whole.abs() {
        return Some(format!(
            "the wind speed is {whole:.3} m/s in the mean and {middle:.3} m/s in the median, as of a channel that drops out, \
             begins late or stops"
        ));
    }
    let (first, second) = wind_m_s.split_at(wind_m_s.len() / 2);
    let [(first, error), (second, other)] = [first, second].map(mean_and_error);
    ((first - second).abs() > SAME_WIND * whole.abs() + ERRORS * error.hypot(other)).then(|| {
        format!(
            "the wind speed is {first:.3} m/s in the first half and {second:.3} m/s in the second, as of a channel that drifts"
        )
    })
}

/// The mean, and its standard error as the means of its parts scatter.
fn mean_and_error(wind_m_s: &[f64]) -> (f64, f64) {
    let parts = wind_m_s.chunks(wind_m_s.len().div_ceil(PARTS).max(1));
    let count = parts.len() as f64;
    let (mean, deviation) = mean_and_deviation(parts.map(mean));
    (mean, deviation / count.sqrt())
}
