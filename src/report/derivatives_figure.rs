//! Aerodynamic derivatives over the reduced velocity: measured points and fitted lines.

use super::vocabulary::{
    Axis, BLACK, Drawing, Entry, Figure, GREY, Ink, Panel, PlottedSeries, Shape, colour, dash,
    entries, labels_of,
};
use crate::error::{Error, Result};

/// One derivative (or any other quantity that is measured and fitted).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DerivativePlot {
    /// Name, e.g. `H1`: written as H₁*. Any other name stands as it is.
    pub name: String,
    /// Test points, drawn as dots; several series e.g. for several wind speeds or tests.
    pub measured: Vec<PlottedSeries>,
    /// Intervals: abscissa, lower and upper end, drawn as thin bars.
    pub bars: Vec<(f64, f64, f64)>,
    /// Fitted or computed lines, one per model.
    pub fitted: Vec<PlottedSeries>,
    /// Theory to compare with (flat plate, quasi-steady), drawn thin and black.
    pub reference: Vec<PlottedSeries>,
}

/// A grid of the derivatives over reduced velocity: four columns for up to eight, six for the eighteen.
///
/// Series of the same label share ink and legend entry over all panels. All panels have the same abscissa.
///
/// # Errors
/// [`Error::Input`] for no derivatives, one without any data, numbers that are not finite, and more labels than
/// colours.
pub fn derivatives_figure(
    title: &str,
    velocity_label: &str,
    bars_label: &str,
    all: &[DerivativePlot],
) -> Result<Figure> {
    if all.is_empty() {
        return Err(Error::input(PLACE, "at least one derivative", "none"));
    }
    let measured = labels_of(all.iter().flat_map(|d| &d.measured));
    let fitted = labels_of(all.iter().flat_map(|d| &d.fitted));
    let reference = labels_of(all.iter().flat_map(|d| &d.reference));
    let columns = if all.len() <= 8 { 4 } else { 6 }.min(all.len());
    let range = velocity_range(all);
    let mut panels = Vec::with_capacity(all.len());
    for derivative in all {
        let velocity = Axis::new(velocity_label);
        let mut panel = Panel::new(Axis { range, ..velocity }, Axis::new(""));
        panel.title = Some(starred(&derivative.name));
        panel.level = Some(0.0);
        panel.add_labelled(&derivative.reference, &reference, reference_ink)?;
        panel.add_labelled(&derivative.fitted, &fitted, fitted_ink)?;
        for (at, low, high) in &derivative.bars {
            panel.add("interval", vec![(*at, *low), (*at, *high)], BAR);
        }
        panel.add_labelled(&derivative.measured, &measured, |i| {
            measured_ink(i, measured.len())
        })?;
        panels.push(panel);
    }
    let mut legend = Vec::new();
    if all.iter().any(|d| !d.bars.is_empty()) {
        legend.push(Entry::new(bars_label, BAR));
    }
    legend.extend(entries(&measured, |i| measured_ink(i, measured.len()))?);
    legend.extend(entries(&fitted, fitted_ink)?);
    legend.extend(entries(&reference, reference_ink)?);
    let axes = match columns {
        6 => [150.0, 140.0],
        _ => [190.0, 160.0],
    };
    let drawing = Drawing::grid(PLACE, title, panels, columns, axes, vec![legend]);
    drawing.over_one_abscissa().draw()
}

const PLACE: &str = "aerodynamic derivatives";
const BAR: Ink = Ink::solid(GREY, 1.6);

fn fitted_ink(i: usize) -> Result<Ink> {
    Ink::nth(PLACE, i)
}

fn reference_ink(i: usize) -> Result<Ink> {
    Ok(Ink::stroke(BLACK, dash(i + 1), 1.1))
}

/// Black dots for one series; several in colours and shapes, from the far end of the palette, where no line is.
fn measured_ink(i: usize, count: usize) -> Result<Ink> {
    const SHAPES: [Shape; 3] = [Shape::Circle, Shape::Square, Shape::Diamond];
    let colour = match count == 1 {
        true => BLACK,
        false => colour(PLACE, (i + 3) % 7)?,
    };
    Ok(Ink {
        size: 2.7,
        ..Ink::dots(colour, SHAPES[i % SHAPES.len()])
    })
}

/// The abscissae of all panels: reduced velocities from zero, angles from the lowest.
fn velocity_range(all: &[DerivativePlot]) -> Option<(f64, f64)> {
    let (low, high) = all
        .iter()
        .flat_map(|d| d.measured.iter().chain(&d.fitted).chain(&d.reference))
        .flat_map(|s| &s.points)
        .fold((0.0, 0.0), |(low, high): (f64, f64), p| {
            (low.min(p.0), high.max(p.0))
        });
    let margin = 0.04 * (high - low);
    let first = if low < 0.0 { low - margin } else { 0.0 };
    (margin > 0.0 && margin.is_finite()).then_some((first, high + margin))
}

/// `H1` and `H1*` as H₁*; everything else as it is.
fn starred(name: &str) -> String {
    let mut characters = name.chars();
    let parts = (characters.next(), characters.next(), characters.as_str());
    if let (Some(letter @ ('P' | 'H' | 'A')), Some(digit @ '1'..='6'), "" | "*") = parts {
        let subscript = ['₁', '₂', '₃', '₄', '₅', '₆'][digit as usize - '1' as usize];
        return format!("{letter}{subscript}*");
    }
    name.to_owned()
}

#[cfg(test)]
mod tests {
    use super::starred;

    #[test]
    fn only_names_of_derivatives_get_subscripts() {
        assert_eq!(starred("H1"), "H₁*");
        assert_eq!(starred("A6*"), "A₆*");
        for name in ["H7", "c_L", "", "P", "H1 at 6 m/s", "A10"] {
            assert_eq!(starred(name), name);
        }
    }
}
