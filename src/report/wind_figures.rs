//! Static equilibria, and the response to turbulence: spectra, root mean squares, and envelopes along the span of a bridge.

use super::vocabulary::{Axis, BLACK, Drawing, Entry, Figure, Ink, Panel, Shape, entries};
use crate::aeroelastic::EquilibriumPath;
use crate::buffeting::{BuffetingResponse, SpectrumCurve};
use crate::error::Result;
use crate::section::Dof;
use crate::study::BuffetingStudy;
use crate::study::bridge::BridgeBuffeting;

/// Components of the turbulence in words.
const GUSTS: [&str; 2] = ["u", "w"];

/// Factor and unit in which people read a motion: degrees, or m.
pub(crate) fn shown_in(dof: Dof) -> (f64, &'static str) {
    match dof {
        Dof::Torsion => (1f64.to_degrees(), "deg"),
        Dof::Vertical | Dof::Lateral => (1.0, "m"),
    }
}

/// Name, symbol and unit of an ordinate, and the factor to that unit from m and rad.
fn ordinate(dof: Dof, before: &str) -> (String, f64) {
    let (factor, unit) = shown_in(dof);
    let label = format!("{before}{} {} ({unit})", dof.name(), dof.symbol());
    (label, factor)
}

/// Static displacements over wind speed, one panel per degree of freedom; the end of the branch is an upright.
///
/// # Errors
/// [`crate::Error::Input`] for no points and numbers that are not finite.
pub(crate) fn equilibrium_figure(
    title: &str,
    dofs: &[Dof],
    path: &EquilibriumPath,
) -> Result<Figure> {
    const PLACE: &str = "static equilibrium";
    let line = Ink::nth(PLACE, 0)?;
    let panel = |(i, dof): (usize, &Dof)| {
        let (label, factor) = ordinate(*dof, "");
        let speed = Axis::new("Wind speed V (m/s)").tight();
        let mut panel = Panel::new(speed, Axis::new(label));
        panel.level = Some(0.0);
        let points = path.points.iter();
        let points = points.map(|p| (p.speed_m_s, factor * p.displacement[i]));
        panel.add(dof.name(), points.collect(), line);
        let end = path.end.iter().map(|end| (end.speed_m_s(), BLACK));
        panel.uprights.extend(end);
        panel
    };
    let panels = dofs.iter().enumerate().map(panel).collect();
    let mut legend = vec![Entry::new("static equilibrium", line)];
    if let Some(end) = &path.end {
        let upright = Ink::stroke(BLACK, Some("3 3"), 0.9);
        legend.push(Entry::new(end.explain(), upright));
    }
    Drawing::stacked(PLACE, title, panels, 150.0, vec![legend])
}

/// Root mean squares over wind speed, one panel per degree of freedom: in all, by each component of the turbulence, and in
/// the time domain with two standard errors either way.
///
/// # Errors
/// [`crate::Error::Input`] for no points and numbers that are not finite.
pub(crate) fn buffeting_rms_figure(title: &str, study: &BuffetingStudy) -> Result<Figure> {
    const PLACE: &str = "RMS over wind speed";
    let total = Ink::nth(PLACE, 0)?;
    let parts = [Ink::nth(PLACE, 1)?, Ink::nth(PLACE, 2)?];
    let stepped = Ink::dots(BLACK, Shape::Diamond);
    let bar = Ink::solid(BLACK, 1.2);
    let blows = |j: usize| {
        let mut responses = study.responses.iter();
        responses.any(|r| r.rms_by_gust[j].iter().any(|x| *x > 0.0))
    };
    let both = blows(0) && blows(1);
    let mut panels = Vec::with_capacity(study.dofs.len());
    for (i, dof) in study.dofs.iter().enumerate() {
        let (label, factor) = ordinate(*dof, "RMS ");
        let speed = Axis::new("Wind speed V (m/s)").tight();
        let mut panel = Panel::new(speed, Axis::new(label).zero_based());
        let line = |pick: &dyn Fn(&BuffetingResponse) -> f64| -> Vec<(f64, f64)> {
            let all = study.responses.iter();
            all.map(|r| (r.speed_m_s, factor * pick(r))).collect()
        };
        panel.add("all", line(&|r| r.rms[i]), total);
        for (j, ink) in parts.iter().enumerate().filter(|_| both) {
            panel.add(GUSTS[j], line(&|r| r.rms_by_gust[j][i]), *ink);
        }
        for domain in &study.time {
            let e = &domain.ensemble;
            let (at, rms, error) = (e.speed_m_s, e.rms[i], e.standard_error[i]);
            let ends = [-2.0, 2.0].map(|s| (at, factor * (rms + s * error)));
            panel.add("standard error", ends.to_vec(), bar);
            panel.add("time domain", vec![(at, factor * rms)], stepped);
        }
        panels.push(panel);
    }
    let mut legend = vec![Entry::new("frequency domain", total)];
    if both {
        legend.push(Entry::new("by u alone", parts[0]));
        legend.push(Entry::new("by w alone", parts[1]));
    }
    if !study.time.is_empty() {
        legend.push(Entry::new("time domain, ±2 standard errors", stepped));
    }
    Drawing::stacked(PLACE, title, panels, 170.0, vec![legend])
}

