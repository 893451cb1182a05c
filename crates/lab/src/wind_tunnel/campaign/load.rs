//! Reading the recordings that a campaign file names.

use super::air::Air;
use super::channel_map::{ChannelMap, SAME_RATE};
use super::file::{Campaign, RunBlock};
use super::findings::{RunFinding, file_hints, run_findings};
use super::section_forces::SectionForces;
use crate::error::{Error, Result, ensure, positive};
use crate::signal::mean;
use crate::wind_tunnel::processing::all_or_errors;
use crate::wind_tunnel::{RawCampaign, RawRun, Rig};
use aerodeck_core::threads;

impl Campaign {
    /// Reads all recordings.
    ///
    /// # Errors
    /// [`Error::Io`](crate::error::Error::Io); [`Error::Input`](crate::error::Error::Input) naming run, recording, channel and sample: a channel that the file does not
    /// hold (with those that it does), channels of unequal length or rate, samples that are no numbers, a unit that
    /// does not fit, a mean speed that is not positive, air of unknown density. The errors of all runs, in their order.
    pub fn load(&self) -> Result<RawCampaign> {
        let map = self.channel_map();
        let rig = self.rig()?;
        let load = |run: &RunBlock| {
            let path = self.directory.join(run.in_wind.file());
            self.load_run(&rig, &map, run).map_err(|e| e.in_file(path))
        };
        let read = all_or_errors(threads::each(&self.runs, true, load))?;
        let (runs, found): (Vec<_>, Vec<_>) = read.into_iter().unzip();
        each_once(&runs)?;
        let mut findings = file_hints(self);
        findings.extend(found.into_iter().flatten());
        Ok(RawCampaign {
            section: self.section.name.clone(),
            source: self.section.source.clone(),
            licence: self.section.licence.clone(),
            forces: map.section.as_ref().map(SectionForces::dofs),
            rig,
            runs,
            findings,
        })
    }

    /// Reads both recordings of a run; what is odd in them.
    fn load_run(
        &self,
        rig: &Rig,
        map: &ChannelMap,
        run: &RunBlock,
    ) -> Result<(RawRun, Vec<RunFinding>)> {
        let mut of_channels = Vec::new();
        let mut read =
            |file, what| self.read_recording(rig, map, run, file, what, &mut of_channels);
        let (in_wind, air) = read(&run.in_wind, "in wind")?;
        let still_air = run.still_air.as_ref().map(|file| read(file, "still air"));
        let still_air = still_air.transpose()?.map(|(recording, _)| recording);
        let wind_hz = in_wind.sampling_hz;
        let still_hz = still_air.as_ref().map_or(wind_hz, |s| s.sampling_hz);
        let same = (wind_hz / still_hz - 1.0).abs() <= SAME_RATE;
        let place = format_args!("run `{}`", run.name);
        let expected = "one sampling frequency in wind and in still air";
        let found = format_args!("{wind_hz} Hz and {still_hz} Hz");
        ensure(same, place, expected, found)?;
        let measured = || {
            let place = format_args!("run `{}`, mean of the wind speed", run.name);
            positive(place, mean(&in_wind.wind_speed_m_s))
        };
        let mean_speed_m_s = run.mean_speed_m_s.map_or_else(measured, Ok)?;
        let raw = RawRun {
            name: run.name.clone(),
            motion: run.motion.clone(),
            mean_speed_m_s,
            air_density_kg_m3: self.density(map, run, air)?,
            in_wind,
            still_air,
        };
        let mut findings = run_findings(&raw, rig.model_width_m)?;
        findings.extend(of_channels);
        Ok((raw, findings))
    }

    /// The air: what the run states, else what its file in wind holds, else what holds for all.
    fn density(&self, map: &ChannelMap, run: &RunBlock, by_file: Air) -> Result<f64> {
        let common = Air::over(by_file, self.air);
        let has_map = map.air_density.is_some() || map.temperature.is_some();
        let place = match run.air.is_empty() && !has_map {
            true => "air".to_owned(),
            false => format!("air of run `{}`", run.name),
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
