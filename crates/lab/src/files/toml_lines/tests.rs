//! Every complaint with its line.

use super::*;

#[test]
fn a_file_of_another_kind_is_named_with_its_command() {
    let read = |what: &str, text: &str| {
        let read = parse::<std::collections::BTreeMap<String, i32>>(what, text, |_| Ok(()));
        read.unwrap_err().to_string()
    };
    let text = "schema = 1\n[modes]\n";
    assert_eq!(
        read("a study file", text),
        "expected a study file, found a bridge file, which `aerodeck bridge flutter` takes"
    );
    // a mistake in what it is, and what has no command of its own
    for (what, text) in [
        ("a study file", "deck = {}\n[modes]\n"),
        ("a case file", text),
    ] {
        assert!(read(what, text).contains("line"), "{what}");
    }
}

#[test]
fn names_with_control_characters_are_refused_with_line_and_key() {
    let read = |text: &str| parse::<toml::Table>("a file", text, |_| Ok(())).map(drop);
    assert!(read("name = \"a\\tb\"\n[x]\ntext = \"a\\nb\"").is_ok());
    for escape in ["\\u001b", "\\u0000", "\\u007f", "\\b"] {
        let text = format!("a = 1\n[export]\nauthors = [\"b\", \"{escape}[2J\"]\n");
        assert_eq!(
            read(&text).unwrap_err().to_string(),
            "line 3, export.authors[1]: expected a text without control characters, found one with them"
        );
    }
}

/// Of values, of what is missing in a table, and in lists over several lines.
#[test]
fn a_mistake_is_told_with_its_line() {
    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct File {
        b: Vec<Item>,
        #[serde(default)]
        c: Vec<f64>,
    }
    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Item {
        x: f64,
        y: Option<Word>,
        z: Option<OneOrOther>,
    }
    #[derive(Debug, PartialEq, serde::Deserialize)]
    #[serde(rename_all = "snake_case")]
    enum Word {
        Same,
    }
    #[derive(Debug, serde::Deserialize)]
    #[serde(untagged)]
    enum OneOrOther {
        One(String),
        Other { at: u64 },
    }
    let read = |text: &str| parse::<File>("a file", text, |_| Ok(()));
    let good = "c = [1, 0x2,\n  +3.5,\n  1_0e-1]\n[[b]]\nx = 1\n[[b]]\nx = -2.5\n";
    let file = read(good).unwrap();
    let numbers = (&file.c[..], file.b[1].x);
    assert_eq!(numbers, (&[1.0, 2.0, 3.5, 1.0][..], -2.5));
    let ends = "[[b]]\nx = 0\ny = \"same\"\nz.at = 0xffff_ffff_ffff_ffff\n[[b]]\nx = 1\nz = \"a\"";
    let file = read(ends).unwrap();
    let (Some(OneOrOther::Other { at }), Some(OneOrOther::One(text))) =
        (&file.b[0].z, &file.b[1].z)
    else {
        panic!("{file:?}")
    };
    let found = (*at, &**text, &file.b[0].y);
    assert_eq!(found, (u64::MAX, "a", &Some(Word::Same)));
    for (from, to, said) in [
        (
            "+3.5",
            "\"3\"",
            "line 2: expected a file (invalid type: string \"3\", expected f64), found `\"3\",`",
        ),
        (
            "1_0e-1",
            "inf",
            "line 3, c[3]: expected a finite number, found inf",
        ),
        (
            "x = -2.5",
            "",
            "line 6: expected a file (missing field `x`), found `[[b]]`",
        ),
        (
            "x = -2.5",
            "w = 1",
            "line 7: expected a file (unknown field `w`, expected one of `x`, `y`, `z`), found `w = 1`",
        ),
        (
            "x = -2.5",
            "x = [1]",
            "line 7: expected a file (invalid type: sequence, expected f64), found `x = [1]`",
        ),
        (
            "x = -2.5",
            "x = 1979-05-27",
            "line 7, b[1].x: expected a text in quotes, or no date, found 1979-05-27",
        ),
        (
            "x = -2.5",
            "x = 1\ny = 3",
            "line 8: expected a file (expected a word or a table), found `y = 3`",
        ),
        (
            "x = -2.5",
            "x = 1\ny = \"other\"",
            "line 8: expected a file (unknown variant `other`, expected `same`), found `y = \"other\"`",
        ),
        // what has no place of its own is told at the end of its block, and stands in its last line
        (
            "x = -2.5",
            "x = 1\nz = 3",
            "line 8: expected a file (data did not match any variant of untagged enum OneOrOther), found `z = 3`",
        ),
        (
            "x = 1\n",
            "x = 1\nz = { on = 3 }\n",
            "line 6: expected a file (data did not match any variant of untagged enum OneOrOther), found `z = { on = 3 }`",
        ),
        ("x = 1\n", "x = \n", "line 5: expected a file ("),
    ] {
        let message = read(&good.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(message.starts_with(said), "{message}\n{said}");
    }
}

#[test]
fn a_list_is_no_block() {
    assert!(only_blocks("a = 1\n[b]\nc = [1]\n[[d]]\ne = 2\n").is_ok());
    for list in ["[45.0]", "[]"] {
        let said = only_blocks(&format!("a = 1\nflutter = {list}\n")).unwrap_err();
        assert_eq!(
            said.to_string(),
            "line 2, flutter: expected a block [flutter], found a list"
        );
    }
}
