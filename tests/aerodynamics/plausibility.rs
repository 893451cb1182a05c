//! Tests of the hints: silent on what is right, right on what is mislabelled.

use crate::matrix;
use crate::notation::read;
use aerodeck::aerodynamics::derivatives::notation::{Argument, Axes, Convention, Notation};
use aerodeck::aerodynamics::derivatives::{Derivative, DerivativePoint, DerivativeTable};
use aerodeck::files::derivatives::embedded;
use aerodeck::plausibility::{FindingKind, FindingSeverity, of_table, sentences};
use aerodeck::section::Dof;

/// What `deck`, written in `truth`, becomes when it is read as `label`.
fn mislabelled(deck: &DerivativeTable, truth: Convention, label: Convention) -> DerivativeTable {
    let mut written = truth.express(deck);
    written.convention = label;
    read(&written)
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
        let hints = said(&read(&in_degrees), own);
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

/// The drag derivatives of every deck with the other sign: sway that drag feeds.
#[test]
fn drag_of_the_wrong_sign_is_a_doubt() {
    for deck in embedded::names().map(|n| embedded::deck(n).unwrap()) {
        let turned = scaled(&deck, |d| match d.force() {
            Dof::Lateral => -1.0,
            _ => 1.0,
        });
        let found = of_table(&turned, &Convention::default());
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(found[0].severity, FindingSeverity::Doubt);
        assert!(found[0].text.starts_with("P1* > 0 at "), "{found:?}");
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

/// A table of the crate's own convention with other points for each derivative.
fn rewritten(
    deck: &DerivativeTable,
    change: impl Fn(Derivative) -> Vec<DerivativePoint>,
) -> DerivativeTable {
    let points = deck.derivatives().map(|d| (d, change(d))).collect();
    DerivativeTable::new(deck.name.clone(), deck.width_m, deck.header.clone(), points).unwrap()
}

/// Two derivatives in each other's place.
fn exchanged(deck: &DerivativeTable, a: Derivative, b: Derivative) -> DerivativeTable {
    rewritten(deck, |d| {
        let from = if d == a {
            b
        } else if d == b {
            a
        } else {
            d
        };
        deck.points(from).to_vec()
    })
}

/// Values times a factor of each derivative.
fn scaled(deck: &DerivativeTable, factor: impl Fn(Derivative) -> f64) -> DerivativeTable {
    rewritten(deck, |d| {
        let scale = |p: &DerivativePoint| DerivativePoint {
            value: factor(d) * p.value,
            ..*p
        };
        deck.points(d).iter().map(scale).collect()
    })
}

/// The only finding is a doubt and says all this.
#[track_caller]
fn doubted(table: &DerivativeTable, expected: &[&str]) {
    let found = of_table(table, &Convention::default());
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].severity, FindingSeverity::Doubt, "{}", found[0]);
    let text = found[0].to_string();
    for words in expected {
        assert!(text.contains(words), "{text}");
    }
}

/// Each of these raises the onset, up to twice and beyond; as notes they let a requirement be met.
#[test]
fn slips_to_the_unsafe_side_are_doubts() {
    use Derivative::{A1, A2, A3, H3, H4};
    let those_of = "they would be those of a bridge deck";
    let slopes = "though one slope of the moment stands behind both";
    for deck in embedded::names().map(|n| embedded::deck(n).unwrap()) {
        let by_semi_chord = rewritten(&deck, |d| {
            let twice = |p: &DerivativePoint| DerivativePoint {
                v_hat: 2.0 * p.v_hat,
                ..*p
            };
            deck.points(d).iter().map(twice).collect()
        });
        let words = "read over reduced velocities by the semi-chord b = B/2 ";
        doubted(&by_semi_chord, &[words, those_of]);
        let words = ["with A1* and A2* exchanged ", those_of, slopes];
        doubted(&exchanged(&deck, A1, A2), &words);
        for turned in [H3, A1, A3] {
            let words = format!("with the sign of {turned}* turned ");
            let by = |d| if d == turned { -1.0 } else { 1.0 };
            doubted(&scaled(&deck, by), &[&words, those_of]);
        }
        for halved in [A1, A3] {
            let by = |d| if d == halved { 0.5 } else { 1.0 };
            doubted(&scaled(&deck, by), &[slopes]);
        }
        let nose_down = |d: Derivative| if d.force() == Dof::Torsion { -1.0 } else { 1.0 };
        let words = [
            "read as moments nose-down beside rotations nose-up",
            those_of,
        ];
        doubted(&scaled(&deck, nose_down), &words);
        let about_edge = rewritten(&deck, |d| {
            let mut points = deck.points(d).to_vec();
            if d.force() == Dof::Torsion {
                let lift = deck.points(Derivative::from_entry(Dof::Vertical, d.motion(), d.part()));
                let both = points.iter_mut().zip(lift);
                both.for_each(|(moment, lift)| moment.value -= 0.5 * lift.value);
            }
            points
        });
        let words = [
            "read as moments about the leading edge",
            those_of,
            "beside a lift of",
        ];
        doubted(&about_edge, &words);
        for turned in [A1, A3] {
            let in_upper_half = rewritten(&deck, |d| {
                let mut points = deck.points(d).to_vec();
                points.sort_by(|a, b| a.v_hat.total_cmp(&b.v_hat));
                let middle = points[points.len() / 2].v_hat;
                let mut points = deck.points(d).to_vec();
                let above = points
                    .iter_mut()
                    .filter(|p| d == turned && p.v_hat >= middle);
                above.for_each(|p| p.value = -p.value);
                points
            });
            doubted(&in_upper_half, &["at high V̂ A1* and A3* are ", slopes]);
        }
    }
    // where H4* is that of a streamlined deck; on the other two the onset comes down
    for name in ["LN20-5500", "LN21-5200", "LN21-5500"] {
        let wrong = exchanged(&embedded::deck(name).unwrap(), H4, A2);
        let words = [
            "A2* damps rotation",
            "with H4* and A2* exchanged ",
            those_of,
        ];
        doubted(&wrong, &words);
    }
}

/// Half the moment is what decks with wide gaps have: every A* together is a note, unless the lift is that of another notation.
#[test]
fn half_of_all_moments_is_a_note() {
    for deck in ["LN20-5500", "LN21-5200", "LN21-5800", "LN21-6100"] {
        let deck = embedded::deck(deck).unwrap();
        let half = |d: Derivative| match d.force() {
            Dof::Torsion => 0.5,
            _ => 1.0,
        };
        let found = of_table(&scaled(&deck, half), &Convention::default());
        assert_eq!(found.len(), 1, "{}: {found:?}", deck.name);
        assert_eq!(found[0].severity, FindingSeverity::Note, "{}", found[0]);
    }
}

/// A bluff deck that gallops is worth a note, no more.
#[test]
fn what_is_bluff_is_no_doubt() {
    let deck = embedded::deck("LN21-5200").unwrap();
    let bluff = scaled(&deck, |d| match d {
        Derivative::H1 | Derivative::A2 => -0.3,
        _ => 1.0,
    });
    let found = of_table(&bluff, &Convention::default());
    assert!(
        found.iter().all(|f| f.severity == FindingSeverity::Note),
        "{found:?}"
    );
}

/// Bluff decks of other tests, and one that is published.
#[test]
fn other_decks_give_no_hint() {
    let published = aerodeck::files::derivatives::named_table(
        "data/bridges/iabse-2a-derivatives.csv",
        "".as_ref(),
    );
    let fed = |d: DerivativeTable| matrix::made_bluff(&d);
    let decks = matrix::decks().into_iter().map(fed);
    for deck in decks.chain([matrix::bluff_table(), published.unwrap()]) {
        let found = sentences(&of_table(&deck, &Convention::default()));
        assert_eq!(found, Vec::<String>::new(), "{}", deck.name);
    }
}
