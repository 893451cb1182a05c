//! `aerodeck tunnel`: records of the virtual wind tunnel.

use super::stages;
use super::vocabulary::{Answer, OutputDir, Progress, Result, StudyArgs};
use crate::study::Deck;
use std::fmt::Write as _;

/// Runs the command.
pub(crate) fn run(args: &StudyArgs, progress: &Progress) -> Result<Answer> {
    let study = args.read()?;
    let deck = Deck::load(&study)?;
    let mut out = OutputDir::new(&args.directory())?;
    let records = stages::tunnel(&study, &deck, &mut out, progress)?;
    let mut text = format!("{}\n{}\n", study.name, deck.description());
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
    out.answer(text, serde_json::json!({ "records": headers }))
}
