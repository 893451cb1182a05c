//! The deck of a study: a measured table or the flat plate, and what it answers itself: its onset by the determinant, and its forces at rest.

use crate::aerodynamics::derivatives::notation::Convention;
use crate::aerodynamics::derivatives::{
    DerivativeTable, Extrapolation, InterpolatedTable, Interpolation, TransferSample,
};
use crate::aerodynamics::{FlatPlate, Transfer, TransferMatrix};
use crate::error::{Result, ensure};
use crate::files::derivatives::{
    ReadOptions, WIDTH_ASSUMED, embedded, is_table_file, read_table_with, state_angle,
};
use crate::flutter::{AssumedAtRest, FlutterSearch, OnsetInterval, determinant_onset, static_part};
use crate::identification::sample_model;
use crate::plausibility::{Finding, WIDEST_MODEL_M, of_table};
use crate::section::{Dof, Structure};
use crate::signal::extremes;
use crate::study::Study;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use crate::wind_tunnel::Record;

/// Name of the exact flat plate as a source.
pub(super) const FLAT_PLATE: &str = "flat plate";
/// Width of the section model of a plate that is itself too wide for a tunnel, m.
const PLATE_MODEL_WIDTH_M: f64 = 0.5;

/// Reduced frequencies in which the onset of the flat plate is searched: still air to nearly steady flow.
const EXACT_RANGE: [f64; 2] = [0.02, 10.0];

/// Where the aerodynamics of a study come from.
#[derive(Debug, Clone)]
pub struct Deck {
    /// The whole table; none for the flat plate, which is known exactly.
    whole: Option<DerivativeTable>,
    /// The part of the table at the speed groups of the deck, where it states some: a model may still be of another.
    chosen: Option<DerivativeTable>,
    interpolation: Interpolation,
    /// What was assumed in reading the table.
    pub(crate) notes: Vec<String>,
    /// What is odd about it.
    pub(crate) findings: Vec<Finding>,
    /// Whether the table is part of this program.
    built_in: bool,
    dofs: Vec<Dof>,
}

/// The table cut to the speed groups that the study asks for; none where it asks for none. Groups that only the records of a
/// study have are those of the records.
fn at_speeds(whole: Option<&DerivativeTable>, study: &Study) -> Result<Option<DerivativeTable>> {
    let (Some(table), Some(groups)) = (whole, &study.deck.speed_groups) else {
        return Ok(None);
    };
    let count = table.speed_groups().len().max(1);
    let of_records = !study.deck.records.is_empty() && groups.iter().any(|g| *g > count);
    if of_records {
        return Ok(None);
    }
    let cut = chosen(Some(groups), count).and_then(|groups| table.at_speed_groups(&groups));
    cut.map(Some).map_err(|e| e.at("deck.speed_groups"))
}

/// Width at which the flat plate is tested, m: speeds and frequencies of the tunnel are those of section models.
fn plate_width_m(study: &Study) -> f64 {
    match study.section.width_m {
        width_m if width_m < WIDEST_MODEL_M => width_m,
        _ => PLATE_MODEL_WIDTH_M,
    }
}

impl Deck {
    /// The deck that the study names.
    ///
    /// # Errors
    /// [`Error::Input`](crate::Error::Input) for a name that is none and a table that is wrong;
    /// [`Error::Io`](crate::Error::Io) for a file that cannot be read.
    pub fn load(study: &Study) -> Result<Self> {
        let name = study.deck.source.trim();
        let dofs = study.section.dofs();
        let is_file = is_table_file(name);
        let mut convention = Convention::default();
        let whole = if name.eq_ignore_ascii_case(FLAT_PLATE) {
            None
        } else if is_file {
            let options = ReadOptions {
                convention: study.deck.convention,
                width_m: study.deck.width_m,
                missing: study.deck.missing,
                ..ReadOptions::default()
            };
            let (mut table, of_file) = read_table_with(study.directory.join(name), &options)?;
            convention = of_file;
            let angle_deg = study.deck.angle_deg;
            state_angle(&mut table.header, "deck.angle_deg", angle_deg)?;
            Some(table)
        } else {
            let deck = embedded::deck_where_files_are_taken(name);
            Some(deck.map_err(|e| e.at("deck.source"))?)
        };
        let of = &study.deck;
        let found = format_args!("`{name}`, whose convention is known");
        let expected = "a table in a file (.csv, .xlsx) as deck.source";
        let known = is_file || of.convention.is_empty();
        ensure(known, "deck.convention", expected, found)?;
        let states = of.width_m.is_some() || of.angle_deg.is_some() || of.missing.is_some();
        let expected =
            "`width_m`, `angle_deg` and `missing` for a table in a file (.csv, .xlsx) only";
        let found = format_args!("source `{name}`");
        ensure(is_file || !states, "deck", expected, found)?;
        if let Some(table) = &whole {
            table.require(&dofs)?;
        } else {
            let expected = "a table, since the section has a lateral degree of freedom";
            ensure(dofs == Dof::TWO, "deck.source", expected, FLAT_PLATE)?;
        }
        let (mut notes, mut findings) = (Vec::new(), Vec::new());
        if let (Some(table), true) = (&whole, is_file) {
            // derivatives have no dimension: the width of an answer is that of the section, which is stated
            let of_answer = table.header.notes.iter();
            notes.extend(of_answer.filter(|n| !n.starts_with(WIDTH_ASSUMED)).cloned());
            findings.extend(of_table(table, &convention));
            if study.deck.records.is_empty() && study.models.iter().any(|m| m.table.is_none()) {
                notes.extend(study.tunnel.assumption(table));
            }
        }
        Ok(Self {
            chosen: at_speeds(whole.as_ref(), study)?,
            built_in: whole.is_some() && !is_file,
            whole,
            notes,
            findings,
            interpolation: study.deck.interpolation,
            dofs,
        })
    }

