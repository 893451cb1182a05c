//! Round trip of records and every kind of bad file.

use super::super::TunnelPlan;
use super::*;
use crate::aerodynamics::FlatPlate;
use crate::wind_tunnel::Record;

fn read(path: &Path) -> Result<Record> {
    Record::whole(&RecordFile::open(path)?)
}

/// A short noisy record of two degrees of freedom: 2 s of rest and 8 s of motion at 200 Hz.
fn record() -> Record {
    let plan = TunnelPlan {
        frequencies_hz: vec![0.5, 2.5],
        speeds_m_s: vec![8.17],
        still_s: 2.0,
        segment_s: 8.0,
        ramp_s: 2.0,
        noise_fraction: 0.05,
        ..TunnelPlan::default()
    };
    let records = plan.records_from_model(&FlatPlate::default(), "plate", 0.5);
    records.unwrap().swap_remove(1)
}

fn written(record: &Record) -> String {
    let mut out = Vec::new();
    write_record(record, &mut out).unwrap();
    String::from_utf8(out).unwrap()
}

fn in_file(text: &[u8]) -> tempfile::NamedTempFile {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), text).unwrap();
    file
}

/// What reading `text` complains of, without the file, which has to stand first.
fn complaint(text: impl AsRef<[u8]>) -> String {
    let file = in_file(text.as_ref());
    let message = read(file.path()).unwrap_err().to_string();
    let start = format!("{}: ", file.path().display());
    message.strip_prefix(&start).unwrap().to_owned()
}

#[test]
fn write_and_read_give_the_same_bits() {
    let record = record();
    let text = written(&record);
    let file = in_file(text.as_bytes());
    let again = read(file.path()).unwrap();
    assert_eq!(again, record);
    assert_eq!(written(&again), text);
    let bits = |r: &Record| -> Vec<u64> {
        let all = r.motion.iter().chain(&r.force).flatten();
        all.map(|x| x.to_bits()).collect()
    };
    assert_eq!(bits(&again), bits(&record));
    // channels in another order are put into that of all others
    let mut turned = record.clone();
    turned.header.dofs.reverse();
    turned.motion.reverse();
    turned.force.reverse();
    let file = in_file(written(&turned).as_bytes());
    assert_eq!(read(file.path()).unwrap(), record);
    // a file of Windows has other line ends, and a mark at its head
    let file = in_file(format!("\u{feff}{}", text.replace('\n', "\r\n")).as_bytes());
    assert_eq!(read(file.path()).unwrap(), record);
}

#[test]
fn a_file_is_streamed_in_blocks_of_bounded_size() {
    let mut record = record();
    for channel in record.motion.iter_mut().chain(&mut record.force) {
        channel.resize(10_000, 0.0);
    }
    let file = in_file(written(&record).as_bytes());
    let file = RecordFile::open(file.path()).unwrap();
    for _ in 0..2 {
        let mut sizes = Vec::new();
        file.for_each_block(&mut |block| {
            sizes.push(block[3].len());
            Ok(())
        })
        .unwrap();
        assert_eq!(sizes, [4096, 4096, 1808]);
    }
}

#[test]
fn bad_headers_are_explained() {
    let good = written(&record());
    for (old, new, expected) in [
        (
            "# width_m: 0.5",
            "# width_m: wide",
            "line 4 (width_m): expected a number, found `wide`",
        ),
        (
            "# width_m: 0.5",
            "# width_m: 0",
            "line 4 (width_m): expected a positive number, found 0",
        ),
        (
            "# width_m: 0.5\n",
            "",
            "header: expected a line `# width_m: …`, found none",
        ),
        (
            "# sampling_hz: 200",
            "# sampling: 200",
            "line 7: expected one of the header keys name, dofs,",
        ),
        (
            "# sampling_hz: 200",
            "# name: twice",
            "line 7: expected `name` once, found it twice",
        ),
        (
            "# dofs: vertical, torsion",
            "# dofs: vertical, pitch",
            "line 3 (dofs): expected a list with commas of vertical, lateral, torsion",
        ),
        (
            "lift up",
            "lift down",
            "line 8 (sign_convention): expected `y and lift up",
        ),
        (
            "0.5 Hz from 2 s",
            "0.5 Hz at 2 s",
            "line 11 (segment): expected a stretch like `0.25 Hz from 8 s to 34 s`",
        ),
        (
            "vertical_m,",
            "",
            "line 13: expected the columns time_s,vertical_m,torsion_rad,lift_n_m,moment_n_m_m, each once, found no column `vertical_m`",
        ),
        (
            "lift_n_m,",
            "lift_n_m,tension_v,",
            "found a column `tension_v`",
        ),
        ("lift_n_m,", "lift_n_m,lift_n_m,", "found a column twice"),
    ] {
        let bad = good.replacen(old, new, 1);
        assert_ne!(bad, good, "{old}");
        let message = complaint(bad);
        assert!(message.contains(expected), "{message}");
    }
    let header_only: String = good.lines().take(5).map(|l| format!("{l}\n")).collect();
    assert_eq!(
        complaint(header_only),
        "line 6: expected a line of column names, found the end of the file"
    );
}

