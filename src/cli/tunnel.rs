//! `aerodeck tunnel`: records of the virtual wind tunnel.

use super::stages::Stages;
use super::vocabulary::{Answer, OutputDir, Progress, Result, StudyArgs};

/// Runs the command.
pub(crate) fn run(args: &StudyArgs, progress: &Progress) -> Result<Answer> {
    let study = args.read()?;
    let mut stages = Stages::new(study, OutputDir::new(&args.directory())?, progress)?;
    let records = stages.tunnel()?;
    let mut text = format!("{}\n{}\n", stages.study.name, stages.deck.description());
    for record in &records {
        let h = &record.header;
        let samples = record.motion.first().map_or(0, Vec::len);
        let (name, speed, rate) = (&h.name, h.mean_speed_m_s, h.sampling_hz);
        let tested = format!(
            "{} frequencies, {samples} samples at {rate} Hz",
            h.segments.len()
        );
        text += &format!("  {name}: {speed:.2} m/s, {tested}\n");
    }
    let headers: Vec<_> = records.iter().map(|r| r.header.clone()).collect();
    let value = serde_json::json!({ "records": headers });
    stages.out.answer(text, value)
}
