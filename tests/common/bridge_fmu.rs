//! The FMUs of the Langenuen bridge: the whole of it, its forces alone, and a system of its parts.

use crate::bridges::{SEARCH, TWO, coupled, langenuen, lively, onset};
use crate::patchwork::patchwork;
use aerodeck::aerodynamics::RationalAdmittance;
use aerodeck::flutter::find_onset;
use aerodeck::fmu::force_options::{ForceOptions, StripOptions};
use aerodeck::fmu::package::{
    Export, FmiVersion, Label, Runtime, package, write_archive, write_fmu,
};
use aerodeck::study::bridge::motion_at_onset;
use aerodeck::study::bridge::{BridgeExportOptions, BridgeStudy};
use serde_json::json;
use std::fs;
use std::path::{Path, PathBuf};

/// Writes `bridge.fmu`, `bridge_force.fmu` and, in `bridge.json`, the structure and the onset by eigenvalues.
pub fn export(folder: &Path, runtimes: &[Runtime]) {
    let study = langenuen("LN21-5200", TWO);
    let wanted = BridgeExportOptions {
        nodes: ["1156", "1081"].map(String::from).to_vec(),
        ..BridgeExportOptions::default()
    };
    let (model, export) = study.export(&wanted).unwrap();
    for (name, version) in [
        ("bridge", FmiVersion::Two),
        ("bridge_fmi3", FmiVersion::Three),
    ] {
        let export = Export {
            version,
            ..export.clone()
        };
        let bytes = package(&model, runtimes, export).unwrap();
        let path = folder.join(format!("{name}.fmu"));
        write_archive(&path, &bytes, false).unwrap();
    }
    gusts(folder, runtimes);
    sections(folder, runtimes);
    system(folder.join("bridge.ssp"), &study, runtimes);
    let bridge = &study.by_model;
    let strip = |node: &aerodeck::bridge::Node| StripOptions {
        width_m: bridge.width_m(),
        length_m: node.length_m,
        wind_factor: 1.0,
        model: 0,
    };
    let options = ForceOptions {
        strips: bridge.nodes.iter().map(strip).collect(),
        named_strips: true,
        ..ForceOptions::single(bridge.width_m())
    };
    let force = Export {
        force: Some(options),
        ..Export::default()
    };
    let fmu = folder.join("bridge_force.fmu");
    write_fmu(&fmu, &model, runtimes, false, force).unwrap();
    let section = coupled(bridge);
    let onset = &onset(find_onset("bridge", &section, &SEARCH, None).unwrap()).at;
    let motion = motion_at_onset(bridge, &bridge.forces(), onset).unwrap();
    // coordinates of the modes in the order of the bridge
    let flutter: Vec<[f64; 2]> = bridge
        .modes
        .iter()
        .map(|m| {
            let share = motion.modes.iter().find(|s| s.mode == m.number).unwrap();
            let size = (share.energy_share / m.generalised_mass).sqrt();
            let (sin, cos) = share.phase_deg.to_radians().sin_cos();
            [size * cos, size * sin]
        })
        .collect();
    let text = json!({
        "flutter": flutter,
        "onset_m_s": onset.speed_m_s,
        "frequency_hz": onset.frequency_hz,
        "nodes": bridge.nodes,
        "modes": bridge.modes,
    });
    fs::write(folder.join("bridge.json"), text.to_string()).unwrap();
}

/// Writes the system of a bridge.
fn system(path: PathBuf, study: &BridgeStudy, runtimes: &[Runtime]) {
    let (all, verdict) = (BridgeExportOptions::default(), study.verdict().unwrap());
    let system = study.system(&all, &verdict, runtimes, &Label::default());
    let bytes = system.unwrap().package().unwrap();
    write_archive(&path, &bytes, false).unwrap();
}

/// Writes the forces on a bridge of several sections in both versions, its system and, in `sections.json`, its onset by eigenvalues.
fn sections(folder: &Path, runtimes: &[Runtime]) {
    let study = patchwork();
    system(folder.join("sections.ssp"), &study, runtimes);
    let wanted = BridgeExportOptions::default();
    let gusts = Some(RationalAdmittance::Sears);
    let each = study
        .section_forces(&study.export(&wanted).unwrap().0, gusts)
        .unwrap();
    let all = study.joined(each).unwrap();
    for (name, version) in [
        ("sections_force", FmiVersion::Two),
        ("sections_force_fmi3", FmiVersion::Three),
    ] {
        let export = all.packed(&Label::default(), version);
        let path = folder.join(format!("{name}.fmu"));
        write_fmu(&path, &all.model, runtimes, false, export).unwrap();
    }
    let section = coupled(&study.by_model);
    let onset = onset(find_onset("bridge", &section, &SEARCH, None).unwrap()).at;
    let text = json!({ "onset_m_s": onset.speed_m_s, "frequency_hz": onset.frequency_hz });
    fs::write(folder.join("sections.json"), text.to_string()).unwrap();
}

/// Writes `bridge_gusts.fmu`: every node with forces of its own and with gusts of its own, and a little turbulence.
fn gusts(folder: &Path, runtimes: &[Runtime]) {
    let study = lively();
    let block = study.buffeting_block().unwrap();
    let mut field = study.first_field(&block, 35.0).unwrap();
    field
        .gusts
        .iter_mut()
        .flatten()
        .for_each(|row| row.truncate(50));
    let wanted = BridgeExportOptions {
        nodes: study
            .by_model
            .nodes
            .iter()
            .map(|n| n.name.clone())
            .collect(),
        gust_strips: Some(study.by_model.nodes.len()),
        turbulence: Some(field),
        ..BridgeExportOptions::default()
    };
    let (model, export) = study.export(&wanted).unwrap();
    let bytes = package(&model, runtimes, export).unwrap();
    write_archive(&folder.join("bridge_gusts.fmu"), &bytes, false).unwrap();
}
