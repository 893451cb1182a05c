//! Records as CSV: a header of `# key: value` lines, a line of column names, one row per sample.
//!
//! ```text
//! # aerodeck record 1
//! # name: …
//! # dofs: vertical, torsion
//! # width_m: 0.5
//! # air_density_kg_m3: 1.19
//! # mean_speed_m_s: 8.17
//! # sampling_hz: 200
//! # sign_convention: …
//! # source: …
//! # licence: …
//! # segment: 0.25 Hz from 8 s to 34 s      one line per stretch of harmonic motion
//! time_s,vertical_m,torsion_rad,lift_n_m,moment_n_m_m
//! 0,0,0,0,0
//! ```

use super::records::{RecordHeader, Segment};
use crate::error::{Error, Place, Result, ensure};
use crate::files::header_csv::{CommentHeader, HeaderLine};
use crate::section::Dof;
use std::io::{BufRead, Write};
use std::path::{Path, PathBuf};

/// First line of the file.
const FORMAT: &str = "aerodeck record 1";

/// Signs of all channels.
const SIGN_CONVENTION: &str = "y and lift up, theta and moment nose-up, x and drag downwind; self-excited forces per unit length";

/// Keys of the header; `segment` may stand several times.
const KEYS: [&str; 10] = [
    "name",
    "dofs",
    "width_m",
    "air_density_kg_m3",
    "mean_speed_m_s",
    "sampling_hz",
    "sign_convention",
    "source",
    "licence",
    "segment",
];

/// A record in a CSV file, read block by block whenever asked.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordFile {
    pub(super) path: PathBuf,
    pub(super) header: RecordHeader,
    /// Byte at which the first row begins.
    pub(super) start: u64,
    /// Line of the column names, from 1.
    pub(super) names_line: usize,
    /// Names of the columns.
    pub(super) names: Vec<String>,
    /// Channel of each column: `None` for the time, else motions and then forces in the order of the header.
    pub(super) channels: Vec<Option<usize>>,
}

/// Writes everything above the samples.
pub(super) fn write_head(header: &RecordHeader, out: &mut dyn Write) -> std::io::Result<()> {
    let entries = [
        ("name", header.name.as_str()),
        ("dofs", &Dof::names(&header.dofs)),
        ("width_m", &header.width_m.to_string()),
        ("air_density_kg_m3", &header.air_density_kg_m3.to_string()),
        ("mean_speed_m_s", &header.mean_speed_m_s.to_string()),
        ("sampling_hz", &header.sampling_hz.to_string()),
        ("sign_convention", SIGN_CONVENTION),
        ("source", &header.source),
        ("licence", &header.licence),
    ];
    CommentHeader::write(out, FORMAT, &entries)?;
    for s in &header.segments {
        let text = format!(
            "{} Hz from {} s to {} s",
            s.frequency_hz, s.start_s, s.end_s
        );
        CommentHeader::write_line(out, "segment", text)?;
    }
    writeln!(out, "{}", column_names(&header.dofs).join(","))
}

/// `time_s`, then the motions, then the forces.
fn column_names(dofs: &[Dof]) -> Vec<String> {
    let column = |name: &str, dof: &Dof, unit: &str, unit_of_rotation: &str| match dof {
        Dof::Torsion => format!("{name}_{unit_of_rotation}"),
        _ => format!("{name}_{unit}"),
    };
    let motions = dofs.iter().map(|d| column(d.name(), d, "m", "rad"));
    let forces = dofs
        .iter()
        .map(|d| column(d.force_name(), d, "n_m", "n_m_m"));
    let time = std::iter::once("time_s".to_owned());
    time.chain(motions).chain(forces).collect()
}

