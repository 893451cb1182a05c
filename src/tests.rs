//! Mutated input of every kind that a user or an importer hands in: each is read or refused, none panics or hangs.
//!
//! Bounded, the same on every run. `AERODECK_FUZZ=100000 cargo test --release --lib tests::mutated` tries more of each kind,
//! `AERODECK_SEED=7` others.

use crate::files::lab::ChannelSet;
use crate::fmu::force_options::ForceOptions;
use crate::fmu::importer::Fmu;
use crate::fmu::instance::Instance;
use crate::fmu::package::{Export, FmiVersion, Runtime, package};
use crate::fmu::resources::Resources;
use crate::fmu::variables::{Causality, StartValue};
use crate::study::{Study, demo_study_text};
use crate::trained_model::TrainedModel;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::io::{Cursor, Read, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Nothing that is read or refused takes as long, on any machine.
const HANG_S: u64 = 60;
/// What numbers of a text are replaced by.
const EXTREMES: [&str; 10] = [
    "0",
    "-1",
    "1e308",
    "-1e308",
    "1e-320",
    "1e40",
    "null",
    "99999999999",
    "1e999",
    "0.5",
];

fn from_environment(name: &str, default: u64) -> u64 {
    let value = std::env::var(name).ok();
    value.and_then(|text| text.parse().ok()).unwrap_or(default)
}

/// A few changes of `right`: bits, bytes, pieces left out or doubled, numbers replaced.
fn mutated(right: &[u8], random: &mut ChaCha8Rng) -> Vec<u8> {
    let mut bytes = right.to_vec();
    for _ in 0..random.random_range(1..4) {
        if bytes.is_empty() {
            break;
        }
        let at = random.random_range(0..bytes.len());
        let length = random.random_range(1..=16.min(bytes.len() - at));
        match random.random_range(0..7) {
            0 => bytes[at] ^= 1 << random.random_range(0..8),
            1 => bytes[at] = random.random(),
            2 => drop(bytes.drain(at..at + length)),
            3 => {
                let piece = bytes[at..at + length].to_vec();
                bytes.splice(at..at, piece);
            }
            4 if random.random_range(0..4) == 0 => bytes.truncate(at),
            _ => {
                let digit = |b: &u8| b.is_ascii_digit() || matches!(b, b'.' | b'-' | b'e');
                let begin = at + bytes[at..].iter().take_while(|b| !digit(b)).count();
                let end = begin + bytes[begin..].iter().take_while(|b| digit(b)).count();
                let extreme = EXTREMES[random.random_range(0..EXTREMES.len())];
                bytes.splice(begin..end, extreme.bytes());
            }
        }
    }
    bytes
}

/// Hands mutations of `right` to `read`, which says whether it took them.
fn all_survive(what: &str, right: &[u8], default: u64, mut read: impl FnMut(&[u8]) -> bool) {
    let seed = from_environment("AERODECK_SEED", 1);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (count, mut taken) = (from_environment("AERODECK_FUZZ", default), 0);
    assert!(read(right), "{what}: refused as it is");
    for case in 0..count {
        let bytes = mutated(right, &mut random);
        let begin = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| read(&bytes)));
        let place = format!("{what}, seed {seed}, case {case}");
        taken += u64::from(outcome.unwrap_or_else(|_| panic!("{place}: a panic")));
        assert!(begin.elapsed().as_secs() < HANG_S, "{place}: hangs");
    }
    println!("{what}: {count} mutations, {taken} of them taken");
}

fn file(path: &str) -> Vec<u8> {
    std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap()
}

fn model(kind: &str) -> Vec<u8> {
    file(&format!("tests/data/models/{kind}.json"))
}

/// Makes an instance and runs it as an importer does that reads everything; outputs are numbers or refused.
fn run(resources: Resources) -> bool {
    let Ok(mut instance) = Instance::new(resources) else {
        return false;
    };
    let variables = instance.table().variables().iter().enumerate();
    let outputs = variables.filter(|(_, v)| {
        v.causality == Causality::Output && matches!(v.value, StartValue::Real(_))
    });
    let outputs: Vec<u32> = outputs.map(|(place, _)| place as u32).collect();
    instance.enter_initialization();
    if instance.exit_initialization().is_err() {
        return true;
    }
    for step in [0.01, 1.0] {
        let _ = instance.do_step(instance.time_s(), step);
        for reference in &outputs {
            let mut value = [0.0];
            if instance.reals(&[*reference], &mut value).is_ok() {
                assert!(value[0].is_finite(), "{reference}: {value:?}");
            }
        }
    }
    true
}

#[test]
fn mutated_models() {
    for kind in ["continuous_laguerre", "rational", "discrete_laguerre"] {
        let mut read = |bytes: &[u8]| Resources::from_bytes(bytes, [None; 3]).is_ok_and(run);
        all_survive(kind, &model(kind), 60, &mut read);
    }
}

