//! Every format of modes gives the same bridge; what is wrong in a file is named with its place.

use crate::matlab;
use aerodeck::bridge::Bridge;
use aerodeck::files::bridge::BridgeFile;
use aerodeck::study::bridge::BridgeStudy;
use std::f64::consts::TAU;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Four nodes of a girder along x, wind along −y: one vertical mode that sways a little, one torsional mode.
const NODES: [(u32, [f64; 3]); 4] = [
    (11, [0.0, 0.0, 50.0]),
    (12, [30.0, 0.0, 51.0]),
    (13, [70.0, 0.0, 51.0]),
    (14, [100.0, 0.0, 50.0]),
];
const FREQUENCIES: [f64; 2] = [0.11, 0.31];
const MASSES: [f64; 2] = [2.0e6, 7.0e8];

/// `ux, uy, uz, rx, ry, rz`.
fn shape(mode: usize, node: usize) -> [f64; 6] {
    let sine = (std::f64::consts::PI * NODES[node].1[0] / 100.0).sin() + 0.01;
    match mode {
        0 => [0.001, -0.2 * sine, sine, 0.002, 0.0, 0.1],
        _ => [0.0, 0.05, 0.1 * sine, 0.04 * sine, 0.3, 0.0],
    }
}

pub(super) fn tables(folder: &Path) {
    let mut nodes = "# a comment\nnode,x_m,y_m,z_m\n".to_owned();
    for (name, [x, y, z]) in NODES {
        nodes += &format!("{name},{x},{y},{z}\n");
    }
    let (mut modes, mut shapes) = (
        "mode,frequency_hz,generalised_mass_kg\n".to_owned(),
        "mode,node,ux,uy,uz,rx,ry,rz\n".to_owned(),
    );
    for m in 0..2 {
        modes += &format!("{},{},{}\n", m + 1, FREQUENCIES[m], MASSES[m]);
        for (n, (name, _)) in NODES.iter().enumerate() {
            let row: Vec<String> = shape(m, n).iter().map(f64::to_string).collect();
            shapes += &format!("{},{name},{}\n", m + 1, row.join(","));
        }
    }
    fs::write(folder.join("nodes.csv"), nodes).unwrap();
    fs::write(folder.join("modes.csv"), modes).unwrap();
    fs::write(folder.join("shapes.csv"), shapes).unwrap();
}

fn abaqus(folder: &Path) {
    tables(folder);
    for name in ["modes.csv", "shapes.csv"] {
        fs::remove_file(folder.join(name)).unwrap();
    }
    let lines = |values: [f64; 2]| format!("{}\n{}\n", values[0], values[1]);
    fs::write(folder.join("eigenfrequencies.csv"), lines(FREQUENCIES)).unwrap();
    fs::write(folder.join("generalised_masses.csv"), lines(MASSES)).unwrap();
    for m in 0..2 {
        let mut text = "node,U1,U2,U3,UR1,UR2,UR3\n".to_owned();
        // the order of nodes does not matter
        for (n, (name, _)) in NODES.iter().enumerate().rev() {
            let row: Vec<String> = shape(m, n).iter().map(f64::to_string).collect();
            text += &format!("{name},{}\n", row.join(","));
        }
        fs::write(folder.join(format!("mode_{}.csv", m + 1)), text).unwrap();
    }
}

fn opensees(folder: &Path) {
    let mut nodes = String::new();
    for (name, [x, y, z]) in NODES {
        nodes += &format!("{name} {x} {y} {z}\n");
    }
    fs::write(folder.join("nodes.out"), nodes).unwrap();
    let square = FREQUENCIES.map(|f| ((TAU * f) * (TAU * f)).to_string());
    fs::write(folder.join("eigenvalues.out"), square.join(" ") + "\n").unwrap();
    fs::write(
        folder.join("masses.out"),
        format!("{} {}\n", MASSES[0], MASSES[1]),
    )
    .unwrap();
    for m in 0..2 {
        let row: Vec<String> = (0..4)
            .flat_map(|n| shape(m, n))
            .map(|x| x.to_string())
            .collect();
        // with the time in front, as recorders write it when asked
        fs::write(
            folder.join(format!("mode_{}.out", m + 1)),
            format!("0.0 {}\n", row.join(" ")),
        )
        .unwrap();
    }
}