    /// The deck in words.
    pub(crate) fn description(&self) -> String {
        match &self.whole {
            Some(table) => format!("{}: {}", table.name, table.header.source),
            None => "flat plate, Theodorsen's theory, exact".to_owned(),
        }
    }

    /// Licence notice of the data.
    pub(crate) fn licence(&self) -> String {
        match &self.whole {
            // the notice has to go wherever the figures go
            Some(_) if self.built_in => embedded::LICENCE.to_owned(),
            Some(table) => table.header.licence.clone(),
            None => "none needed: a closed formula".to_owned(),
        }
    }

    /// Name of its table; none for a closed formula.
    pub(crate) fn table_name(&self) -> Option<&str> {
        self.whole.as_ref().map(|table| table.name.as_str())
    }

    /// Name of the deck's own model, searched by the determinant.
    pub(crate) fn own_model_name(&self) -> String {
        match &self.whole {
            Some(_) => "interpolated table".to_owned(),
            None => "flat plate (exact)".to_owned(),
        }
    }

    /// Records of the virtual tunnel, one per motion and speed.
    pub(crate) fn virtual_records(&self, study: &Study) -> Result<Vec<Record>> {
        let (plate, width_m) = (FlatPlate::default(), plate_width_m(study));
        match &self.whole {
            Some(table) => study.tunnel.records_from_table(table, &self.dofs),
            None => study.tunnel.records_from_model(&plate, FLAT_PLATE, width_m),
        }
    }

    /// What the deck says about `G`, at the chosen groups of speeds (from 1; all when `None`).
    pub(crate) fn samples(
        &self,
        study: &Study,
        groups: Option<&[usize]>,
    ) -> Result<Vec<TransferSample>> {
        if let Some(table) = &self.whole {
            if groups.is_none() {
                return Ok(table.samples(&self.dofs));
            }
            let groups = chosen(groups, table.speed_groups().len().max(1))?.into_iter();
            let parts = groups.map(|group| Ok(table.at_speed_group(group)?.samples(&self.dofs)));
            return Ok(parts.collect::<Result<Vec<_>>>()?.concat());
        }
        // groups are numbered from the lowest speed, as those of tables and records
        let mut speeds = study.tunnel.speeds_m_s.clone();
        speeds.sort_by(f64::total_cmp);
        let (width_m, mut ks) = (plate_width_m(study), Vec::new());
        for i in chosen(groups, speeds.len())? {
            let frequencies = study.tunnel.frequencies_hz.iter();
            ks.extend(frequencies.map(|f| ReducedFrequency::from_hertz(*f, width_m, speeds[i])));
        }
        sample_model(&FlatPlate::default(), &ks)
    }

    /// The measured table at the speeds of the deck; `None` for the flat plate.
    pub(crate) fn table(&self) -> Option<&DerivativeTable> {
        self.chosen.as_ref().or(self.whole.as_ref())
    }

