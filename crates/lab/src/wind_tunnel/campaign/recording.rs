//! Reading the recordings that a campaign file names: channels taken out of a file by the map, in SI units, of one length, all of it
//! numbers.

use super::air::Air;
use super::channel::{CellChannel, ChannelRef, Quantity};
use super::channel_map::{
    ChannelMap, SAME_RATE, SectionForces, cell_quantity, described, sampling_by_time, sampling_of,
};
use super::file::{Campaign, FileRef, RunBlock};
use super::findings::{channel_findings, file_hints, first_gap, run_findings};
use crate::error::{Error, Result, ensure, positive};
use crate::files::lab::ChannelSet;
use crate::section::Dof;
use crate::signal::mean;
use crate::wind_tunnel::processing::all_or_errors;
use crate::wind_tunnel::{
    CELL_CHANNELS, RawCampaign, RawRecording, RawRun, Rig, RunFinding, SAMPLES_AT_LEAST,
};
use aerodeck_core::threads;

impl Campaign {
    /// Reads all recordings.
    ///
    /// # Errors
    /// [`Error::Io`]; [`Error::Input`] naming run, recording, channel and sample: a channel that the file does not
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

    /// Reads a file, or a group of it: the recording, and the air that the file in wind states. What is odd is added to `findings`.
    fn read_recording(
        &self,
        rig: &Rig,
        map: &ChannelMap,
        run: &RunBlock,
        file: &FileRef,
        what: &'static str,
        findings: &mut Vec<RunFinding>,
    ) -> Result<(RawRecording, Air)> {
        let path = self.directory.join(file.file());
        let place = format!("run `{}`, {what}", run.name);
        let mut read = || {
            let set = ChannelSet::read(&path, file.group()).map_err(|e| below(&place, e))?;
            let mut taking = ChannelExtraction {
                map,
                set: &set,
                place: &place,
                of: (&run.name, what),
                first: None,
                channels: Vec::new(),
                findings,
            };
            let recording = taking.recording(self, rig, file.to_string())?;
            Ok((recording, taking.air(what == "in wind")?))
        };
        read().map_err(|e: Error| e.in_file(&path))
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

/// The same error with the run in front of its place.
fn below(place: &str, error: Error) -> Error {
    match error {
        // a file that is not there is the run's that names it
        Error::Io { source, .. } => Error::input(place, "a recording", source.to_string()),
        other => other.within(place),
    }
}

/// Channels being taken out of a file.
struct ChannelExtraction<'a> {
    map: &'a ChannelMap,
    set: &'a ChannelSet,
    place: &'a str,
    of: (&'a str, &'static str),
    /// Length and description of the first channel; all others must have it.
    first: Option<(usize, String)>,
    channels: Vec<String>,
    findings: &'a mut Vec<RunFinding>,
}

impl ChannelExtraction<'_> {
    fn recording(
        &mut self,
        campaign: &Campaign,
        rig: &Rig,
        source: String,
    ) -> Result<RawRecording> {
        let map = self.map;
        let mut motion: [Vec<f64>; 3] = Default::default();
        for (samples, dof) in motion.iter_mut().zip(Dof::THREE) {
            if let Some(channel) = map.motion(dof) {
                let quantity = match dof {
                    Dof::Torsion => Quantity::Angle,
                    _ => Quantity::Length,
                };
                let key = format!("channels.{}", dof.name());
                *samples = self.take(&key, channel, quantity, false)?;
            }
        }
        let mut cells = Vec::new();
        for cell in &rig.cells {
            cells.push(self.cell(&cell.name)?);
        }
        let wind_speed_m_s = self.wind_speed()?;
        let samples = self.first.as_ref().map_or(0, |(length, _)| *length);
        let expected = format_args!("at least {SAMPLES_AT_LEAST} samples");
        ensure(samples >= SAMPLES_AT_LEAST, self.place, expected, samples)?;
        // those not measured
        let channels = cells.iter_mut().flatten();
        let silent = channels.filter(|c: &&mut Vec<f64>| c.is_empty());
        silent.for_each(|c| c.resize(samples, 0.0));
        Ok(RawRecording {
            source,
            sampling_hz: self.sampling(campaign.recording.sampling_hz)?,
            motion,
            cells,
            wind_speed_m_s,
            channels: std::mem::take(&mut self.channels),
        })
    }

    fn cell(&mut self, cell: &str) -> Result<[Vec<f64>; 6]> {
        let map = self.map;
        let mut channels: [Vec<f64>; 6] = Default::default();
        for (samples, key) in channels.iter_mut().zip(CELL_CHANNELS) {
            let channel = map.cells.get(cell).and_then(|channels| channels.get(key));
            if let Some(CellChannel::Measured(channel)) = channel {
                let place = map.cell_key(cell, key);
                *samples = self.take(&place, channel, cell_quantity(key), true)?;
            }
        }
        Ok(channels)
    }