/// Spectra at one wind speed, logarithmic, `f S`: of the turbulence of a section above, of each displacement below, of each of the
/// `nodes` of a bridge.
///
/// # Errors
/// [`crate::Error::Input`] for no points, more nodes than colours and numbers that are not finite.
pub(crate) fn buffeting_spectra_figure(
    title: &str,
    dofs: &[Dof],
    nodes: &[String],
    spectra: &SpectrumCurve,
) -> Result<Figure> {
    const PLACE: &str = "spectra";
    let logarithmic = |label: &str| Axis::new(label).logarithmic();
    let ink = |i: usize| Ink::nth(PLACE, i);
    let labels: Vec<String> = nodes.iter().map(|n| format!("node {n}")).collect();
    let mut legend = entries(&labels, ink)?;
    let mut panels = Vec::new();
    let add = |panel: &mut Panel, label: &str, density: &[f64], factor: f64, ink: Ink| {
        let pairs = spectra.frequency_hz.iter().zip(density);
        // zero has no place on a logarithmic scale
        let above = pairs.filter(|(f, s)| **f > 0.0 && **s > 0.0);
        let points: Vec<(f64, f64)> = above.map(|(f, s)| (*f, factor * f * s)).collect();
        let any = !points.is_empty();
        if any {
            panel.add(label, points, ink);
        }
        any
    };
    if nodes.is_empty() {
        let mut turbulence = Panel::new(logarithmic(""), logarithmic("f S of the gusts (m²/s²)"));
        for (j, density) in spectra.gust.iter().enumerate() {
            if add(&mut turbulence, GUSTS[j], density, 1.0, ink(j + 1)?) {
                legend.push(Entry::new(format!("gusts {}", GUSTS[j]), ink(j + 1)?));
            }
        }
        panels.push(turbulence);
        legend.push(Entry::new("motion", ink(0)?));
    }
    for (i, dof) in dofs.iter().enumerate() {
        let (label, factor, unit) = match dof {
            Dof::Torsion => ("f S_θ", 1f64.to_degrees().powi(2), "deg²"),
            Dof::Lateral => ("f S_x", 1.0, "m²"),
            Dof::Vertical => ("f S_y", 1.0, "m²"),
        };
        let last = i + 1 == dofs.len();
        let frequency = if last { "Frequency f (Hz)" } else { "" };
        let ordinate = logarithmic(&format!("{label} ({unit})"));
        let mut panel = Panel::new(logarithmic(frequency), ordinate);
        let of_nodes = spectra.motion.iter().skip(i).step_by(dofs.len());
        for (n, density) in of_nodes.enumerate() {
            let label = labels.get(n).map_or(dof.name(), String::as_str);
            add(&mut panel, label, density, factor, ink(n)?);
        }
        panels.push(panel);
    }
    panels.retain(|p| !p.series.is_empty());
    Drawing::stacked(PLACE, title, panels, 150.0, vec![legend])
}

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
    let inks = [Ink::nth("envelope", 0)?, Ink::nth("envelope", 1)?];
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
