//! NI TDMS, read here: of the readers on offer, `tdms-rs` 2.0 takes one block of samples a segment and knows no
//! interleaved data, so that files written by LabVIEW in several blocks come out short without a word, and `tdms` 0.3
//! calls itself unfinished.
//!
//! A file is a row of segments, each with metadata (objects with their properties and the layout of their samples) and
//! samples: as many blocks of that layout as fit. What a segment does not state is as in the one before. Not read:
//! DAQmx raw data, strings, time stamps, and channels whose samples still have to be scaled.

use super::tdms_bytes::Bytes;
use super::{Attribute, ChannelSet, no_group};
use crate::error::{Error, Result};
use std::collections::BTreeMap;

const LEAD_IN_BYTES: usize = 28;
const HAS_METADATA: u32 = 1 << 1;
const HAS_NEW_LIST: u32 = 1 << 2;
const HAS_RAW_DATA: u32 = 1 << 3;
const IS_INTERLEAVED: u32 = 1 << 5;
const IS_BIG_ENDIAN: u32 = 1 << 6;
const IS_DAQMX: u32 = 1 << 7;
/// In place of a length: no samples in this segment.
const NO_SAMPLES: u32 = u32::MAX;
/// In place of a length: samples as in the segment before.
const AS_BEFORE: u32 = 0;
/// Type codes.
const STRING: u32 = 0x20;
const BOOLEAN: u32 = 0x21;
const TIME_STAMP: u32 = 0x44;

/// Reads the bytes of a file, or one group of it.
///
/// # Errors
/// [`Error::Input`] with the byte for a file that is truncated or corrupt; for data in a form that is not read; for a
/// group that is not there.
pub(super) fn parse(data: &[u8], group: Option<&str>) -> Result<ChannelSet> {
    let mut file = TdmsFile::default();
    let mut at = 0;
    while at < data.len() {
        at = file.take_segment(data, at)?;
    }
    file.channels(group)
}

/// Layout of the samples of one channel in a block.
#[derive(Debug, Clone, Copy)]
struct Layout {
    kind: u32,
    count: usize,
}

#[derive(Debug, Default)]
struct Object {
    properties: BTreeMap<String, Attribute>,
    layout: Option<Layout>,
    samples: Vec<f64>,
}

#[derive(Debug, Default)]
struct TdmsFile {
    /// In the order in which they are first named.
    paths: Vec<String>,
    objects: BTreeMap<String, Object>,
    /// Objects with samples in the current segment, in order.
    active: Vec<String>,
}

impl TdmsFile {
    /// Takes the segment at a byte; the byte behind it.
    fn take_segment(&mut self, data: &[u8], start: usize) -> Result<usize> {
        let mut bytes = Bytes {
            data,
            at: start,
            big_endian: false,
        };
        let wrong = |expected: &str, found: String| {
            Error::input(format!("segment at byte {start}"), expected, found)
        };
        if bytes.take(4)? != b"TDSm" {
            return Err(wrong("the mark TDSm", "something else".to_owned()));
        }
        let contents = bytes.u32()?;
        bytes.big_endian = contents & IS_BIG_ENDIAN != 0;
        let _version = bytes.u32()?;
        let (length, metadata) = (bytes.u64()?, bytes.u64()?);
        if length == u64::MAX {
            return Err(wrong("a file that was closed", "an open end".to_owned()));
        }
        let behind = |offset: u64| {
            let offset = usize::try_from(offset).ok()?;
            (start + LEAD_IN_BYTES).checked_add(offset)
        };
        let (end, raw) = match (behind(length), behind(metadata)) {
            (Some(end), Some(raw)) if raw <= end && end <= data.len() => (end, raw),
            _ => {
                let found = format!("{} (truncated?)", data.len() - start);
                return Err(wrong(&format!("{length} more bytes"), found));
            }
        };
        if contents & IS_DAQMX != 0 {
            return Err(wrong("samples", "DAQmx raw data, not read".to_owned()));
        }
        if contents & HAS_METADATA != 0 {
            self.take_metadata(&mut bytes, contents & HAS_NEW_LIST != 0)?;
        }
        if contents & HAS_RAW_DATA != 0 {
            bytes.at = raw;
            self.take_samples(&mut bytes, end, contents & IS_INTERLEAVED != 0)?;
        }
        Ok(end)
    }

