//! A run before any stage: checked for what it must be before anything is computed from it, its test points found, its inertia asked for
//! the lag.

use super::lag::{Ratios, still_air_inertia};
use super::options::ProcessingOptions;
use super::report::{ClippedStretch, LAG_TURNS, RunReport};
use super::segmentation::{find_segments, moving_dof, whole_periods};
use super::signals::{HarmonicSegment, highest_hz};
use super::{body, index, lag, still_air};
use crate::error::{Error, Result, ensure, positive};
use crate::section::Dof;
use crate::signal::{check_clipping, check_finite};
use crate::wind_tunnel::{CELL_CHANNELS, RawRecording, RawRun, Rig, SAMPLES_AT_LEAST};
use std::ops::Range;

/// Of the steady periods at a frequency, still air covers at least this part.
const COVERED: f64 = 0.75;
const WEIGHT_IS_HIDDEN: &str = "the runs of the torsion motion have one frequency, which cannot tell the weight of the model from its \
                                inertia: signs and units of their channels are not judged by it";

/// A run that has been checked, with its test points and its lag.
pub(super) struct PreparedRun<'a> {
    pub run: &'a RawRun,
    /// What is known of it: segments in samples of the whole recording in wind, what still air says with the other runs of the motion.
    pub report: RunReport,
    /// In samples of the recording in still air; empty without one.
    pub still_segments: Vec<HarmonicSegment>,
    /// Forces over the motion in still air.
    pub ratios: Option<Ratios>,
}

impl<'a> PreparedRun<'a> {
    pub(crate) fn new(run: &'a RawRun, rig: &Rig, options: &ProcessingOptions) -> Result<Self> {
        let (clipped, warnings) = check_run(run, rig)?;
        let width = rig.model_width_m;
        let moving = |r: &RawRecording, what: &str| {
            let place = format!("run {}, {what}", run.name);
            moving_dof(&r.motion, width)
                .ok_or_else(|| Error::input(place, "a motion", "none that moves"))
        };
        let dof = moving(&run.in_wind, "in wind")?;
        let find = |r: &RawRecording| {
            let motion = still_air::from_rest(&r.motion[index(dof)]);
            find_segments(&motion, r.sampling_hz, &options.segments)
        };
        let segments = find(&run.in_wind);
        if segments.is_empty() {
            whole_periods(&format!("run {}, in wind", run.name), &run.in_wind, dof)?;
        }
        let mut still_segments = Vec::new();
        let mut ratios = None;
        if let Some(still) = &run.still_air {
            let in_still_air = moving(still, "still air")?;
            let place = format_args!("run {}, still air", run.name);
            let expected = format_args!("the {} motion of the recording in wind", dof.name());
            let found = format_args!("a {} motion", in_still_air.name());
            ensure(in_still_air == dof, place, expected, found)?;
            body::check_force(&run.name, rig, still, dof)?;
            still_segments = find(still);
            ratios = Some(Ratios::new(&run.name, still, rig, dof, &still_segments)?);
        }
        Ok(Self {
            run,
            report: RunReport {
                clipped,
                segments,
                warnings,
                ..RunReport::new(run, rig, dof)
            },
            still_segments,
            ratios,
        })
    }
}

impl RunReport {
    /// Segments counted from the first covered sample, their steady parts cut to the whole periods that are covered.
    pub(super) fn covered_segments(&self, covered: &Range<usize>) -> Result<Vec<HarmonicSegment>> {
        let rate = self.sampling_hz;
        let shift_s = covered.start as f64 / rate;
        let last_s = covered.len() as f64 / rate;
        let Range { start: first, end } = *covered;
        let moved = |s: &HarmonicSegment| {
            let (p, frequency) = (s.plateau.range(), s.segment.frequency_hz);
            let mut moved = *s;
            let common = p.start.max(first)..p.end.min(end);
            if common != p {
                let period = rate / frequency;
                moved.plateau.periods = (common.len() as f64 / period) as usize;
                moved.plateau.samples = (moved.plateau.periods as f64 * period).round() as usize;
            }
            let Range { start, end: last } = p;
            ensure(
                moved.plateau.periods as f64 >= COVERED * s.plateau.periods as f64,
                format_args!("run {}, still air", self.run),
                format_args!(
                    "a recording as long as the motion at {frequency:.3} Hz (samples {start} to {last})"
                ),
                format_args!("one that covers samples {first} to {end}"),
            )?;
            moved.plateau.first = common.start - first;
            moved.segment.start_s = (s.segment.start_s - shift_s).max(0.0);
            moved.segment.end_s = (s.segment.end_s - shift_s).min(last_s);
            Ok(moved)
        };
        self.segments.iter().map(moved).collect()
    }

