//! Writing a virtual campaign to files that [`Campaign::read`] reads back.

use super::air::Air;
use super::channel::ChannelRef;
use super::channel_map::{ChannelMap, cell_unit};
use super::file::{
    CAMPAIGN_SCHEMA, Campaign, FileRef, RecordingBlock, RecordingLayout, RunBlock, SectionBlock,
};
use super::ntnu;
use crate::error::{Error, Result};
use crate::files::text::{csv_cell, file_name};
use crate::json;
use crate::wind_tunnel::record_file::write_rows;
use crate::wind_tunnel::virtual_campaign::VirtualCampaign;
use crate::wind_tunnel::{CELL_CHANNELS, RawRecording, RawRun, Rig, write_record};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// How recordings are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FileFormat {
    /// One CSV file per recording, channels as the cells have them: reads back bit for bit.
    Csv,
    /// One HDF5 file in the layout of NTNU's tools, forces in fixed axes.
    Ntnu,
}

/// Columns of the truth table.
const TRUTH_COLUMNS: &str = "run,motion,force,frequency_hz,k,g_real,g_imaginary";

/// Writes `campaign.toml`, the recordings, and the truth: `truth.csv` with `G` at the test points, `truth/RUN.csv`
/// with the clean records, `disturbances.json`. `place` says at which path to write each file, given its path below
/// the folder of the campaign.
pub fn write_virtual_campaign(
    made: &VirtualCampaign,
    format: FileFormat,
    place: &mut dyn FnMut(&Path) -> Result<PathBuf>,
) -> Result<()> {
    let campaign = campaign_file(made, format);
    let text = toml::to_string(&campaign).map_err(|e| Error::Numerical(e.to_string()))?;
    write_text(&place(Path::new("campaign.toml"))?, &text)?;
    match format {
        FileFormat::Csv => {
            for (run, block) in made.raw.runs.iter().zip(&campaign.runs) {
                let still = block.still_air.iter().zip(&run.still_air);
                let in_wind = std::iter::once((&block.in_wind, &run.in_wind));
                for (file, recording) in in_wind.chain(still) {
                    write_csv(recording, &made.raw.rig, &place(file.file())?)?;
                }
            }
        }
        FileFormat::Ntnu => {
            let path = place(Path::new(NTNU_FILE))?;
            ntnu::build(made)
                .write(&path)
                .map_err(|e| Error::io(&path, std::io::Error::other(e.to_string())))?;
        }
    }
    write_truth(made, place)
}

/// File of all runs in the layout of NTNU.
const NTNU_FILE: &str = "runs.h5";

fn write_text(path: &Path, text: &str) -> Result<()> {
    std::fs::write(path, text).map_err(|e| Error::io(path, e))
}

fn write_truth(
    made: &VirtualCampaign,
    place: &mut dyn FnMut(&Path) -> Result<PathBuf>,
) -> Result<()> {
    let mut table = format!("{TRUTH_COLUMNS}\n");
    for p in &made.points {
        let (run, motion, force) = (csv_cell(&p.run), p.motion.name(), p.force.name());
        let (at, g) = ([p.frequency_hz, p.k], [p.real, p.imaginary]);
        let numbers = at.iter().chain(&g).map(f64::to_string).collect::<Vec<_>>();
        table.push_str(&format!("{run},{motion},{force},{}\n", numbers.join(",")));
    }
    write_text(&place(Path::new("truth.csv"))?, &table)?;
    let runs = BTreeMap::from([("runs", &made.disturbances)]);
    let applied = json::write("disturbances", &runs)?;
    write_text(&place(Path::new("disturbances.json"))?, &applied)?;
    for record in &made.records {
        let name = format!("{}.csv", file_name(&record.header.name));
        let path = place(&Path::new("truth").join(name))?;
        let file = File::create(&path).map_err(|e| Error::io(&path, e))?;
        write_record(record, &mut BufWriter::new(file))?;
    }
    Ok(())
}

