//! Campaign files and recordings of the laboratory, sound and wrong.
//!
//! Recordings are those of `tests/data/lab/make_lab_files.py` and small ones made here.

mod channels;
mod findings;
mod order;
mod section_forces;
mod write;

use super::*;
use crate::error::Result;
use crate::section::Dof;
use crate::wind_tunnel::RawCampaign;
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::path::PathBuf;

const CELL: &str = r#"
[[rig.cells]]
name = "near"
axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
position_m = [0, 0, -1.4]
turns_with_model = true
"#;

/// A campaign of one run and one cell on `a.csv` and `b.csv`.
fn small() -> String {
    format!(
        r#"schema = 1
[section]
name = "S"
[air]
density_kg_m3 = 1.2
[recording]
sampling_hz = 100
[rig]
model_length_m = 2.5
model_width_m = 0.5
{CELL}
[channels]
vertical = {{ name = "y", unit = "mm", scale = -1 }}
wind_speed = {{ name = "v", unit = "m/s" }}
[channels.cells.near]
fx = {{ name = "d", unit = "N" }}
fy = {{ name = "l", unit = "kN" }}
fz = "none"
mx = "none"
my = "none"
mz = {{ name = "m", unit = "Nm" }}
[[run]]
name = "one"
motion = ["vertical"]
in_wind = "a.csv"
still_air = "b.csv"
"#
    )
}

/// The samples of `a.csv` and `b.csv`: y in mm, d in N, l in kN, m in Nm, v in m/s.
fn sample(i: usize) -> [f64; 5] {
    let phase = TAU * 2.0 * i as f64 / 100.0;
    [
        10.0 * phase.sin(),
        0.1 * phase.cos(),
        0.002 * (phase + 0.3).sin(),
        0.4 * (phase - 0.2).sin(),
        8.0 + 0.1 * (0.7 * phase).sin(),
    ]
}

fn recording(samples: usize, change: impl Fn(usize, &mut [f64; 5])) -> String {
    let mut text = "y,d,l,m,v\n".to_owned();
    for i in 0..samples {
        let mut row = sample(i);
        change(i, &mut row);
        let cells = row.map(|x| x.to_string()).join(",");
        let _ = writeln!(text, "{cells}");
    }
    text
}

fn still(i: usize, row: &mut [f64; 5]) {
    row[4] = 0.001 * (i as f64).sin();
}

/// Reads a campaign from its text and the texts of its two recordings.
fn load(text: &str, a: &str, b: &str) -> Result<RawCampaign> {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [("campaign.toml", text), ("a.csv", a), ("b.csv", b)] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    Campaign::read(folder.path().join("campaign.toml"))?.load()
}

/// What reading says, without the folder.
fn complaint(text: &str, a: &str, b: &str) -> String {
    let said = load(text, a, b).unwrap_err().to_string();
    let file = said
        .find(".csv: ")
        .or_else(|| said.find(".toml: "))
        .unwrap();
    let name = said[..file].rfind('/').unwrap() + 1;
    said[name..].to_owned()
}

#[test]
fn channels_are_taken_in_si_units_with_their_sign() {
    let (a, b) = (recording(200, |_, _| {}), recording(200, still));
    let reading = load(&small(), &a, &b).unwrap();
    assert_eq!(reading.findings, []);
    let run = &reading.runs[0];
    let wind = &run.in_wind;
    assert_eq!((wind.sample_count(), wind.sampling_hz), (200, 100.0));
    assert!(wind.motion[1..].iter().all(Vec::is_empty));
    for i in 0..200 {
        let [y, d, l, m, v] = sample(i);
        let found = [
            wind.motion[0][i],
            wind.cells[0][0][i],
            wind.cells[0][1][i],
            wind.cells[0][5][i],
        ];
        let expected = [-0.001 * y, d, 1000.0 * l, m];
        for (f, e) in found.into_iter().zip(expected) {
            // one rounding of the factor
            assert!(
                (f - e).abs() <= 4.0 * f64::EPSILON * e.abs(),
                "{i}: {f} {e}"
            );
        }
        assert_eq!(wind.wind_speed_m_s[i], v);
        assert_eq!(wind.cells[0][2][i], 0.0);
    }
    // 1.4 periods a second of the gust in 2 s: the mean is not quite 8
    let mean: f64 = (0..200).map(|i| sample(i)[4]).sum::<f64>() / 200.0;
    assert!((run.mean_speed_m_s - mean).abs() < 1e-12);
    assert_eq!(run.air_density_kg_m3, 1.2);
    assert_eq!(wind.channels, ["y", "d", "l", "m", "v"]);
    assert_eq!(run.motion, [Dof::Vertical]);
}

