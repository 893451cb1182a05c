//! What a raw run must be before anything is computed from it.

use crate::error::{Result, ensure, positive};
use crate::section::Dof;
use crate::signal::{check_clipping, check_finite};
use crate::wind_tunnel::{CELL_CHANNELS, RawRecording, RawRun, Rig, SAMPLES_AT_LEAST};
use serde::{Deserialize, Serialize};

/// Sampling frequencies that differ by less are the same, written with fewer digits.
const SAME_RATE: f64 = 1e-6;

/// What channels of the recording in still air are called first.
const STILL_AIR: &str = "still air";

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

impl ClippedStretch {
    /// Whether it is of the recording in still air.
    pub(super) fn is_in_still_air(&self) -> bool {
        self.channel.starts_with(STILL_AIR)
    }
}

/// Checks both recordings of a run: clipped stretches in wind, then in still air, and what the user should know.
///
/// # Errors
/// [`Error::Input`] naming run, recording, channel and sample: a speed or density that is not positive, no cells, too few
/// samples, channels of unequal length, numbers that are not finite, different sampling frequencies, no motion, channels
/// at their limit for more than a short while.
pub(super) fn check_run(run: &RawRun, rig: &Rig) -> Result<(Vec<ClippedStretch>, Vec<String>)> {
    let place = |what: &str| format!("run {}, {what}", run.name);
    positive(place("mean wind speed"), run.mean_speed_m_s)?;
    positive(place("air density"), run.air_density_kg_m3)?;
    let wind = &run.in_wind;
    check_recording(&place("in wind"), wind, rig)?;
    let mut clipped_stretches = clipped(&run.name, "in wind", wind, rig)?;
    let mut warnings = Vec::new();
    if let Some(still) = &run.still_air {
        check_recording(&place("still air"), still, rig)?;
        check_pair(&run.name, wind, still)?;
        clipped_stretches.extend(clipped(&run.name, STILL_AIR, still, rig)?);
        let (in_wind, in_still) = (wind.sample_count(), still.sample_count());
        if in_wind != in_still {
            warnings.push(format!(
                "{in_wind} samples in wind, {in_still} in still air: only the part that both cover is used"
            ));
        }
    }
    let channels = clipped_stretches.chunk_by(|a, b| a.channel == b.channel);
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
    let same = (f1 / f2 - 1.0).abs() <= SAME_RATE;
    let expected = format_args!("the sampling frequency of the recording in wind, {f1} Hz");
    ensure(same, place("still air"), expected, format_args!("{f2} Hz"))?;
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
        all.push((format!("{} motion", dof.name()), &samples[..]));
    }
    all.retain(|(_, samples)| !samples.is_empty());
    for (cell, channels) in rig.cells.iter().zip(&recording.cells) {
        for (name, samples) in CELL_CHANNELS.iter().zip(channels) {
            all.push((format!("cell {}, {name}", cell.name), &samples[..]));
        }
    }
    if !recording.wind_speed_m_s.is_empty() {
        all.push(("wind speed".to_owned(), &recording.wind_speed_m_s));
    }
    all
}

fn check_recording(place: &str, recording: &RawRecording, rig: &Rig) -> Result<()> {
    let rate = format!("{place}, sampling frequency");
    positive(rate, recording.sampling_hz)?;
    let (cells, found) = (rig.cells.len(), recording.cells.len());
    let expected = format_args!("{cells} load cells, at least one");
    ensure(found == cells && cells > 0, place, expected, found)?;
    let any_moves = recording.motion.iter().any(|c| !c.is_empty());
    ensure(any_moves, place, "a motion channel", "none")?;
    let count = recording.sample_count();
    let expected = format_args!("at least {SAMPLES_AT_LEAST} samples");
    ensure(count >= SAMPLES_AT_LEAST, place, expected, count)?;
    let expected = format_args!("{count} samples, as the first force channel");
    for (name, samples) in channels(recording, rig) {
        let (place, found) = (format!("{place}, {name}"), samples.len());
        ensure(found == count, &place, expected, found)?;
        check_finite(&place, 0, samples)?;
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
        for (first, samples) in stretches {
            let channel = channel.clone();
            found.push(ClippedStretch {
                channel,
                first,
                samples,
            });
        }
    }
    Ok(found)
}
