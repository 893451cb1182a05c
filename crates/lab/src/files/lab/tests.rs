//! Every kind of file against the closed form of its samples, and what corrupt files say.
//!
//! The files are written by `tests/data/lab/make_lab_files.py`.

mod bounds;
mod left_out;

use super::channels::Attribute;
use super::*;
use std::f64::consts::PI;
use std::path::PathBuf;
use std::time::{Duration, Instant};

const SAMPLES: usize = 128;

fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/data/lab")
        .join(name)
}

fn read(name: &str, group: Option<&str>) -> ChannelSet {
    ChannelSet::read(file(name), group).unwrap()
}

fn complaint(name: &str, bytes: &[u8], group: Option<&str>) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    let error = ChannelSet::read(&path, group).unwrap_err().to_string();
    error.replace(&format!("{}: ", path.display()), "")
}

/// The sample that the generator wrote.
fn expected(j: usize, i: usize) -> f64 {
    let j = j as f64;
    j + (j + 1.0) * (PI * (j + 1.0) * i as f64 / 200.0).sin()
}

fn check(set: &ChannelSet, name: &str, j: usize, scale: f64, tolerance: f64) {
    let channel = set
        .channel(name)
        .unwrap_or_else(|| panic!("{name}: {}", set.listing()));
    assert_eq!(channel.samples.len(), SAMPLES, "{name}");
    for (i, x) in channel.samples.iter().enumerate() {
        let e = scale * expected(j, i);
        assert!((x - e).abs() <= tolerance, "{name} {i}: {x} {e}");
    }
}

#[test]
fn csv_with_semicolons_and_decimal_commas() {
    let set = read("semicolons.csv", None);
    for (j, (name, unit)) in [("y", "mm"), ("theta", "deg"), ("Fx", "N")]
        .into_iter()
        .enumerate()
    {
        check(&set, name, j, 1.0, 5.1e-10); // nine decimals
        assert_eq!(set.channel(name).unwrap().unit.as_deref(), Some(unit));
    }
    assert_eq!(set.left_out, [("remark".to_owned(), "text".to_owned())]);
    assert_eq!(set.sampling_hz, None);
}

/// `1.234` among decimal commas may be a thousand.
#[test]
fn one_file_has_one_decimal_mark() {
    let message = complaint("a.csv", b"t;y\n0,5;1\n1,5;1.234\n", None);
    assert_eq!(
        message,
        "line 3, column y: expected decimals behind `,` as above, found `1.234`"
    );
}

#[test]
fn csv_with_comments_and_a_row_of_units() {
    let set = read("units_row.csv", None);
    for (j, name) in ["y", "theta", "Fx"].into_iter().enumerate() {
        check(&set, name, j, 1.0, 1e-11); // twelve digits
    }
    assert_eq!(set.channel("theta").unwrap().unit.as_deref(), Some("deg"));
    assert_eq!(set.sampling_hz, Some(200.0));
    let operator = Attribute::Text("nobody".to_owned());
    assert_eq!(set.attributes.get("operator"), Some(&operator));
}

#[test]
fn csv_of_other_habits() {
    let parse = |text: &str| csv_file::parse(text.as_bytes(), None).unwrap();
    let plain = parse("1,2\n3,4\n");
    assert_eq!(plain.channel("column[2]").unwrap().samples, [2.0, 4.0]);
    let tabs = parse("\u{feff}a\tb\t\n1,5\t2e-3\t\n\t4\t\n");
    assert_eq!(tabs.channel("b").unwrap().samples, [2e-3, 4.0]);
    let a = &tabs.channel("a").unwrap().samples;
    assert!(a[0] == 1.5 && a[1].is_nan());
    let clock = parse("when,x\n2021-03-04 12:00,1\n2021-03-04 12:01,2\n");
    assert_eq!(clock.channel("x").unwrap().samples, [1.0, 2.0]);
    assert_eq!(
        complaint("a.csv", b"a,b\n1,2\n3,x\n", None),
        "line 3, column b: expected a number, found `x`"
    );
    assert_eq!(
        complaint("a.csv", b"# c: 1\na,b\n1,2\n3\n", None),
        "line 4: expected 2 columns as in the header, found 1"
    );
    assert_eq!(
        complaint("a.csv", b"a,b\n", None),
        "expected a header and rows of numbers, found no row of numbers"
    );
    assert!(complaint("a.csv", b"a,b\n1,2\n", Some("g")).contains("no group"));
    assert!(complaint("a.xyz", b"a,b\n1,2\n", None).contains("CSV (.csv"));
    assert!(complaint("a.csv", b"", None).contains("an empty file"));
}