fn wawi(folder: &Path) {
    let phi: Vec<Vec<f64>> = (0..24)
        .map(|row| (0..2).map(|m| shape(m, row / 6)[row % 6]).collect())
        .collect();
    let k: Vec<f64> = (0..2)
        .map(|m| MASSES[m] * (TAU * FREQUENCIES[m]).powi(2))
        .collect();
    let modal = serde_json::json!({ "local": false, "m": MASSES, "k": k, "phi": { "full": phi }, "phi_x": [] });
    let nodes: Vec<Vec<f64>> = NODES
        .iter()
        .map(|(n, [x, y, z])| vec![f64::from(*n), *x, *y, *z])
        .collect();
    let element =
        serde_json::json!({ "element_matrix": [[1.0, 11.0, 12.0]], "node_matrix": nodes });
    fs::write(folder.join("modal.json"), modal.to_string()).unwrap();
    fs::write(folder.join("element.json"), element.to_string()).unwrap();
}

pub(super) fn text(format: &str, extra: &str) -> String {
    format!(
        "schema = 1\nname = \"small\"\nair_density_kg_m3 = 1.25\n\
         [modes]\nformat = \"{format}\"\npath = \".\"\naxes = {{ up = \"z\", downwind = \"-y\" }}\ndamping_ratio = 0.005\n\
         [[section]]\nname = \"girder\"\nwidth_m = 20.0\nstatic = {{ lift_slope = 4.0, moment_slope = 1.0 }}\n{extra}"
    )
}

pub(super) fn study(folder: &Path, text: &str) -> aerodeck::Result<BridgeStudy> {
    let path = folder.join("bridge.toml");
    fs::write(&path, text).unwrap();
    BridgeStudy::new(BridgeFile::read(&path)?)
}

fn read(write: fn(&Path), format: &str) -> Bridge {
    let folder = TempDir::new().unwrap();
    write(folder.path());
    study(folder.path(), &text(format, "")).unwrap().by_model
}

#[test]
fn all_formats_give_the_same_bridge() {
    let bridge = read(tables, "csv");
    assert_eq!(bridge.nodes[1].name, "12");
    assert_eq!(bridge.nodes[1].length_m, 35.0);
    // wind along −y: downwind is −uy, and nose-up is +rx
    let [u, v] = [shape(0, 1), shape(1, 2)];
    assert_eq!(bridge.modes[0].shape[1], [u[2], -u[1], u[3]]);
    assert_eq!(bridge.modes[1].shape[2], [v[2], -v[1], v[3]]);
    for (write, format) in [
        (abaqus as fn(&Path), "abaqus"),
        (opensees, "opensees"),
        (wawi, "wawi"),
    ] {
        let other = read(write, format);
        assert_eq!(other.nodes, bridge.nodes, "{format}");
        for (a, b) in other.modes.iter().zip(&bridge.modes) {
            assert!(
                (a.frequency_hz / b.frequency_hz - 1.0).abs() < 1e-14,
                "{format}"
            );
            assert_eq!(
                (a.generalised_mass, &a.shape),
                (b.generalised_mass, &b.shape),
                "{format}"
            );
        }
    }
}

#[test]
fn the_compact_file_reads_back() {
    let folder = TempDir::new().unwrap();
    tables(folder.path());
    let file = BridgeFile::from_toml(&text("csv", ""), folder.path().to_path_buf()).unwrap();
    let modes = file.read_modes().unwrap();
    let mut bytes = Vec::new();
    aerodeck::files::bridge::write_modes(&modes, "none", "a test", &mut bytes).unwrap();
    fs::write(folder.path().join("modes_one.csv"), bytes).unwrap();
    let one = text("csv", "").replace("path = \".\"", "path = \"modes_one.csv\"");
    let again = BridgeFile::from_toml(&one, folder.path().to_path_buf())
        .unwrap()
        .read_modes()
        .unwrap();
    assert_eq!(again.nodes, modes.nodes);
    assert_eq!(again.modes, modes.modes);
}

/// One change in one file, and what is said of it.
#[track_caller]
fn refused(change: impl FnOnce(&Path) -> String, expected: &[&str]) {
    let folder = TempDir::new().unwrap();
    tables(folder.path());
    let text = change(folder.path());
    let message = study(folder.path(), &text).unwrap_err().to_string();
    for part in expected {
        assert!(message.contains(part), "{message} lacks {part}");
    }
}

