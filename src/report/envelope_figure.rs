//! Response of a bridge to turbulence along the span.

use super::axis::Axis;
use super::drawing::Drawing;
use super::figure::Figure;
use super::legend::Entry;
use super::panel::Panel;
use super::style::{Ink, colour, dash};
use crate::error::Result;
use crate::study::bridge::BridgeBuffeting;

/// Motions as panels name them, with the factor to the unit.
const MOTIONS: [(&str, f64); 3] = [
    ("vertical y (m)", 1.0),
    ("lateral x (m)", 1.0),
    ("rotation θ (°)", 180.0 / std::f64::consts::PI),
];

/// Mean, and mean ± peak, of every motion along the girder.
///
/// # Errors
/// [`crate::Error::Input`] for numbers that are not finite.
pub(crate) fn envelope_figure(of: &BridgeBuffeting, title: &str) -> Result<Figure> {
    let envelope = &of.envelope;
    let inks = [
        Ink::line(colour("envelope", 0)?, None),
        Ink::line(colour("envelope", 1)?, dash(1)),
    ];
    let panel = |(i, (name, factor)): (usize, (&str, f64))| {
        let along = Axis::new("Along the girder x (m)").tight();
        let mut panel = Panel::new(along, Axis::new(name));
        panel.level = Some(0.0);
        for (sign, ink) in [(0.0, inks[0]), (1.0, inks[1]), (-1.0, inks[1])] {
            let value = |n: usize| {
                let peak = envelope.peak_factor[n][i] * envelope.rms[n][i];
                factor * (envelope.mean[n][i] + sign * peak)
            };
            let places = envelope.along_m.iter().enumerate();
            panel.add(name, places.map(|(n, x)| (*x, value(n))).collect(), ink);
        }
        panel
    };
    let panels = MOTIONS.into_iter().enumerate().map(panel).collect();
    let legend = vec![
        Entry::new("mean", inks[0]),
        Entry::new("mean ± expected peak", inks[1]),
    ];
    let name = "envelope along the span";
    Drawing::stacked(name, title, panels, 130.0, vec![legend])
}
