//! `bridge.toml`: where the modes are, sections along the span, wind profile, damping.

use super::blocks::{BridgeSectionBlock, DamperBlock, WindBlock};
use super::matlab::SpanBlock;
use super::modal_data::BridgeModes;
use super::{WindAxes, abaqus, embedded, matlab, opensees, single_file, tables, wawi};
use crate::bridge::{BridgeMode, Dampers};
use crate::error::{Error, Result, ensure, non_negative, of_schema, positive};
use crate::files::report_block::ReportBlock;
use crate::files::text::parsed;
use crate::files::toml_lines;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Version of the layout.
const SCHEMA: u32 = 1;

/// A bridge as a file states it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BridgeFile {
    /// Version of the layout, 1.
    pub schema: u32,
    /// Name in tables and figures.
    pub name: String,
    /// Air density `ρ`, kg/m³.
    pub air_density_kg_m3: f64,
    /// Natural modes.
    pub modes: ModesBlock,
    /// Sections along the span.
    #[serde(rename = "section")]
    pub sections: Vec<BridgeSectionBlock>,
    /// Dampers.
    #[serde(default, rename = "damper", skip_serializing_if = "Vec::is_empty")]
    pub dampers: Vec<DamperBlock>,
    /// Wind along the span.
    #[serde(default)]
    pub wind: WindBlock,
    /// Speeds that are looked at.
    #[serde(default)]
    pub flutter: SearchBlock,
    /// Turbulence, as the room of buffeting reads it.
    pub buffeting: Option<toml::Table>,
    /// Whose report it is.
    #[serde(default, skip_serializing_if = "ReportBlock::is_empty")]
    pub report: ReportBlock,
    /// Directory of the file, against which paths in it are read.
    #[serde(skip)]
    pub directory: PathBuf,
    /// The file itself, where it is one, and its text: of what is found wrong with the modes at hand.
    #[serde(skip)]
    pub path: Option<PathBuf>,
    /// See `path`.
    #[serde(skip)]
    pub text: String,
}

/// Where the modes are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModesBlock {
    /// Format of the files.
    pub format: ModesFormat,
    /// File or folder, or the name of an embedded bridge (`langenuen`).
    pub path: PathBuf,
    /// Up and downwind in the axes of the files.
    pub axes: Option<WindAxes>,
    /// Damping ratio of all modes, or a list of one per mode.
    pub damping_ratio: DampingRatios,
    /// Numbers of the modes that take part; left out, all.
    pub select: Option<Vec<usize>>,
    /// Span and masses, for files that do not know them.
    pub span: Option<SpanBlock>,
}

/// Formats of modes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModesFormat {
    /// One of ours: a single file, or a folder of three tables.
    Csv,
    /// Model folder of wawi.
    Wawi,
    /// CSV exports of Abaqus.
    Abaqus,
    /// `wn` and `phi`.
    Matlab,
    /// Recorder text of OpenSees.
    Opensees,
    /// One that comes with the program.
    Embedded,
}

/// Damping ratios of the modes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "a number, or a list of one number per mode")]
pub enum DampingRatios {
    /// The same for all.
    Same(f64),
    /// One per mode, in the order of the file of modes.
    Each(Vec<f64>),
}

impl DampingRatios {
    fn apply(&self, modes: &mut [BridgeMode]) -> Result<()> {
        match self {
            Self::Same(ratio) => modes.iter_mut().for_each(|m| m.damping_ratio = *ratio),
            Self::Each(all) => {
                let (count, stated) = (modes.len(), all.len());
                let expected = format_args!("one number, or {count}, one per mode");
                let found = format_args!("{stated} numbers");
                ensure(stated == count, "modes.damping_ratio", expected, found)?;
                for (mode, ratio) in modes.iter_mut().zip(all) {
                    mode.damping_ratio = *ratio;
                }
            }
        }
        Ok(())
    }
}

/// Keeps the modes of these numbers alone.
fn keep(numbers: &[usize], all: &mut BridgeModes) -> Result<()> {
    let modes = &mut all.modes;
    let known = |n: &&usize| modes.iter().any(|m| m.number == **n);
    if let Some(unknown) = numbers.iter().find(|n| !known(n)) {
        let all: Vec<String> = modes.iter().map(|m| m.number.to_string()).collect();
        let expected = format!("modes among {}", all.join(", "));
        return Err(Error::input("modes.select", expected, unknown.to_string()));
    }
    let selected = |m: &mut BridgeMode| numbers.contains(&m.number);
    let kept = modes.extract_if(.., selected).collect();
    all.left_out = std::mem::replace(modes, kept);
    Ok(())
}

/// Speeds that are looked at.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SearchBlock {
    /// Highest wind speed, m/s.
    pub speed_max_m_s: f64,
    /// Speeds between still air and the highest.
    pub speeds: usize,
    /// Nothing critical may begin below this wind speed, m/s: the criterion of a code. The search always reaches it.
    pub required_speed_m_s: Option<f64>,
}

impl Default for SearchBlock {
    fn default() -> Self {
        Self {
            speed_max_m_s: 120.0,
            speeds: 60,
            required_speed_m_s: None,
        }
    }
}

impl BridgeFile {
    /// Reads and checks a file.
    ///
    /// # Errors
    /// [`Error::Io`] when it cannot be read; [`Error::Input`] with file and line for everything that is wrong in it.
    pub fn read(path: &Path) -> Result<Self> {
        let file = toml_lines::read(path, Self::from_toml)?;
        Ok(Self {
            path: Some(path.to_owned()),
            ..file
        })
    }

