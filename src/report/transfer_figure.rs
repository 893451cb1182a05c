//! Transfer functions over frequency: magnitude and phase, models against a reference with its tolerance bands.

use super::vocabulary::{
    Axis, BLACK, Drawing, Entry, Figure, GREY, Ink, Panel, Shape, distinct, entries, index_of,
};
use crate::comparison::forces::PerModel;
use crate::error::Result;

/// A transfer function of one model, or of what was measured: abscissa, magnitude, phase in degrees.
pub(crate) type TransferCurve = PerModel<(f64, f64, f64)>;

/// One transfer function: two panels side by side.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TransferPlot {
    /// Name above the panels.
    pub name: String,
    /// What the models are compared with.
    pub reference: TransferCurve,
    /// Band around a reference of a few test points, as a part of its magnitude and in degrees; none around one that is a line.
    pub tolerance: Option<(f64, f64)>,
    /// The models.
    pub models: Vec<TransferCurve>,
}

/// Magnitude and phase of transfer functions, one per row.
///
/// Curves of one label share ink and legend entry.
///
/// # Errors
/// [`crate::Error::Input`] for no data, numbers that are not finite, and more models than colours.
pub(crate) fn transfer_figure(title: &str, plots: &[TransferPlot]) -> Result<Figure> {
    const PLACE: &str = "transfer functions";
    let labels = distinct(plots.iter().flat_map(|p| &p.models).map(|c| &c.model));
    let ink = |i: usize| Ink::nth(PLACE, i);
    let mut panels = Vec::with_capacity(2 * plots.len());
    for (plot, phase) in plots.iter().flat_map(|p| [(p, false), (p, true)]) {
        let mut panel = reference_panel(plot, phase);
        for curve in &plot.models {
            let ink = ink(index_of(&labels, &curve.model))?;
            panel.add(&curve.model, points(curve, phase), ink);
        }
        panels.push(panel);
    }
    let mut legend = Vec::new();
    if let Some(plot) = plots.first() {
        legend.push(Entry::new(&plot.reference.model, reference_ink(plot)));
        if let Some((part, degrees)) = plot.tolerance {
            let band = format!("±{:.0} %, ±{degrees:.0}° of it", 100.0 * part);
            legend.push(Entry::new(band, BAND));
        }
    }
    legend.extend(entries(&labels, ink)?);
    let axes = [330.0, if plots.len() > 2 { 150.0 } else { 240.0 }];
    let drawing = Drawing::grid(PLACE, title, panels, 2, axes, vec![legend]);
    drawing.over_one_abscissa().draw()
}

/// A panel of magnitudes or phases with the reference and the band around it.
fn reference_panel(plot: &TransferPlot, phase: bool) -> Panel {
    let y = match phase {
        true => "Phase (°)",
        false => "Magnitude (–)",
    };
    let mut panel = Panel::new(Axis::new("Frequency (Hz)").tight(), Axis::new(y));
    panel.title = Some(plot.name.clone());
    for (band, points) in bands(plot, phase) {
        panel.add(band, points, BAND);
    }
    let reference = points(&plot.reference, phase);
    panel.add(&plot.reference.model, reference, reference_ink(plot));
    panel
}

fn points(curve: &TransferCurve, phase: bool) -> Vec<(f64, f64)> {
    let value = |p: &(f64, f64, f64)| (p.0, if phase { p.2 } else { p.1 });
    curve.points.iter().map(value).collect()
}

const BAND: Ink = Ink::stroke(GREY, Some("4 3"), 0.9);

fn reference_ink(plot: &TransferPlot) -> Ink {
    match plot.tolerance {
        Some(_) => Ink::dots(BLACK, Shape::Circle),
        None => Ink::solid(BLACK, 2.6),
    }
}

/// Lower and upper edge of the band.
fn bands(plot: &TransferPlot, phase: bool) -> Vec<(&'static str, Vec<(f64, f64)>)> {
    let Some((part, degrees)) = plot.tolerance else {
        return Vec::new();
    };
    let edge = |sign: f64| {
        let at = |p: &(f64, f64, f64)| match phase {
            true => (p.0, p.2 + sign * degrees),
            false => (p.0, p.1 * (1.0 + sign * part)),
        };
        plot.reference.points.iter().map(at).collect()
    };
    vec![
        ("lower edge of the band", edge(-1.0)),
        ("upper edge of the band", edge(1.0)),
    ]
}
