//! Distribution of the onset speed of random sections.

use super::axis::significant;
use super::vocabulary::{Axis, BLACK, Drawing, Entry, Figure, Ink, Note, Panel, Shape, colour};
use crate::error::{Error, Result};
use crate::uncertainty::monte_carlo::MonteCarloResult;

const PLACE: &str = "distribution of the onset";

/// Histogram of the onset speed (part of all answered samples in each bin) and its distribution function with the
/// quantiles, over wind speed (m/s); the onset of the model itself and the design speed are upright lines.
pub(crate) fn onset_distribution_figure(result: &MonteCarloResult) -> Result<Figure> {
    if result.histogram.counts.is_empty() {
        return Err(Error::input(PLACE, "at least one onset", "none"));
    }
    let samples = Ink::line(colour(PLACE, 0)?, None);
    let panel = |x, y| Panel::new(Axis::new(x).tight(), Axis::new(y).zero_based());
    let mut share = panel("", "Samples in a bin (%)");
    let mut distribution = panel("Onset speed V (m/s)", "Onset at or below V (%)");
    let (outline, steps) = curves(result);
    share.add("histogram", outline, samples);
    distribution.add("distribution function", steps, samples);
    let mut legend = vec![Entry::new("samples", samples)];
    legend.extend(mark_quantiles(result, &mut distribution));
    for (speed, text, i) in known_speeds(result) {
        let colour = colour(PLACE, i)?;
        legend.push(Entry::new(text, Ink::line(colour, Some("3 3"))));
        for panel in [&mut share, &mut distribution] {
            panel.uprights.push((speed, colour));
        }
    }
    let (model, samples, counts) = (&result.model, result.samples, result.counts_in_words());
    Drawing {
        name: PLACE,
        title: Some(format!("{model}: {samples} random sections, {counts}")),
        panels: vec![share, distribution],
        columns: 1,
        axes: [640.0, 210.0],
        legend: vec![legend],
    }
    .draw()
}

/// Points over wind speed, per cent.
type Curve = Vec<(f64, f64)>;

/// Outline of the histogram, and the distribution function, of all samples.
fn curves(result: &MonteCarloResult) -> (Curve, Curve) {
    let (h, unstable) = (&result.histogram, result.unstable_at_or_below);
    let percent = |count: u64| 100.0 * count as f64 / result.samples as f64;
    let edge = |i: usize| h.from_m_s + h.width_m_s * i as f64;
    // their onsets lie somewhere below
    let mut sum = unstable as u64;
    let (mut outline, mut steps) = (vec![(edge(0), 0.0)], vec![(edge(0), percent(sum))]);
    for (i, count) in h.counts.iter().enumerate() {
        outline.extend([(edge(i), percent(*count)), (edge(i + 1), percent(*count))]);
        sum += count;
        steps.push((edge(i + 1), percent(sum)));
    }
    outline.push((edge(h.counts.len()), 0.0));
    (outline, steps)
}

/// The quantiles that have a speed, each with its number; their entry of the legend, if there are any.
fn mark_quantiles(result: &MonteCarloResult, panel: &mut Panel) -> Option<Entry> {
    let quantiles = result.quantiles.iter();
    let known = quantiles.filter_map(|q| Some((q.speed_m_s?, 100.0 * q.probability)));
    let known: Curve = known.collect();
    panel.notes.extend(known.iter().map(|at| Note {
        at: *at,
        text: format!("{} m/s", significant(at.0)),
        colour: BLACK,
    }));
    let ink = Ink::dots(BLACK, Shape::Circle);
    let entry = (!known.is_empty()).then(|| Entry::new("quantiles", ink));
    if entry.is_some() {
        panel.add("quantiles", known, ink);
    }
    entry
}

/// Onset of the model itself and design speed, with what the legend says and the number of their colour.
fn known_speeds(result: &MonteCarloResult) -> Vec<(f64, String, usize)> {
    let nominal = result.nominal_m_s.map(|speed| {
        let text = format!("model itself, {} m/s", significant(speed));
        (speed, text, 2)
    });
    let design = result.design.as_ref().map(|d| {
        let (speed, part, low, high) = (significant(d.speed_m_s), d.probability, d.lower, d.upper);
        let text =
            format!("design speed {speed} m/s: probability {part:.2e} ({low:.2e} to {high:.2e})");
        (d.speed_m_s, text, 1)
    });
    nominal.into_iter().chain(design).collect()
}
