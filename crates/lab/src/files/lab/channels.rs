//! What a laboratory file holds: channels, single values and what was left out.

use crate::error::{Error, Place, Result, ensure};
use std::collections::BTreeMap;

/// What one file, or one group of it, holds.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ChannelSet {
    /// Sampled channels in the order of the file.
    pub channels: Vec<Channel>,
    /// Single numbers and texts by name.
    pub attributes: BTreeMap<String, Attribute>,
    /// Sampling frequency, Hz, where the file states it.
    pub sampling_hz: Option<f64>,
    /// What was not read: name and reason.
    pub left_out: Vec<(String, String)>,
}

/// One sampled channel.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Name, as a channel map has it.
    pub name: String,
    /// Samples in the unit of the file.
    pub samples: Vec<f64>,
    /// Unit, where the file states it.
    pub unit: Option<String>,
}

/// A single value.
#[derive(Debug, Clone, PartialEq)]
pub enum Attribute {
    /// A number.
    Number(f64),
    /// A text.
    Text(String),
}

impl Attribute {
    /// The number, if it is one.
    pub(super) fn number(&self) -> Option<f64> {
        match self {
            Self::Number(x) => Some(*x),
            Self::Text(_) => None,
        }
    }

    /// The value as text.
    pub(crate) fn text(&self) -> String {
        match self {
            Self::Number(x) => x.to_string(),
            Self::Text(text) => text.clone(),
        }
    }
}

/// Numbers in one file, or one group of it, at most: all channels of 46 for an hour at 200 Hz. With it each reader works within
/// 1 GiB for files of 100 MB.
pub(super) const NUMBERS_AT_MOST: u64 = 32 << 20;
/// Names in a message at most.
const NAMES_AT_MOST: usize = 60;

/// Refuses more numbers than a recording has.
pub(super) fn check_count(place: impl Into<Place>, numbers: u64) -> Result<()> {
    let expected = format_args!(
        "at most {NUMBERS_AT_MOST} numbers in a file or group (cut the recording, or give each run a group)"
    );
    ensure(numbers <= NUMBERS_AT_MOST, place, expected, numbers)
}

/// More channels than this in one array are taken for an image or a table, not for channels.
const CHANNELS_AT_MOST: usize = 512;

/// Names under which files state their sampling frequency in Hz, in lower case.
const SAMPLING_NAMES: [&str; 8] = [
    "sampling frequency",
    "sampling_frequency",
    "samplingfrequency",
    "sampling_hz",
    "sampling_rate",
    "sample_rate",
    "samplerate",
    "fs",
];

