//! Tests of wide tables.

use crate::aerodynamics::derivatives::Missing;
use crate::aerodynamics::derivatives::notation::Notation;
use crate::files::derivatives::csv_wide::*;
use crate::files::derivatives::{StatedConvention, embedded, read_csv_with};
use crate::section::Dof;

fn read(text: &str, options: &ReadOptions) -> Result<DerivativeTable> {
    parse(text, "deck", options).map(|(table, _)| table)
}

fn scanlan() -> ReadOptions {
    ReadOptions {
        convention: StatedConvention::notation(Notation::Scanlan),
        ..ReadOptions::default()
    }
}

/// Six derivatives, decimal commas, an empty cell, a column that means nothing, no speeds, no width, no header.
#[test]
fn a_table_of_a_paper_is_read_with_notes() {
    let text = "v_hat;H1*;H2*;H3*;A1*;A2*;A3*;run\n2,0;-9,1;0,8;13,6;-2,4;-0,6;3,5;a\n4;-20;;60;-5;-1;15;b\n;;;;;;;\n";
    let table = read(text, &scanlan()).unwrap();
    assert_eq!(table.name, "deck");
    assert_eq!(table.points(Derivative::H1)[0].value, -9.1);
    assert_eq!(table.points(Derivative::H2).len(), 1);
    assert_eq!(table.points(Derivative::A3)[1].v_hat, 4.0);
    assert!(table.speed_groups().is_empty());
    let notes = table.header.notes.join("; ");
    for part in ["H4*, A4*: taken as zero", "not read: run", "1 m is assumed"] {
        assert!(notes.contains(part), "{notes}");
    }
    let stated = ReadOptions {
        missing: Some(Missing::QuasiSteady),
        width_m: Some(0.4),
        ..scanlan()
    };
    let table = read(text, &stated).unwrap();
    assert_eq!(table.width_m, 0.4);
    assert_eq!(table.points(Derivative::A4)[0].value, -0.6 / 2.0);
    assert_eq!(table.points(Derivative::H4).len(), 1);
}

/// Curves read off figures, each over reduced velocities of its own; behind their values these are refused.
#[test]
fn every_derivative_has_the_argument_before_it() {
    let names = "v_hat,H1,v_hat,H2,H3,v_hat,A1,A2,A3";
    let text = format!("{names}\n2,-9,2.5,1,14,3,-2,-1,3\n4,-20,5,2,60,,,,\n");
    let table = read(&text, &scanlan()).unwrap();
    let over = |d| table.points(d).iter().map(|p| p.v_hat).collect::<Vec<_>>();
    assert_eq!(over(Derivative::H1), [2.0, 4.0]);
    assert_eq!(over(Derivative::H3), [2.5, 5.0]);
    assert_eq!(over(Derivative::A3), [3.0]);
    let twice = text.replace(
        names,
        "v_hat,H1,v_hat,mean_speed_m_s,mean_speed_m_s,v_hat,A1,A2,A3",
    );
    let said = read(&twice, &scanlan()).unwrap_err().to_string();
    assert_eq!(
        said,
        "line 1: expected `mean_speed_m_s` once, found it twice"
    );
    let behind = text.replace("v_hat,H1,", "H1,v_hat,");
    let said = read(&behind, &scanlan()).unwrap_err().to_string();
    assert!(
        said.contains("or one before every derivative, found one behind"),
        "{said}"
    );
}

/// An embedded deck written out wide, in another notation, comes back, through a file as well.
#[test]
fn a_deck_written_wide_comes_back() {
    let deck = embedded::deck("LN21-5500")
        .unwrap()
        .at_speed_group(0)
        .unwrap();
    let polimi = Convention::usual(Notation::Polimi);
    let of = |d| polimi.express_point(d, &deck.points(d)[0]);
    let names: Vec<_> = deck
        .derivatives()
        .map(|d| polimi.notation.name_of(d))
        .collect();
    let values: Vec<_> = deck
        .derivatives()
        .map(|d| of(d).value.to_string())
        .collect();
    let argument = of(Derivative::H1).argument;
    let head = "# notation: polimi\n# axes: heave_up\n# width_m: 0.5057\n";
    let text = format!(
        "{head}{},v_star,mean_speed_m_s\n{},{argument},6.36\n",
        names.join(","),
        values.join(",")
    );
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("wide.csv");
    std::fs::write(&path, text).unwrap();
    let (table, convention) = read_csv_with(&path, &ReadOptions::default()).unwrap();
    assert_eq!(convention, polimi);
    assert_eq!((table.name.as_str(), table.width_m), ("wide", 0.5057));
    assert_eq!(table.dofs(), Dof::THREE);
    let (found, expected) = (
        table.points(Derivative::H1)[0],
        deck.points(Derivative::H1)[0],
    );
    assert!((found.value / expected.value - 1.0).abs() < 1e-12);
}

