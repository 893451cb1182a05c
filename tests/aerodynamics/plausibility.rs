//! Tests of the hints: silent on what is right, right on what is mislabelled.

use aerodeck::aerodynamics::derivatives::notation::{Argument, Axes, Convention, Notation};
use aerodeck::aerodynamics::derivatives::{Derivative, DerivativeTable};
use aerodeck::files::derivatives::embedded;
use aerodeck::plausibility::{FindingKind, FindingSeverity, of_table, sentences};
use aerodeck::section::Dof;

/// What `deck`, written in `truth`, becomes when it is read as `label`.
fn mislabelled(deck: &DerivativeTable, truth: Convention, label: Convention) -> DerivativeTable {
    let mut written = truth.express(deck);
    written.convention = label;
    written.to_table().unwrap()
}

/// The findings in one line.
fn said(table: &DerivativeTable, label: Convention) -> String {
    sentences(&of_table(table, &label)).join("; ")
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
        let found = sentences(&of_table(&deck, &label));
        assert_eq!(found, Vec::<String>::new(), "{}", deck.name);
        for group in 0..2 {
            assert!(of_table(&deck.at_speed_group(group).unwrap(), &label).is_empty());
        }
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
                let hints = said(&mislabelled(&deck, truth, label), label);
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
            let hints = said(&mislabelled(&deck, truth, own), own);
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
        let hints = said(&in_degrees.to_table().unwrap(), own);
        assert!(
            hints.contains("numbers per degree of rotation"),
            "{}: {hints}",
            deck.name
        );
        let mut wide = deck.clone();
        wide.width_m *= 1000.0;
        assert!(said(&wide, own).contains("in mm it would be"));
    }
}

/// PoliMi's numbers under Scanlan's names: the pattern of positive h1* and a2* is named.
#[test]
fn both_positive_is_said() {
    let deck = embedded::deck("LN21-5200").unwrap();
    let own = Convention::default();
    let polimi = Convention::usual(Notation::Polimi);
    let hints = said(&mislabelled(&deck, polimi, own), own);
    assert!(hints.contains("H1* and A2* both positive"), "{hints}");
}

/// Numbers over V̂ that are labelled V*: 2π in the reduced velocity, on which an onset is far too low. Numbers in PoliMi's notation
/// hardly depend on the velocity and cannot tell.
#[test]
fn v_hat_labelled_v_star_is_a_doubt() {
    for deck in embedded::names().map(|n| embedded::deck(n).unwrap()) {
        for notation in [Notation::Scanlan, Notation::Classical, Notation::Starossek] {
            let over = |argument| Convention {
                argument,
                ..Convention::usual(notation)
            };
            let (truth, label) = (over(Argument::VHat), over(Argument::VStar));
            let found = of_table(&mislabelled(&deck, truth, label), &label);
            assert_eq!(found.len(), 1, "{}", deck.name);
            assert_eq!(
                (found[0].kind, found[0].severity),
                (FindingKind::Convention, FindingSeverity::Doubt)
            );
            let text = found[0].to_string();
            assert!(
                text.contains(&format!("read as {} ", words(truth))),
                "{text}"
            );
        }
    }
}

/// A bluff deck that gallops is worth a note, no more.
#[test]
fn what_is_bluff_is_no_doubt() {
    let label = Convention::default();
    let deck = embedded::deck("LN21-5200").unwrap();
    let mut bluff = label.express(&deck);
    for d in &mut bluff.derivatives {
        if [Derivative::H1, Derivative::A2].contains(&d.derivative) {
            d.points.iter_mut().for_each(|p| p.value *= -0.3);
        }
    }
    let found = of_table(&bluff.to_table().unwrap(), &label);
    assert!(
        found.iter().all(|f| f.severity == FindingSeverity::Note),
        "{found:?}"
    );
}
