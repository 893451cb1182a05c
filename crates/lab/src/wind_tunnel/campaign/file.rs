//! The campaign file itself.

use super::air::Air;
use super::channel::ChannelRef;
use super::channel_map::{CELL, ChannelMap, SectionForces};
use super::ntnu;
use crate::error::{Error, Result, at_most, ensure, of_schema, positive};
use crate::files::toml_lines;
use crate::section::Dof;
use crate::wind_tunnel::Rig;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Version of the campaign file.
pub(crate) const CAMPAIGN_SCHEMA: u32 = 1;

/// Bounds that no campaign reaches: a typing error must not become hours or the whole memory.
const SAMPLING_HZ_AT_MOST: f64 = 1e6;
const RUNS_AT_MOST: f64 = 10_000.0;
const CELLS_AT_MOST: f64 = 64.0;

/// Contents of a campaign file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Campaign {
    /// 1.
    pub schema: u32,
    /// What was tested.
    pub section: SectionBlock,
    /// The air of all runs that state nothing else.
    #[serde(default, skip_serializing_if = "Air::is_empty")]
    pub air: Air,
    /// What all recordings have in common.
    #[serde(default)]
    pub recording: RecordingBlock,
    /// The rig; left out where `channels.section` has the forces on the whole section.
    pub rig: Option<Rig>,
    /// Which channel is what.
    #[serde(default)]
    pub channels: ChannelMap,
    /// The runs.
    #[serde(rename = "run", default)]
    pub runs: Vec<RunBlock>,
    /// Folder of the file, against which paths in it are read.
    #[serde(skip)]
    pub directory: PathBuf,
}

/// What was tested.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SectionBlock {
    /// Name of the section.
    pub name: String,
    /// Where the data come from.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub source: String,
    /// Licence of the data.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub licence: String,
    /// Width B, m, where there is no rig that states it.
    pub width_m: Option<f64>,
    /// Length along the span, m, that the forces are those of, where there is no rig; left out, 1 m.
    pub length_m: Option<f64>,
}

/// What all recordings have in common.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordingBlock {
    /// Sampling frequency, Hz; may be left out where the files state it or have a time channel.
    pub sampling_hz: Option<f64>,
    /// A known layout of the files; left out, that of `channels`.
    pub layout: Option<RecordingLayout>,
}

/// Layouts of files that need no channel map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RecordingLayout {
    /// HDF5 of NTNU's tools, one group per run; entries of `channels` replace those of the layout.
    Ntnu,
}

/// A recording: a file, or one group of it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum FileRef {
    /// A whole file.
    File(PathBuf),
    /// A group (HDF5, TDMS) or struct (MATLAB) of a file.
    Group {
        /// The file.
        file: PathBuf,
        /// The group.
        group: String,
    },
}

/// One motion at one wind speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunBlock {
    /// Name, unlike that of any other run.
    pub name: String,
    /// What moves: one or several of vertical, lateral, torsion.
    pub motion: Vec<Dof>,
    /// Recording in wind.
    pub in_wind: FileRef,
    /// Recording of the same motion in still air; not needed for `channels.section`, the forces of the wind alone.
    pub still_air: Option<FileRef>,
    /// Mean wind speed, m/s; left out, the mean of the channel `wind_speed`.
    pub mean_speed_m_s: Option<f64>,
    /// The air of this run where it differs from that of the campaign.
    #[serde(default, skip_serializing_if = "Air::is_empty")]
    pub air: Air,
}

impl FileRef {
    /// The file.
    pub(crate) fn file(&self) -> &Path {
        match self {
            Self::File(file) | Self::Group { file, .. } => file,
        }
    }

    /// The group, if it is not the whole file.
    pub(crate) fn group(&self) -> Option<&str> {
        match self {
            Self::File(_) => None,
            Self::Group { group, .. } => Some(group),
        }
    }
}

impl std::fmt::Display for FileRef {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.file().display())?;
        self.group().map_or(Ok(()), |group| write!(f, ", {group}"))
    }
}

