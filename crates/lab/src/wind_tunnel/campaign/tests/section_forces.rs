//! Forces on the whole section in place of load cells.

use super::*;

fn computed() -> String {
    r#"schema = 1
[section]
name = "S"
width_m = 0.5
[air]
density_kg_m3 = 1.2
[recording]
sampling_hz = 100
[channels]
vertical = { name = "y", unit = "mm" }
[channels.section]
lift = { name = "l", unit = "kN" }
moment = { name = "m", unit = "Nm" }
[[run]]
name = "one"
motion = ["vertical"]
in_wind = "a.csv"
mean_speed_m_s = 8
"#
    .to_owned()
}

#[test]
fn neither_rig_nor_still_air_nor_other_channels_are_needed() {
    let a = recording(200, |_, _| {});
    let reading = load(&computed(), &a, "").unwrap();
    assert_eq!(reading.findings, []);
    assert_eq!(reading.forces, Some(vec![Dof::Vertical, Dof::Torsion]));
    let run = &reading.runs[0];
    assert!(run.still_air.is_none());
    assert_eq!(
        (reading.rig.model_length_m, reading.rig.model_width_m),
        (1.0, 0.5)
    );
    for i in 0..200 {
        let [y, _, l, m, _] = sample(i);
        assert!((run.in_wind.motion[0][i] - 0.001 * y).abs() < 1e-15);
        assert!((run.in_wind.cells[0][1][i] - 1000.0 * l).abs() < 1e-12);
        // a nose-up moment is one about −z
        assert!((run.in_wind.cells[0][5][i] + m).abs() < 1e-15);
    }
}

#[test]
fn what_is_missing_is_named() {
    let a = recording(200, |_, _| {});
    let said = |from: &str, to: &str| complaint(&computed().replace(from, to), &a, "");
    assert!(
        said("width_m = 0.5\n", "")
            .contains("section.width_m: expected the width B of the section, m, found none")
    );
    let none = said(
        "[channels.section]\nlift = { name = \"l\", unit = \"kN\" }\nmoment = { name = \"m\", unit = \"Nm\" }\n",
        "",
    );
    assert!(
        none.contains("rig: expected either load cells in `rig`, or the forces"),
        "{none}"
    );
    let wrong = said("\"kN\"", "\"mm\"");
    assert!(
        wrong.contains("channels.section.lift.unit: expected a unit of a force"),
        "{wrong}"
    );
    let sway = said("motion = [\"vertical\"]", "motion = [\"lateral\"]");
    assert!(
        sway.contains("expected its force too: `channels.section.drag` (run `one`)"),
        "{sway}"
    );
    let twice = said("name = \"m\"", "name = \"l\"");
    assert!(
        twice.contains("found `l`, which is `channels.section.lift` too"),
        "{twice}"
    );
}
