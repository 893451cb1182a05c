//! The deck of a study: a measured table or the flat plate, and the records made from it or measured.

use super::Study;
use crate::aerodynamics::derivatives::TransferSample;
use crate::aerodynamics::derivatives::{
    DerivativeTable, Extrapolation, InterpolatedTable, embedded, read_table_in,
};
use crate::aerodynamics::{AerodynamicModel, FlatPlate};
use crate::error::{Error, Result};
use crate::flutter::{FlutterSearch, OnsetInterval, determinant_onset};
use crate::identification::sample_model;
use crate::section::{Dof, Structure};
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use crate::wind_tunnel::{Record, RecordFile, RecordSource};
use std::path::{Path, PathBuf};

/// Name of the exact flat plate as a source.
const FLAT_PLATE: &str = "flat plate";
/// Mean speeds less than this ratio apart belong to one group, as in the tables.
const GROUP_RATIO: f64 = 1.05;
/// Reduced frequencies in which the onset of the flat plate is searched: still air to nearly steady flow.
const EXACT_RANGE: (f64, f64) = (0.02, 10.0);

/// Where the aerodynamics of a study come from.
#[derive(Debug, Clone)]
pub struct Deck {
    source: Source,
    /// Whether the table is part of this program.
    built_in: bool,
    dofs: Vec<Dof>,
}

#[derive(Debug, Clone)]
enum Source {
    Table(DerivativeTable),
    FlatPlate,
}

impl Deck {
    /// The deck that the study names.
    ///
    /// # Errors
    /// [`Error::Input`] for a name that is none and a table that is wrong; [`Error::Io`] for a file that cannot be read.
    pub fn load(study: &Study) -> Result<Self> {
        let name = study.deck.source.trim();
        let dofs = study.section.dofs();
        let is_file = [".csv", ".xlsx"]
            .iter()
            .any(|e| name.to_lowercase().ends_with(e));
        let source = if name.eq_ignore_ascii_case(FLAT_PLATE) {
            Source::FlatPlate
        } else if is_file {
            let stated = study.deck.convention;
            Source::Table(read_table_in(study.directory.join(name), stated)?.0)
        } else {
            Source::Table(embedded::deck(name)?)
        };
        if !is_file && !study.deck.convention.is_empty() {
            return Err(Error::input(
                "deck.convention",
                "a table in a file (.csv, .xlsx) as deck.source",
                format!("`{name}`, whose convention is known"),
            ));
        }
        if let Source::Table(table) = &source {
            table.require(&dofs)?;
        } else if dofs != Dof::TWO {
            return Err(Error::input(
                "deck.source",
                "a table, since the section has a lateral degree of freedom",
                FLAT_PLATE,
            ));
        }
        let built_in = matches!(source, Source::Table(_)) && !is_file;
        Ok(Self {
            source,
            built_in,
            dofs,
        })
    }

    /// The deck in words.
    pub fn description(&self) -> String {
        match &self.source {
            Source::Table(table) => format!("{}: {}", table.name, table.header.source),
            Source::FlatPlate => "flat plate, Theodorsen's theory, exact".to_owned(),
        }
    }

    /// Licence notice of the data.
    pub fn licence(&self) -> String {
        match &self.source {
            // the notice has to go wherever the figures go
            Source::Table(_) if self.built_in => embedded::LICENCE.to_owned(),
            Source::Table(table) => table.header.licence.clone(),
            Source::FlatPlate => "none needed: a closed formula".to_owned(),
        }
    }

    /// Name of the deck's own model, searched by the determinant.
    pub fn own_model_name(&self) -> String {
        match &self.source {
            Source::Table(_) => "interpolated table".to_owned(),
            Source::FlatPlate => "flat plate (exact)".to_owned(),
        }
    }

    /// Records of the virtual tunnel, one a motion and speed.
    ///
    /// # Errors
    /// Those of the tunnel.
    pub fn virtual_records(&self, study: &Study) -> Result<Vec<Record>> {
        match &self.source {
            Source::Table(table) => study.tunnel.records_from_table(table, &self.dofs),
            Source::FlatPlate => study.tunnel.records_from_model(
                &FlatPlate::default(),
                FLAT_PLATE,
                study.section.width_m,
            ),
        }
    }

    /// What the deck says about `G`, at the chosen groups of speeds (from 1; all when `None`).
    ///
    /// # Errors
    /// [`Error::Input`] for a group that does not exist.
    pub fn samples(&self, study: &Study, groups: Option<&[usize]>) -> Result<Vec<TransferSample>> {
        match &self.source {
            Source::Table(table) => {
                let Some(groups) = groups else {
                    return Ok(table.samples(&self.dofs));
                };
                let mut samples = Vec::new();
                for group in groups {
                    let part = table.at_speed_group(group_index(*group)?)?;
                    samples.extend(part.samples(&self.dofs));
                }
                Ok(samples)
            }
            Source::FlatPlate => {
                // groups are numbered from the lowest speed, as those of tables and records
                let mut speeds = study.tunnel.speeds_m_s.clone();
                speeds.sort_by(f64::total_cmp);
                let chosen = chosen(groups, speeds.len())?;
                let ks: Vec<_> = chosen
                    .iter()
                    .flat_map(|i| {
                        study.tunnel.frequencies_hz.iter().map(|f| {
                            ReducedFrequency::from_hertz(*f, study.section.width_m, speeds[*i])
                        })
                    })
                    .collect();
                sample_model(&FlatPlate::default(), &ks)
            }
        }
    }

    /// The measured table; `None` for the flat plate.
    pub fn table(&self) -> Option<&DerivativeTable> {
        match &self.source {
            Source::Table(table) => Some(table),
            Source::FlatPlate => None,
        }
    }