fn check_matlab(set: &ChannelSet) {
    for j in 0..3 {
        check(set, &format!("motion[{}]", j + 1), j, 1.0, 5e-14);
    }
    check(set, "row", 3, 1.0, 5e-14);
    check(set, "run.force", 4, 1.0, 5e-14);
    check(set, "run.counts", 5, 1000.0, 0.5); // whole counts
    let label = Attribute::Text("still air".to_owned());
    assert_eq!(set.attributes.get("run.label"), Some(&label));
    assert_eq!(set.sampling_hz, Some(200.0));
}

#[test]
fn matlab_of_all_versions() {
    for name in ["v5_plain.mat", "v5_compressed.mat"] {
        let set = read(name, None);
        check_matlab(&set);
        check(&set, "cells{1}", 6, 1.0, 5e-14);
        check(&set, "single", 7, 1.0, 1e-6); // 24 bits of up to 15
        let run = read(name, Some("run"));
        check(&run, "force", 4, 1.0, 5e-14);
        assert_eq!(run.channels.len(), 2);
    }
    check_matlab(&read("v73.mat", None));
    check(&read("v73.mat", Some("run")), "force", 4, 1.0, 5e-14);
    let bytes = std::fs::read(file("v5_plain.mat")).unwrap();
    assert_eq!(
        complaint("a.mat", &bytes, Some("none")),
        "group: expected one of the groups run, found `none`"
    );
}

/// Nested structs whose names of fields have up to four bytes, and a variable that cannot be read beside others.
#[test]
fn matlab_structs_with_short_names_and_a_variable_that_is_none() {
    for name in ["v5_short_plain.mat", "v5_short_compressed.mat"] {
        let set = read(name, None);
        check(&set, "info.rig.y", 0, 1.0, 5e-14);
        check(&set, "runs[2].q", 1, 1.0, 5e-14);
        assert!(set.left_out.is_empty(), "{}", set.listing());
    }
    let mut bytes = std::fs::read(file("v5_plain.mat")).unwrap();
    bytes[128 + 16] = 99; // the class of `motion`
    let set = ChannelSet::parse(bytes, "mat", None).unwrap();
    check(&set, "run.force", 4, 1.0, 5e-14);
    let left_out = "not read: motion (corrupt, or of a kind that is not known)";
    assert!(set.listing().contains(left_out), "{}", set.listing());
}

#[test]
fn hdf5_in_groups() {
    let set = read("ntnu.h5", Some("in_wind"));
    check(&set, "motion[2]", 0, 0.01, 1e-16);
    for j in 0..12 {
        check(
            &set,
            &format!("forces_global_coord[{}]", j + 1),
            j,
            1.5,
            1e-13,
        );
    }
    assert_eq!(
        set.channel("forces_global_coord[24]").unwrap().samples,
        [0.0; SAMPLES]
    );
    assert_eq!(set.sampling_hz, Some(200.0));
    assert_eq!(set.number("air_density"), Some(1.195));
    let motion = Attribute::Text("vertical".to_owned());
    assert_eq!(set.attributes.get("forced motion"), Some(&motion));
    let all = read("ntnu.h5", None);
    check(&all, "still_air/forces_global_coord[3]", 2, 1.0, 5e-14);
    let bytes = std::fs::read(file("ntnu.h5")).unwrap();
    assert_eq!(
        complaint("a.h5", &bytes, Some("run 7")),
        "group: expected one of the groups in_wind, still_air, found `run 7`"
    );
}

