//! The channel map: which channel of the files is what, in which unit, with which sign.

use super::channel::{CellChannel, ChannelRef, Quantity};
use crate::error::{Error, Result, ensure};
use crate::files::lab::{Channel, ChannelSet};
use crate::section::Dof;
use crate::signal::median;
use crate::wind_tunnel::{CELL_CHANNELS, LoadCell, Rig};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Which channel is what. Cells are named as in the rig.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChannelMap {
    /// Time; may be left out where the sampling frequency is known.
    pub time: Option<ChannelRef>,
    /// Heave, positive up.
    pub vertical: Option<ChannelRef>,
    /// Sway, positive downwind.
    pub lateral: Option<ChannelRef>,
    /// Rotation, positive nose-up.
    pub torsion: Option<ChannelRef>,
    /// Wind speed.
    pub wind_speed: Option<ChannelRef>,
    /// Air density, a channel or a single number.
    pub air_density: Option<ChannelRef>,
    /// Air temperature, a channel or a single number.
    pub temperature: Option<ChannelRef>,
    /// Static pressure, a channel or a single number.
    pub pressure: Option<ChannelRef>,
    /// Forces on the whole section, in place of cells.
    pub section: Option<SectionForces>,
    /// For each cell its channels `fx`, `fy`, `fz`, `mx`, `my`, `mz` in local axes.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub cells: BTreeMap<String, BTreeMap<String, CellChannel>>,
}

impl ChannelMap {
    /// The channel of a motion.
    pub(crate) fn motion(&self, dof: Dof) -> Option<&ChannelRef> {
        match dof {
            Dof::Vertical => self.vertical.as_ref(),
            Dof::Lateral => self.lateral.as_ref(),
            Dof::Torsion => self.torsion.as_ref(),
        }
    }

    /// The channels that are no cell's, with their keys and what they measure.
    fn single(&self) -> Vec<(String, &ChannelRef, Quantity)> {
        let all = [
            ("time", &self.time, Quantity::Time),
            ("vertical", &self.vertical, Quantity::Length),
            ("lateral", &self.lateral, Quantity::Length),
            ("torsion", &self.torsion, Quantity::Angle),
            ("wind_speed", &self.wind_speed, Quantity::Speed),
            ("air_density", &self.air_density, Quantity::Density),
            ("temperature", &self.temperature, Quantity::Temperature),
            ("pressure", &self.pressure, Quantity::Pressure),
        ];
        let mut stated = Vec::new();
        for (key, channel, quantity) in all {
            let key = format!("channels.{key}");
            stated.extend(channel.as_ref().map(|c| (key, c, quantity)));
        }
        stated
    }

    /// Cells of which all is measured, each channel by the numbers of cell and channel.
    pub(super) fn measured_cells(
        rig: &Rig,
        channel: impl Fn(usize, usize) -> ChannelRef,
    ) -> BTreeMap<String, BTreeMap<String, CellChannel>> {
        let cell = |(c, cell): (usize, &LoadCell)| {
            let keys = CELL_CHANNELS.iter().enumerate();
            let measured = |k| CellChannel::Measured(channel(c, k));
            let channels = keys.map(|(k, key)| ((*key).to_owned(), measured(k)));
            (cell.name.clone(), channels.collect())
        };
        rig.cells.iter().enumerate().map(cell).collect()
    }

    /// The key of a channel of a cell.
    pub(super) fn cell_key(&self, cell: &str, channel: &str) -> String {
        if self.section.is_some() {
            return SectionForces::key(channel);
        }
        format!("channels.cells.{cell}.{channel}")
    }

    /// Checks units and names without any file.
    ///
    /// # Errors
    /// [`Error::Input`] with the key: a unit that does not fit, a cell that the rig does not have or that has no map,
    /// a channel that a cell does not have or that has no map.
    pub(crate) fn validate(&self, rig: &Rig) -> Result<()> {
        for (key, channel, quantity) in self.single() {
            channel.validate(&key, quantity)?;
        }
        let any = self.section.as_ref().is_none_or(|s| !s.dofs().is_empty());
        let expected = "at least one of lift, drag, moment";
        ensure(any, "channels.section", expected, "none")?;
        self.each_once()?;
        let names: Vec<&str> = rig.cells.iter().map(|c| c.name.as_str()).collect();
        if let Some(unknown) = self.cells.keys().find(|n| !names.contains(&n.as_str())) {
            let expected = format!("one of the cells of the rig: {}", names.join(", "));
            let found = format!("`{unknown}`");
            return Err(Error::input("channels.cells", expected, found));
        }
        names.iter().try_for_each(|cell| self.validate_cell(cell))
    }