    /// The deck as a force model that answers at every reduced frequency, and where it was tested (everywhere when
    /// `None`). Outside, a table keeps the values of its nearest points.
    ///
    /// # Errors
    /// [`Error::Input`] when the table lacks a derivative of the section.
    pub fn model(&self) -> Result<(Box<dyn AerodynamicModel>, Option<ReducedFrequencyRange>)> {
        match &self.source {
            Source::Table(table) => {
                let model = InterpolatedTable::new(table, &self.dofs, Extrapolation::Hold)?;
                let range = model.tested_range();
                Ok((Box::new(model), Some(range)))
            }
            Source::FlatPlate => Ok((Box::new(FlatPlate::default()), None)),
        }
    }

    /// Onset of the deck itself by the determinant.
    ///
    /// # Errors
    /// Those of the search.
    pub fn own_onset(&self, structure: &Structure, speed_max_m_s: f64) -> Result<FlutterSearch> {
        let name = self.own_model_name();
        match &self.source {
            Source::Table(table) => {
                let model = InterpolatedTable::new(table, &self.dofs, Extrapolation::Refuse)?;
                let range = model.tested_range();
                let mut search = determinant_onset(&name, structure, &model, range, speed_max_m_s)?;
                if let FlutterSearch::Onset(onset) = &mut search {
                    onset.interval = OnsetInterval::none(
                        "the table states no errors, and interpolation leaves no residuals to judge them by",
                    );
                }
                Ok(search)
            }
            Source::FlatPlate => {
                let range = ReducedFrequencyRange {
                    min: ReducedFrequency::from_full_width(EXACT_RANGE.0),
                    max: ReducedFrequency::from_full_width(EXACT_RANGE.1),
                };
                let mut search = determinant_onset(
                    &name,
                    structure,
                    &FlatPlate::default(),
                    range,
                    speed_max_m_s,
                )?;
                if let FlutterSearch::Onset(onset) = &mut search {
                    // exact at every K: there is no tested range to leave
                    onset.in_tested_range = None;
                    onset.interval =
                        OnsetInterval::none("a closed formula, without data that scatter");
                }
                Ok(search)
            }
        }
    }
}

fn group_index(group: usize) -> Result<usize> {
    group
        .checked_sub(1)
        .ok_or_else(|| Error::input("speed_groups", "numbers from 1", "0"))
}

/// Indices of the chosen groups among `count`.
fn chosen(groups: Option<&[usize]>, count: usize) -> Result<Vec<usize>> {
    let Some(groups) = groups else {
        return Ok((0..count).collect());
    };
    groups
        .iter()
        .map(|group| {
            let index = group_index(*group)?;
            if index < count {
                Ok(index)
            } else {
                Err(Error::input(
                    "speed_groups",
                    format!("numbers from 1 to {count}"),
                    group.to_string(),
                ))
            }
        })
        .collect()
}

/// Records on disk, in groups of one mean speed.
pub struct RecordSet {
    records: Vec<RecordFile>,
    /// Mean speeds of the groups, m/s, rising.
    speeds_m_s: Vec<f64>,
}

impl RecordSet {
    /// The records that the study states.
    ///
    /// # Errors
    /// Those of reading.
    pub fn measured(study: &Study) -> Result<Self> {
        let paths = study.deck.records.iter().map(|p| study.directory.join(p));
        Self::open(paths.collect())
    }

    /// Records just written, still in memory.
    ///
    /// # Errors
    /// Those of reading.
    pub fn staged(written: Vec<(PathBuf, Record)>) -> Result<Self> {
        Self::open(written.into_iter().map(|(path, _)| path).collect())
    }

    /// All records of a folder, as `tunnel` writes them; none when no model of the study needs any.
    ///
    /// # Errors
    /// [`Error::Input`] when there are none although a model needs them; those of reading.
    pub fn in_folder(study: &Study, folder: &Path) -> Result<Self> {
        let needed = study.models.iter().any(|m| m.table.is_none());
        let mut paths = Vec::new();
        if folder.is_dir() {
            let entries = std::fs::read_dir(folder).map_err(|e| Error::io(folder, e))?;
            for entry in entries {
                let path = entry.map_err(|e| Error::io(folder, e))?.path();
                if path.extension().is_some_and(|e| e == "csv") {
                    paths.push(path);
                }
            }
        }
        if needed && paths.is_empty() {
            return Err(Error::input(
                "",
                "records (run `aerodeck tunnel` first, or name your own under `deck.records`)",
                "none",
            )
            .in_file(folder));
        }
        paths.sort();
        Self::open(paths)
    }

    fn open(paths: Vec<PathBuf>) -> Result<Self> {
        let records = paths
            .iter()
            .map(RecordFile::open)
            .collect::<Result<Vec<_>>>()?;
        let mut speeds: Vec<f64> = records.iter().map(|r| r.header().mean_speed_m_s).collect();
        speeds.sort_by(f64::total_cmp);
        speeds.dedup_by(|next, kept| *next < *kept * GROUP_RATIO);
        Ok(Self {
            records,
            speeds_m_s: speeds,
        })
    }

    /// The records of the chosen groups (from 1; all when `None`).
    ///
    /// # Errors
    /// [`Error::Input`] for a group that does not exist.
    pub fn select(&self, groups: Option<&[usize]>) -> Result<Vec<&dyn RecordSource>> {
        let chosen = chosen(groups, self.speeds_m_s.len())?;
        let inside = |record: &&RecordFile| {
            let speed = record.header().mean_speed_m_s;
            chosen.iter().any(|i| {
                let low = self.speeds_m_s[*i];
                low <= speed && speed < low * GROUP_RATIO
            })
        };
        Ok(self
            .records
            .iter()
            .filter(inside)
            .map(|r| r as &dyn RecordSource)
            .collect())
    }
}