    /// Clipped stretches of both recordings in samples from the first covered one, that in still air being aligned.
    pub(super) fn clipped_ranges(&self, covered: &Range<usize>) -> Vec<Range<usize>> {
        let place = |x: f64| (x.max(0.0) as usize).min(covered.len());
        let range = |c: &ClippedStretch| {
            let late = self.alignment.filter(|_| c.channel.starts_with(STILL_AIR));
            let late = late.map_or(0.0, |a| a.offset_samples);
            let first = c.first as f64 - late - covered.start as f64;
            place(first.floor())..place((first + c.samples as f64).ceil())
        };
        let ranges = self.clipped.iter().map(range);
        ranges.filter(|r| !r.is_empty()).collect()
    }
}

/// Asks the `runs` in which `dof` moves what still air says of the model, and judges each of them and all together.
pub(super) fn judge_still_air(
    dof: Dof,
    rig: &Rig,
    runs: &mut [&mut PreparedRun<'_>],
) -> Vec<Result<()>> {
    let ratios: Vec<_> = runs.iter().filter_map(|p| p.ratios.as_ref()).collect();
    let found = still_air_inertia(rig, dof, &ratios);
    let with_still_air = runs.iter_mut().filter(|p| p.ratios.is_some());
    let judged = with_still_air.zip(found).map(|(p, found)| {
        p.report.still_air = found?;
        let Some(found) = &p.report.still_air else {
            return Ok(());
        };
        let doubt = body::compare(&p.run.name, rig, found, p.run.air_density_kg_m3)?;
        p.report.doubts.extend(doubt);
        Ok(())
    });
    let mut judged: Vec<_> = judged.collect();
    if judged.iter().all(Result::is_ok) {
        let bodies = runs
            .iter()
            .filter_map(|p| Some((&p.run.name[..], p.report.still_air.as_ref()?)));
        let doubt = body::compare_runs(dof, bodies.collect());
        if let Some(first) = runs.first_mut().map(|first| &mut first.report) {
            let hidden = first.still_air.as_ref().filter(|s| s.hides_weight());
            let said =
                hidden.map(|s| format!("{WEIGHT_IS_HIDDEN} ({:.4} kg·m² in all)", s.inertia));
            // the weight of a model that hangs low, or a sign that is reversed
            match hidden.is_some_and(|s| s.inertia < 0.0) {
                true => first.doubts.extend(said),
                false => first.warnings.extend(said),
            }
        }
        judged.push(doubt.map(|doubt| {
            if let Some((lowest, doubt)) = doubt {
                let named = runs.iter_mut().filter(|p| p.run.name == lowest);
                named.for_each(|p| p.report.doubts.push(doubt.clone()));
            }
        }));
    }
    judged
}

/// The lag to be corrected in all `runs` and its standard error, s, both from their inertia unless it is stated.
pub(super) fn common_lag(
    runs: &mut [PreparedRun<'_>],
    options: &ProcessingOptions,
) -> (f64, Option<f64>) {
    if let Some(stated) = options.lag_s {
        return (stated, None);
    }
    let mut runs: Vec<_> = runs.iter_mut().map(|p| &mut p.report).collect();
    let inertia: Vec<_> = runs.iter().filter_map(|r| r.still_air.clone()).collect();
    let Some((lag_s, standard_error_s)) = lag::common_lag(&inertia, runs[0].sampling_hz) else {
        return (0.0, None);
    };
    let unknown =
        |r: &&mut &mut RunReport| r.still_air.as_ref().is_some_and(|s| s.damping.is_none());
    let unknown = runs.iter_mut().filter(unknown);
    let fastest =
        unknown.max_by(|a, b| highest_hz(&a.segments).total_cmp(&highest_hz(&b.segments)));
    // with a standard error the other motion tells the lag, and each run is asked what its own says
    if let (None, Some(fastest)) = (standard_error_s, fastest) {
        let highest = highest_hz(&fastest.segments);
        let turned = 360.0 * highest * lag_s;
        let said = format!(
            "the runs of a motion have one frequency, which cannot tell a lag of the force channels from damping: {:.3} ms are taken \
             for lag; were it damping, the lag would be 0 and the forces are turned by {turned:.1}° too much at {highest:.3} Hz (a \
             stated `lag_s`, or another frequency, tells)",
            1e3 * lag_s
        );
        match turned.abs() > LAG_TURNS.0 {
            true => fastest.doubts.push(said),
            false => fastest.warnings.push(said),
        }
    }
    (lag_s, standard_error_s)
}

/// Sampling frequencies that differ by less are the same, written with fewer digits.
const SAME_RATE: f64 = 1e-6;

/// What channels of the recording in still air are called first.
const STILL_AIR: &str = "still air";

/// Checks both recordings of a run: clipped stretches in wind, then in still air, and what the user should know.
///
/// # Errors
/// [`Error::Input`] naming run, recording, channel and sample: a speed or density that is not positive, no cells, too few
/// samples, channels of unequal length, numbers that are not finite, different sampling frequencies, no motion, channels
/// at their limit for more than a short while.
fn check_run(run: &RawRun, rig: &Rig) -> Result<(Vec<ClippedStretch>, Vec<String>)> {
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
        let recorded = |r: &RawRecording| !r.motion[index(dof)].is_empty();
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
