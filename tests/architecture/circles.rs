//! No circles between the files of a room: who reads a file need not know those that use it.

use crate::rules::{mentions, module_of};
use crate::source::{Mention, SourceFile};
use std::collections::{BTreeMap, BTreeSet};

/// A name may be passed on so many times.
const LONGEST_CHAIN: usize = 8;

/// The files of `src` by their module paths, with what each mentions.
struct Tree<'a> {
    files: BTreeMap<Vec<String>, (&'a str, Vec<Mention>)>,
}

/// Groups of files each of which needs all others, in order.
pub fn circles<'a>(files: impl Iterator<Item = (&'a str, &'a SourceFile)>) -> Vec<String> {
    let entry = |(path, source): (&'a str, &'a SourceFile)| {
        (module_of(path), (path, mentions(path, source)))
    };
    let tree = Tree {
        files: files.map(entry).collect(),
    };
    let needs: BTreeMap<&str, BTreeSet<&str>> = tree
        .files
        .values()
        .map(|(path, mentions)| (*path, tree.needed(path, mentions)))
        .collect();
    let reached: BTreeMap<&str, BTreeSet<&str>> = needs
        .keys()
        .map(|path| (*path, reach(path, &needs)))
        .collect();
    let circle = |path: &&str| -> Vec<&str> {
        let back = reached[path]
            .iter()
            .filter(|other| reached[*other].contains(path));
        back.copied().collect()
    };
    let all: BTreeSet<Vec<&str>> = reached.keys().map(circle).collect();
    all.iter()
        .filter(|files| files.len() > 1)
        .map(|files| files.join(" ↔ "))
        .collect()
}

/// All files that `from` needs, directly or not.
fn reach<'a>(from: &str, needs: &BTreeMap<&str, BTreeSet<&'a str>>) -> BTreeSet<&'a str> {
    let mut found = BTreeSet::new();
    let mut waiting: Vec<&str> = needs[from].iter().copied().collect();
    while let Some(path) = waiting.pop() {
        if found.insert(path) {
            waiting.extend(&needs[path]);
        }
    }
    found
}

impl<'a> Tree<'a> {
    /// The files that hold what is mentioned and not just passed on.
    fn needed(&self, own: &str, mentions: &[Mention]) -> BTreeSet<&'a str> {
        mentions
            .iter()
            .filter(|mention| !mention.is_public)
            .filter_map(|mention| self.file_of(&mention.path, LONGEST_CHAIN))
            .filter(|path| *path != own)
            .collect()
    }

    /// The file in which an item stands, through the files that pass it on.
    fn file_of(&self, path: &[String], chain: usize) -> Option<&'a str> {
        let (length, (file, mentions)) = (1..=path.len())
            .rev()
            .find_map(|length| Some((length, self.files.get(&path[..length])?)))?;
        let name = path.get(length);
        let passed_on = mentions
            .iter()
            .find(|m| name.is_some() && m.name.as_ref() == name);
        match passed_on {
            Some(mention) if chain > 0 => {
                let onward = [&mention.path[..], &path[length + 1..]].concat();
                self.file_of(&onward, chain - 1)
            }
            // a module that is named as a whole is no item of its file
            _ => (length < path.len()).then_some(*file),
        }
    }
}
