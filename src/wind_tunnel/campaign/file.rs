//! The campaign file itself.

use super::air::Air;
use super::channel_map::{ChannelMap, ChannelRef};
use super::ntnu;
use crate::error::{Error, Result, positive};
use crate::section::Dof;
use crate::toml_lines;
use crate::wind_tunnel::Rig;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Version of the campaign file.
pub const CAMPAIGN_SCHEMA: u32 = 1;

/// Contents of a campaign file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Campaign {
    /// [`CAMPAIGN_SCHEMA`].
    pub schema: u32,
    /// What was tested.
    pub section: SectionBlock,
    /// The air of all runs that state nothing else.
    #[serde(default, skip_serializing_if = "Air::is_empty")]
    pub air: Air,
    /// What all recordings have in common.
    #[serde(default)]
    pub recording: RecordingBlock,
    /// The rig.
    pub rig: Rig,
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
}

/// What all recordings have in common.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordingBlock {
    /// Sampling frequency, Hz; may be left out where the files state it or have a time channel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sampling_hz: Option<f64>,
    /// A known layout of the files; left out, that of `channels`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub layout: Option<RecordingLayout>,
}

/// Layouts of files that need no channel map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RecordingLayout {
    /// HDF5 of NTNU's tools, one group a run; entries of `channels` replace those of the layout.
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
    /// Recording of the same motion in still air.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub still_air: Option<FileRef>,
    /// Mean wind speed, m/s; left out, the mean of the channel `wind_speed`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mean_speed_m_s: Option<f64>,
    /// The air of this run where it differs from that of the campaign.
    #[serde(default, skip_serializing_if = "Air::is_empty")]
    pub air: Air,
}

impl FileRef {
    /// The file.
    pub fn file(&self) -> &Path {
        match self {
            Self::File(file) | Self::Group { file, .. } => file,
        }
    }

    /// The group, if it is not the whole file.
    pub fn group(&self) -> Option<&str> {
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
        let text = std::fs::read_to_string(path).map_err(|e| Error::io(path, e))?;
        let directory = path.parent().unwrap_or(Path::new("")).to_path_buf();
        Self::from_toml(&text, directory).map_err(|e| e.in_file(path))
    }

    /// Reads and checks the text of a campaign file; paths in it are read against `directory`.
    ///
    /// # Errors
    /// [`Error::Input`] with line and key for everything that is wrong in it.
    pub fn from_toml(text: &str, directory: PathBuf) -> Result<Self> {
        let mut campaign: Self = toml::from_str(text)
            .map_err(|e| toml_lines::syntax_error("a campaign file", text, &e))?;
        campaign.directory = directory;
        campaign
            .validate()
            .map_err(|e| toml_lines::with_line(text, e))?;
        Ok(campaign)
    }

    /// The channel map, that of a layout filled in.
    pub fn channel_map(&self) -> ChannelMap {
        let own = &self.channels;
        let Some(RecordingLayout::Ntnu) = self.recording.layout else {
            return own.clone();
        };
        let preset = ntnu::channel_map(&self.rig);
        let first = |own: &Option<ChannelRef>, preset: Option<ChannelRef>| own.clone().or(preset);
        let mut cells = preset.cells;
        cells.extend(own.cells.clone());
        ChannelMap {
            time: first(&own.time, preset.time),
            vertical: first(&own.vertical, preset.vertical),
            lateral: first(&own.lateral, preset.lateral),
            torsion: first(&own.torsion, preset.torsion),
            wind_speed: first(&own.wind_speed, preset.wind_speed),
            air_density: own.air_density.clone().or_else(|| self.density_of_layout()),
            temperature: own.temperature.clone(),
            pressure: own.pressure.clone(),
            cells,
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
        if self.schema != CAMPAIGN_SCHEMA {
            return Err(Error::input(
                "schema",
                CAMPAIGN_SCHEMA.to_string(),
                self.schema.to_string(),
            ));
        }
        if self.section.name.trim().is_empty() {
            return Err(Error::input("section.name", "a name", "none"));
        }
        self.rig.validate()?;
        self.validate_cells()?;
        if let Some(hz) = self.recording.sampling_hz {
            positive("recording.sampling_hz", hz)?;
        }
        let map = self.channel_map();
        map.validate(&self.rig)?;
        if self.runs.is_empty() {
            return Err(Error::input("run", "at least one [[run]]", "none"));
        }
        for (i, run) in self.runs.iter().enumerate() {
            if self.runs[..i].iter().any(|r| r.name == run.name) {
                return Err(Error::input(
                    format!("run[{i}].name"),
                    "a name of its own for every run",
                    format!("`{}` a second time", run.name),
                ));
            }
            run.validate(&format!("run[{i}]"), &map, self.air)?;
        }
        Ok(())
    }

    fn validate_cells(&self) -> Result<()> {
        let cells = &self.rig.cells;
        for (i, cell) in cells.iter().enumerate() {
            if cells[..i].iter().any(|c| c.name == cell.name) {
                return Err(Error::input(
                    format!("rig.cells[{i}].name"),
                    "a name of its own for every cell",
                    format!("`{}` a second time", cell.name),
                ));
            }
        }
        if self.recording.layout.is_some() && cells.len() > ntnu::CELLS {
            let expected = format!("at most {} cells in this layout", ntnu::CELLS);
            return Err(Error::input("rig.cells", expected, cells.len().to_string()));
        }
        Ok(())
    }
}

impl RunBlock {
    fn validate(&self, place: &str, map: &ChannelMap, common: Air) -> Result<()> {
        let key = |name: &str| format!("{place}.{name}");
        let of_run = format!("(run `{}`)", self.name);
        if self.name.trim().is_empty() {
            return Err(Error::input(key("name"), "a name", "none"));
        }
        if self.still_air.is_none() {
            return Err(Error::input(
                key("still_air"),
                format!("the recording of the same motion in still air {of_run}"),
                "none",
            ));
        }
        if self.motion.is_empty() {
            let expected = format!("what moves {of_run}: vertical, lateral, torsion");
            return Err(Error::input(key("motion"), expected, "nothing"));
        }
        for dof in &self.motion {
            if map.motion(*dof).is_none() {
                return Err(Error::input(
                    key("motion"),
                    format!(
                        "a motion with a channel: `channels.{}` {of_run}",
                        dof.name()
                    ),
                    "none",
                ));
            }
        }
        match self.mean_speed_m_s {
            Some(speed) => {
                positive(&key("mean_speed_m_s"), speed)?;
            }
            None if map.wind_speed.is_none() => {
                let expected =
                    format!("a mean speed or the channel `channels.wind_speed` {of_run}");
                return Err(Error::input(key("mean_speed_m_s"), expected, "neither"));
            }
            None => {}
        }
        // what comes from the files is checked when they are read
        let by_file =
            map.air_density.is_some() || map.temperature.is_some() || map.pressure.is_some();
        if by_file {
            return Ok(());
        }
        let where_stated = if self.air.is_empty() {
            "air".to_owned()
        } else {
            key("air")
        };
        Air::over(self.air, common).density(&where_stated).map(drop)
    }
}
