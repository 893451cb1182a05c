//! A run before any stage: checked, its test points found, its inertia asked for the lag.

use super::body::StillAirInertia;
use super::check::{RunCheck, check_run};
use super::lag::still_air_inertia;
use super::options::ProcessingOptions;
use super::segmentation::{find_segments, moving_dof, whole_periods};
use super::signals::HarmonicSegment;
use super::{body, index, still_air};
use crate::error::{Error, Result, ensure};
use crate::section::Dof;
use crate::wind_tunnel::{RawRecording, RawRun, Rig};
use std::ops::Range;

/// A run that has been checked, with its test points and its lag.
pub(super) struct PreparedRun<'a> {
    pub run: &'a RawRun,
    /// Degree of freedom that moves.
    pub dof: Dof,
    pub findings: RunCheck,
    /// In samples of the recording in wind.
    pub segments: Vec<HarmonicSegment>,
    /// In samples of the recording in still air; empty without one.
    pub still_segments: Vec<HarmonicSegment>,
    pub still_air: Option<StillAirInertia>,
}

impl<'a> PreparedRun<'a> {
    pub(crate) fn new(run: &'a RawRun, rig: &Rig, options: &ProcessingOptions) -> Result<Self> {
        let mut findings = check_run(run, rig)?;
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
        let mut still_air = None;
        if let Some(still) = &run.still_air {
            let in_still_air = moving(still, "still air")?;
            ensure(
                in_still_air == dof,
                format_args!("run {}, still air", run.name),
                format_args!("the {} motion of the recording in wind", dof.name()),
                format_args!("a {} motion", in_still_air.name()),
            )?;
            body::check_force(&run.name, rig, still, dof)?;
            still_segments = find(still);
            still_air = still_air_inertia(&run.name, still, rig, dof, &still_segments)?;
            if let Some(inertia) = &still_air {
                let density = run.air_density_kg_m3;
                findings
                    .doubts
                    .extend(body::compare(&run.name, rig, inertia, density)?);
            }
        }
        Ok(Self {
            run,
            dof,
            findings,
            segments,
            still_segments,
            still_air,
        })
    }

    /// Segments counted from the first covered sample.
    pub(crate) fn covered_segments(&self, covered: &Range<usize>) -> Result<Vec<HarmonicSegment>> {
        let rate = self.run.in_wind.sampling_hz;
        let shift_s = covered.start as f64 / rate;
        let last_s = covered.len() as f64 / rate;
        self.segments
            .iter()
            .map(|s| {
                let p = s.plateau.range();
                ensure(
                    p.start >= covered.start && p.end <= covered.end,
                    format_args!("run {}, still air", self.run.name),
                    format_args!(
                        "a recording as long as the motion at {:.3} Hz (samples {} to {})",
                        s.segment.frequency_hz, p.start, p.end
                    ),
                    format_args!(
                        "one that covers samples {} to {}",
                        covered.start, covered.end
                    ),
                )?;
                let mut moved = *s;
                moved.plateau.first -= covered.start;
                moved.segment.start_s = (s.segment.start_s - shift_s).max(0.0);
                moved.segment.end_s = (s.segment.end_s - shift_s).min(last_s);
                Ok(moved)
            })
            .collect()
    }

    /// Clipped stretches of both recordings in samples from the first covered one.
    pub(crate) fn clipped(&self, covered: &Range<usize>, offset: f64) -> Vec<Range<usize>> {
        let wind = self.findings.clipped_in_wind.iter().map(|c| (c, 0.0));
        let still = self.findings.clipped_still_air.iter().map(|c| (c, offset));
        let place = |x: f64| (x.max(0.0) as usize).min(covered.len());
        wind.chain(still)
            .map(|(c, late)| {
                let first = c.first as f64 - late - covered.start as f64;
                place(first.floor())..place((first + c.samples as f64).ceil())
            })
            .filter(|r| !r.is_empty())
            .collect()
    }
}