    fn take_metadata(&mut self, bytes: &mut Bytes<'_>, is_new_list: bool) -> Result<()> {
        if is_new_list {
            self.active.clear();
        }
        for _ in 0..bytes.u32()? {
            let path = bytes.text()?;
            let place = format!("byte {}", bytes.at);
            if !self.objects.contains_key(&path) {
                self.paths.push(path.clone());
            }
            let object = self.objects.entry(path.clone()).or_default();
            let has_samples = match bytes.u32()? {
                NO_SAMPLES => false,
                AS_BEFORE => true,
                length => {
                    let kind = bytes.u32()?;
                    let _dimension = bytes.u32()?;
                    let count = usize::try_from(bytes.u64()?).unwrap_or(usize::MAX);
                    if kind == STRING {
                        return Err(Error::input(
                            format!("{place}, {path}"),
                            "samples that are numbers",
                            format!("texts (index of {length} bytes)"),
                        ));
                    }
                    object.layout = Some(Layout { kind, count });
                    true
                }
            };
            for _ in 0..bytes.u32()? {
                let name = bytes.text()?;
                let value = property(bytes)?;
                if let Some(value) = value {
                    object.properties.insert(name, value);
                }
            }
            self.active.retain(|p| *p != path || has_samples);
            if has_samples && !self.active.contains(&path) {
                self.active.push(path);
            }
        }
        Ok(())
    }

    /// The blocks up to `end`.
    fn take_samples(
        &mut self,
        bytes: &mut Bytes<'_>,
        end: usize,
        is_interleaved: bool,
    ) -> Result<()> {
        let mut layouts = Vec::new();
        for path in &self.active {
            if let Some(layout) = self.objects.get(path).and_then(|o| o.layout) {
                layouts.push((path.clone(), layout));
            }
        }
        let mut block = 0_usize;
        for (path, layout) in &layouts {
            let size = layout.count.checked_mul(size_of(layout.kind, path)?);
            block = size
                .and_then(|s| block.checked_add(s))
                .unwrap_or(usize::MAX);
        }
        let raw = end.saturating_sub(bytes.at);
        if raw == 0 || layouts.is_empty() {
            return Ok(());
        }
        if block == 0 || !raw.is_multiple_of(block) {
            return Err(Error::input(
                format!("byte {}", bytes.at),
                format!("whole blocks of {block} bytes"),
                format!("{raw} bytes of samples"),
            ));
        }
        let rows = layouts[0].1.count;
        if is_interleaved && layouts.iter().any(|(_, l)| l.count != rows) {
            let place = format!("byte {}", bytes.at);
            return Err(Error::input(
                place,
                "interleaved channels of one length",
                "others",
            ));
        }
        for _ in 0..raw / block {
            let (rows, each) = if is_interleaved {
                (rows, 1)
            } else {
                (1, usize::MAX)
            };
            for _ in 0..rows {
                for (path, layout) in &layouts {
                    if let Some(object) = self.objects.get_mut(path) {
                        for _ in 0..layout.count.min(each) {
                            object.samples.push(sample(bytes, layout.kind)?);
                        }
                    }
                }
            }
        }
        Ok(())
    }

    fn channels(self, group: Option<&str>) -> Result<ChannelSet> {
        let mut set = ChannelSet::default();
        let parts: Vec<(String, Vec<String>)> = self
            .paths
            .iter()
            .map(|path| (path.clone(), path_parts(path)))
            .collect();
        if let Some(wanted) = group {
            let groups: Vec<String> = parts
                .iter()
                .filter_map(|(_, p)| p.first().cloned())
                .collect();
            if !groups.iter().any(|g| g == wanted) {
                let mut groups = groups;
                groups.dedup();
                return Err(no_group(wanted, &groups));
            }
        }
        let (mut objects, mut rates) = (self.objects, Vec::new());
        for (path, parts) in parts {
            let Some(object) = objects.remove(&path) else {
                continue;
            };
            let inside = match (group, parts.first()) {
                (Some(wanted), Some(own)) if own != wanted => continue,
                (Some(_), Some(_)) => parts[1..].join("/"),
                _ => parts.join("/"),
            };
            if parts.len() < 2 {
                let prefix = if inside.is_empty() {
                    String::new()
                } else {
                    format!("{inside}/")
                };
                for (name, value) in object.properties {
                    set.attributes.insert(format!("{prefix}{name}"), value);
                }
            } else if let Some(rate) = push_channel(&mut set, &inside, object) {
                rates.push(rate);
            }
        }
        set.sampling_hz = common_rate(&rates)?;
        Ok(set)
    }
}

