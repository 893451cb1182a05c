//! Tests of the hints: silent on what is right, right on what is mislabelled.

use super::super::table::tests::flat_plate_table;
use super::*;
use crate::files::derivatives::embedded;

/// What `deck`, written in `truth`, becomes when it is read as `label`.
fn mislabelled(deck: &DerivativeTable, truth: Convention, label: Convention) -> DerivativeTable {
    let mut written = truth.express(deck);
    written.convention = label;
    written.to_table().unwrap()
}

fn words(c: Convention) -> String {
    format!(
        "{}, over {}, {}",
        c.notation.title(),
        c.argument.definition(),
        c.axes
    )
}

#[test]
fn right_tables_give_no_hint() {
    let label = Convention::default();
    for deck in embedded::names().map(|n| embedded::deck(n).unwrap()) {
        assert_eq!(deck.hints(&label), Vec::<String>::new(), "{}", deck.name);
        for group in 0..2 {
            assert!(deck.at_speed_group(group).unwrap().hints(&label).is_empty());
        }
    }
    for v_hats in [
        vec![0.6, 1.0, 2.0, 4.0, 8.0],
        vec![0.1, 0.4, 0.8],
        vec![5.0, 20.0, 40.0],
    ] {
        assert!(flat_plate_table(&[4.0], &v_hats).hints(&label).is_empty());
    }
}

/// Every deck in every notation, labelled as every other: the hint names the notation that it is in.
#[test]
fn mislabelled_decks_are_recognised() {
    for deck in embedded::names().map(|n| embedded::deck(n).unwrap()) {
        for truth in Notation::ALL.map(Convention::usual) {
            for label in Notation::ALL.map(Convention::usual) {
                if truth == label {
                    continue;
                }
                let hints = mislabelled(&deck, truth, label).hints(&label).join("; ");
                let expected = format!("read as {} ", words(truth));
                assert!(
                    hints.contains(&expected),
                    "{} as {label}: {hints}",
                    deck.name
                );
            }
        }
    }
}

/// One thing wrong at a time: the factor of two, the axes, the argument; degrees; millimetres.
#[test]
fn single_slips_are_recognised() {
    let own = Convention::default();
    for deck in embedded::names().map(|n| embedded::deck(n).unwrap()) {
        let slips = [
            Convention {
                notation: Notation::Classical,
                ..own
            },
            Convention {
                axes: Axes::HeaveDown,
                ..own
            },
            Convention {
                argument: Argument::VStar,
                ..own
            },
            Convention {
                argument: Argument::KSemi,
                ..own
            },
        ];
        for truth in slips {
            let hints = mislabelled(&deck, truth, own).hints(&own).join("; ");
            assert!(
                hints.contains(&format!("read as {} ", words(truth))),
                "{}: {hints}",
                deck.name
            );
        }
        let mut in_degrees = own.express(&deck);
        for d in &mut in_degrees.derivatives {
            if d.derivative.motion() == Dof::Torsion {
                d.points
                    .iter_mut()
                    .for_each(|p| p.value = p.value.to_radians());
            }
        }
        let hints = in_degrees.to_table().unwrap().hints(&own).join("; ");
        assert!(
            hints.contains("numbers per degree of rotation"),
            "{}: {hints}",
            deck.name
        );
        let mut wide = deck.clone();
        wide.width_m *= 1000.0;
        assert!(wide.hints(&own)[0].contains("millimetres?"));
    }
}

/// PoliMi's numbers under Scanlan's names: the pattern of positive h1* and a2* is named.
#[test]
fn both_positive_is_said() {
    let deck = embedded::deck("LN21-5200").unwrap();
    let own = Convention::default();
    let polimi = Convention::usual(Notation::Polimi);
    let hints = mislabelled(&deck, polimi, own).hints(&own).join("; ");
    assert!(hints.contains("H1* and A2* both positive"), "{hints}");
}