/// Reads everything above the samples.
pub(super) fn read_head(path: &Path, reader: &mut dyn BufRead) -> Result<RecordFile> {
    let mut head = CommentHeader::new(&[FORMAT], &KEYS, &["segment"]);
    let (mut start, mut line) = (0, Vec::new());
    let names = loop {
        line.clear();
        let read = reader.read_until(b'\n', &mut line);
        let read = read.map_err(|e| Error::io(path, e))?;
        start += read as u64;
        let place = || Place::line(head.lines() + 1);
        let text = text(&line).map_err(|found| Error::input(place(), "a line of text", found))?;
        let expected = "a line of column names";
        ensure(read != 0, place(), expected, "the end of the file")?;
        if !head.take(text)? {
            let names = text.split(',').map(|name| name.trim().to_owned());
            break names.collect::<Vec<_>>();
        }
    };
    let header = record_header(&head)?;
    let names_line = head.lines() + 1;
    let channels = find_channels(&names, &header.dofs, names_line)?;
    Ok(RecordFile {
        path: path.to_path_buf(),
        header,
        start,
        names_line,
        names,
        channels,
    })
}

fn record_header(head: &CommentHeader) -> Result<RecordHeader> {
    head.must_say("sign_convention", SIGN_CONVENTION)?;
    let positive = |key: &str| head.required(key)?.positive();
    Ok(RecordHeader {
        name: head.required("name")?.value.clone(),
        dofs: dofs(head.required("dofs")?)?,
        width_m: positive("width_m")?,
        air_density_kg_m3: positive("air_density_kg_m3")?,
        mean_speed_m_s: positive("mean_speed_m_s")?,
        sampling_hz: positive("sampling_hz")?,
        segments: head.all("segment").map(segment).collect::<Result<_>>()?,
        source: head.text("source"),
        licence: head.text("licence"),
    })
}

fn dofs(entry: &HeaderLine) -> Result<Vec<Dof>> {
    let one = |name: &str| Dof::THREE.into_iter().find(|d| d.name() == name.trim());
    let mut dofs: Option<Vec<Dof>> = entry.value.split(',').map(one).collect();
    // columns go by their names: in every file the channels come in one order
    dofs.iter_mut().for_each(|dofs| dofs.sort());
    dofs.filter(|dofs| dofs.windows(2).all(|pair| pair[0] != pair[1]))
        .ok_or_else(|| {
            entry.wrong("a list with commas of vertical, lateral, torsion, each at most once")
        })
}

fn segment(entry: &HeaderLine) -> Result<Segment> {
    let words: Vec<&str> = entry.value.split_whitespace().collect();
    let numbers = match words[..] {
        [f, "Hz", "from", start, "s", "to", end, "s"] => {
            [f, start, end].map(|word| word.parse().unwrap_or(f64::NAN))
        }
        _ => [f64::NAN; 3],
    };
    let [frequency_hz, start_s, end_s] = numbers;
    if frequency_hz > 0.0 && start_s >= 0.0 && end_s > start_s && end_s.is_finite() {
        return Ok(Segment {
            frequency_hz,
            start_s,
            end_s,
        });
    }
    Err(entry.wrong("a stretch like `0.25 Hz from 8 s to 34 s`"))
}

fn find_channels(names: &[String], dofs: &[Dof], line: usize) -> Result<Vec<Option<usize>>> {
    let expected = column_names(dofs);
    let place = Place::line(line);
    let wrong = |found: String| {
        let columns = format!("the columns {}, each once", expected.join(","));
        Error::input(&place, columns, found)
    };
    if let Some(missing) = expected.iter().find(|e| !names.contains(e)) {
        return Err(wrong(format!("no column `{missing}`")));
    }
    if names.len() > expected.len() {
        let unknown = names.iter().find(|n| !expected.contains(n));
        return Err(wrong(match unknown {
            Some(name) => format!("a column `{name}`"),
            None => "a column twice".to_owned(),
        }));
    }
    // Every expected name is there and there are no more, so each has one position.
    let channel = |name: &String| expected.iter().position(|e| e == name).unwrap_or(0);
    Ok(names.iter().map(|n| channel(n).checked_sub(1)).collect())
}

/// A line without its end.
pub(super) fn text(line: &[u8]) -> std::result::Result<&str, &'static str> {
    std::str::from_utf8(line)
        .map(|text| text.trim_end_matches(['\n', '\r']))
        .map_err(|_| "bytes that are no UTF-8")
}
