//! What is odd in a recording but does not stop reading it: clipped or silent channels, speeds and motions that do not fit
//! what is stated, units that were probably not meant; and where a channel is no number.

use super::file::Campaign;
use crate::error::{Error, Result, ensure};
use crate::plausibility::{
    DECK_WIDTH, Finding, FindingSeverity, Limits, MODEL_LENGTH, MODEL_WIDTH, SAMPLING, WIND_SPEED,
    beyond, ratio_hint,
};
use crate::section::Dof;
use crate::signal::{
    clipped_stretches, extremes, largest_magnitude, mean, mean_and_deviation, median,
};
use crate::wind_tunnel::{RawRun, RunFinding};

/// A motion that should not be there may have this part of the one that should, both dimensionless.
const OTHER_MOTION_AT_MOST: f64 = 0.05;
/// Air of a laboratory, from 3500 m above the sea to frost at its level.
const AIR_OF_A_LABORATORY: Limits = Limits {
    unit: "kg/m³",
    usual: (0.75, 1.33),
    meant: &[("g/m³", 1e-3)],
};
/// Stated and measured mean speed may differ by this part.
const SPEED_OFF_AT_MOST: f64 = 0.05;
/// Beyond this part one of them is not the speed of the run: derivatives go with its square.
const ANOTHER_SPEED: f64 = 0.2;

/// First stretch of samples that are no numbers: where it begins and how long it is.
pub(super) fn first_gap(samples: &[f64]) -> Option<(usize, usize)> {
    let first = samples.iter().position(|x| !x.is_finite())?;
    let gap = samples[first..].iter().take_while(|x| !x.is_finite());
    Some((first, gap.count()))
}

/// What is odd about one channel: clipped at its highest or lowest value, or not moving at all where it should.
pub(super) fn channel_findings(
    run: &str,
    recording: &str,
    name: &str,
    samples: &[f64],
    must_change: bool,
) -> Vec<RunFinding> {
    let finding = |stretch, what| RunFinding::of_channel(run, recording, name, stretch, what);
    let (low, high) = extremes(samples.iter().copied());
    if low == high {
        let silent = finding(None, format!("is {low} all the time"));
        return must_change.then_some(silent).into_iter().collect();
    }
    let stretches = clipped_stretches(samples);
    let Some((first, longest)) = stretches.first().copied() else {
        return Vec::new();
    };
    let total: usize = stretches.iter().map(|s| s.1).sum();
    let limit = samples[first];
    let word = if limit == high { "highest" } else { "lowest" };
    let what = format!(
        "stays at its {word} value {limit:.6} for {longest} samples (clipped? {total} such samples in all)"
    );
    vec![finding(Some((first, longest)), what)]
}

/// What is odd about a run: lengths, speeds, motions.
///
/// # Errors
/// [`Error::Input`] when another motion than those stated moves most: then motion channels are exchanged, or the run is.
pub(super) fn run_findings(run: &RawRun, width_m: f64) -> Result<Vec<RunFinding>> {
    use FindingSeverity::{Doubt, Note};
    let motion = &run.motion[..];
    let mut found = Vec::new();
    let mut say = |severity, what| found.push(RunFinding::of_run(&run.name, severity, what));
    let measured = &run.in_wind.wind_speed_m_s;
    let air = beyond("air density", run.air_density_kg_m3, &AIR_OF_A_LABORATORY);
    if let Some(odd) = air {
        say(Doubt, odd.to_string());
    }
    if let Some(still) = &run.still_air {
        let (in_wind, still_air) = (run.in_wind.sample_count(), still.sample_count());
        if in_wind != still_air {
            let both = in_wind.min(still_air);
            let what = format!(
                "{in_wind} samples in wind, {still_air} in still air; only the first {both} have both"
            );
            say(Note, what);
        }
    }
    let (stated, channel) = (run.mean_speed_m_s, mean(measured));
    let off = (stated / channel - 1.0).abs();
    if !measured.is_empty() && off > SPEED_OFF_AT_MOST {
        let hint = ratio_hint(stated / channel);
        let place = format_args!("run `{}`: mean_speed_m_s", run.name);
        let expected = format_args!("about the {channel:.3} m/s of the channel `wind_speed`");
        let found = format_args!("{stated:.3} m/s{hint}");
        ensure(off <= ANOTHER_SPEED, place, expected, found)?;
        let what =
            format!("the mean speed is {stated:.3} m/s, its channel says {channel:.3} m/s{hint}");
        say(Doubt, what);
    }
    if let Some(what) = other_than_one_wind(measured) {
        say(Doubt, what);
    }
    if let Some(still) = &run.still_air
        && !still.wind_speed_m_s.is_empty()
        && mean(&still.wind_speed_m_s) > SPEED_OFF_AT_MOST * run.mean_speed_m_s
    {
        let wind = mean(&still.wind_speed_m_s);
        let what = format!("the still-air recording has a wind of {wind:.3} m/s");
        say(Doubt, what);
    }
    let still = run.still_air.iter().map(|r| ("still air", r));
    for (name, recording) in std::iter::once(("in wind", &run.in_wind)).chain(still) {
        let spread = |d: Dof| deviation(&recording.motion[d as usize]) * d.motion_scale(width_m);
        let stated = motion.iter().map(|d| spread(*d)).fold(0.0, f64::max);
        for dof in Dof::THREE {
            let is_stated = motion.contains(&dof);
            if !is_stated && spread(dof) > stated && spread(dof) > 0.0 {
                let ratio = spread(dof) / stated;
                return Err(exchanged(&run.name, name, motion, dof, ratio));
            } else if is_stated && spread(dof) == 0.0 {
                say(Doubt, format!("{name}: no {} motion", dof.name()));
            } else if !is_stated && spread(dof) > OTHER_MOTION_AT_MOST * stated {
                let part = 100.0 * spread(dof) / stated;
                let what = format!(
                    "{name}: {} motion of {part:.0} % of the stated one, both over the width",
                    dof.name()
                );
                say(Note, what);
            }
        }
        for (dof, moves) in Dof::THREE.into_iter().zip(&recording.motion) {
            let odd = odd_amplitude(name, dof, moves, motion.contains(&dof), width_m);
            odd.into_iter().for_each(|what| say(Doubt, what));
        }
    }
    Ok(found)
}

