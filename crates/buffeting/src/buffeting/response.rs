//! What a response in the frequency domain is: of a section, and of the nodes of a bridge.

use serde::Serialize;

/// Response to turbulence at one mean wind speed; vectors in the order of the degrees of freedom.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BuffetingResponse {
    /// Mean wind speed, m/s.
    pub speed_m_s: f64,
    /// Root mean square of the displacements about their mean: m, rad.
    pub rms: Vec<f64>,
    /// Root mean square of the rates: m/s, rad/s.
    pub rate_rms: Vec<f64>,
    /// Root mean square of the accelerations: m/s², rad/s².
    pub acceleration_rms: Vec<f64>,
    /// The part of `rms` that each component of the turbulence causes alone, `u` then `w`.
    pub rms_by_gust: [Vec<f64>; 2],
    /// Mean frequency of upward crossings of the mean, Hz: rate over displacement over 2π.
    pub crossing_frequency_hz: Vec<f64>,
    /// Part of each variance inside the tested range of `K`, when the model has one.
    pub part_in_tested_range: Option<Vec<f64>>,
}

/// Response at named nodes to turbulence at one mean wind speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpanResponse {
    /// Mean wind speed, m/s.
    pub speed_m_s: f64,
    /// Places of the nodes in the bridge.
    pub nodes: Vec<usize>,
    /// Root mean square of vertical, lateral displacement (m) and rotation (rad) of each node.
    pub rms: Vec<[f64; 3]>,
    /// Mean frequency of upward crossings of the mean, Hz.
    pub crossing_frequency_hz: Vec<[f64; 3]>,
    /// Part of each variance inside the tested range of `K`, where the forces have one; the rest rests on forces that were
    /// not tested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub part_in_tested_range: Option<Vec<[f64; 3]>>,
}

impl SpanResponse {
    /// Expected greatest departure from the mean in `duration_s`, over the root mean square (Davenport 1964).
    pub fn peak_factors(&self, duration_s: f64) -> Vec<[f64; 3]> {
        let each = self.crossing_frequency_hz.iter();
        each.map(|f| f.map(|hertz| peak_factor(hertz, duration_s)))
            .collect()
    }
}

/// Expected greatest departure from the mean in `duration_s` of what crosses it upwards `hertz` times a second, over the root mean
/// square (Davenport 1964); 0 of what does not move. Records of less than four thirds of a crossing have the least value of the formula,
/// which would rise again.
pub fn peak_factor(hertz: f64, duration_s: f64) -> f64 {
    const EULER: f64 = 0.577_215_664_901_532_9;
    if hertz == 0.0 {
        return 0.0;
    }
    let root = (2.0 * (hertz * duration_s).max(1.0).ln()).max(EULER).sqrt();
    root + EULER / root
}

/// A part of a variance, or a rate over a displacement, which is `otherwise` where nothing moves.
pub fn part(of: f64, whole: f64, otherwise: f64) -> f64 {
    if whole > 0.0 { of / whole } else { otherwise }
}

/// Vertical, lateral and rotation of each node, one after the other.
pub(super) fn by_node(nodes: usize, of: impl Fn(usize) -> f64) -> Vec<[f64; 3]> {
    let node = |n: usize| std::array::from_fn(|i| of(3 * n + i));
    (0..nodes).map(node).collect()
}

/// One-sided spectra at one mean wind speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpectrumCurve {
    /// Mean wind speed, m/s.
    pub speed_m_s: f64,
    /// Frequencies, Hz, rising.
    pub frequency_hz: Vec<f64>,
    /// `S_u` and `S_w` in the mean wind, m²/s² per Hz; zero for a component that is left out.
    pub gust: [Vec<f64>; 2],
    /// Spectra of the displacements, m²/Hz, rad²/Hz: those of a section (n), or vertical, lateral and rotation of each node of a bridge.
    pub motion: Vec<Vec<f64>>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_of_short_records_and_of_what_is_still_are_finite() {
        assert_eq!(peak_factor(0.0, 600.0), 0.0);
        // 2 ln 60 = 8.1887
        assert!((peak_factor(0.1, 600.0) - 3.0633).abs() < 1e-4);
        let durations = [1e-3, 5.0, 10.0, 13.0, 14.0, 20.0, 100.0];
        let peaks = durations.map(|duration_s| peak_factor(0.1, duration_s));
        assert!(peaks[0] > 1.5 && peaks.is_sorted(), "{peaks:?}");
        assert_eq!(part(0.0, 0.0, 1.0), 1.0);
    }
}