fn lab(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/data/lab")
        .join(name)
}

#[test]
fn the_layout_of_ntnu_needs_no_map() {
    let text = r#"schema = 1
section.name = "LN"
recording.layout = "ntnu"
[rig]
model_length_m = 2.68
model_width_m = 0.5
[[rig.cells]]
name = "one"
axes = [[1, 0, 0], [0, 0, 1], [0, -1, 0]]
position_m = [0, 0, -1.4]
turns_with_model = false
[[rig.cells]]
name = "two"
axes = [[1, 0, 0], [0, 0, 1], [0, -1, 0]]
position_m = [0, 0, 1.4]
turns_with_model = false
[[run]]
name = "vertical"
motion = ["vertical"]
in_wind = { file = "ntnu.h5", group = "in_wind" }
still_air = { file = "ntnu.h5", group = "still_air" }
"#;
    let folder = lab("ntnu.h5").parent().unwrap().to_path_buf();
    let reading = Campaign::from_toml(text, folder.clone())
        .unwrap()
        .load()
        .unwrap();
    let run = &reading.runs[0];
    assert_eq!((run.mean_speed_m_s, run.air_density_kg_m3), (8.0, 1.195));
    assert_eq!(run.in_wind.sampling_hz, 200.0);
    let channel = |j: usize, i: usize| {
        let j = j as f64;
        j + (j + 1.0) * (PI * (j + 1.0) * i as f64 / 200.0).sin()
    };
    for i in 0..run.in_wind.sample_count() {
        assert!((run.in_wind.motion[0][i] - 0.01 * channel(0, i)).abs() < 1e-16);
        // six channels a cell, the second cell from the seventh; rounding of up to 35
        assert!((run.in_wind.cells[1][4][i] - 1.5 * channel(10, i)).abs() < 1e-12);
        assert!((run.still_air.as_ref().unwrap().cells[0][2][i] - channel(2, i)).abs() < 1e-12);
    }
    // drag is their first, lift their third, nose-up moment their fifth
    let [cell, _] = &run.in_wind.cells[..] else {
        panic!("two cells")
    };
    let axes = reading.rig.cells[0].axes_at(0.1);
    let force = axes * nalgebra::Vector3::new(cell[0][9], cell[1][9], cell[2][9]);
    let moment = axes * nalgebra::Vector3::new(cell[3][9], cell[4][9], cell[5][9]);
    assert_eq!(
        (force.x, force.y, -moment.z),
        (cell[0][9], cell[2][9], cell[4][9])
    );
    // with temperature and pressure the gas law is used instead: 101325/(287.058 (273.15 + 21.5))
    let by_gas_law = text.replace(
        "[rig]",
        "[air]\npressure_pa = 101325\n[channels]\ntemperature = { name = \"temperature\", unit = \"C\" }\n[rig]",
    );
    let reading = Campaign::from_toml(&by_gas_law, folder)
        .unwrap()
        .load()
        .unwrap();
    let density = reading.runs[0].air_density_kg_m3;
    assert!(
        (density - 101_325.0 / (287.058 * 294.65)).abs() < 1e-12,
        "{density}"
    );
}

