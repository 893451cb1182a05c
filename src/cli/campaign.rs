//! `aerodeck campaign`: raw wind-tunnel campaigns.

mod virtual_campaign;

use super::vocabulary::{Answer, Dof, Progress, Result, counted};
use crate::cli::text::to_tenths_of_mm;
use crate::wind_tunnel::campaign::Campaign;
use crate::wind_tunnel::{RawCampaign, RawRecording};
use serde_json::json;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Raw wind-tunnel campaigns: check the files of a laboratory, or invent a campaign with a known truth
#[derive(clap::Subcommand)]
pub(crate) enum CampaignCommand {
    /// Read a campaign file and all recordings it names: runs, channels, lengths, rates, speeds, densities, findings
    ///
    /// Example: aerodeck campaign check campaign.toml
    #[command(verbatim_doc_comment)]
    Check {
        /// The campaign file.
        campaign: PathBuf,
    },
    Virtual(virtual_campaign::VirtualCampaignArgs),
}

/// Runs the command.
pub(crate) fn run(command: &CampaignCommand, progress: &Progress) -> Result<Answer> {
    match command {
        CampaignCommand::Check { campaign } => check(campaign, progress),
        CampaignCommand::Virtual(args) => virtual_campaign::run(args, progress),
    }
}

/// Reads a campaign and says what is in it.
fn check(file: &Path, progress: &Progress) -> Result<Answer> {
    let campaign = Campaign::read(file)?;
    let raw = progress.during("reading the recordings", || campaign.load())?;
    let recording = |r: &RawRecording| {
        json!({
            "source": r.source,
            "samples": r.sample_count(),
            "sampling_hz": r.sampling_hz,
            "channels": r.channels,
        })
    };
    let runs = raw.runs.iter().map(|run| {
        json!({
            "name": run.name,
            "motion": run.motion,
            "mean_speed_m_s": run.mean_speed_m_s,
            "air_density_kg_m3": run.air_density_kg_m3,
            "in_wind": recording(&run.in_wind),
            "still_air": run.still_air.as_ref().map(recording),
        })
    });
    let value = json!({
        "section": raw.section,
        "rig": raw.rig,
        "runs": runs.collect::<Vec<_>>(),
        "findings": raw.findings,
    });
    Answer::new(text(&raw), &value)
}

fn text(raw: &RawCampaign) -> String {
    let rig = &raw.rig;
    let cells: Vec<&str> = rig.cells.iter().map(|c| c.name.as_str()).collect();
    let (section, cells) = (&raw.section, cells.join(", "));
    let (length, width) = (rig.model_length_m, to_tenths_of_mm(rig.model_width_m));
    let mut text = format!("{section}: model of {length} m × {width} m, cells {cells}\n");
    for run in &raw.runs {
        let (name, motion) = (&run.name, Dof::names(&run.motion));
        let (speed, density) = (run.mean_speed_m_s, run.air_density_kg_m3);
        text += &format!("  {name}: {motion} motion, {speed:.3} m/s, {density:.4} kg/m³\n");
        let still = run.still_air.iter().map(|r| ("still air", r));
        for (what, recording) in std::iter::once(("in wind", &run.in_wind)).chain(still) {
            let _ = writeln!(text, "    {what:<9} {}", described(recording));
        }
    }
    if let Some(run) = raw.runs.first() {
        let _ = writeln!(text, "  channels: {}", run.in_wind.channels.join(", "));
    }
    match raw.findings.len() {
        0 => text.push_str("nothing odd found\n"),
        n => {
            let _ = writeln!(text, "{}:", counted(n, "finding"));
            let findings = raw.findings.iter();
            text.extend(findings.map(|finding| format!("  {finding}\n")));
        }
    }
    text
}

fn described(recording: &RawRecording) -> String {
    let (samples, rate) = (recording.sample_count(), recording.sampling_hz);
    let seconds = samples as f64 / rate;
    format!(
        "{}: {samples} samples at {rate} Hz ({seconds:.1} s)",
        recording.source
    )
}