fn edited(folder: &Path, file: &str, from: &str, to: &str) {
    let path = folder.join(file);
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.contains(from), "{from}");
    fs::write(path, text.replacen(from, to, 1)).unwrap();
}

#[test]
fn wrong_tables_are_named_with_their_place() {
    let plain = || text("csv", "");
    refused(
        |f| {
            edited(f, "modes.csv", "1,0.11,2000000", "1,0.11,0");
            plain()
        },
        &["modes.csv: line 2, column 3: expected a positive generalised mass, found 0"],
    );
    refused(
        |f| {
            edited(f, "modes.csv", "2,0.31", "2,-0.31");
            plain()
        },
        &["modes.csv: line 3, column 2: expected a positive frequency in Hz, found -0.31"],
    );
    refused(
        |f| {
            edited(f, "nodes.csv", "12,30", "12,80");
            plain()
        },
        &[
            "node 13: expected a place along the girder beyond 80 m",
            "found 70 m",
        ],
    );
    refused(
        |f| {
            edited(f, "shapes.csv", "1,12,", "1,15,");
            plain()
        },
        &["shapes.csv: line 3: expected a node of nodes.csv, found node 15"],
    );
    refused(
        |f| {
            let text = fs::read_to_string(f.join("shapes.csv")).unwrap();
            let fewer: Vec<&str> = text.lines().filter(|l| !l.starts_with("2,13")).collect();
            fs::write(f.join("shapes.csv"), fewer.join("\n")).unwrap();
            plain()
        },
        &[
            "shapes.csv: mode 2: expected a row for each of the 4 nodes",
            "none for node 13",
        ],
    );
    refused(
        |f| {
            edited(f, "shapes.csv", "0.001,", "abc,");
            plain()
        },
        &["shapes.csv: line 2, column 3: expected a finite number, found `abc`"],
    );
}

#[test]
fn wrong_bridge_files_are_named_with_their_line() {
    let second = "[[section]]\nname = \"other\"\nwidth_m = 12.0\nfrom = \"13\"\nstatic = { lift_slope = 4.0 }\n";
    refused(
        |_| text("csv", second),
        &["section other: expected each node in one section, found node 13 also in section girder"],
    );
    refused(
        |_| {
            text(
                "csv",
                "[wind]\nprofile = [{ along_m = 0.0, factor = 0.0 }]\n",
            )
        },
        &[
            "bridge.toml: line 14, wind.profile: expected wind somewhere along the bridge, found zero everywhere",
        ],
    );
    let percent = "[wind]\nprofile = [{ along_m = 0.0, factor = 90.0 }]\n";
    refused(
        |_| text("csv", percent),
        &[
            "wind.profile[0].factor: expected at most 3 times the wind speed of the bridge (a factor, not per cent), found 90",
        ],
    );
    refused(
        |_| text("csv", "").replace("\"-y\"", "\"z\""),
        &["modes.axes.downwind: expected a direction square to `up`"],
    );
    refused(
        |_| text("csv", "").replace("axes =", "# axes ="),
        &["modes.axes: expected up and downwind"],
    );
    refused(
        |_| text("csv", "").replace("width_m = 20.0", "width_m = -20.0"),
        &["section[0].width_m: expected a positive number, found -20"],
    );
    refused(
        |_| {
            text("csv", "").replace(
                "damping_ratio = 0.005",
                "damping_ratio = [0.01, 0.02, 0.03]",
            )
        },
        &["modes.damping_ratio: expected one number, or 2, one per mode, found 3 numbers"],
    );
    refused(
        |_| text("csv", "").replace("damping_ratio", "select = [7]\ndamping_ratio"),
        &["modes.select: expected modes among 1, 2, found 7"],
    );
    refused(
        |_| {
            let arms = "static = { lift_slope = 4.0, arms = { vertical = 1e9 }";
            text("csv", "").replace("static = { lift_slope = 4.0", arms)
        },
        &[
            "bridge.toml: line ",
            "section[0].static.arms.vertical: expected a part of the width, 100 at most, found 1",
        ],
    );
    refused(
        |_| text("csv", "from = \"99\"\n"),
        &[
            "section[0].from: expected a node of the bridge, 11 to 14; next to it are 14 and 13, found `99`",
        ],
    );
}

