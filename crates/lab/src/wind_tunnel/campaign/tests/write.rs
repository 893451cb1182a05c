//! A virtual campaign written and read back.

use super::super::*;
use crate::aerodynamics::RationalModel;
use crate::wind_tunnel::virtual_campaign::{VirtualCampaign, VirtualCampaignPlan};
use crate::wind_tunnel::{RawCampaign, RawRecording, Record, RecordFile, Rig};
use nalgebra::Vector3;
use std::path::Path;

fn made() -> VirtualCampaign {
    let mut plan = VirtualCampaignPlan::realistic();
    plan.tunnel.frequencies_hz = vec![0.5, 2.0];
    plan.tunnel.speeds_m_s = vec![8.17];
    plan.tunnel.still_s = 2.0;
    plan.tunnel.segment_s = 6.0;
    plan.tunnel.ramp_s = 2.0;
    let jones = RationalModel::jones_flat_plate();
    plan.from_model(&jones, "Jones", 0.5).unwrap()
}

/// Written to a folder and read back; what was found on the way.
fn again(made: &VirtualCampaign, format: FileFormat, folder: &Path) -> RawCampaign {
    let mut place = |name: &Path| {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        Ok(path)
    };
    write_virtual_campaign(made, format, &mut place).unwrap();
    Campaign::read(folder.join("campaign.toml"))
        .unwrap()
        .load()
        .unwrap()
}

#[test]
fn csv_reads_back_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let made = made();
    let mut reading = again(&made, FileFormat::Csv, folder.path());
    assert_eq!(reading.findings, []);
    for (run, own) in reading.runs.iter_mut().zip(&made.raw.runs) {
        assert_eq!(run.in_wind.source, format!("runs/{}-wind.csv", own.name));
        assert_eq!(run.in_wind.channels.len(), 3 + 2 * 6 + 1);
        let (still, of_still) = (run.still_air.as_mut(), own.still_air.as_ref());
        for (read, own) in [
            (&mut run.in_wind, &own.in_wind),
            (still.unwrap(), of_still.unwrap()),
        ] {
            read.source.clone_from(&own.source);
            read.channels.clear();
        }
    }
    assert_eq!(reading, made.raw);
    // the truth stands beside it
    let truth = std::fs::read_to_string(folder.path().join("truth.csv")).unwrap();
    assert_eq!(truth.lines().count(), 1 + 2 * 2 * 2);
    let file = RecordFile::open(folder.path().join("truth/Jones-torsion-8.17.csv")).unwrap();
    let record = Record::whole(&file).unwrap();
    assert_eq!(record.force, made.records[1].force);
    let applied = std::fs::read_to_string(folder.path().join("disturbances.json")).unwrap();
    assert!(applied.contains("\"force_lag_s\": 0.0017"));
}

/// Force and moment about the centre of rotation at one sample.
fn sum(rig: &Rig, recording: &RawRecording, i: usize) -> (Vector3<f64>, Vector3<f64>) {
    let theta = recording.motion[2][i];
    let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
    for (cell, c) in rig.cells.iter().zip(&recording.cells) {
        let own = cell.axes_at(theta) * Vector3::new(c[0][i], c[1][i], c[2][i]);
        force += own;
        moment += cell.axes_at(theta) * Vector3::new(c[3][i], c[4][i], c[5][i])
            + cell.position_at(theta).cross(&own);
    }
    (force, moment)
}

#[test]
fn the_layout_of_ntnu_reads_back_the_same_forces() {
    let folder = tempfile::tempdir().unwrap();
    let made = made();
    let reading = again(&made, FileFormat::Ntnu, folder.path());
    assert_eq!(reading.findings, []);
    let raw: &RawCampaign = &reading;
    assert!(raw.rig.cells.iter().all(|c| !c.turns_with_model));
    for (a, b) in raw.runs.iter().zip(&made.raw.runs) {
        assert_eq!(a.air_density_kg_m3, b.air_density_kg_m3);
        let still = [&a.still_air, &b.still_air].map(|r| r.as_ref().unwrap());
        for (a, b) in [(&a.in_wind, &b.in_wind), (still[0], still[1])] {
            assert_eq!(
                (&a.motion, &a.wind_speed_m_s),
                (&b.motion, &b.wind_speed_m_s)
            );
            for i in (0..a.sample_count()).step_by(7) {
                let (f, m) = sum(&raw.rig, a, i);
                let (f0, m0) = sum(&made.raw.rig, b, i);
                // rounding of forces of 60 N on an arm of 1.4 m
                assert!((f - f0).amax() < 1e-12 && (m - m0).amax() < 1e-12, "{i}");
            }
        }
    }
}

/// Units stand in the file as one per column, and the map has to agree with them.
#[test]
fn the_layout_of_ntnu_states_its_units() {
    let folder = tempfile::tempdir().unwrap();
    again(&made(), FileFormat::Ntnu, folder.path());
    let file = folder.path().join("runs.h5");
    let group = "Jones-vertical-8.17-wind";
    let set = crate::files::lab::ChannelSet::read(&file, Some(group)).unwrap();
    let unit = |name: &str| set.channel(name).unwrap().unit.clone().unwrap();
    assert_eq!(unit("motion[2]"), "m");
    assert_eq!(unit("motion[3]"), "rad");
    assert_eq!(unit("forces_global_coord_center[11]"), "Nm");
    assert!((set.number("temperature").unwrap() - 23.5).abs() < 1.0);
    let toml = folder.path().join("campaign.toml");
    let text = std::fs::read_to_string(&toml).unwrap();
    let map = "[channels]\ntorsion = { name = \"motion[3]\", unit = \"deg\" }\n";
    assert!(text.contains("[channels]\n"), "{text}");
    std::fs::write(&toml, text.replacen("[channels]\n", map, 1)).unwrap();
    let said = Campaign::read(&toml)
        .unwrap()
        .load()
        .unwrap_err()
        .to_string();
    assert!(
        said.contains(
            "`motion[3]`: expected the unit `rad` that the file states, found `deg` in the map"
        ),
        "{said}"
    );
}
