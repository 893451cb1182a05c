//! What the user should know of a run that could be processed.

use super::options::ProcessingOptions;
use super::report::RunReport;

/// A lag of one run is off that of the campaign when it is this many standard errors and a fiftieth of a sample away.
const LAG_OFF: (f64, f64) = (5.0, 0.02);
/// Amplitudes in wind and in still air may differ by this fraction without a warning.
const SAME_AMPLITUDE: f64 = 0.01;

/// Warnings from the figures of the report, besides those that are in it.
pub(super) fn warn(report: &mut RunReport, options: &ProcessingOptions) {
    let mut warnings = Vec::new();
    if report.segments.is_empty() {
        warnings.push("no stretch of harmonic motion: no test points".into());
    }
    let rate = report.sampling_hz;
    match &report.still_air {
        Some(s) if s.tells_lag(rate) => {
            let off = (s.lag_s - report.lag_corrected_s).abs();
            let (errors, samples) = LAG_OFF;
            if off > errors * s.lag_standard_error_s && off * rate > samples {
                warnings.push(format!(
                    "its own inertia says a lag of {:.3} ms, {:.3} ms were corrected",
                    1e3 * s.lag_s,
                    1e3 * report.lag_corrected_s
                ));
            }
        }
        _ if options.lag_s.is_none() && report.alignment.is_some() => warnings
            .push("the inertia in still air is too small to tell the lag of the channels".into()),
        _ => {}
    }
    let ratio = report.alignment.map_or(1.0, |a| a.amplitude_ratio);
    if (ratio - 1.0).abs() > SAME_AMPLITUDE {
        warnings.push(format!(
            "the motion in wind is {ratio:.4} times that in still air: inertia is not removed exactly"
        ));
    }
    warnings.extend(report.low_pass.as_ref().and_then(|l| l.warning()));
    for r in &report.replaced {
        warnings.push(format!(
            "samples {} to {} ({:.2} s) replaced: {}",
            r.first,
            r.first + r.samples - 1,
            r.start_s,
            r.reason
        ));
    }
    report.warnings.extend(warnings);
}