impl Campaign {
    /// Reads and checks a campaign file; the recordings are not opened.
    ///
    /// # Errors
    /// [`Error::Io`] when it cannot be read; [`Error::Input`] with file and line for everything that is wrong in it.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        toml_lines::read(path, Self::from_toml)
    }

    /// Reads and checks the text of a campaign file; paths in it are read against `directory`.
    pub(crate) fn from_toml(text: &str, directory: PathBuf) -> Result<Self> {
        toml_lines::parse("a campaign file", text, |campaign: &mut Self| {
            campaign.directory = directory;
            campaign.validate()
        })
    }

    /// The channel map, that of a layout filled in.
    pub(crate) fn channel_map(&self) -> ChannelMap {
        let mut map = self.channels.clone();
        if let Some(section) = &self.channels.section {
            let cell = (CELL.to_owned(), section.channels());
            map.cells.extend([cell]);
        } else if let (Some(RecordingLayout::Ntnu), Some(rig)) = (self.recording.layout, &self.rig)
        {
            let preset = ntnu::channel_map(rig);
            map.vertical = map.vertical.or(preset.vertical);
            map.lateral = map.lateral.or(preset.lateral);
            map.torsion = map.torsion.or(preset.torsion);
            map.wind_speed = map.wind_speed.or(preset.wind_speed);
            map.air_density = map.air_density.or_else(|| self.density_of_layout());
            for (name, channels) in preset.cells {
                map.cells.entry(name).or_insert(channels);
            }
        }
        map
    }

    /// The rig of the file, or what stands for it where the forces are those on the whole section: one cell in global axes
    /// at the centre of rotation.
    ///
    /// # Errors
    /// [`Error::Input`] for neither or both of `rig` and `channels.section`, and for a width or length that is not positive.
    pub(crate) fn rig(&self) -> Result<Rig> {
        match (&self.rig, &self.channels.section) {
            (Some(rig), None) => {
                rig.validate()?;
                let alone = self.section.width_m.is_none() && self.section.length_m.is_none();
                let expected = "width and length of the model in `rig` alone";
                let found = "`width_m` or `length_m` besides";
                ensure(alone, "section", expected, found).map(|()| rig.clone())
            }
            (None, Some(_)) => {
                let width = self.section.width_m.ok_or_else(|| {
                    Error::input("section.width_m", "the width B of the section, m", "none")
                })?;
                let length = self.section.length_m.unwrap_or(1.0);
                Ok(Rig {
                    model_length_m: positive("section.length_m", length)?,
                    model_width_m: positive("section.width_m", width)?,
                    cells: vec![SectionForces::cell()],
                    ..Rig::default()
                })
            }
            (rig, _) => {
                let found = if rig.is_some() { "both" } else { "neither" };
                let expected = "either load cells in `rig`, or the forces on the whole section in `channels.section`";
                Err(Error::input("rig", expected, found))
            }
        }
    }

    /// The density in the files of the layout, where the campaign file says nothing of the air.
    fn density_of_layout(&self) -> Option<ChannelRef> {
        let channels = &self.channels;
        let is_stated =
            !self.air.is_empty() || channels.temperature.is_some() || channels.pressure.is_some();
        (!is_stated).then(|| ChannelRef::new("air_density", "kg/m3"))
    }

    fn validate(&self) -> Result<()> {
        of_schema(CAMPAIGN_SCHEMA, self.schema)?;
        let is_named = !self.section.name.trim().is_empty();
        ensure(is_named, "section.name", "a name", "none")?;
        let rig = self.rig()?;
        self.validate_cells(&rig)?;
        if let Some(hz) = self.recording.sampling_hz {
            positive("recording.sampling_hz", hz)?;
            at_most("recording.sampling_hz", hz, SAMPLING_HZ_AT_MOST)?;
        }
        at_most("run", self.runs.len() as f64, RUNS_AT_MOST)?;
        let map = self.channel_map();
        map.validate(&rig)?;
        ensure(!self.runs.is_empty(), "run", "at least one [[run]]", "none")?;
        for (i, run) in self.runs.iter().enumerate() {
            let mut before = self.runs[..i].iter();
            if before.any(|r| r.name == run.name) {
                return Err(second_time(&format!("run[{i}].name"), "run", &run.name));
            }
            let same = self.runs[..i].iter().find(|r| r.in_wind == run.in_wind);
            if let Some(other) = same {
                let found = format!("{}, that of run `{}`", run.in_wind, other.name);
                let expected = "a recording of its own for every run";
                return Err(Error::input(format!("run[{i}].in_wind"), expected, found));
            }
            if run.still_air.as_ref() == Some(&run.in_wind) {
                let found = format!("{}, that in wind", run.in_wind);
                let expected = format!("a recording of its own in still air (run `{}`)", run.name);
                return Err(Error::input(format!("run[{i}].still_air"), expected, found));
            }
            run.validate(&format!("run[{i}]"), &map, self.air)?;
        }
        Ok(())
    }

    fn validate_cells(&self, rig: &Rig) -> Result<()> {
        let cells = &rig.cells;
        at_most("rig.cells", cells.len() as f64, CELLS_AT_MOST)?;
        for (i, cell) in cells.iter().enumerate() {
            if cells[..i].iter().any(|c| c.name == cell.name) {
                let key = format!("rig.cells[{i}].name");
                return Err(second_time(&key, "cell", &cell.name));
            }
        }
        let fit = self.recording.layout.is_none() || cells.len() <= ntnu::CELLS;
        let expected = format_args!("at most {} cells in this layout", ntnu::CELLS);
        ensure(fit, "rig.cells", expected, cells.len())
    }
}