    /// Refuses a channel of the files that is said to be two things.
    fn each_once(&self) -> Result<()> {
        let single = self.single().into_iter();
        let mut all: Vec<_> = single.map(|(key, channel, _)| (key, channel)).collect();
        for (cell, channels) in &self.cells {
            for (key, channel) in channels {
                if let CellChannel::Measured(channel) = channel {
                    all.push((self.cell_key(cell, key), channel));
                }
            }
        }
        let mut used = BTreeMap::new();
        for (key, ChannelRef { name, .. }) in all {
            if let Some(other) = used.insert(name, key.clone()) {
                let found = format!("`{name}`, which is `{other}` too");
                return Err(Error::input(key, "a channel of its own", found));
            }
        }
        Ok(())
    }

    fn validate_cell(&self, cell: &str) -> Result<()> {
        let place = format!("channels.cells.{cell}");
        let none = || Error::input("channels.cells", format!("a table `{cell}`"), "none");
        let map = self.cells.get(cell).ok_or_else(none)?;
        let all = CELL_CHANNELS.join(", ");
        let all = format!("{all} (`\"none\"` for one not measured)");
        if let Some(unknown) = map.keys().find(|k| !CELL_CHANNELS.contains(&k.as_str())) {
            let found = format!("`{unknown}`");
            return Err(Error::input(format!("{place}.{unknown}"), all, found));
        }
        for key in CELL_CHANNELS {
            match map.get(key) {
                None => return Err(Error::input(&place, all, format!("no `{key}`"))),
                Some(CellChannel::NotMeasured) => {}
                Some(CellChannel::Measured(channel)) => {
                    channel.validate(&self.cell_key(cell, key), cell_quantity(key))?;
                }
            }
        }
        Ok(())
    }
}

/// What a channel of a cell measures.
pub(super) fn cell_quantity(key: &str) -> Quantity {
    match key.starts_with('f') {
        true => Quantity::Force,
        false => Quantity::Moment,
    }
}

/// Its unit as it is written.
pub(super) fn cell_unit(key: &str) -> &'static str {
    match cell_quantity(key) {
        Quantity::Force => "N",
        _ => "Nm",
    }
}

/// Name of the cell that stands for them.
pub(super) const CELL: &str = "section";
/// Its channels that are measured, the force in each, and its sign: the nose-up moment is one about −z.
const CHANNELS: [(&str, Dof, f64); 3] = [
    ("fx", Dof::Lateral, 1.0),
    ("fy", Dof::Vertical, 1.0),
    ("mz", Dof::Torsion, -1.0),
];

/// Forces of the wind on the section, without inertia, about the centre of rotation; at least one.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SectionForces {
    /// Lift, positive up.
    pub lift: Option<ChannelRef>,
    /// Drag, positive downwind.
    pub drag: Option<ChannelRef>,
    /// Pitching moment, positive nose-up.
    pub moment: Option<ChannelRef>,
}

impl SectionForces {
    /// The cell that measures them: global axes, at the centre of rotation.
    pub(super) fn cell() -> LoadCell {
        LoadCell {
            name: CELL.to_owned(),
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            position_m: [0.0; 3],
            turns_with_model: false,
        }
    }

    fn channel(&self, dof: Dof) -> Option<&ChannelRef> {
        match dof {
            Dof::Vertical => self.lift.as_ref(),
            Dof::Lateral => self.drag.as_ref(),
            Dof::Torsion => self.moment.as_ref(),
        }
    }

    /// Degrees of freedom whose force there is.
    pub(crate) fn dofs(&self) -> Vec<Dof> {
        let has = |d: &Dof| self.channel(*d).is_some();
        Dof::THREE.into_iter().filter(has).collect()
    }

    /// The channels of that cell.
    pub(super) fn channels(&self) -> BTreeMap<String, CellChannel> {
        let measured = |key: &str| {
            let (_, dof, sign) = CHANNELS.iter().find(|(name, ..)| *name == key)?;
            let own = self.channel(*dof)?.clone();
            let scale = sign * own.scale;
            Some(CellChannel::Measured(ChannelRef { scale, ..own }))
        };
        let channel = |key: &str| {
            let channel = measured(key).unwrap_or(CellChannel::NotMeasured);
            (key.to_owned(), channel)
        };
        CELL_CHANNELS.into_iter().map(channel).collect()
    }

