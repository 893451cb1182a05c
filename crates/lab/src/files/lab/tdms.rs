//! NI TDMS, read here: of the readers on offer, `tdms-rs` 2.0 takes one block of samples per segment and knows no
//! interleaved data, so that files written by LabVIEW in several blocks come out short without a word, and `tdms` 0.3
//! calls itself unfinished.
//!
//! A file is a row of segments, each with metadata (objects with their properties and the layout of their samples) and
//! samples: as many blocks of that layout as fit. What a segment does not state is as in the one before. Not read:
//! DAQmx raw data, texts, time stamps, complex numbers, and channels whose samples still have to be scaled.

use super::channels::{Attribute, ChannelSet, check_count, no_group};
use super::tdms_bytes::{Bytes, STRING, no_number, property, size_of, take_numbers};
use crate::error::{Error, Result, ensure};
use std::collections::{BTreeMap, HashMap};

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

/// Where the samples of one channel in a block.
#[derive(Debug, Clone, Copy)]
struct SampleLayout {
    kind: u32,
    count: usize,
    /// Bytes of all of them.
    size: usize,
}

#[derive(Debug, Default)]
struct Object {
    path: String,
    /// Whether it is in `active`.
    is_active: bool,
    properties: BTreeMap<String, Attribute>,
    layout: Option<SampleLayout>,
    /// Why it is left out, if any of its samples are no numbers.
    no_number: Option<&'static str>,
    samples: Vec<f64>,
}

/// Objects of one file at most.
const OBJECTS_AT_MOST: usize = 20_000;
/// Layouts looked at over all segments at most: 20 channels in 10 million segments.
const LOOKS_AT_MOST: usize = 200_000_000;

#[derive(Debug, Default)]
struct TdmsFile {
    /// In the order in which they are first named.
    objects: Vec<Object>,
    /// Place of an object by its path.
    places: HashMap<String, usize>,
    /// Objects with samples in the current segment, in order.
    active: Vec<usize>,
    /// Samples taken so far.
    samples: u64,
    /// Layouts looked at so far.
    looks: usize,
}

