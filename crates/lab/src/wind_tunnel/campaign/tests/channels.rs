//! Channel maps that contradict the files, or themselves.

use super::*;

fn sound() -> (String, String) {
    (recording(200, |_, _| {}), recording(200, still))
}

#[test]
fn a_column_is_one_thing_only() {
    let (a, b) = sound();
    let twice = small().replace("name = \"l\"", "name = \"d\"");
    assert!(
        complaint(&twice, &a, &b).contains(
            "channels.cells.near.fy: expected a channel of its own, found `d`, which is `channels.cells.near.fx` too"
        ),
        "{}",
        complaint(&twice, &a, &b)
    );
    let motions = small().replace(
        "wind_speed =",
        "torsion = { name = \"y\", unit = \"deg\" }\nwind_speed =",
    );
    assert!(complaint(&motions, &a, &b).contains("found `y`, which is `channels.vertical` too"));
    // two columns of one name: no one knows which
    let said = complaint(
        &small(),
        &a.replacen("y,d,l,m,v", "y,l,l,m,v", 1)
            .replace("y,l,l", "y,d,d"),
        &b,
    );
    assert!(
        said.contains("expected one channel `d`, found 2 of that name"),
        "{said}"
    );
}

#[test]
fn a_header_that_contradicts_the_map_is_refused() {
    let (a, b) = sound();
    let with = |header: &str, map: &str| {
        let head = |text: &str| text.replacen("y,d,l,m,v", header, 1);
        load(map, &head(&a), &head(&b))
            .map(drop)
            .map_err(|e| e.to_string())
    };
    let map = small();
    for header in [
        "y [mm],d,l,m,v",
        "y (mm),d,l,m,v",
        "y [millimetres],d,l,m,v",
        "y,d [V],l,m,v",
        "y,d,l [kN],m,v",
    ] {
        assert_eq!(with(header, &map), Ok(()), "{header}");
    }
    for (header, said) in [
        (
            "y [m],d,l,m,v",
            "channels.vertical, `y`: expected the unit `m` that the file states, found `mm` in the map",
        ),
        (
            "y,d,l [N],m,v",
            "channels.cells.near.fy, `l`: expected the unit `N` that the file states, found `kN` in the map",
        ),
        // of another quantity
        (
            "y,d [mm],l,m,v",
            "channels.cells.near.fx, `d`: expected the unit `mm` that the file states, found `N` in the map",
        ),
        (
            "y [deg],d,l,m,v",
            "expected the unit `deg` that the file states",
        ),
    ] {
        assert!(
            with(header, &map).unwrap_err().contains(said),
            "{header}: {:?}",
            with(header, &map)
        );
    }
    // a unit at the end of the name
    let named = map.replace(
        "name = \"y\", unit = \"mm\"",
        "name = \"y_cm\", unit = \"mm\"",
    );
    assert!(
        with("y_cm,d,l,m,v", &named)
            .unwrap_err()
            .contains("the unit `cm` that the file states")
    );
    let named = map.replace("name = \"y\"", "name = \"y_mm\"");
    assert_eq!(with("y_mm,d,l,m,v", &named), Ok(()));
}

#[test]
fn exchanged_motions_contradict_the_run() {
    let (a, b) = sound();
    let map = small().replace(
        "vertical = { name = \"y\", unit = \"mm\", scale = -1 }",
        "vertical = { name = \"still\", unit = \"mm\" }\ntorsion = { name = \"y\", unit = \"deg\" }",
    );
    let with_still = |text: &str| {
        let mut lines = text.lines();
        let mut all = format!("still,{}\n", lines.next().unwrap());
        lines.for_each(|line| all.push_str(&format!("0.01,{line}\n")));
        all
    };
    let said = complaint(&map, &with_still(&a), &with_still(&b));
    assert!(
        said.contains("run `one`, in wind: expected vertical motion, as `motion` states, found a torsion motion of alone")
            || said.contains("are the motion channels exchanged"),
        "{said}"
    );
}

#[test]
fn absurd_numbers_are_refused_and_odd_ones_said() {
    let (a, b) = sound();
    let said = complaint(
        &small().replace("sampling_hz = 100", "sampling_hz = 1e9"),
        &a,
        &b,
    );
    assert!(
        said.contains("recording.sampling_hz: expected at most 1000000, found 1000000000"),
        "{said}"
    );
    let hints = |from: &str, to: &str| -> Vec<String> {
        let reading = load(&small().replace(from, to), &a, &b).unwrap();
        reading.findings.iter().map(ToString::to_string).collect()
    };
    let said = hints("model_width_m = 0.5\n", "model_width_m = 502.3\n");
    assert_eq!(
        said[0],
        "rig.model_width_m = 502.3: 0.02 to 5 m is usual; in mm it would be 0.5023 m"
    );
    let said = hints("model_length_m = 2.5", "model_length_m = 2500");
    assert!(said[0].contains("in mm it would be 2.5 m"), "{said:?}");
    // derivatives go with the square of the speed
    let stated = |speed: &str| {
        let other = format!("name = \"one\"\nmean_speed_m_s = {speed}");
        complaint(&small().replace("name = \"one\"", &other), &a, &b)
    };
    let said = stated("80");
    assert!(
        said.contains("run `one`: mean_speed_m_s: expected about the 8.0"),
        "{said}"
    );
    assert!(
        said.ends_with("found 80.000 m/s (ten times that: a decimal place?)"),
        "{said}"
    );
    assert!(stated("9.8").ends_with("found 9.800 m/s"));
    let said = hints("name = \"y\", unit = \"mm\"", "name = \"y\", unit = \"m\"");
    assert!(
        said.iter().any(|s| s.ends_with("millimetres for metres?")),
        "{said:?}"
    );
}

/// A time column that the map leaves out may not contradict the stated rate: 5 ms beside 100 Hz moved an onset by 5 %.
#[test]
fn an_unmapped_time_column_is_compared_with_the_stated_rate() {
    let (a, b) = sound();
    let timed = |text: &str, name: &str, step: f64| {
        let mut lines = text.lines();
        let mut all = format!("{name},{}\n", lines.next().unwrap());
        for (i, line) in lines.enumerate() {
            all.push_str(&format!("{},{line}\n", i as f64 * step));
        }
        all
    };
    for (name, step, found) in [
        ("time [ms]", 5.0, "200.0000 Hz"),
        // neither in seconds nor in milliseconds
        ("Time", 5.0, "0.2000 Hz"),
        ("t [s]", 0.005, "200.0000 Hz"),
        ("t", 0.005, "200.0000 Hz"),
    ] {
        let said = complaint(&small(), &timed(&a, name, step), &timed(&b, name, step));
        assert!(
            said.contains(&format!(
                "expected the sampling frequency 100 Hz of the campaign file, found {found} by a time column that \
                 `channels.time` does not name"
            )),
            "{name}: {said}"
        );
    }
    for (name, step) in [("time [ms]", 10.0), ("t", 0.01), ("time [min]", 5.0)] {
        assert!(load(&small(), &timed(&a, name, step), &timed(&b, name, step)).is_ok());
    }
}