    /// The key of the campaign file behind a channel of that cell.
    pub(super) fn key(channel: &str) -> String {
        let named = CHANNELS.iter().find(|(name, ..)| *name == channel);
        let dof = named.map_or(Dof::Torsion, |(_, dof, _)| *dof);
        format!("channels.section.{}", dof.force_name())
    }
}

/// The time channel as a sampling frequency, Hz.
pub(super) fn sampling_of(place: &str, time_s: &[f64]) -> Result<f64> {
    let n = time_s.len();
    ensure(n >= 2, place, "at least two samples", n)?;
    let step = (time_s[n - 1] - time_s[0]) / (n - 1) as f64;
    if step <= 0.0 {
        let found = format!("from {} to {}", time_s[0], time_s[n - 1]);
        return Err(Error::input(place, "a time that rises", found));
    }
    // stamps are often rounded: a sample may stand off its place by a quarter of a step
    let uneven = (1..n).find(|i| {
        let off = (time_s[*i] - time_s[i - 1]) / step - 1.0;
        off.is_nan() || off.abs() > 0.25
    });
    match uneven {
        None if step.is_finite() => Ok(1.0 / step),
        uneven => {
            // a pause makes the mean step one that no sample has
            let steps: Vec<f64> = time_s.windows(2).map(|t| t[1] - t[0]).collect();
            let usual = median(&steps);
            // rounded stamps may mostly be equal
            let usual = if usual > 0.0 { usual } else { step };
            let is_off = |s: &f64| s.is_nan() || (s / usual - 1.0).abs() > 0.25;
            let first = steps.iter().position(is_off).map(|i| i + 1);
            let i = first.or(uneven).unwrap_or(1);
            Err(Error::input(
                format!("{place}, sample {i}"),
                format!("{usual:.6} s after the sample before, as most"),
                format!("{:.6} s", time_s[i] - time_s[i - 1]),
            ))
        }
    }
}

/// Two statements of one sampling frequency may differ by this part.
pub const SAME_RATE: f64 = 1e-3;
/// Steps of a time without a unit that are read as seconds; longer ones can be milliseconds.
const SECONDS_BELOW: f64 = 0.1;

/// The sampling frequency by a column that is called time, Hz; none without one. A column without a unit is in seconds or milliseconds: in
/// that which agrees with the frequency `stated_hz` elsewhere, and in seconds where its steps would be none of a laboratory's otherwise.
///
/// # Errors
/// [`Error::Input`] with column and sample where it does not rise evenly, and where its unit cannot be told.
pub fn sampling_by_time(set: &ChannelSet, stated_hz: Option<f64>) -> Option<Result<f64>> {
    let is_time = |name: &str| {
        let name = name.trim().to_lowercase();
        ["t", "zeit"].contains(&name.as_str()) || name.starts_with("time")
    };
    let channel = set.channels.iter().find(|c| is_time(&c.name))?;
    let place = format!("`{}`", channel.name);
    let per_unit = match sampling_of(&place, &channel.samples) {
        Ok(per_unit) => per_unit,
        Err(error) => return Some(Err(error)),
    };
    let agrees = |hz: &f64| stated_hz.is_some_and(|stated| (hz / stated - 1.0).abs() <= SAME_RATE);
    let in_ms = 1e3 * per_unit;
    let named = || {
        ["s", "ms"]
            .into_iter()
            .find(|unit| channel.name.ends_with(&format!("_{unit}")))
    };
    Some(Ok(match channel.unit.as_deref().or_else(named) {
        Some("s") => per_unit,
        Some("ms") => in_ms,
        // minutes, dates: not judged
        Some(_) => return None,
        None if agrees(&in_ms) => in_ms,
        None if stated_hz.is_some() || per_unit * SECONDS_BELOW > 1.0 => per_unit,
        None => {
            let expected = "a unit, as in `t [s]`: seconds or milliseconds";
            let found = format!("steps of {}", 1.0 / per_unit);
            return Some(Err(Error::input(place, expected, found)));
        }
    }))
}

/// Length of a channel, for messages about unequal ones.
pub(super) fn described(channel: &Channel) -> String {
    format!("{} in `{}`", channel.samples.len(), channel.name)
}