/// A column of any name is the argument when the argument is stated and nothing else is left.
#[test]
fn a_stated_argument_needs_no_name() {
    let text = "Vr,H1,H2,H3,H4,A1,A2,A3,A4\n6.283185307179586,-9,1,13,1,-2,-1,3,0\n";
    let mut options = scanlan();
    let message = read(text, &options).unwrap_err().to_string();
    assert!(
        message.starts_with("argument: expected it stated"),
        "{message}"
    );
    options.convention.argument = Some(Argument::VStar);
    let table = read(text, &options).unwrap();
    assert!((table.points(Derivative::H1)[0].v_hat - 1.0).abs() < 1e-15);
}

/// V* taken for V̂ would be a factor of 2π: what is stated may not contradict the column, here or in the head.
#[test]
fn a_stated_argument_does_not_contradict_the_column() {
    let text = "V/(fB),H1,H2,H3,A1,A2,A3\n6,-9,1,13,-2,-1,3\n";
    let mut options = scanlan();
    assert!(read(text, &options).is_ok());
    options.convention.argument = Some(Argument::VHat);
    let message = read(text, &options).unwrap_err().to_string();
    assert_eq!(
        message,
        "argument: expected `v_hat` as stated on import, found `v_star` stated in the file"
    );
    let message = read(&format!("# argument: v_hat\n{text}"), &scanlan()).unwrap_err();
    assert_eq!(
        message.to_string(),
        "line 2: expected a column `v_hat` as the header says, found `v_star`"
    );
    // where both are there, the one that is stated is meant
    let both = "v_hat,v_star,H1,H2,H3,A1,A2,A3\n1,6,-9,1,13,-2,-1,3\n";
    options.convention.argument = Some(Argument::VStar);
    let table = read(both, &options).unwrap();
    assert_eq!(
        Argument::VStar.at_v_hat(table.points(Derivative::H1)[0].v_hat),
        6.0
    );
}

#[test]
fn what_is_wrong_is_named() {
    let long = format!(
        "v_hat,H1,H2,H3,A1,A2,A3\n1,x{},1,1,1,1,1\n",
        "9".repeat(100_000)
    );
    for (text, expected) in [
        ("v_hat,H1,H1\n1,2,3\n", "line 1: expected `H1` once"),
        (
            "v_hat,width\n1,2\n",
            "line 1: expected columns of derivatives",
        ),
        ("v_hat,H1\n1,2,3\n", "line 2: expected 2 columns, found 3"),
        (
            "v_hat;H1;H2\n1,5;-2,25;3\n2,5;-1.234;4\n",
            "line 3, column H1: expected a number with a decimal comma, as others of the file have, found `-1.234`",
        ),
        (
            "v_hat,H1\n0,2\n",
            "line 2, column v_hat: expected a positive number",
        ),
        (
            "v_hat,H1\n1,n/a\n",
            "line 2, column H1: expected a number, found `n/a`",
        ),
        (
            "v_hat,H1\n1,2\n2,3\n2,4\n",
            "line 4 (H1): expected every reduced velocity",
        ),
        ("v_hat,H1\n1,2\n", "points for H1 to H4 and A1 to A4"),
        (&long, "line 2, column H1: expected a number, found `x999"),
    ] {
        let message = read(text, &scanlan()).unwrap_err().to_string();
        assert!(message.contains(expected), "{message}");
        assert!(message.len() < 600, "{} characters", message.len());
    }
    let rows: String = (1..=10_001).map(|i| format!("{i},1\n")).collect();
    let message = read(&format!("v_hat,H1\n{rows}"), &scanlan())
        .unwrap_err()
        .to_string();
    assert!(message.contains("at most 10000 test points"), "{message}");
}

/// A derivative with its unit is that derivative, and what is none is named instead of the argument.
#[test]
fn a_unit_behind_a_name_is_no_other_column() {
    let text = |h1: &str| {
        format!(
            "# notation: scanlan\n# axes: heave_up\n# width_m: 0.5\nv_star [-],{h1},H2,H3,A1,A2,A3\n9,-1,1,1,-1,-1,1\n"
        )
    };
    let read = |h1: &str| parse(&text(h1), "wide", &ReadOptions::default());
    let table = read("H1 [-]").unwrap().0;
    assert_eq!(table.points(Derivative::H1)[0].value, -1.0);
    // the argument is there: it is not blamed for a derivative that is not
    let said = read("H1_up").unwrap_err().to_string();
    assert!(
        said.starts_with("derivatives: expected points for H1"),
        "{said}"
    );
    assert!(said.contains("found none for H1"), "{said}");
    for word in ["v_star", "argument"] {
        assert!(!said.contains(word), "{word}: {said}");
    }
}
