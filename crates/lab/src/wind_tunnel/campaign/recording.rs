//! One recording: channels taken out of a file by the map, in SI units, of one length, all of it numbers.

use super::air::Air;
use super::channel::{CellChannel, ChannelRef};
use super::channel_map::{
    ChannelMap, SAME_RATE, cell_quantity, described, sampling_by_time, sampling_of,
};
use super::file::{Campaign, FileRef, RunBlock};
use super::findings::{RunFinding, channel_findings, first_gap};
use super::quantity::Quantity;
use crate::error::{Error, Result, ensure};
use crate::files::lab::ChannelSet;
use crate::section::Dof;
use crate::wind_tunnel::{CELL_CHANNELS, RawRecording, Rig, SAMPLES_AT_LEAST};

impl Campaign {
    /// Reads a file, or a group of it: the recording, and the air that the file in wind states. What is odd is added to `findings`.
    pub(super) fn read_recording(
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