fn exchanged(run: &str, recording: &str, stated: &[Dof], found: Dof, ratio: f64) -> Error {
    let part = match ratio.is_finite() {
        true => format!("of {ratio:.1} times that, both over the width"),
        false => "alone".to_owned(),
    };
    Error::input(
        format!("run `{run}`, {recording}"),
        format!("{} motion, as `motion` states", Dof::names(stated)),
        format!(
            "a {} motion {part}: are the motion channels exchanged, or their units wrong?",
            found.name()
        ),
    )
}

/// Standard deviation; 0 for a channel that is not there.
fn deviation(samples: &[f64]) -> f64 {
    let centre = mean(samples);
    let squares = samples.iter().map(|x| (x - centre).powi(2)).sum::<f64>();
    (squares / samples.len().max(1) as f64).sqrt()
}

/// Usual amplitudes of a forced motion: displacements over the width, rotations in rad.
const AMPLITUDES: [(f64, f64); 2] = [(1e-3, 0.5), (5e-4, 0.6)];

/// Hints about the numbers of the campaign file.
pub(super) fn file_hints(campaign: &Campaign) -> Vec<RunFinding> {
    let mut said = Vec::new();
    if let Some(rig) = &campaign.rig {
        let (width, length) = (rig.model_width_m, rig.model_length_m);
        said.push(beyond("rig.model_width_m", width, &MODEL_WIDTH));
        said.push(beyond("rig.model_length_m", length, &MODEL_LENGTH));
        for (i, cell) in rig.cells.iter().enumerate() {
            let farthest = largest_magnitude(&cell.position_m);
            let key = format!("rig.cells[{i}].position_m");
            said.push(beyond(&key, farthest, &MODEL_LENGTH).filter(|_| farthest > 1.0));
        }
    } else if let Some(width) = campaign.section.width_m {
        said.push(beyond("section.width_m", width, &DECK_WIDTH));
    }
    let sampling = campaign.recording.sampling_hz;
    said.extend(sampling.map(|hz| beyond("recording.sampling_hz", hz, &SAMPLING)));
    for (i, run) in campaign.runs.iter().enumerate() {
        let key = format!("run[{i}].mean_speed_m_s");
        said.extend(run.mean_speed_m_s.map(|v| beyond(&key, v, &WIND_SPEED)));
    }
    let finding = |odd: Finding| RunFinding::of_run("", odd.severity, odd.to_string());
    said.into_iter().flatten().map(finding).collect()
}

/// What is odd about the amplitude of a motion in the recording `name`, which is meant to be there where it `is_stated`.
fn odd_amplitude(
    name: &str,
    dof: Dof,
    motion: &[f64],
    is_stated: bool,
    width_m: f64,
) -> Option<String> {
    let (low, high) = extremes(motion.iter().copied());
    let amplitude = 0.5 * (high - low);
    let size = amplitude * dof.motion_scale(width_m);
    let (unit, [large, small], (least, most)) = match dof {
        Dof::Torsion => (
            "rad",
            ["degrees for radians", "radians for degrees"],
            AMPLITUDES[1],
        ),
        _ => (
            "m",
            ["millimetres for metres", "metres for millimetres"],
            AMPLITUDES[0],
        ),
    };
    let is_small = size > 0.0 && size < least && is_stated;
    let units = if is_small { small } else { large };
    (size > most || is_small).then(|| {
        format!(
            "{name}: {} motion of {amplitude:.3e} {unit} in amplitude on a model of {width_m} m: {units}?",
            dof.name()
        )
    })
}

/// Mean and median, and the means of the halves, may differ by this part, of which derivatives take twice as much …
const SAME_WIND: f64 = 0.03;
/// … the halves by so many standard errors more, which gusts leave in the means of so many parts of each.
const ERRORS: f64 = 3.0;
const PARTS: usize = 8;

/// What turbulence about one mean wind, by which all derivatives of a run are divided, does not explain in its channel, in words.
fn other_than_one_wind(wind_m_s: &[f64]) -> Option<String> {
    let (whole, middle) = (mean(wind_m_s), median(wind_m_s));
    if (whole - middle).abs() > SAME_WIND * whole.abs() {
        return Some(format!(
            "the wind speed is {whole:.3} m/s in the mean and {middle:.3} m/s in the median, as of a channel that drops out, \
             begins late or stops"
        ));
    }
    let (first, second) = wind_m_s.split_at(wind_m_s.len() / 2);
    let [(first, error), (second, other)] = [first, second].map(mean_and_error);
    ((first - second).abs() > SAME_WIND * whole.abs() + ERRORS * error.hypot(other)).then(|| {
        format!(
            "the wind speed is {first:.3} m/s in the first half and {second:.3} m/s in the second, as of a channel that drifts"
        )
    })
}

/// The mean, and its standard error as the means of its parts scatter.
fn mean_and_error(wind_m_s: &[f64]) -> (f64, f64) {
    let parts = wind_m_s.chunks(wind_m_s.len().div_ceil(PARTS).max(1));
    let count = parts.len() as f64;
    let (mean, deviation) = mean_and_deviation(parts.map(mean));
    (mean, deviation / count.sqrt())
}