/// The campaign file of a virtual campaign.
fn campaign_file(made: &VirtualCampaign, format: FileFormat) -> Campaign {
    let raw = &made.raw;
    let first = raw.runs.first();
    let run = |run: &RawRun| {
        let file = |what: &str| match format {
            FileFormat::Csv => FileRef::File(PathBuf::from(format!(
                "runs/{}-{what}.csv",
                file_name(&run.name)
            ))),
            FileFormat::Ntnu => FileRef::Group {
                file: PathBuf::from(NTNU_FILE),
                group: format!("{}-{what}", run.name),
            },
        };
        RunBlock {
            name: run.name.clone(),
            motion: run.motion.clone(),
            in_wind: file("wind"),
            still_air: Some(file("still")),
            mean_speed_m_s: Some(run.mean_speed_m_s),
            air: Air::default(),
        }
    };
    let (air, layout, rig, channels) = match format {
        FileFormat::Csv => {
            let air = Air {
                density_kg_m3: first.map(|r| r.air_density_kg_m3),
                ..Air::default()
            };
            (air, None, raw.rig.clone(), csv_map(&raw.rig))
        }
        // the air is in the file
        FileFormat::Ntnu => {
            let (air, layout) = (Air::default(), Some(RecordingLayout::Ntnu));
            (air, layout, ntnu::rig(&raw.rig), ChannelMap::default())
        }
    };
    Campaign {
        schema: CAMPAIGN_SCHEMA,
        section: SectionBlock {
            name: raw.section.clone(),
            source: raw.source.clone(),
            licence: raw.licence.clone(),
            width_m: None,
            length_m: None,
        },
        air,
        recording: RecordingBlock {
            sampling_hz: first.map(|r| r.in_wind.sampling_hz),
            layout,
        },
        rig: Some(rig),
        channels,
        runs: raw.runs.iter().map(run).collect(),
        directory: PathBuf::new(),
    }
}

/// Name and unit of the columns of a CSV file, without the time.
fn csv_columns(rig: &Rig) -> Vec<(String, &'static str)> {
    let motion = [("vertical", "m"), ("lateral", "m"), ("torsion", "rad")];
    let own = motion.into_iter().chain([("wind_speed", "m/s")]);
    let mut columns: Vec<(String, &str)> = own.map(|(n, u)| (n.to_owned(), u)).collect();
    for cell in &rig.cells {
        for key in CELL_CHANNELS {
            let name = csv_cell(&format!("{}.{key}", cell.name));
            columns.push((name, cell_unit(key)));
        }
    }
    columns
}

fn csv_map(rig: &Rig) -> ChannelMap {
    let columns = csv_columns(rig);
    let one = |i: usize| ChannelRef::new(columns[i].0.clone(), columns[i].1);
    ChannelMap {
        time: Some(ChannelRef::new("time", "s")),
        vertical: Some(one(0)),
        lateral: Some(one(1)),
        torsion: Some(one(2)),
        wind_speed: Some(one(3)),
        cells: ChannelMap::measured_cells(rig, |cell, channel| one(4 + 6 * cell + channel)),
        ..ChannelMap::default()
    }
}

fn write_csv(recording: &RawRecording, rig: &Rig, path: &Path) -> Result<()> {
    let io = |e| Error::io(path, e);
    let mut out = BufWriter::new(File::create(path).map_err(io)?);
    let names = csv_columns(rig).into_iter();
    let names: Vec<String> = names
        .map(|(name, unit)| format!("{name} [{unit}]"))
        .collect();
    writeln!(out, "# sampling_hz: {}", recording.sampling_hz).map_err(io)?;
    writeln!(out, "time [s],{}", names.join(",")).map_err(io)?;
    let motion = recording.motion.iter();
    let channels = motion.chain([&recording.wind_speed_m_s]);
    let channels = channels.chain(recording.cells.iter().flatten());
    let channels: Vec<&[f64]> = channels.map(Vec::as_slice).collect();
    write_rows(&mut out, recording.sampling_hz, 0, &channels).map_err(io)?;
    out.flush().map_err(io)
}