    /// What was assumed in reading the table, and what looks wrong in it.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let found = self.findings.iter().map(ToString::to_string);
        self.notes.iter().cloned().chain(found).collect()
    }

    /// The deck as a force model that answers at every reduced frequency, and where it was tested (everywhere when
    /// `None`). Outside, a table holds values, from which nothing may be concluded
    /// ([`Transfer::known_range`]).
    ///
    /// # Errors
    /// [`Error::Input`] when the table lacks a derivative of the section.
    pub(crate) fn model(&self) -> Result<(Box<dyn Transfer>, Option<ReducedFrequencyRange>)> {
        match self.table() {
            Some(table) => {
                let by = self.interpolation;
                let model = InterpolatedTable::by(by, table, &self.dofs, Extrapolation::Hold)?;
                let range = model.tested_range();
                Ok((Box::new(model), Some(range)))
            }
            None => Ok((Box::new(FlatPlate::default()), None)),
        }
    }
}

/// Indices of the chosen groups among `count`, each once: what stands twice would look better known than it is.
pub(super) fn chosen(groups: Option<&[usize]>, count: usize) -> Result<Vec<usize>> {
    let Some(groups) = groups else {
        return Ok((0..count).collect());
    };
    let right =
        |(i, group): (usize, &usize)| (1..=count).contains(group) && !groups[..i].contains(group);
    let right = !groups.is_empty() && groups.iter().enumerate().all(right);
    let (place, found) = ("speed_groups", format_args!("{groups:?}"));
    let expected = format_args!("numbers from 1 to {count}, each once");
    ensure(right, place, expected, found)?;
    Ok(groups.iter().map(|group| group - 1).collect())
}

impl Deck {
    /// The forces on a section that is held, `G` at `K → 0` (n×n), and what a table does not say about them and was
    /// assumed.
    pub(crate) fn static_transfer(&self) -> Result<(TransferMatrix, Option<AssumedAtRest>)> {
        let (model, tested) = self.model()?;
        let Some(range) = tested else {
            let still = ReducedFrequency::from_full_width(0.0);
            return Ok((model.transfer(still)?, None));
        };
        let slopes = static_part(&self.dofs, &model.transfer(range.min)?);
        Ok((slopes, Some(AssumedAtRest::below(range.min)?)))
    }

    /// Onset of the deck itself by the determinant; for a table with the spread between ways of interpolation.
    pub(crate) fn own_onset(
        &self,
        structure: &Structure,
        speed_max_m_s: f64,
    ) -> Result<FlutterSearch> {
        let Some(table) = self.table() else {
            let [low, high] = EXACT_RANGE.map(ReducedFrequency::from_full_width);
            let (name, plate) = (self.own_model_name(), FlatPlate::default());
            let range = ReducedFrequencyRange::between(low, high);
            let mut search = determinant_onset(&name, structure, &plate, range, speed_max_m_s)?;
            if let FlutterSearch::Onset(onset) = &mut search {
                // exact at every K: there is no tested range to leave
                onset.in_tested_range = None;
                onset.interval = OnsetInterval::none("a closed formula, without data that scatter");
            }
            return Ok(search);
        };
        let mut search = self.table_onset(self.interpolation, table, structure, speed_max_m_s)?;
        if let FlutterSearch::Onset(onset) = &mut search {
            onset.interval = self.spread(table, structure, speed_max_m_s);
        }
        Ok(search)
    }

    fn table_onset(
        &self,
        by: Interpolation,
        table: &DerivativeTable,
        structure: &Structure,
        speed_max_m_s: f64,
    ) -> Result<FlutterSearch> {
        let model = InterpolatedTable::by(by, table, &self.dofs, Extrapolation::Refuse)?;
        let range = model.tested_range();
        let name = self.own_model_name();
        determinant_onset(&name, structure, &model, range, speed_max_m_s)
    }

    /// Onsets of the table by every way of interpolation, from the lowest to the highest.
    fn spread(
        &self,
        table: &DerivativeTable,
        structure: &Structure,
        speed_max_m_s: f64,
    ) -> OnsetInterval {
        let onset = |by: Interpolation| {
            let search = self.table_onset(by, table, structure, speed_max_m_s);
            search.ok()?.onset().map(|o| o.at.speed_m_s)
        };
        let onsets = Interpolation::ALL.map(|by| (by, onset(by)));
        let (low_m_s, high_m_s) = extremes(onsets.iter().filter_map(|(_, speed)| *speed));
        let words = onsets.map(|(by, speed)| {
            let speed = speed.map_or("none within the table".to_owned(), |v| format!("{v:.3}"));
            format!("{} {speed}", by.title())
        });
        OnsetInterval::Spread {
            low_m_s,
            high_m_s,
            of: format!("spread between interpolations: {}", words.join(", ")),
        }
    }
}