impl TdmsFile {
    /// Takes the segment at a byte; the byte behind it.
    fn take_segment(&mut self, data: &[u8], start: usize) -> Result<usize> {
        let mut bytes = Bytes {
            data,
            at: start,
            big_endian: false,
        };
        let place = format_args!("segment at byte {start}");
        let mark = bytes.take(4)? == b"TDSm";
        ensure(mark, place, "the mark TDSm", "something else")?;
        let contents = bytes.u32()?;
        bytes.big_endian = contents & IS_BIG_ENDIAN != 0;
        let _version = bytes.u32()?;
        let (length, metadata) = (bytes.u64()?, bytes.u64()?);
        let closed = length != u64::MAX;
        ensure(closed, place, "a file that was closed", "an open end")?;
        let behind = |offset: u64| {
            let offset = usize::try_from(offset).ok()?;
            (start + LEAD_IN_BYTES).checked_add(offset)
        };
        let (end, raw) = match (behind(length), behind(metadata)) {
            (Some(end), Some(raw)) if raw <= end && end <= data.len() => (end, raw),
            _ => {
                let found = format!("{} (truncated?)", data.len() - start);
                return Err(Error::input(place, format!("{length} more bytes"), found));
            }
        };
        let plain = contents & IS_DAQMX == 0;
        ensure(plain, place, "samples", "DAQmx raw data, not read")?;
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
            for place in self.active.drain(..) {
                self.objects[place].is_active = false;
            }
        }
        for _ in 0..bytes.u32()? {
            let path = bytes.text()?;
            let at = format!("byte {}", bytes.at);
            let place = self.place_of(path, &at)?;
            let object = &mut self.objects[place];
            let has_samples = match bytes.u32()? {
                NO_SAMPLES => false,
                AS_BEFORE => true,
                _ => {
                    let kind = bytes.u32()?;
                    let _dimension = bytes.u32()?;
                    let count = usize::try_from(bytes.u64()?).unwrap_or(usize::MAX);
                    let size = match kind {
                        // of unequal length: the index has the whole
                        STRING => usize::try_from(bytes.u64()?).unwrap_or(usize::MAX),
                        _ => count.saturating_mul(size_of(kind, &object.path)?),
                    };
                    object.no_number = object.no_number.or(no_number(kind));
                    object.layout = Some(SampleLayout { kind, count, size });
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
            if object.is_active && !has_samples {
                self.looks += self.active.len();
                self.active.retain(|p| *p != place);
            } else if !object.is_active && has_samples {
                self.active.push(place);
            }
            self.objects[place].is_active = has_samples;
        }
        Ok(())
    }

    /// The place of an object, a new one when the path is new.
    fn place_of(&mut self, path: String, at: &str) -> Result<usize> {
        if let Some(place) = self.places.get(&path) {
            return Ok(*place);
        }
        let expected = format_args!("at most {OBJECTS_AT_MOST} channels and groups");
        ensure(self.objects.len() != OBJECTS_AT_MOST, at, expected, "more")?;
        self.objects.push(Object {
            path: path.clone(),
            ..Object::default()
        });
        self.places.insert(path, self.objects.len() - 1);
        Ok(self.objects.len() - 1)
    }

    /// The blocks up to `end`.
    fn take_samples(
        &mut self,
        bytes: &mut Bytes<'_>,
        end: usize,
        is_interleaved: bool,
    ) -> Result<()> {
        let raw = end.saturating_sub(bytes.at);
        if raw == 0 || self.active.is_empty() {
            return Ok(());
        }
        self.looks += self.active.len();
        let at = bytes.at;
        let place = format_args!("byte {at}");
        let expected = "fewer segments of so many channels (have the file defragmented)";
        ensure(self.looks <= LOOKS_AT_MOST, place, expected, "more")?;
        let layout = |place: &usize| Some((*place, self.objects[*place].layout?));
        let layouts: Vec<(usize, SampleLayout)> = self.active.iter().filter_map(layout).collect();
        if layouts.is_empty() {
            return Ok(());
        }
        let blocks = self.count_blocks(&layouts, raw, bytes.at)?;
        let rows = layouts[0].1.count;
        let alike = |l: &SampleLayout| l.count == rows && l.kind != STRING;
        let fits = !is_interleaved || layouts.iter().all(|(_, l)| alike(l));
        let expected = "interleaved channels of numbers, of one length";
        ensure(fits, place, expected, "others")?;
        // row by row, or channel by channel
        let (rows, each) = match is_interleaved {
            true => (rows, 1),
            false => (1, usize::MAX),
        };
        for _ in 0..blocks * rows {
            for (place, layout) in &layouts {
                if no_number(layout.kind).is_some() {
                    bytes.take(layout.size / rows)?;
                    continue;
                }
                let samples = &mut self.objects[*place].samples;
                take_numbers(bytes, layout.kind, layout.count.min(each), samples)?;
            }
        }
        Ok(())
    }

    /// Number of blocks in `raw` bytes of samples from the byte `at` on.
    fn count_blocks(
        &mut self,
        layouts: &[(usize, SampleLayout)],
        raw: usize,
        at: usize,
    ) -> Result<usize> {
        let (mut block, mut samples) = (0_usize, 0_usize);
        for (_, layout) in layouts {
            block = block.saturating_add(layout.size);
            // texts without number bound the blocks as well
            samples = samples.saturating_add(layout.count.max(usize::from(layout.size > 0)));
        }
        let place = format_args!("byte {at}");
        let expected = format_args!("whole blocks of {block} bytes");
        let is_whole = block != 0 && raw.is_multiple_of(block);
        let found = format_args!("{raw} bytes of samples");
        ensure(is_whole, place, expected, found)?;
        let blocks = raw / block;
        self.samples += samples.saturating_mul(blocks) as u64;
        check_count(place, self.samples)?;
        Ok(blocks)
    }

    fn channels(self, group: Option<&str>) -> Result<ChannelSet> {
        let mut set = ChannelSet::default();
        let parts = |object: Object| (path_parts(&object.path), object);
        let objects: Vec<(Vec<String>, Object)> = self.objects.into_iter().map(parts).collect();
        if let Some(wanted) = group {
            let groups = objects.iter().filter_map(|(p, _)| p.first().cloned());
            let mut groups: Vec<String> = groups.collect();
            if !groups.iter().any(|g| g == wanted) {
                groups.dedup();
                return Err(no_group(wanted, &groups));
            }
        }
        // scales stand on a channel, its group or the file
        let scaled_later: BTreeMap<Vec<String>, bool> = objects
            .iter()
            .filter_map(|(parts, object)| Some((parts.clone(), object.is_still_to_be_scaled()?)))
            .collect();
        let mut rates = Vec::new();
        for (parts, object) in objects {
            let mut nearest = (0..=parts.len()).rev();
            let is_raw = nearest.find_map(|n| scaled_later.get(&parts[..n])) == Some(&true);
            let inside = match (group, parts.first()) {
                (Some(wanted), Some(own)) if own != wanted => continue,
                (Some(_), Some(_)) => parts[1..].join("/"),
                _ => parts.join("/"),
            };
            if parts.len() < 2 {
                let prefix = match inside.is_empty() {
                    true => String::new(),
                    false => format!("{inside}/"),
                };
                let named = object.properties.into_iter();
                let named = named.map(|(name, value)| (format!("{prefix}{name}"), value));
                set.attributes.extend(named);
            } else if let Some(rate) = push_channel(&mut set, &inside, object, is_raw) {
                rates.push(rate);
            }
        }
        set.sampling_hz = common_rate(&rates)?;
        Ok(set)
    }
}

impl Object {
    fn number(&self, key: &str) -> Option<f64> {
        self.properties.get(key)?.number()
    }

    fn text(&self, key: &str) -> Option<&str> {
        match self.properties.get(key) {
            Some(Attribute::Text(t)) => Some(t),
            _ => None,
        }
    }

    /// Whether samples have still to go through scales, by what it states of them; none where it states nothing. Without a status they
    /// have.
    fn is_still_to_be_scaled(&self) -> Option<bool> {
        let status = self.text("NI_Scaling_Status").map(|s| s == "unscaled");
        match self.number("NI_Number_Of_Scales") {
            Some(scales) => Some(scales > 0.0 && status.unwrap_or(true)),
            None => status.filter(|unscaled| !unscaled),
        }
    }
}

/// Adds a channel; its sampling frequency, if it states one.
fn push_channel(set: &mut ChannelSet, name: &str, object: Object, is_raw: bool) -> Option<f64> {
    let step = object.number("wf_increment").filter(|step| *step > 0.0);
    let unit = object.text("unit_string").filter(|u| !u.is_empty());
    let unit = unit.map(str::to_owned);
    if is_raw {
        set.leave_out(name, "counts that still have to be scaled");
    } else if let Some(why) = object.no_number {
        set.leave_out(name, why);
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
        Some(other) => {
            let expected = "channels of one sampling frequency";
            let found = format!("{first} Hz and {other} Hz");
            Err(Error::input("wf_increment", expected, found))
        }
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