impl ChannelSet {
    /// The channel of this name.
    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|c| c.name == name)
    }

    /// The only channel of this name.
    ///
    /// # Errors
    /// [`Error::Input`] at `place` listing what the file holds when there is no such channel, and for several of the name.
    pub fn only_channel(&self, place: &str, name: &str) -> Result<&Channel> {
        let mut found = self.channels.iter().filter(|c| c.name == name);
        let first = found
            .next()
            .ok_or_else(|| Error::input(place, format!("a channel `{name}`"), self.listing()))?;
        let more = found.count();
        let expected = format_args!("one channel `{name}`");
        let named = format_args!("{} of that name", more + 1);
        ensure(more == 0, place, expected, named).map(|()| first)
    }

    /// The attribute of this name as a number.
    pub(crate) fn number(&self, name: &str) -> Option<f64> {
        self.attributes.get(name)?.number()
    }

    /// Everything that is there, in words, for a message.
    pub fn listing(&self) -> String {
        let names: Vec<&str> = self.channels.iter().map(|c| c.name.as_str()).collect();
        let mut text = match names.is_empty() {
            true => "no channel".to_owned(),
            false => format!("the channels {}", shortened(&names)),
        };
        let numbers = self.attributes.iter();
        let numbers = numbers.filter_map(|(name, a)| a.number().map(|_| name.as_str()));
        let numbers: Vec<&str> = numbers.collect();
        if !numbers.is_empty() {
            text.push_str(&format!("; the numbers {}", shortened(&numbers)));
        }
        for (name, reason) in self.left_out.iter().take(NAMES_AT_MOST) {
            text.push_str(&format!("; not read: {name} ({reason})"));
        }
        text
    }

    /// Takes the sampling frequency from an attribute of a usual name where the file states it no other way.
    pub(super) fn find_sampling(&mut self) {
        if self.sampling_hz.is_none() {
            let found = self.attributes.iter().find_map(|(name, value)| {
                let last = name.rsplit(['/', '.']).next().unwrap_or(name);
                let is_named = SAMPLING_NAMES.contains(&last.to_lowercase().as_str());
                value.number().filter(|_| is_named)
            });
            self.sampling_hz = found.filter(|hz| hz.is_finite() && *hz > 0.0);
        }
    }

    pub(super) fn push(
        &mut self,
        name: impl Into<String>,
        samples: Vec<f64>,
        unit: Option<String>,
    ) {
        self.channels.push(Channel {
            name: name.into(),
            samples,
            unit,
        });
    }

    /// Adds an array of `shape` under `name`: a number, a channel or one per column, time along the longer side. The first index of its elements runs fastest (MATLAB), or the
    /// last (HDF5).
    pub(super) fn push_array(
        &mut self,
        name: &str,
        shape: &[usize],
        first_is_fastest: bool,
        values: Vec<f64>,
        units: &[String],
    ) {
        let sides: Vec<usize> = shape.iter().copied().filter(|n| *n != 1).collect();
        // one unit for all columns, or one per column
        let unit = |column: usize, columns: usize| match units {
            [one] => Some(one.clone()),
            all if all.len() == columns => Some(all[column].clone()),
            _ => None,
        };
        match (sides.len(), &sides[..]) {
            _ if values.is_empty() => self.leave_out(name, "empty"),
            (0, _) => {
                self.attributes
                    .insert(name.to_owned(), Attribute::Number(values[0]));
            }
            (1, _) => self.push(name, values, unit(0, 1)),
            (2, &[rows, columns]) => {
                let (fast, slow) = match first_is_fastest {
                    true => (rows, columns),
                    false => (columns, rows),
                };
                let (samples, channels) = (rows.max(columns), rows.min(columns));
                // of equal sides it is the first
                let time_is_fast = fast > slow || (first_is_fastest && fast == slow);
                if channels > CHANNELS_AT_MOST {
                    self.leave_out(name, format!("{rows} × {columns} numbers"));
                    return;
                }
                for c in 0..channels {
                    let at = |i: usize| match time_is_fast {
                        true => values[c * fast + i],
                        false => values[i * fast + c],
                    };
                    let column = (0..samples).map(at).collect();
                    self.push(format!("{name}[{}]", c + 1), column, unit(c, channels));
                }
            }
            (dimensions, _) => self.leave_out(name, format!("an array of {dimensions} dimensions")),
        }
    }

    pub(super) fn leave_out(&mut self, name: impl Into<String>, reason: impl Into<String>) {
        self.left_out.push((name.into(), reason.into()));
    }
}

/// Names in a row, no more than a message should hold.
fn shortened(names: &[&str]) -> String {
    let shown = names[..names.len().min(NAMES_AT_MOST)].join(", ");
    match names.len().saturating_sub(NAMES_AT_MOST) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

/// The error that there is no such group.
pub(super) fn no_group(wanted: &str, groups: &[String]) -> Error {
    let groups: Vec<&str> = groups.iter().map(String::as_str).collect();
    let expected = match groups.is_empty() {
        true => "no group: the file has none".to_owned(),
        false => format!("one of the groups {}", shortened(&groups)),
    };
    Error::input("group", expected, format!("`{wanted}`"))
}