    /// Reads and checks the text of a file; paths in it are read against `directory`.
    ///
    /// # Errors
    /// [`Error::Input`] with line and key for everything that is wrong in it.
    pub fn from_toml(text: &str, directory: PathBuf) -> Result<Self> {
        toml_lines::only_blocks(text)?;
        toml_lines::parse("a bridge file", text, |file: &mut Self| {
            file.directory = directory;
            text.clone_into(&mut file.text);
            file.validate()
        })
    }

    fn validate(&self) -> Result<()> {
        of_schema(SCHEMA, self.schema)?;
        positive("air_density_kg_m3", self.air_density_kg_m3)?;
        positive("flutter.speed_max_m_s", self.flutter.speed_max_m_s)?;
        if let Some(required) = self.flutter.required_speed_m_s {
            positive("flutter.required_speed_m_s", required)?;
        }
        let any = !self.sections.is_empty();
        ensure(any, "section", "at least one [[section]]", "none")?;
        for (i, section) in self.sections.iter().enumerate() {
            section.validate(&format!("section[{i}]"))?;
            let (name, place) = (&section.name, format!("section[{i}].name"));
            let is_new = self.sections[..i].iter().all(|s| s.name != *name);
            let expected = "a name that no section before it has";
            ensure(is_new, place, expected, format_args!("`{name}`"))?;
        }
        for (i, damper) in self.dampers.iter().enumerate() {
            damper.validate(&format!("damper[{i}]"))?;
        }
        self.wind.validate()?;
        match (self.modes.format, &self.modes.axes, &self.modes.span) {
            (ModesFormat::Matlab, _, None) => {
                let expected = "span_m, mass_kg_m and inertia_kg_m2_m for MATLAB files";
                return Err(Error::input("modes.span", expected, "none"));
            }
            (ModesFormat::Wawi | ModesFormat::Abaqus | ModesFormat::Opensees, None, _) => {
                let expected = "up and downwind in the axes of the files, e.g. { up = \"z\", downwind = \"-y\" }";
                return Err(Error::input("modes.axes", expected, "none"));
            }
            _ => {}
        }
        if let Some(span) = &self.modes.span {
            positive("modes.span.span_m", span.span_m)?;
            positive("modes.span.mass_kg_m", span.mass_kg_m)?;
            positive("modes.span.inertia_kg_m2_m", span.inertia_kg_m2_m)?;
        }
        let ratios = match &self.modes.damping_ratio {
            DampingRatios::Same(ratio) => std::slice::from_ref(ratio),
            DampingRatios::Each(all) => all,
        };
        let check = |ratio: &f64| {
            non_negative("modes.damping_ratio", *ratio)?;
            // no mode would oscillate, and none could be followed
            let expected = "a ratio to critical damping below 1";
            ensure(*ratio < 1.0, "modes.damping_ratio", expected, ratio)
        };
        ratios.iter().try_for_each(check)
    }

    /// The dampers at nodes of these modes.
    ///
    /// # Errors
    /// [`Error::Input`] with the key for a node that is none.
    pub fn dampers(&self, modes: &BridgeModes) -> Result<Dampers> {
        let mut all = Dampers::default();
        for (i, block) in self.dampers.iter().enumerate() {
            block.add(&format!("damper[{i}]"), modes, &mut all)?;
        }
        Ok(all)
    }

    /// The same error with the file, and the line of the key that it names.
    pub fn located(&self, error: Error) -> Error {
        let error = toml_lines::with_line(&self.text, error);
        match &self.path {
            Some(path) => error.in_file(path),
            None => error,
        }
    }

    /// The modes that take part, with their damping.
    ///
    /// # Errors
    /// [`Error::Io`] and [`Error::Input`] with file and place for what the files of the modes lack.
    pub fn read_modes(&self) -> Result<BridgeModes> {
        let block = &self.modes;
        let path = self.directory.join(&block.path);
        let mut modes = match block.format {
            ModesFormat::Embedded => embedded::modes(&block.path.to_string_lossy())?,
            ModesFormat::Csv if !path.is_dir() => parsed(&path, single_file::parse)?,
            ModesFormat::Matlab => {
                let span = block.span.as_ref();
                let span = span.ok_or_else(|| Error::input("modes.span", "the span", "none"))?;
                matlab::read(&path, span)?
            }
            program => {
                let axes = block.axes.as_ref().ok_or_else(|| {
                    let expected = "up and downwind in the axes of the tables, e.g. { up = \"z\", downwind = \"-y\" }";
                    Error::input("modes.axes", expected, "none")
                })?;
                let frame = axes.frame()?;
                let (nodes, modes) = match program {
                    ModesFormat::Wawi => wawi::read(&path, &frame)?,
                    ModesFormat::Abaqus => abaqus::read(&path, &frame)?,
                    ModesFormat::Opensees => opensees::read(&path, &frame)?,
                    _ => tables::read(&path, &frame)?,
                };
                let source = path.display().to_string();
                BridgeModes::in_frame(&frame, nodes, modes, source).map_err(|e| e.in_file(&path))?
            }
        };
        block.damping_ratio.apply(&mut modes.modes)?;
        if let Some(select) = &block.select {
            keep(select, &mut modes)?;
        }
        Ok(modes)
    }
}