#[test]
fn a_wrong_campaign_file_is_refused_by_line() {
    let (a, b) = (recording(100, |_, _| {}), recording(100, still));
    let said = |from: &str, to: &str| {
        let text = small();
        assert!(text.contains(from), "{from}");
        complaint(&text.replacen(from, to, 1), &a, &b)
    };
    let line = |key: &str| 1 + small().lines().position(|l| l.contains(key)).unwrap();
    assert_eq!(
        said("unit = \"mm\"", "unit = \"N\""),
        format!(
            "campaign.toml: line {}, channels.vertical.unit: expected a unit of a length: m, cm, mm, um, found `N`",
            line("vertical =")
        )
    );
    assert_eq!(
        said("still_air = \"b.csv\"", ""),
        format!(
            "campaign.toml: line {}, run[0].still_air: expected the recording of the same motion in still air (run `one`), found none",
            line("[[run]]")
        )
    );
    assert_eq!(
        said("name = \"one\"", "name = \"one\"\nmean_speed_m_s = 0"),
        format!(
            "campaign.toml: line {}, run[0].mean_speed_m_s: expected a positive number, found 0",
            line("name = \"one\"") + 1
        )
    );
    let twice = small() + &small()[small().find("[[run]]").unwrap()..];
    assert!(complaint(&twice, &a, &b).contains(
        "run[1].name: expected a name of its own for every run, found `one` a second time"
    ));
    let renamed = twice.replacen("name = \"one\"", "name = \"two\"", 1);
    let refused = complaint(&renamed, &a, &b);
    assert!(
        refused.contains("run[1].in_wind: expected a recording of its own for every run, found a.csv, that of run `two`"),
        "{refused}"
    );
    let itself = complaint(&small().replace("b.csv", "a.csv"), &a, &b);
    assert!(
        itself.contains("run[0].still_air: expected a recording of its own in still air (run `one`), found a.csv, that in wind"),
        "{itself}"
    );
    // the same samples under another name
    let folder = tempfile::tempdir().unwrap();
    let copied = renamed.replacen("in_wind = \"a.csv\"", "in_wind = \"c.csv\"", 1);
    for (name, text) in [
        ("campaign.toml", &copied),
        ("a.csv", &a),
        ("b.csv", &b),
        ("c.csv", &a),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let campaign = Campaign::read(folder.path().join("campaign.toml")).unwrap();
    let refused = campaign.load().unwrap_err().to_string();
    assert!(
        refused.contains("expected each recording once: what stands twice looks better known than it is, found the samples of run `"),
        "{refused}"
    );
    assert!(said("fz = \"none\"", "").contains("channels.cells.near: expected fx, fy, fz, mx, my, mz (`\"none\"` for one not measured), found no `fz`"));
    assert!(
        said("[channels.cells.near]", "[channels.cells.far]")
            .contains("channels.cells: expected one of the cells of the rig: near, found `far`")
    );
    assert!(
        said("[\"vertical\"]", "[\"torsion\"]")
            .contains("`channels.torsion` (run `one`), found none")
    );
    assert!(said("density_kg_m3 = 1.2", "temperature_c = 20").contains("air: expected either density_kg_m3, or temperature_c and pressure_pa, found one of temperature and pressure only"));
    assert!(said("[0, 1, 0], [0", "[0, -1, 0], [0").contains("expected a rotation"));
    assert!(
        said("sampling_hz = 100", "sampling = 100")
            .contains(&format!("line {}", line("sampling_hz")))
    );
    assert!(said("schema = 1", "schema = 2").contains("line 1, schema: expected 1, found 2"));
    assert!(
        said("scale = -1", "scale = 0")
            .contains("channels.vertical.scale: expected a number other than zero, found 0")
    );
    assert!(
        said("wind_speed = { name = \"v\", unit = \"m/s\" }", "")
            .contains("expected a mean speed or the channel")
    );
}

#[test]
fn recordings_that_do_not_fit_are_refused_by_run_and_sample() {
    let (a, b) = (recording(100, |_, _| {}), recording(100, still));
    let with = |from: &str, to: &str| complaint(&small().replacen(from, to, 1), &a, &b);
    assert_eq!(
        with("name = \"d\"", "name = \"drag\""),
        "a.csv: run `one`, in wind, channels.cells.near.fx: expected a channel `drag`, found the channels y, d, l, m, v"
    );
    assert_eq!(
        complaint(
            &small(),
            &recording(100, |i, r| if (40..53).contains(&i) {
                r[2] = f64::NAN
            }),
            &b
        ),
        "a.csv: run `one`, in wind, `l`, sample 40: expected a finite number, found NaN for 13 samples"
    );
    assert_eq!(
        complaint(&small(), &recording(100, |_, r| r[4] = 0.0), &b),
        "a.csv: run `one`, mean of the wind speed: expected a positive number, found 0"
    );
    assert_eq!(
        complaint(&small(), &recording(63, |_, _| {}), &b),
        "a.csv: run `one`, in wind: expected at least 64 samples, found 63"
    );
    assert_eq!(
        complaint(&small(), &a, "y,d,l,m,v\n1,2,3,x,5\n2,2,3,4,5\n"),
        "b.csv: run `one`, still air, channels.cells.near.mz: expected a channel `m`, found the channels y, d, l, v; not read: m (text)"
    );
    let no_rate = small().replace("sampling_hz = 100", "");
    assert!(
        complaint(&no_rate, &a, &b)
            .contains("expected a sampling frequency: `recording.sampling_hz`")
    );
    let faster = format!("# sampling_hz: 200\n{b}");
    assert_eq!(
        complaint(&small(), &a, &faster),
        "b.csv: run `one`, still air: expected the sampling frequency 100 Hz of the campaign file, found 200.0000 Hz by the file"
    );
    let own = format!("# sampling_hz: 100\n{a}");
    let folder_free = load(&no_rate, &own, &faster).unwrap_err().to_string();
    assert!(folder_free.contains("run `one`: expected one sampling frequency in wind and in still air, found 100 Hz and 200 Hz"));
    let in_mm = a.replacen("y,d", "y [m],d", 1);
    assert!(complaint(&small(), &in_mm, &b).contains(
        "channels.vertical, `y`: expected the unit `m` that the file states, found `mm` in the map"
    ));
    let unitless = small().replacen(", unit = \"mm\"", "", 1);
    assert!(complaint(&unitless, &a, &b).contains(
        "channels.vertical, `y`: expected its unit, in the map or in the file, found none"
    ));
    assert!(load(&unitless, &in_mm, &b.replacen("y,d", "y [mm],d", 1)).is_ok());
    let gone = load(&small().replace("b.csv", "c.csv"), &a, &b).unwrap_err();
    let said = gone.to_string();
    assert!(said.contains("c.csv: run `"), "{said}");
    assert!(said.contains("still air: expected a recording"), "{said}");
}

#[test]
fn channels_of_unequal_length_and_uneven_time_are_refused() {
    let folder = lab("v5_plain.mat").parent().unwrap().to_path_buf();
    let text = small()
        .replace("a.csv", "v5_compressed.mat")
        .replace("b.csv", "v5_plain.mat")
        .replace("\"y\"", "\"row\"");
    let said = Campaign::from_toml(&text, folder)
        .unwrap()
        .load()
        .unwrap_err()
        .to_string();
    assert!(said.contains("expected a channel `d`, found the channels motion[1], motion[2], motion[3], row, run.force, run.counts"), "{said}");
    let (a, b) = (recording(100, |_, _| {}), recording(100, still));
    let timed = |text: &str, jump: usize| {
        let mut time = 0.0;
        let mut rows = text.lines();
        let mut out = format!("t,{}\n", rows.next().unwrap());
        for (i, row) in rows.enumerate() {
            let _ = writeln!(out, "{time},{row}");
            time += if i == jump { 3.0 } else { 0.01 };
        }
        out
    };
    let map = small().replace("sampling_hz = 100", "").replace(
        "[channels]",
        "[channels]\ntime = { name = \"t\", unit = \"s\" }",
    );
    let even = load(&map, &timed(&a, 1000), &timed(&b, 1000)).unwrap();
    assert!((even.runs[0].in_wind.sampling_hz - 100.0).abs() < 1e-9);
    let said = complaint(&map, &timed(&a, 57), &timed(&b, 1000));
    assert!(said.contains("run `one`, in wind, `t`, sample 58: expected 0.010000 s after the sample before, as most, found 3.000000 s"), "{said}");
}

#[test]
fn the_example_of_the_documentation_is_a_campaign() {
    let page = include_str!("../../../../../docs/campaigns.md");
    let start = page.find("```toml\n").unwrap() + 8;
    let example = &page[start..start + page[start..].find("```").unwrap()];
    let campaign = Campaign::from_toml(example, PathBuf::new()).unwrap();
    assert_eq!(campaign.runs.len(), 2);
    assert_eq!(campaign.rig.as_ref().unwrap().cells.len(), 2);
    let again = toml::to_string(&campaign).unwrap();
    assert_eq!(
        Campaign::from_toml(&again, PathBuf::new()).unwrap(),
        campaign
    );
    assert!(Campaign::read("no/such/campaign.toml").is_err());
}
