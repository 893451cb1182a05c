//! `aerodeck bridge show`: modes, similarities, what is stated.

use super::files::BridgeArgs;
use super::summary::main_motion;
use crate::bridge::BridgeMode;
use crate::cli::figures;
use crate::cli::vocabulary::{Answer, Progress, Result, TextTable, counted};
use crate::report::modes_figure;
use std::fmt::Write as _;

/// Pairs of modes whose similarity is stated.
const PAIRS: usize = 10;

/// Runs the command.
pub(super) fn run(args: &BridgeArgs, progress: &Progress) -> Result<Answer> {
    let study = args.study(progress)?;
    let mut out = args.out()?;
    let bridge = &study.by_model;
    let title = format!(
        "{}: modes without wind, the largest displacement of each is 1",
        study.file.name
    );
    figures::write("modes", &mut out, || modes_figure(bridge, &title))?;
    let length: f64 = bridge.nodes.iter().map(|n| n.length_m).sum();
    let (nodes, modes) = (
        counted(bridge.nodes.len(), "node"),
        counted(bridge.modes.len(), "mode"),
    );
    let (name, groups) = (&study.file.name, counted(bridge.groups.len(), "group"));
    let mut text = format!("{name}: {nodes} over {length:.1} m, {modes}, {groups} of strips\n\n");
    let mut table = TextTable::new(">mode | >f Hz | >mass kg | >ζ % | main motion");
    for m in &bridge.modes {
        table.row([
            m.number.to_string(),
            format!("{:.4}", m.frequency_hz),
            format!("{:.6e}", m.generalised_mass),
            format!("{:.3}", 100.0 * m.damping_ratio),
            main_motion(bridge, m).to_owned(),
        ]);
    }
    text.push_str(&table.text());
    for d in &bridge.dampers.masses {
        let (name, mass, hertz, percent) =
            (&d.name, d.mass_kg, d.frequency_hz, 100.0 * d.damping_ratio);
        let (motion, offset) = (d.at.motion.name(), d.at.offset_m);
        text += &format!(
            "{name}: {mass} kg, {hertz} Hz, ζ {percent} %, {motion}, {offset} m downwind of the axis\n"
        );
    }
    for l in &bridge.dampers.links {
        let (motion, c) = (l.at.motion.name(), l.coefficient);
        let _ = writeln!(text, "{}: {motion}, {c} N·s/m (N·m·s/rad)", l.name);
    }
    let similarities = study.similarities();
    text.push_str("\nSimilarity of vertical and torsional modes, (∫φ_y φ_θ)²/(∫φ_y² ∫φ_θ²); a section study assumes 1:\n");
    for s in similarities.iter().take(PAIRS) {
        let (y, theta, similarity) = (s.vertical_mode, s.torsional_mode, s.similarity);
        text += &format!("  modes {y:>3} and {theta:>3}: {similarity:.4}\n");
    }
    let mode = |m: &BridgeMode| {
        serde_json::json!({
            "mode": m.number, "frequency_hz": m.frequency_hz, "generalised_mass": m.generalised_mass,
            "damping_ratio": m.damping_ratio
        })
    };
    let modes: Vec<_> = bridge.modes.iter().map(mode).collect();
    let json = serde_json::json!({
        "name": study.file.name, "nodes": bridge.nodes.len(), "modes": modes, "dampers": bridge.dampers, "similarities": similarities,
        "notes": study.warnings(), "findings": study.findings
    });
    out.answer(text, json)
}
