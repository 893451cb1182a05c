//! The records of a study: measured, or made by the virtual tunnel of its deck.

use super::Study;
use super::deck::{Deck, FLAT_PLATE, chosen};
use crate::error::{Error, Result, ensure};
use crate::identification::KeptRecord;
use crate::section::Dof;
use crate::units::{SAME_SPEED, group_of, near_groups};
use crate::wind_tunnel::{Record, RecordFile, RecordSource};
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};
use std::path::{Path, PathBuf};

/// A number of all motions and forces, of the first block alone or of all; none where they cannot be read, which is said where they
/// are used.
fn digest(record: &RecordFile, whole: bool) -> Option<u64> {
    let (mut hasher, mut blocks) = (DefaultHasher::new(), 0);
    let read = record.for_each_block(&mut |block| {
        let samples = block.iter().copied().flatten();
        samples.for_each(|x| x.to_bits().hash(&mut hasher));
        blocks += 1;
        match whole {
            true => Ok(()),
            // ends the reading
            false => Err(Error::Numerical(String::new())),
        }
    });
    (blocks > 0 && (read.is_ok() || !whole)).then(|| hasher.finish())
}

/// Whether two records hold the same samples, whatever they are called and however they are written: noise never repeats.
fn same_samples(a: &RecordFile, b: &RecordFile) -> bool {
    let all = digest(a, true);
    all.is_some() && all == digest(b, true)
}

/// Refuses widths that differ, and a record that is there twice.
fn check_together(files: &[RecordFile], paths: &[PathBuf]) -> Result<()> {
    let width_m = files.first().map_or(0.0, |r| r.header().width_m);
    let begin: Vec<Option<u64>> = files.iter().map(|f| digest(f, false)).collect();
    for (i, (file, path)) in files.iter().zip(paths).enumerate() {
        let same_as = format_args!("in {}", paths[0].display());
        let same = file.header().check_width(width_m, "width_m", same_as);
        same.map_err(|e| e.in_file(path))?;
        let mut alike = (0..i).filter(|j| begin[*j].is_some() && begin[*j] == begin[i]);
        if let Some(first) = alike.find(|j| same_samples(&files[*j], file)) {
            let expected = "each record once: what stands twice looks better known than it is";
            let found = format!("the same as in {}", paths[first].display());
            return Err(Error::input("", expected, found).in_file(path));
        }
    }
    Ok(())
}

/// Records, in groups of one mean speed.
pub struct RecordSet {
    records: Vec<Box<dyn RecordSource>>,
    /// Mean speeds of the groups, m/s, rising.
    groups_m_s: Vec<Vec<f64>>,
    /// What of the files is not used, for the report of a fit.
    pub(crate) note: Option<String>,
}

impl RecordSet {
    /// The records that the study states.
    pub(crate) fn measured(study: &Study) -> Result<Self> {
        let paths = study.deck.records.iter().map(|p| study.directory.join(p));
        let paths: Vec<PathBuf> = paths.collect();
        Self::open(&paths, &study.section.dofs())
    }

    /// Records in memory.
    pub(crate) fn in_memory(records: Vec<Record>) -> Self {
        Self::new(records.into_iter().map(|r| Box::new(r) as _).collect())
    }

    /// All records of a folder, as `tunnel` writes them of the deck; none when no model of the study needs any.
    pub(crate) fn in_folder(study: &Study, deck: &Deck, folder: &Path) -> Result<Self> {
        let needed = study.select || study.models.iter().any(|m| m.table.is_none());
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
        let expected =
            "records (run `aerodeck tunnel` first, or name your own under `deck.records`)";
        let enough = !needed || !paths.is_empty();
        ensure(enough, "", expected, "none").map_err(|e| e.in_file(folder))?;
        paths.sort();
        let own = deck.table_name().unwrap_or(FLAT_PLATE);
        for path in &paths {
            let record = RecordFile::open(path)?;
            let header = record.header();
            let is_own =
                header.name.starts_with(own) || !header.source.starts_with("virtual tunnel");
            let expected = format_args!(
                "a record of {own} (run `aerodeck tunnel` again, into an empty folder)"
            );
            ensure(is_own, "name", expected, &header.name).map_err(|e| e.in_file(path))?;
        }
        Self::open(&paths, &study.section.dofs())
    }

    /// No records at all: enough for models that are fitted to tables.
    pub fn none() -> Self {
        Self {
            records: Vec::new(),
            groups_m_s: Vec::new(),
            note: None,
        }
    }

    /// As tables are cut to the motions of a section: channels of other motions are left out, and records in which those are driven.
    fn open(paths: &[PathBuf], dofs: &[Dof]) -> Result<Self> {
        let files: Vec<_> = paths.iter().map(RecordFile::open).collect::<Result<_>>()?;
        check_together(&files, paths)?;
        let mut others: Vec<Dof> = files.iter().flat_map(|f| f.header().dofs.clone()).collect();
        others.retain(|dof| !dofs.contains(dof));
        others.sort();
        others.dedup();
        let (mut records, mut left_out) = (Vec::new(), Vec::new());
        for file in files {
            let record = KeptRecord::new(file, dofs);
            match record.drives_another()? {
                true => left_out.push(record.header().name.clone()),
                false => records.push(Box::new(record) as _),
            }
        }
        let others = Dof::names(&others);
        let expected =
            format_args!("a record in which no {others} is driven, for the section has none");
        let any = !records.is_empty() || left_out.is_empty();
        ensure(any, "deck.records", expected, left_out.join(", "))?;
        let mut read = Self::new(records);
        read.note = (!others.is_empty()).then(|| {
            let records = match left_out.is_empty() {
                true => String::new(),
                false => format!(
                    ", and records in which it is driven: {}",
                    left_out.join(", ")
                ),
            };
            format!("the section has no {others} motion; its channels are not used{records}")
        });
        Ok(read)
    }

    fn new(records: Vec<Box<dyn RecordSource>>) -> Self {
        let speeds = records.iter().map(|r| r.header().mean_speed_m_s);
        let groups_m_s = near_groups(speeds, SAME_SPEED);
        Self {
            records,
            groups_m_s,
            note: None,
        }
    }

    /// The records of the chosen groups (from 1; all when `None`).
    pub(crate) fn select(&self, groups: Option<&[usize]>) -> Result<Vec<&dyn RecordSource>> {
        let chosen = chosen(groups, self.groups_m_s.len())?;
        let inside = |record: &&dyn RecordSource| {
            let speed = record.header().mean_speed_m_s;
            chosen.contains(&group_of(&self.groups_m_s, speed))
        };
        let records = self.records.iter().map(AsRef::as_ref);
        Ok(records.filter(inside).collect())
    }
}