/// What the reader does not know is left out and named; it is not called corrupt.
#[test]
fn hdf5_with_links_and_virtual_and_new_datasets() {
    let set = read("links.h5", None);
    check(&set, "run/y", 0, 1.0, 5e-14);
    check(&set, "z", 1, 1.0, 5e-14);
    let links = "not read: 1 soft link (take what they point to)";
    assert!(set.listing().ends_with(links), "{}", set.listing());
    let set = read("virtual.h5", None);
    check(&set, "y", 0, 1.0, 5e-14);
    let names: Vec<&str> = set.left_out.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["v", "packed"], "{}", set.listing());
}

#[test]
fn tdms_in_several_segments() {
    let set = read("forces.tdms", Some("Forces"));
    check(&set, "double", 0, 1.0, 1e-15);
    check(&set, "it's single", 1, 1.0, 1.3e-7); // 24 bits of up to 3
    check(&set, "counts", 2, 1000.0, 0.5);
    assert_eq!(set.channel("double").unwrap().unit.as_deref(), Some("N"));
    assert!((set.sampling_hz.unwrap() - 200.0).abs() < 1e-10);
    assert_eq!(set.number("cell"), Some(1.0));
    let all = read("forces.tdms", None);
    check(&all, "Forces/double", 0, 1.0, 1e-15);
    assert_eq!(
        all.left_out,
        [("Clock/time".to_owned(), "time stamps".to_owned())]
    );
}

/// A segment of two channels of 32-bit integers, `count` samples each per block.
fn segment(contents: u32, count: u64, big: bool, samples: &[i32]) -> Vec<u8> {
    let word = |x: u32| {
        if big {
            x.to_be_bytes()
        } else {
            x.to_le_bytes()
        }
    };
    let long = |x: u64| {
        if big {
            x.to_be_bytes()
        } else {
            x.to_le_bytes()
        }
    };
    let text = |t: &str| [&word(t.len() as u32)[..], t.as_bytes()].concat();
    let mut metadata = word(2).to_vec();
    for name in ["/'g'/'a'", "/'g'/'b'"] {
        metadata.extend(text(name));
        for x in [20, 3, 1] {
            metadata.extend(word(x));
        }
        metadata.extend(long(count));
        metadata.extend(word(0));
    }
    let raw: Vec<u8> = samples.iter().flat_map(|x| word(*x as u32)).collect();
    let mut bytes = b"TDSm".to_vec();
    bytes.extend(contents.to_le_bytes());
    bytes.extend(word(4713));
    bytes.extend(long((metadata.len() + raw.len()) as u64));
    bytes.extend(long(metadata.len() as u64));
    [bytes, metadata, raw].concat()
}

