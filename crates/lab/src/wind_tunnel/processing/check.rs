//! What a raw run must be before anything is computed from it.

use crate::error::{Result, ensure, positive};
use crate::section::Dof;
use crate::signal::{check_clipping, check_finite};
use crate::wind_tunnel::{CELL_CHANNELS, RawRecording, RawRun, Rig, SAMPLES_AT_LEAST};
use serde::{Deserialize, Serialize};

/// Sampling frequencies that differ by less are the same, written with fewer digits.
const SAME_RATE: f64 = 1e-6;

/// A stretch in which a channel stood at its limit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ClippedStretch {
    /// Channel, with the recording it is of.
    pub channel: String,
    /// First sample.
    pub first: usize,
    /// Number of samples.
    pub samples: usize,
}

/// Checks both recordings of a run: clipped stretches in wind and in still air, and what the user should know.
///
/// # Errors
/// [`Error::Input`] naming run, recording, channel and sample: a speed or density that is not positive, no cells, too few
/// samples, channels of unequal length, numbers that are not finite, different sampling frequencies, no motion, channels
/// at their limit for more than a short while.
pub(super) fn check_run(
    run: &RawRun,
    rig: &Rig,
) -> Result<([Vec<ClippedStretch>; 2], Vec<String>)> {
    let place = |what: &str| format!("run {}, {what}", run.name);
    positive(place("mean wind speed"), run.mean_speed_m_s)?;
    positive(place("air density"), run.air_density_kg_m3)?;
    let wind = &run.in_wind;
    check_recording(&place("in wind"), wind, rig)?;
    let mut clipped_stretches = [clipped(&run.name, "in wind", wind, rig)?, Vec::new()];
    let mut warnings = Vec::new();
    if let Some(still) = &run.still_air {
        check_recording(&place("still air"), still, rig)?;
        check_pair(&run.name, wind, still)?;
        clipped_stretches[1] = clipped(&run.name, "still air", still, rig)?;
        if wind.sample_count() != still.sample_count() {
            warnings.push(format!(
                "{} samples in wind, {} in still air: only the part that both cover is used",
                wind.sample_count(),
                still.sample_count()
            ));
        }
    }
    let channels = clipped_stretches
        .iter()
        .flat_map(|c| c.chunk_by(|a, b| a.channel == b.channel));
    warnings.extend(channels.map(|stretches| {
        let samples: usize = stretches.iter().map(|c| c.samples).sum();
        format!(
            "{}: {samples} samples from sample {} on stand at the limit of the channel; they are replaced",
            stretches[0].channel, stretches[0].first
        )
    }));
    Ok((clipped_stretches, warnings))
}

/// Checks that the two recordings of a run can be of one motion.
fn check_pair(run: &str, wind: &RawRecording, still: &RawRecording) -> Result<()> {
    let place = |what: &str| format!("run {run}, {what}");
    let (f1, f2) = (wind.sampling_hz, still.sampling_hz);
    ensure(
        (f1 / f2 - 1.0).abs() <= SAME_RATE,
        place("still air"),
        format_args!("the sampling frequency of the recording in wind, {f1} Hz"),
        format_args!("{f2} Hz"),
    )?;
    for dof in Dof::THREE {
        let recorded = |r: &RawRecording| !r.motion[super::index(dof)].is_empty();
        let (with, without) = match recorded(wind) {
            true => ("in wind", "still air"),
            false => ("still air", "in wind"),
        };
        let expected = format_args!("a {} motion channel, as {with}", dof.name());
        let both = recorded(wind) == recorded(still);
        ensure(both, place(without), expected, "none")?;
    }
    Ok(())
}

/// Channels of a recording with their names.
fn channels<'a>(recording: &'a RawRecording, rig: &'a Rig) -> Vec<(String, &'a [f64])> {
    let mut all = Vec::new();
    for (dof, samples) in Dof::THREE.iter().zip(&recording.motion) {
        if !samples.is_empty() {
            all.push((format!("{} motion", dof.name()), samples.as_slice()));
        }
    }
    for (cell, channels) in rig.cells.iter().zip(&recording.cells) {
        for (name, samples) in CELL_CHANNELS.iter().zip(channels) {
            all.push((format!("cell {}, {name}", cell.name), samples.as_slice()));
        }
    }
    if !recording.wind_speed_m_s.is_empty() {
        all.push(("wind speed".to_owned(), &recording.wind_speed_m_s));
    }
    all
}

fn check_recording(place: &str, recording: &RawRecording, rig: &Rig) -> Result<()> {
    positive(
        format!("{place}, sampling frequency"),
        recording.sampling_hz,
    )?;
    ensure(
        recording.cells.len() == rig.cells.len() && !rig.cells.is_empty(),
        place,
        format_args!("{} load cells, at least one", rig.cells.len()),
        recording.cells.len(),
    )?;
    ensure(
        recording.motion.iter().any(|c| !c.is_empty()),
        place,
        "a motion channel",
        "none",
    )?;
    let count = recording.sample_count();
    ensure(
        count >= SAMPLES_AT_LEAST,
        place,
        format_args!("at least {SAMPLES_AT_LEAST} samples"),
        count,
    )?;
    for (name, samples) in channels(recording, rig) {
        ensure(
            samples.len() == count,
            format_args!("{place}, {name}"),
            format_args!("{count} samples, as the first force channel"),
            samples.len(),
        )?;
        check_finite(&format!("{place}, {name}"), 0, samples)?;
    }
    Ok(())
}

fn clipped(
    run: &str,
    what: &str,
    recording: &RawRecording,
    rig: &Rig,
) -> Result<Vec<ClippedStretch>> {
    let mut found = Vec::new();
    for (name, samples) in channels(recording, rig) {
        let channel = format!("{what}, {name}");
        let stretches = check_clipping(&format!("run {run}, {channel}"), 0, samples)?;
        found.extend(stretches.iter().map(|(first, samples)| ClippedStretch {
            channel: channel.clone(),
            first: *first,
            samples: *samples,
        }));
    }
    Ok(found)
}
