//! `aerodeck tunnel`: records of the virtual wind tunnel.

use super::stages::Stages;
use super::vocabulary::{Answer, OutputDir, Progress, Result, StudyArgs};
use std::fmt::Write as _;

/// Runs the command.
pub(crate) fn run(args: &StudyArgs, progress: &Progress) -> Result<Answer> {
    let study = args.read()?;
    let mut stages = Stages::new(study, OutputDir::new(&args.directory())?, progress)?;
    let records = stages.tunnel()?;
    let mut text = format!("{}\n{}\n", stages.study.name, stages.deck.description());
    for record in &records {
        let h = &record.header;
        let samples = record.motion.first().map_or(0, Vec::len);
        let _ = writeln!(
            text,
            "  {}: {:.2} m/s, {} frequencies, {samples} samples at {} Hz",
            h.name,
            h.mean_speed_m_s,
            h.segments.len(),
            h.sampling_hz,
        );
    }
    let headers: Vec<_> = records.iter().map(|r| r.header.clone()).collect();
    let value = serde_json::json!({ "records": headers });
    stages.out.answer(text, value)
}
