//! Reading the recordings that a campaign file names.

use super::air::Air;
use super::channel_map::ChannelMap;
use super::channel_map::SAME_RATE;
use super::file::{Campaign, RunBlock};
use super::findings::{RunFinding, file_hints, run_findings};
use super::recording::RecordingSummary;
use super::section_forces::SectionForces;
use crate::error::{Error, Result, all_or_errors, ensure, positive};
use crate::plausibility::FindingSeverity;
use crate::section::Dof;
use crate::signal::mean;
use crate::wind_tunnel::{RawCampaign, RawRecording, RawRun, Rig};
use aerodeck_core::threads;
use serde::Serialize;

/// A campaign with all its recordings, and what is odd about them.
#[derive(Debug, Clone, PartialEq)]
pub struct CampaignReading {
    /// The runs.
    pub raw: RawCampaign,
    /// What each run is, in the order of the runs.
    pub runs: Vec<RunSummary>,
    /// What did not stop reading.
    pub findings: Vec<RunFinding>,
}

/// What a run is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunSummary {
    /// Name.
    pub name: String,
    /// What moves.
    pub motion: Vec<Dof>,
    /// Mean wind speed, m/s.
    pub mean_speed_m_s: f64,
    /// Air density, kg/m³.
    pub air_density_kg_m3: f64,
    /// Recording in wind.
    pub in_wind: RecordingSummary,
    /// Recording in still air, if there is one.
    pub still_air: Option<RecordingSummary>,
}

impl CampaignReading {
    /// The findings of this weight in words.
    pub fn words(&self, severity: FindingSeverity) -> Vec<String> {
        let of_weight = self.findings.iter().filter(|f| f.severity == severity);
        of_weight.map(ToString::to_string).collect()
    }
}

impl Campaign {
    /// Reads all recordings.
    ///
    /// # Errors
    /// [`Error::Io`](crate::error::Error::Io); [`Error::Input`](crate::error::Error::Input) naming run, recording, channel and sample: a channel that the file does not
    /// hold (with those that it does), channels of unequal length or rate, samples that are no numbers, a unit that
    /// does not fit, a mean speed that is not positive, air of unknown density. The errors of all runs, in their order.
    pub fn load(&self) -> Result<CampaignReading> {
        let map = self.channel_map();
        let rig = self.rig()?;
        let load = |run: &RunBlock| {
            let path = self.directory.join(run.in_wind.file());
            self.load_run(&rig, &map, run).map_err(|e| e.in_file(path))
        };
        let read = all_or_errors(threads::each(&self.runs, true, load))?;
        let mut reading = CampaignReading {
            raw: RawCampaign {
                section: self.section.name.clone(),
                source: self.section.source.clone(),
                licence: self.section.licence.clone(),
                forces: map.section.as_ref().map(SectionForces::dofs),
                rig,
                runs: Vec::new(),
            },
            runs: Vec::new(),
            findings: file_hints(self),
        };
        for (run, summary, findings) in read {
            reading.raw.runs.push(run);
            reading.runs.push(summary);
            reading.findings.extend(findings);
        }
        each_once(&reading.raw.runs)?;
        Ok(reading)
    }

    fn load_run(
        &self,
        rig: &Rig,
        map: &ChannelMap,
        run: &RunBlock,
    ) -> Result<(RawRun, RunSummary, Vec<RunFinding>)> {
        let place = format!("run `{}`", run.name);
        let mut read = Vec::new();
        let (wind, in_wind, air) =
            self.read_recording(rig, map, run, &run.in_wind, "in wind", &mut read)?;
        let still = run.still_air.as_ref();
        let still =
            still.map(|file| self.read_recording(rig, map, run, file, "still air", &mut read));
        let (still, in_still_air) = still
            .transpose()?
            .map(|(s, summary, _)| (s, summary))
            .unzip();
        let wind_hz = wind.sampling_hz;
        let still_hz = still
            .as_ref()
            .map_or(wind_hz, |s: &RawRecording| s.sampling_hz);
        ensure(
            (wind_hz / still_hz - 1.0).abs() <= SAME_RATE,
            place,
            "one sampling frequency in wind and in still air",
            format_args!("{wind_hz} Hz and {still_hz} Hz"),
        )?;
        let mean_speed_m_s = mean_speed(run, &wind)?;
        let air_density_kg_m3 = self.density(map, run, air)?;
        let summary = RunSummary {
            name: run.name.clone(),
            motion: run.motion.clone(),
            mean_speed_m_s,
            air_density_kg_m3,
            in_wind,
            still_air: in_still_air,
        };
        let raw = RawRun {
            name: run.name.clone(),
            in_wind: wind,
            still_air: still,
            mean_speed_m_s,
            air_density_kg_m3,
        };
        let mut findings = run_findings(&raw, &run.motion, rig.model_width_m)?;
        findings.extend(read);
        Ok((raw, summary, findings))
    }

    /// The air: what the run states, else what its file in wind holds, else what holds for all.
    fn density(&self, map: &ChannelMap, run: &RunBlock, by_file: Air) -> Result<f64> {
        let common = Air::over(by_file, self.air);
        let has_map = map.air_density.is_some() || map.temperature.is_some();
        let place = if run.air.is_empty() && !has_map {
            "air".to_owned()
        } else {
            format!("air of run `{}`", run.name)
        };
        Air::over(run.air, common).density(&place)
    }
}

/// Refuses samples that stand twice, under whatever name: noise never repeats.
fn each_once(runs: &[RawRun]) -> Result<()> {
    for (i, run) in runs.iter().enumerate() {
        let same = |other: &&RawRun| {
            let (a, b) = (&other.in_wind, &run.in_wind);
            a.motion == b.motion && a.cells == b.cells
        };
        if let Some(first) = runs[..i].iter().find(same) {
            let expected = "each recording once: what stands twice looks better known than it is";
            let found = format!("the samples of run `{}`", first.name);
            let place = format!("run `{}`, in wind", run.name);
            return Err(Error::input(place, expected, found).in_file(&run.in_wind.source));
        }
    }
    Ok(())
}

fn mean_speed(run: &RunBlock, wind: &RawRecording) -> Result<f64> {
    match run.mean_speed_m_s {
        Some(speed) => Ok(speed),
        None => {
            let place = format!("run `{}`, mean of the wind speed", run.name);
            positive(&place, mean(&wind.wind_speed_m_s))
        }
    }
}
