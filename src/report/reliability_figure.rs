//! Distribution of the onset speed of random sections.

use super::axis::{Axis, significant};
use super::figure::Figure;
use super::legend::Entry;
use super::panel::{Note, Panel};
use super::sheet::Sheet;
use super::style::{BLACK, Ink, Shape, colour};
use crate::error::{Error, Result};
use crate::uncertainty::monte_carlo::MonteCarloResult;

const PLACE: &str = "distribution of the onset";

/// Histogram of the onset speed (part of all answered samples in each bin) and its distribution function with the
/// quantiles, over wind speed (m/s); the onset of the model itself and the design speed are upright lines.
pub(crate) fn onset_distribution_figure(result: &MonteCarloResult) -> Result<Figure> {
    let h = &result.histogram;
    if h.counts.is_empty() {
        return Err(Error::input(PLACE, "at least one onset", "none"));
    }
    let (blue, red, green) = (colour(PLACE, 0)?, colour(PLACE, 1)?, colour(PLACE, 2)?);
    let unstable = result.unstable_at_or_below;
    let answered = (result.onsets + unstable + result.stable) as f64;
    let mut share = Panel::new(
        Axis::new("").tight(),
        Axis::new("Samples in a bin (%)").zero_based(),
    );
    let mut distribution = Panel::new(
        Axis::new("Onset speed V (m/s)").tight(),
        Axis::new("Onset at or below V (%)").zero_based(),
    );
    let (mut outline, mut steps) = (
        vec![(h.from_m_s, 0.0)],
        vec![(h.from_m_s, 100.0 * unstable as f64 / answered)],
    );
    // their onsets lie somewhere below
    let mut sum = unstable as u64;
    for (i, count) in h.counts.iter().enumerate() {
        let (low, high) = (
            h.from_m_s + h.width_m_s * i as f64,
            h.from_m_s + h.width_m_s * (i + 1) as f64,
        );
        let part = 100.0 * *count as f64 / answered;
        outline.extend([(low, part), (high, part)]);
        sum += count;
        steps.push((high, 100.0 * sum as f64 / answered));
        if i + 1 == h.counts.len() {
            outline.push((high, 0.0));
        }
    }
    share.add("histogram", outline, Ink::line(blue, None));
    distribution.add("distribution function", steps, Ink::line(blue, None));
    let known: Vec<(f64, f64)> = result
        .quantiles
        .iter()
        .filter_map(|q| Some((q.speed_m_s?, 100.0 * q.probability)))
        .collect();
    let mut legend = vec![
        Entry::new("samples", Ink::line(blue, None)),
        Entry::new("quantiles", Ink::dots(BLACK, Shape::Circle)),
    ];
    for at in &known {
        let text = format!("{} m/s", significant(at.0));
        let colour = BLACK;
        distribution.notes.push(Note {
            at: *at,
            text,
            colour,
        });
    }
    if known.is_empty() {
        legend.pop();
    } else {
        distribution.add("quantiles", known, Ink::dots(BLACK, Shape::Circle));
    }
    let upright = Some("3 3");
    if let Some(nominal) = result.nominal_m_s {
        let text = format!("model itself, {} m/s", significant(nominal));
        legend.push(Entry::new(text, Ink::line(green, upright)));
        share.uprights.push((nominal, green));
        distribution.uprights.push((nominal, green));
    }
    if let Some(d) = &result.design {
        let text = format!(
            "design speed {} m/s: probability {:.2e} ({:.2e} to {:.2e})",
            significant(d.speed_m_s),
            d.probability,
            d.lower,
            d.upper
        );
        legend.push(Entry::new(text, Ink::line(red, upright)));
        share.uprights.push((d.speed_m_s, red));
        distribution.uprights.push((d.speed_m_s, red));
    }
    Sheet {
        name: PLACE,
        title: Some(format!(
            "{}: onset of {} random sections, {} of them stable up to {:.3} m/s",
            result.model, result.samples, result.stable, result.speed_max_m_s
        )),
        panels: vec![share, distribution],
        columns: 1,
        axes: (640.0, 210.0),
        legend: vec![legend],
    }
    .draw()
}