    /// The wind speed; in still air, where a Pitot tube need not give a number, only if it is there and sound.
    fn wind_speed(&mut self) -> Result<Vec<f64>> {
        let Some(channel) = &self.map.wind_speed else {
            return Ok(Vec::new());
        };
        let (run, recording) = self.of;
        if recording != "in wind" {
            let Some(c) = self.set.channel(&channel.name) else {
                return Ok(Vec::new());
            };
            let (gap, length) = (first_gap(&c.samples), self.first.as_ref().map(|f| f.0));
            if gap.is_some() || Some(c.samples.len()) != length {
                let what = "wind speed is not a number or of another length; ignored".to_owned();
                let finding = RunFinding::of_channel(run, recording, &channel.name, gap, what);
                self.findings.push(finding);
                return Ok(Vec::new());
            }
        }
        self.take("channels.wind_speed", channel, Quantity::Speed, false)
    }

    /// One channel in SI units, of the length of those before, all of it numbers.
    fn take(
        &mut self,
        key: &str,
        channel: &ChannelRef,
        quantity: Quantity,
        must_change: bool,
    ) -> Result<Vec<f64>> {
        let samples = channel.samples(key, quantity, self.set);
        let samples = samples.map_err(|e| below(self.place, e))?;
        let own = self.set.channel(&channel.name).map(described);
        let own = own.unwrap_or_default();
        match &self.first {
            Some((length, first)) if *length != samples.len() => {
                let expected = format!("channels of one length ({first} samples)");
                return Err(Error::input(self.place, expected, own));
            }
            Some(_) => {}
            None => self.first = Some((samples.len(), own)),
        }
        if let Some((first, length)) = first_gap(&samples) {
            let place = format!("{}, `{}`, sample {first}", self.place, channel.name);
            let found = format!("{} for {length} samples", samples[first]);
            return Err(Error::input(place, "a finite number", found));
        }
        let found = channel_findings(self.of.0, self.of.1, &channel.name, &samples, must_change);
        self.findings.extend(found);
        self.channels.push(channel.name.clone());
        Ok(samples)
    }

    /// The one sampling frequency of campaign file, recording and time channel, Hz.
    fn sampling(&self, stated: Option<f64>) -> Result<f64> {
        let by_channel = |channel: &ChannelRef| {
            let time = channel.samples("channels.time", Quantity::Time, self.set);
            let time = time.map_err(|e| below(self.place, e))?;
            sampling_of(&format!("{}, `{}`", self.place, channel.name), &time)
        };
        let by_time = self.map.time.as_ref().map(by_channel).transpose()?;
        let known = [
            (stated, "the campaign file"),
            (self.set.sampling_hz, "the file"),
            (by_time, "the time channel"),
        ];
        // a time that the map leaves out is no statement of its own, but may not contradict
        let beside = sampling_by_time(self.set, stated.or(self.set.sampling_hz));
        let beside = beside.and_then(Result::ok).filter(|_| by_time.is_none());
        let beside = beside.map(|hz| (hz, "a time column that `channels.time` does not name"));
        let mut known = known.into_iter().filter_map(|(hz, who)| Some((hz?, who)));
        let Some((hz, who)) = known.next() else {
            let expected =
                "a sampling frequency: `recording.sampling_hz`, `channels.time` or one in the file";
            return Err(Error::input(self.place, expected, "none"));
        };
        let mut known = known.chain(beside);
        match known.find(|(other, _)| (other / hz - 1.0).abs() > SAME_RATE) {
            None => Ok(hz),
            Some((other, says)) => {
                let expected = format!("the sampling frequency {hz} Hz of {who}");
                let found = format!("{other:.4} Hz by {says}");
                Err(Error::input(self.place, expected, found))
            }
        }
    }

    /// What the file states of the air, where that is needed.
    fn air(&self, is_needed: bool) -> Result<Air> {
        let number = |key: &str, channel: &Option<ChannelRef>, quantity| {
            let channel = channel.as_ref().filter(|_| is_needed);
            let number = channel.map(|c| c.number(&format!("channels.{key}"), quantity, self.set));
            number.transpose().map_err(|e| below(self.place, e))
        };
        let map = self.map;
        Ok(Air {
            density_kg_m3: number("air_density", &map.air_density, Quantity::Density)?,
            temperature_c: number("temperature", &map.temperature, Quantity::Temperature)?,
            pressure_pa: number("pressure", &map.pressure, Quantity::Pressure)?,
            relative_humidity: None,
        })
    }
}