fn second_time(key: &str, of: &str, name: &str) -> Error {
    let expected = format!("a name of its own for every {of}");
    Error::input(key, expected, format!("`{name}` a second time"))
}

impl RunBlock {
    /// What the map lacks for a motion.
    fn validate_motion(&self, dof: Dof, map: &ChannelMap) -> std::result::Result<(), String> {
        let section = map.section.as_ref();
        if section.is_some_and(|s| !s.dofs().contains(&dof)) {
            let force = dof.force_name();
            return Err(format!("its force too: `channels.section.{force}`"));
        }
        if map.motion(dof).is_none() {
            let name = dof.name();
            return Err(format!("a motion with a channel: `channels.{name}`"));
        }
        Ok(())
    }

    fn validate(&self, place: &str, map: &ChannelMap, common: Air) -> Result<()> {
        let key = |name: &str| format!("{place}.{name}");
        let of_run = format!("(run `{}`)", self.name);
        ensure(!self.name.trim().is_empty(), key("name"), "a name", "none")?;
        let has_both = self.still_air.is_some() || map.section.is_some();
        let expected = format_args!("the recording of the same motion in still air {of_run}");
        ensure(has_both, key("still_air"), expected, "none")?;
        let moves = !self.motion.is_empty();
        let expected = format_args!("what moves {of_run}: vertical, lateral, torsion");
        ensure(moves, key("motion"), expected, "nothing")?;
        for dof in &self.motion {
            self.validate_motion(*dof, map).map_err(|expected| {
                let expected = format!("{expected} {of_run}");
                Error::input(key("motion"), expected, "none")
            })?;
        }
        let is_known = self.mean_speed_m_s.is_some() || map.wind_speed.is_some();
        let expected = format_args!("a mean speed or the channel `channels.wind_speed` {of_run}");
        ensure(is_known, key("mean_speed_m_s"), expected, "neither")?;
        if let Some(speed) = self.mean_speed_m_s {
            positive(key("mean_speed_m_s"), speed)?;
        }
        // what comes from the files is checked when they are read
        let by_file =
            map.air_density.is_some() || map.temperature.is_some() || map.pressure.is_some();
        if by_file {
            return Ok(());
        }
        let where_stated = match self.air.is_empty() {
            true => "air".to_owned(),
            false => key("air"),
        };
        Air::over(self.air, common).density(&where_stated).map(drop)
    }
}