#[test]
fn tdms_in_several_blocks_interleaved_and_big_endian() {
    let samples = |bytes: &[u8]| {
        let set = tdms::parse(bytes, Some("g")).unwrap();
        (
            set.channels[0].samples.clone(),
            set.channels[1].samples.clone(),
        )
    };
    let in_blocks = segment(0b1110, 2, false, &[1, 2, -1, -2, 3, 4, -3, -4]);
    assert_eq!(
        samples(&in_blocks),
        (vec![1.0, 2.0, 3.0, 4.0], vec![-1.0, -2.0, -3.0, -4.0])
    );
    let interleaved = segment(0b10_1110, 2, false, &[1, -1, 2, -2, 3, -3, 4, -4]);
    assert_eq!(samples(&interleaved), samples(&in_blocks));
    let big = segment(0b100_1110, 4, true, &[1, 2, 3, 4, -1, -2, -3, -4]);
    assert_eq!(samples(&big), samples(&in_blocks));
    // a segment without metadata goes on as before
    let mut twice = in_blocks.clone();
    twice.extend(b"TDSm");
    for x in [0b1000_u32, 4713, 16, 0, 0, 0] {
        twice.extend(x.to_le_bytes());
    }
    for x in [5_i32, 6, -5, -6] {
        twice.extend(x.to_le_bytes());
    }
    assert_eq!(samples(&twice).0, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(
        complaint("a.tdms", &segment(0b1110, 2, false, &[1, 2, 3]), None),
        "byte 104: expected whole blocks of 16 bytes, found 12 bytes of samples"
    );
    assert!(complaint("a.tdms", &segment(0b1000_1110, 1, false, &[1, 2]), None).contains("DAQmx"));
    assert!(complaint("a.tdms", &in_blocks[..in_blocks.len() - 1], None).contains("truncated?"));
}

/// Scales of a group hold for its channels; where nothing is said of them, they are still to be taken.
#[test]
fn tdms_counts_of_scaled_groups_are_left_out() {
    let plain = segment(0b1110, 2, false, &[1, 2, -1, -2]);
    let mut group = Vec::new();
    for x in [3, 4] {
        group.extend(u32::to_le_bytes(x)); // objects; letters of the name
    }
    group.extend(b"/'g'");
    for x in [u32::MAX, 1, 19] {
        group.extend(x.to_le_bytes()); // no samples; one property; letters of its name
    }
    group.extend(b"NI_Number_Of_Scales");
    for x in [3_u32, 1] {
        group.extend(x.to_le_bytes()); // a whole number: one scale
    }
    let mut bytes = [&plain[..28], &group, &plain[32..]].concat();
    for at in [12, 20] {
        let length = u64::from_le_bytes(plain[at..at + 8].try_into().unwrap());
        bytes[at..at + 8].copy_from_slice(&(length + group.len() as u64 - 4).to_le_bytes());
    }
    let set = tdms::parse(&bytes, Some("g")).unwrap();
    let why = "counts that still have to be scaled".to_owned();
    let left_out = ["a", "b"].map(|name| (name.to_owned(), why.clone()));
    assert!(set.channels.is_empty());
    assert_eq!(set.left_out, left_out);
}

/// Truncated at every length and with bytes overwritten, every file gives samples or an error, and soon.
#[test]
fn truncated_and_corrupt_files_are_refused() {
    let names = [
        "v5_plain.mat",
        "v5_compressed.mat",
        "v5_short_plain.mat",
        "v5_short_compressed.mat",
        "v73.mat",
        "ntnu.h5",
        "forces.tdms",
    ];
    for name in names {
        let whole = std::fs::read(file(name)).unwrap();
        let extension = name.rsplit('.').next().unwrap();
        let start = Instant::now();
        let lengths = (1..40).map(|i| whole.len() * i / 40);
        for length in lengths.chain([whole.len() - 1]) {
            let cut = whole[..length].to_vec();
            let read = ChannelSet::parse(cut, extension, None);
            // the last bytes of an HDF5 file may be padding
            assert!(
                read.is_err() || length == whole.len() - 1,
                "{name} cut at {length}"
            );
        }
        let mut state = 1_u64;
        let mut draw = |below: usize| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 33) as usize % below
        };
        for _ in 0..300 {
            let mut bytes = whole.clone();
            for _ in 0..3 {
                // headers are where it hurts
                let in_head = draw(2) == 0;
                let at = draw(if in_head {
                    bytes.len().min(4096)
                } else {
                    bytes.len()
                });
                let kind = draw(4);
                bytes[at] = [0, 0xff, 0x7f, draw(256) as u8][kind];
            }
            let _ = ChannelSet::parse(bytes, extension, None);
        }
        // 340 readings of less than 100 kB
        assert!(start.elapsed() < Duration::from_secs(60), "{name}");
    }
    let whole = std::fs::read(file("v5_plain.mat")).unwrap();
    let said = complaint("a.mat", &whole[..whole.len() / 2], None);
    assert!(said.contains("truncated?"), "{said}");
    assert!(complaint("a.mat", b"MATLAB", None).contains("found 6 bytes"));
}

#[test]
fn utf_16_is_named() {
    let text = "\u{feff}a,b\n1,2\n".encode_utf16();
    let little: Vec<u8> = text.clone().flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = text.flat_map(u16::to_be_bytes).collect();
    // with the mark and without
    for bytes in [&little[..], &little[2..], &big[..], &big[2..]] {
        let said = csv_file::parse(bytes, None).unwrap_err().to_string();
        assert!(said.contains("found text in UTF-16"), "{said}");
    }
}

/// A degree sign in Latin-1, which is no UTF-8.
#[test]
fn a_header_in_latin_1_keeps_its_degrees() {
    let set = csv_file::parse(b"y [mm],theta [\xb0]\n1,2\n3,4\n", None).unwrap();
    let unit = set.channel("theta").unwrap().unit.clone();
    assert_eq!(unit.as_deref(), Some("\u{b0}"));
}