/// Adds a channel; its sampling frequency, if it states one.
fn push_channel(set: &mut ChannelSet, name: &str, object: Object) -> Option<f64> {
    let number = |key: &str| match object.properties.get(key) {
        Some(Attribute::Number(x)) => Some(*x),
        _ => None,
    };
    let text = |key: &str| match object.properties.get(key) {
        Some(Attribute::Text(t)) => Some(t.clone()),
        _ => None,
    };
    let is_raw = number("NI_Number_Of_Scales").is_some_and(|n| n > 0.0)
        && text("NI_Scaling_Status").is_some_and(|s| s == "unscaled");
    let step = number("wf_increment").filter(|step| *step > 0.0);
    let unit = text("unit_string").filter(|u| !u.is_empty());
    if is_raw {
        set.leave_out(name, "counts that still have to be scaled");
    } else if object.layout.is_some_and(|l| l.kind == TIME_STAMP) {
        set.leave_out(name, "time stamps");
    } else if object.samples.is_empty() {
        set.leave_out(name, "empty");
    } else {
        set.push(name, object.samples, unit);
    }
    step.map(|step| 1.0 / step)
}

/// The one sampling frequency of all channels.
fn common_rate(rates: &[f64]) -> Result<Option<f64>> {
    let Some(first) = rates.first() else {
        return Ok(None);
    };
    match rates.iter().find(|r| (*r / first - 1.0).abs() > 1e-6) {
        None => Ok(Some(*first)),
        Some(other) => Err(Error::input(
            "wf_increment",
            "channels of one sampling frequency",
            format!("{first} Hz and {other} Hz"),
        )),
    }
}

/// `/'group'/'channel'` as its parts; a quote inside a name stands twice.
fn path_parts(path: &str) -> Vec<String> {
    let (mut parts, mut inside) = (Vec::new(), false);
    let mut letters = path.chars().peekable();
    while let Some(c) = letters.next() {
        match (c, inside) {
            ('\'', false) => {
                parts.push(String::new());
                inside = true;
            }
            ('\'', true) if letters.peek() != Some(&'\'') => inside = false,
            (c, true) => {
                if c == '\'' {
                    letters.next();
                }
                if let Some(part) = parts.last_mut() {
                    part.push(c);
                }
            }
            _ => {}
        }
    }
    parts
}

/// Bytes a sample.
fn size_of(kind: u32, path: &str) -> Result<usize> {
    match kind {
        1 | 5 | BOOLEAN => Ok(1),
        2 | 6 => Ok(2),
        3 | 7 | 9 | 0x19 => Ok(4),
        4 | 8 | 10 | 0x1a => Ok(8),
        TIME_STAMP => Ok(16),
        other => Err(Error::input(
            path,
            "samples that are numbers",
            format!("type {other:#x}"),
        )),
    }
}

fn sample(bytes: &mut Bytes<'_>, kind: u32) -> Result<f64> {
    Ok(match kind {
        1 => i8::from_le_bytes(bytes.little()?).into(),
        2 => i16::from_le_bytes(bytes.little()?).into(),
        3 => i32::from_le_bytes(bytes.little()?).into(),
        4 => i64::from_le_bytes(bytes.little()?) as f64,
        5 | BOOLEAN => u8::from_le_bytes(bytes.little()?).into(),
        6 => u16::from_le_bytes(bytes.little()?).into(),
        7 => u32::from_le_bytes(bytes.little()?).into(),
        8 => u64::from_le_bytes(bytes.little()?) as f64,
        9 | 0x19 => f32::from_le_bytes(bytes.little()?).into(),
        TIME_STAMP => {
            bytes.take(16)?;
            f64::NAN
        }
        // every other kind was refused before
        _ => f64::from_le_bytes(bytes.little()?),
    })
}

/// A property; `None` for one that is of no use here.
fn property(bytes: &mut Bytes<'_>) -> Result<Option<Attribute>> {
    match bytes.u32()? {
        STRING => Ok(Some(Attribute::Text(bytes.text()?))),
        TIME_STAMP => {
            bytes.take(16)?;
            Ok(None)
        }
        kind => {
            size_of(kind, &format!("byte {}, property", bytes.at))?;
            Ok(Some(Attribute::Number(sample(bytes, kind)?)))
        }
    }
}
