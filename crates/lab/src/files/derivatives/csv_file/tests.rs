//! Tests of the file of derivatives.

use crate::files::derivatives::csv_file::*;
use crate::files::derivatives::embedded;
use crate::files::derivatives::{csv_header, state_angle};

fn written(table: &DerivativeTable) -> String {
    let mut out = Vec::new();
    write_csv(table, &mut out).unwrap();
    String::from_utf8(out).unwrap()
}

#[test]
fn write_and_read_give_the_same_table_and_file() {
    let table = embedded::deck("LN20-5500").unwrap();
    let text = written(&table);
    let again = parse_csv(&text).unwrap();
    assert_eq!(again, table);
    assert_eq!(written(&again), text);
}

/// What a table says of its tests, and what a user may add to it.
#[test]
fn angle_and_amplitude_of_the_tests_are_kept() {
    let mut table = embedded::deck("LN20-5500").unwrap();
    assert_eq!(table.header.angle_deg, None);
    table.header.angle_deg = Some(-3.0);
    table.header.rotation_amplitude_deg = Some(1.5);
    let text = written(&table);
    assert!(text.contains("# angle_deg: -3\n# rotation_amplitude_deg: 1.5\n"));
    assert_eq!(parse_csv(&text).unwrap(), table);
    let wrong = text.replace("# angle_deg: -3", "# angle_deg: 300");
    let said = parse_csv(&wrong).unwrap_err().to_string();
    let expected = "(angle_deg): expected an angle between -90 and 90 degrees, found `300`";
    assert!(said.ends_with(expected), "{said}");
    let mut state = |angle| state_angle(&mut table.header, "deck.angle_deg", Some(angle));
    state(-3.0).unwrap();
    let other = state(0.0);
    let said = other.unwrap_err().to_string();
    let expected = "deck.angle_deg: expected -3, which the table states, found 0";
    assert_eq!(said, expected);
}

#[test]
fn bad_files_are_explained() {
    let good = written(&embedded::deck("LN21-5200").unwrap());
    let row = "P1,2,8.18";
    assert!(good.contains(row));
    let cases = [
        (
            "# width_m: 0.5",
            "# width: 0.5",
            "line 11: expected one of the header keys name,",
        ),
        (
            "# name: LN21-5200\n",
            "",
            "header: expected a line `# name: …`, found none",
        ),
        (
            "v_hat,value",
            "V,value",
            "line 13: expected a column `v_hat`, found `derivative,point,mean_speed_m_s,V,value`",
        ),
        (
            row,
            "P1,2,fast8.18",
            "line 15, column mean_speed_m_s: expected a number, found `fast8.18",
        ),
        (
            row,
            "P1,3,8.18",
            "line 15, column point: expected point 2 of P1, found `3`",
        ),
        (
            row,
            "P7,2,8.18",
            "line 15, column derivative: expected one of P1 to P6, H1 to H6, A1 to A6, found `P7`",
        ),
        (row, "P1,2,0,8.18", "line 15: expected 5 columns, found 6"),
        (
            "# width_m: 0",
            "# width_m: -0",
            "line 11 (width_m): expected a positive number, found -0.50",
        ),
    ];
    for (old, new, expected) in cases {
        let bad = good.replacen(old, new, 1);
        assert_ne!(bad, good, "{old}");
        let message = parse_csv(&bad).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn impossible_points_carry_their_line() {
    let table = embedded::deck("LN21-5200").unwrap();
    let good = written(&table);
    let points = table.points(Derivative::P1);
    let (third, second) = (points[2].v_hat.to_string(), points[1].v_hat.to_string());
    for (new, expected) in [
        (
            "99",
            "line 16 (P1): expected reduced velocities V̂ falling steadily",
        ),
        (
            "-1",
            "line 16 (P1): expected a positive reduced velocity V̂, found -1",
        ),
        (
            second.as_str(),
            "line 16 (P1): expected every reduced velocity V̂ once",
        ),
    ] {
        let bad = good.replacen(&third, new, 1);
        let message = parse_csv(&bad).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn a_missing_file_is_named() {
    let message = read_csv_with("no/such.csv", &ReadOptions::default())
        .unwrap_err()
        .to_string();
    assert!(message.starts_with("no/such.csv: "), "{message}");
}

/// A file of the first format, which could be in one convention only.
fn first_format() -> String {
    let new = written(&embedded::deck("LN21-5200").unwrap());
    let rows = new.split_once("derivative,point").unwrap().1;
    format!(
        "# aerodeck derivative table 1\n# name: LN21-5200\n# source: NTNU\n# licence: MIT\n# units: {}\n\
         # sign_convention: {}\n# generator: x\n# width_m: 0.5023\n# model_length_m: 2.68\nderivative,point{rows}",
        csv_header::UNITS,
        csv_header::SIGN_CONVENTION,
    )
}

#[test]
fn files_of_the_first_format_are_still_read() {
    let old = first_format();
    let (table, convention) = parse_csv_in(&old, &ReadOptions::default()).unwrap();
    assert_eq!(convention, Convention::default());
    let embedded = embedded::deck("LN21-5200").unwrap();
    for d in Derivative::ALL {
        assert_eq!(table.points(d), embedded.points(d));
    }
    let down = old.replacen("y and lift up", "y and lift down", 1);
    let message = parse_csv(&down).unwrap_err().to_string();
    assert!(
        message.contains("(sign_convention): expected `y and lift up, theta"),
        "{message}"
    );
    let twice = old.replacen("# units", "# notation: polimi\n# units", 1);
    let message = parse_csv(&twice).unwrap_err().to_string();
    assert!(
        message.contains("line 5 (notation): expected `scanlan` as the line sign_convention says"),
        "{message}"
    );
    let third = old.replacen("table 1", "table 3", 1);
    let message = parse_csv(&third).unwrap_err().to_string();
    assert!(message.contains("derivative table 3"), "{message}");
}