#[test]
fn mutated_options_of_forces() {
    let rational = model("rational");
    let options = ForceOptions::single(0.45).to_json().unwrap();
    all_survive("force.json", options.as_bytes(), 100, |bytes| {
        Resources::from_bytes(&rational, of_force(Some(bytes))).is_ok_and(run)
    });
}

#[test]
fn mutated_gust_forces() {
    let rational = model("rational");
    let gusts = r#"{"dofs": ["vertical", "torsion"], "coefficients": [[0.3, -5.0], [0.05, 1.2]], "admittance": "sears", "source": "test"}"#;
    fn with(gusts: &[u8]) -> [Option<&[u8]>; 3] {
        [None, Some(gusts), None]
    }
    assert!(Resources::from_bytes(&rational, with(gusts.as_bytes())).is_ok_and(run));
    all_survive("gusts.json", gusts.as_bytes(), 100, |bytes| {
        Resources::from_bytes(&rational, with(bytes)).is_ok_and(run)
    });
}

/// Options of forces alone, without gusts.
fn of_force(force: Option<&[u8]>) -> [Option<&[u8]>; 3] {
    [force, None, None]
}

/// States with the right digest, so that what is behind it is reached as well.
#[test]
fn mutated_states() {
    for force in [None, Some(ForceOptions::single(0.45))] {
        let rational = model("rational");
        let options = force.map(|f| f.to_json().unwrap());
        let resources = || {
            let options = options.as_deref().map(str::as_bytes);
            Resources::from_bytes(&rational, of_force(options)).unwrap()
        };
        let mut instance = Instance::new(resources()).unwrap();
        instance.enter_initialization();
        instance.exit_initialization().unwrap();
        instance.do_step(0.0, 0.1).unwrap();
        let right = instance.serialize(&instance.snapshot()).unwrap();
        all_survive("state", &right, 2000, |bytes| {
            let mut bytes = bytes.to_vec();
            if bytes.len() > 44 {
                let end = bytes.len() - 16;
                let owner = uuid::Uuid::from_slice(&bytes[12..28]).unwrap();
                let digest = uuid::Uuid::new_v5(&owner, &bytes[..end]).into_bytes();
                bytes[end..].copy_from_slice(&digest);
            }
            let Ok(snapshot) = instance.deserialize(&bytes) else {
                return false;
            };
            if instance.restore(&snapshot).is_ok() {
                let _ = instance.do_step(instance.time_s(), 0.1);
            }
            true
        });
    }
}

fn packed() -> Vec<u8> {
    let model = TrainedModel::from_json(&String::from_utf8(model("rational")).unwrap()).unwrap();
    let export = Export {
        reals_only: false,
        allow_unstable: true,
        ..Export::default()
    };
    package(&model, &[Runtime::embedded().unwrap()], export).unwrap()
}

/// Opens an archive; its library is not loaded, since no host survives mutated machine code.
fn opens(folder: &Path, bytes: &[u8]) -> bool {
    let path = folder.join("mutated.fmu");
    std::fs::write(&path, bytes).unwrap();
    Fmu::open(&path).is_ok()
}

#[test]
fn mutated_archives() {
    let folder = tempfile::tempdir().unwrap();
    // small: most of an archive is the library, which no reader looks into
    let mut zip = zip::ZipArchive::new(Cursor::new(packed())).unwrap();
    let mut description = Vec::new();
    let mut entry = zip.by_name("modelDescription.xml").unwrap();
    entry.read_to_end(&mut description).unwrap();
    let archive = |description: &[u8]| {
        let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
        let options = zip::write::SimpleFileOptions::default();
        let library = Runtime::embedded()
            .unwrap()
            .path_in_archive(FmiVersion::Two);
        for (name, contents) in [("modelDescription.xml", description), (&library, b"none")] {
            zip.start_file(name, options).unwrap();
            zip.write_all(contents).unwrap();
        }
        zip.finish().unwrap().into_inner()
    };
    all_survive("archive", &archive(&description), 300, |bytes| {
        opens(folder.path(), bytes)
    });
    all_survive("modelDescription.xml", &description, 300, |bytes| {
        opens(folder.path(), &archive(bytes))
    });
}

#[test]
fn mutated_studies() {
    let text = demo_study_text();
    all_survive("study", text.as_bytes(), 2000, |bytes| {
        let text = String::from_utf8_lossy(bytes);
        Study::from_toml(&text, PathBuf::from("/nowhere")).is_ok()
    });
}

#[test]
fn mutated_laboratory_files() {
    let folder = tempfile::tempdir().unwrap();
    for name in [
        "forces.tdms",
        "ntnu.h5",
        "semicolons.csv",
        "units_row.csv",
        "v5_compressed.mat",
        "v5_plain.mat",
        "v73.mat",
    ] {
        let right = file(&format!("tests/data/lab/{name}"));
        let path = folder.path().join(name);
        all_survive(name, &right, 150, |bytes| {
            std::fs::write(&path, bytes).unwrap();
            ChannelSet::read(&path, None).is_ok()
        });
    }
}