/// The file with line `number` (from 1) changed.
fn with_line(number: usize, change: impl Fn(&str) -> String) -> String {
    let text = written(&record());
    let lines = text.lines().enumerate();
    lines
        .map(|(i, l)| {
            if i + 1 == number {
                change(l)
            } else {
                format!("{l}\n")
            }
        })
        .collect()
}

/// Stretches of rest, of another motion, and beyond the samples.
#[test]
fn segments_that_are_not_those_of_the_motion_are_refused() {
    let good = record();
    let refused = |change: &dyn Fn(&mut Record)| {
        let mut bad = good.clone();
        change(&mut bad);
        let by_arrays = bad
            .header
            .check_segments(&bad.motion)
            .unwrap_err()
            .to_string();
        let file = in_file(written(&bad).as_bytes());
        let by_file = read_record(file.path()).unwrap_err().to_string();
        assert!(by_file.ends_with(&by_arrays), "{by_file} {by_arrays}");
        by_arrays
    };
    let message = refused(&|r| r.header.segments[1].end_s = 30.0);
    assert!(message.contains("end of the record at 18 s"), "{message}");
    let message = refused(&|r| r.header.segments[1].start_s = 7.0);
    assert!(message.contains("between 10 s and"), "{message}");
    for frequency_hz in [5.0, 2.7, 1.25] {
        let message = refused(&|r| r.header.segments[1].frequency_hz = frequency_hz);
        let expected = format!("found {frequency_hz} Hz, which no motion has there");
        assert!(message.contains(&expected), "{message}");
    }
    let mut near = good.clone();
    near.header.segments[1].frequency_hz = 2.55;
    near.header.check_segments(&near.motion).unwrap();
}

#[test]
fn bad_samples_are_explained() {
    let cells = |l: &str, n: usize| l.splitn(5, ',').take(n).collect::<Vec<_>>().join(",");
    for (text, expected) in [
        (
            with_line(20, |l| format!("{},NaN\n", cells(l, 4))),
            "line 20, column moment_n_m_m: expected a finite number, found `NaN`",
        ),
        (
            with_line(20, |l| format!("{},overload\n", cells(l, 4))),
            "line 20, column moment_n_m_m: expected a finite number, found `overload`",
        ),
        (
            with_line(20, |l| format!("{}\n", cells(l, 4))),
            "line 20: expected 5 columns, found 4",
        ),
        (
            with_line(20, |l| format!("{l},1\n")),
            "line 20: expected 5 columns, found 6",
        ),
        (
            with_line(20, |_| String::new()),
            "line 20, column time_s: expected 0.005 s after the sample before (200 Hz), found 0.010000 s",
        ),
        (
            with_line(7, |_| "# sampling_hz: 201\n".to_owned()),
            "column time_s: expected samples at 201 Hz as in the header, found 200.0000 Hz",
        ),
    ] {
        assert_eq!(complaint(text), expected);
    }
    let short: String = written(&record())
        .lines()
        .take(53)
        .map(|l| format!("{l}\n"))
        .collect();
    assert_eq!(
        complaint(short),
        "end of the file: expected at least 64 samples, found 40"
    );
    let mut bytes = written(&record()).into_bytes();
    let last = bytes.len() - 2;
    bytes[last] = 0xff;
    assert!(complaint(bytes).ends_with("expected numbers, found bytes that are no UTF-8"));
}

#[test]
fn a_missing_file_is_named() {
    let message = RecordFile::open("no/such.csv").unwrap_err().to_string();
    assert!(message.starts_with("no/such.csv: "), "{message}");
}
