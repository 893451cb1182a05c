//! `aerodeck campaign check`: reads a campaign and says what is in it.

use crate::cli::answer::Answer;
use crate::cli::progress::Progress;
use crate::cli::text::to_tenths_of_mm;
use crate::error::{Result, counted};
use crate::wind_tunnel::campaign::{Campaign, CampaignReading, RecordingSummary};
use std::fmt::Write as _;
use std::path::Path;

/// Runs the command.
pub(crate) fn run(file: &Path, progress: &Progress) -> Result<Answer> {
    let campaign = Campaign::read(file)?;
    let reading = progress.during("reading the recordings", || campaign.load())?;
    Answer::new(
        text(&reading),
        &serde_json::json!({
            "section": reading.raw.section,
            "rig": reading.raw.rig,
            "runs": reading.runs,
            "findings": reading.findings,
        }),
    )
}

fn text(reading: &CampaignReading) -> String {
    let rig = &reading.raw.rig;
    let cells: Vec<&str> = rig.cells.iter().map(|c| c.name.as_str()).collect();
    let mut text = format!(
        "{}: model of {} m × {} m, cells {}\n",
        reading.raw.section,
        rig.model_length_m,
        to_tenths_of_mm(rig.model_width_m),
        cells.join(", ")
    );
    for run in &reading.runs {
        let motion: Vec<&str> = run.motion.iter().map(|d| d.name()).collect();
        let _ = writeln!(
            text,
            "  {}: {} motion, {:.3} m/s, {:.4} kg/m³",
            run.name,
            motion.join(", "),
            run.mean_speed_m_s,
            run.air_density_kg_m3
        );
        let still = run.still_air.iter().map(|r| ("still air", r));
        for (what, recording) in std::iter::once(("in wind", &run.in_wind)).chain(still) {
            let _ = writeln!(text, "    {what:<9} {}", described(recording));
        }
    }
    if let Some(run) = reading.runs.first() {
        let _ = writeln!(text, "  channels: {}", run.in_wind.channels.join(", "));
    }
    match reading.findings.len() {
        0 => text.push_str("nothing odd found\n"),
        n => {
            let _ = writeln!(text, "{}:", counted(n, "finding"));
            for finding in &reading.findings {
                let _ = writeln!(text, "  {finding}");
            }
        }
    }
    text
}

fn described(recording: &RecordingSummary) -> String {
    format!(
        "{}: {} samples at {} Hz ({:.1} s)",
        recording.source,
        recording.samples,
        recording.sampling_hz,
        recording.samples as f64 / recording.sampling_hz
    )
}