#[test]
fn coherence_has_to_fall() {
    let folder = TempDir::new().unwrap();
    tables(folder.path());
    let gust = "along = { spectrum = { shape = { kind = \"kaimal\" }, length_m = 100.0, intensity = 0.1 } }";
    for value in ["0.0", "-3.0", "inf"] {
        let block = format!("[buffeting]\n{gust}\ncoherence = {{ along = {value} }}\n");
        let read = study(folder.path(), &text("csv", &block)).and_then(|s| s.buffeting_block());
        let message = read.unwrap_err().to_string();
        let expected = match value {
            "inf" => "a finite number",
            _ => "a decay of the coherence in (0, ∞)",
        };
        let said = format!("buffeting.coherence.along: expected {expected}, found");
        assert!(message.contains(&said), "{message}");
    }
}

#[test]
fn degrees_and_unit_masses_are_hinted_at() {
    let folder = TempDir::new().unwrap();
    tables(folder.path());
    edited(folder.path(), "shapes.csv", "0.001,-0.", "0.001,-0.");
    let path = folder.path().join("shapes.csv");
    let changed: String = fs::read_to_string(&path)
        .unwrap()
        .lines()
        .map(|line| {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            if cells[0] == "2" {
                cells[5] = "30".into();
            }
            cells.join(",") + "\n"
        })
        .collect();
    fs::write(&path, changed).unwrap();
    edited(folder.path(), "modes.csv", "2000000", "1");
    let notes = study(folder.path(), &text("csv", "")).unwrap().warnings();
    assert!(
        notes
            .iter()
            .any(|n| n.contains("mode 2: it turns by 30.000")
                && n.contains("in degrees it would be 0.52")),
        "{notes:?}"
    );
    assert!(
        notes
            .iter()
            .any(|n| n.contains("mode 1: a generalised mass of 1")),
        "{notes:?}"
    );
}

/// Half sines of a span of 100 m: lateral, vertical, torsional; `∫φ²` is half the span.
#[test]
fn matlab_files_are_read() {
    let folder = TempDir::new().unwrap();
    let points = 21;
    let sine = |i: usize| (std::f64::consts::PI * i as f64 / (points as f64 - 1.0)).sin();
    let phi: Vec<f64> = (0..points).flat_map(|i| [sine(i); 3]).collect();
    let arrays = [
        ("wn", vec![3, 1], vec![0.7, 0.9, 2.1]),
        ("phi", vec![3, 1, points], phi),
    ];
    let arrays = arrays.map(|(n, size, x)| (n, size.into_iter().map(|s| s as i32).collect(), x));
    fs::write(folder.path().join("modes"), matlab::file(&arrays)).unwrap();
    let span =
        "span = { span_m = 100.0, mass_kg_m = 5000.0, inertia_kg_m2_m = 60000.0 }\n[[section]]";
    let named = text("matlab", "").replace("path = \".\"", "path = \"modes\"");
    let stated = named.replacen("[[section]]", span, 1);
    let modes = study(folder.path(), &stated).unwrap().by_model.modes;
    for (m, (omega, mass, motion)) in [(0.7, 5e3, 1), (0.9, 5e3, 0), (2.1, 6e4, 2)]
        .into_iter()
        .enumerate()
    {
        assert!((modes[m].frequency_hz * TAU / omega - 1.0).abs() < 1e-12);
        assert!((modes[m].generalised_mass / (mass * 50.0) - 1.0).abs() < 1e-12);
        assert_eq!(modes[m].shape[5][motion], sine(5));
    }
    let message = study(folder.path(), &named).unwrap_err().to_string();
    assert!(message.contains("modes.span: expected span_m"), "{message}");
    // a shape that does not move has no mass
    let [w, mut shape] = arrays;
    for x in shape.2.iter_mut().skip(1).step_by(3) {
        *x = 0.0;
    }
    fs::write(folder.path().join("modes"), matlab::file(&[w, shape])).unwrap();
    let message = study(folder.path(), &stated).unwrap_err().to_string();
    assert!(
        message.ends_with(
            "modes: phi(2, 1, :): expected a shape with a finite mass, m ∫φ² dx > 0, found 0"
        ),
        "{message}"
    );
}
