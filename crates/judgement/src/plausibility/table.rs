//! Tables of derivatives: whether the numbers look like what they are said to be.
//!
//! Between notations, arguments and axes lie factors of 2, π and K and changes of sign. At low reduced velocities the
//! derivatives `H1*`, `H3*`, `A1*`, `A3*` of streamlined and most bluff girders have the signs of a flat plate's and nearly
//! its size: on the embedded decks 0.65 to 1.1 of it for the lift, 0.85 to 0.95 for the moment. A table that is far from
//! that, and near it when it is read in another convention, was probably written in that one: reduced velocities that are
//! wrong by 2π change `H1*`, `A1*` by that factor against the plate's and `H3*`, `A2*`, `A3*` by its square.
//!
//! What is too small among the terms that couple the motions raises the onset, and no bluffness explains one of them by itself:
//! a heave of speed `ẏ` is an angle of attack `−ẏ/V`, so that one slope of the lift stands behind `H1*` and `H3*`, and one of the
//! moment behind `A1*` and `A3*`. Where these contradict each other, a number is wrong, whatever the deck.

mod readings;

use super::limits::{DECK_WIDTH, beyond};
use super::{Finding, FindingKind};
use crate::aerodynamics::derivatives::notation::Convention;
use crate::aerodynamics::derivatives::{Derivative, DerivativePoint, DerivativeTable, Part};
use crate::aerodynamics::{FlatPlate, Transfer};
use crate::section::Dof;
use readings::{candidates, single_slips};

/// Derivative, its usual size over the flat plate's, and how much that varies, as a standard deviation of the logarithm.
const USUAL: [(Derivative, f64, f64); 5] = [
    (Derivative::H1, 0.85, 0.35),
    (Derivative::H3, 0.85, 0.30),
    (Derivative::A1, 0.92, 0.25),
    (Derivative::A2, 0.60, 0.70),
    (Derivative::A3, 0.90, 0.25),
];
/// What a wrong sign counts, and the most that a size can count; `A2*` changes its sign on bluff decks and counts a quarter.
const WRONG_SIGN: f64 = 16.0;
/// A table is odd from this sum on (the embedded decks and the flat plate have 0.1 to 1.3) …
const ODD: f64 = 10.0;
/// … and another convention is named when it brings the sum below this, and at least so much lower.
const FITS: f64 = 6.0;
const BETTER_BY: f64 = 8.0;
/// A size that no bluff deck has, as a factor on what is usual.
const NO_DECK: f64 = 5.0;
/// Two derivatives with one slope behind them differ by less than this, both over the flat plate's: `A1*/A3*` is 0.96 to 1.05 on the
/// embedded decks (also by speeds) and of IABSE 2a, 0.67 on the bluff deck of the tests, `H1*/H3*` 0.84 to 1.16. Half of one is beyond.
const ONE_SLOPE: f64 = 1.8;
/// The moment over the flat plate's below which both slopes of it are too small beside a lift above the other: moments about
/// another axis. The embedded decks have 0.88 to 0.95, decks with wide gaps half of it.
const LEAST_MOMENT: f64 = 0.35;
const MUCH_LIFT: f64 = 0.5;
/// `A2*` over the flat plate's above which a deck would damp rotation as none does: 0.36 to 0.61 is measured, less on bluff decks.
const MOST_A2: f64 = 1.5;

/// The five numbers in the lower and the upper half of the reduced velocities, over those of the flat plate; `None` where the table
/// has no such derivative.
type Signature = [[Option<f64>; 5]; 2];

/// What looks wrong in a table: signs, sizes and units that are those of another convention, and what its measurements contradict.
/// Empty when nothing does. `label` is the convention that the file states, or that was stated for it.
pub fn of_table(table: &DerivativeTable, label: &Convention) -> Vec<Finding> {
    let width = format!("{}: width_m", table.name);
    let measured = format!("measurements of {}", table.name);
    let doubt = |text| Finding::doubt(FindingKind::Contradiction, &measured, text);
    let doubts = table.header.doubts.iter().map(doubt);
    let width = beyond(&width, table.width_m, &DECK_WIDTH);
    let mut found: Vec<Finding> = width.into_iter().chain(doubts).collect();
    found.extend(of_sway(table));
    let own = signature(&|d| table.points(d).to_vec());
    let own_score = score(&own);
    if own_score < ODD {
        return found;
    }
    let contradict = contradictions(&own).iter().any(|half| !half.is_empty());
    // by themselves the sizes of a bluff deck may resemble those of an exchange
    let slips = contradict.then(|| single_slips(table, *label));
    let best = candidates(table, *label)
        .chain(slips.into_iter().flatten())
        .map(|(words, reading)| (score(&signature(&*reading)), words))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let odd = Finding::doubt(FindingKind::Convention, &table.name, words(&own));
    found.push(match best {
        Some((other, words)) if other < FITS && other + BETTER_BY < own_score => {
            odd.otherwise(format!(
                "{words} they would be those of a bridge deck: is the table labelled wrongly? (nothing was changed)"
            ))
        }
        _ => {
            let odd = odd.otherwise(
                "a streamlined deck has H1* < 0, H3* > 0, A1* < 0, A2* < 0, A3* > 0 at low V̂ (Scanlan, heave up), in size near \
                 a flat plate's: check notation, argument, axes and units (nothing was changed)"
                    .to_owned(),
            );
            let beyond_decks = |(ratio, (_, usual, _)): (f64, (Derivative, f64, f64))| {
                (ratio / usual).abs().ln().abs() > NO_DECK.ln()
            };
            // signs by themselves may be those of a bluff deck, which gallops
            odd.into_note_if(!contradict && !known(&own).any(beyond_decks))
        }
    });
    found
}

/// Drag grows with the wind that a deck meets, and damps its sway: `P1* ≈ −2 C_D/K`, whatever the deck.
fn of_sway(table: &DerivativeTable) -> Option<Finding> {
    let points = table.points(Derivative::P1);
    let feeding = points.iter().filter(|p| p.value > 0.0).count();
    let text = format!("P1* > 0 at {feeding} of {} points", points.len());
    let odd = Finding::doubt(FindingKind::Convention, &table.name, text).otherwise(
        "drag damps sway, P1* is about \u{2212}2 C_D/K: check the signs of all P* (nothing was changed)".to_owned(),
    );
    // small numbers scatter: of one speed of an embedded deck three in eight
    (4 * feeding > 3 * points.len()).then_some(odd)
}

/// Medians over each half of the reduced velocities.
fn signature(reading: &dyn Fn(Derivative) -> Vec<DerivativePoint>) -> Signature {
    let mut halves = [[None; 5]; 2];
    for (i, (derivative, _, _)) in USUAL.into_iter().enumerate() {
        let mut points = reading(derivative);
        points.sort_by(|a, b| a.v_hat.total_cmp(&b.v_hat));
        let ratio = |p: &DerivativePoint| p.value / flat_plate(derivative, p);
        let median = |points: &[DerivativePoint]| {
            let mut ratios: Vec<f64> = points.iter().map(ratio).collect();
            ratios.sort_by(f64::total_cmp);
            ratios.get(ratios.len() / 2).copied()
        };
        let (low, high) = points.split_at(points.len().div_ceil(2));
        (halves[0][i], halves[1][i]) = (median(low), median(high));
    }
    halves
}

/// Those that the table has at low reduced velocities, each with its derivative, usual size and spread.
fn known(own: &Signature) -> impl Iterator<Item = (f64, (Derivative, f64, f64))> {
    let all = own[0].into_iter().zip(USUAL);
    all.filter_map(|(ratio, usual)| Some((ratio?, usual)))
}

/// Sum over the five of the squared distance from what is usual, in standard deviations, and what contradictions count.
fn score(own: &Signature) -> f64 {
    let terms = known(own).map(|(ratio, (d, usual, spread))| {
        if ratio > 0.0 {
            ((ratio / usual).ln() / spread).powi(2).min(WRONG_SIGN)
        } else if d == Derivative::A2 {
            0.25 * WRONG_SIGN
        } else {
            WRONG_SIGN
        }
    });
    terms.sum::<f64>() + WRONG_SIGN * contradictions(own).concat().len() as f64
}

/// What no deck can have whatever its shape, and errs to the side of a high onset, in the lower half of the reduced velocities, or
/// where nothing is wrong there in the upper one.
fn contradictions(own: &Signature) -> [Vec<String>; 2] {
    let low = contradictions_of(&own[0]);
    match low.is_empty() {
        true => [low, contradictions_of(&own[1])],
        false => [low, Vec::new()],
    }
}

fn contradictions_of(half: &[Option<f64>; 5]) -> Vec<String> {
    let below = |a: f64, b: f64| b > 0.0 && a * ONE_SLOPE < b;
    let one_slope = |i: usize, j: usize, force: &str| {
        let (a, b) = (half[i]?, half[j]?);
        // an H1* that is small or feeds heave is that of a bluff deck, and lowers the onset
        let odd = below(b, a) || force == "moment" && below(a, b);
        let (x, y) = (USUAL[i].0, USUAL[j].0);
        let words = format!(
            "{x}* and {y}* are {a:.2} and {b:.2} times a flat plate's, though one slope of the {force} stands behind both"
        );
        odd.then_some(words)
    };
    let damping = half[3].filter(|a2| *a2 > MOST_A2);
    let damping = damping.map(|a2| {
        format!("A2* damps rotation {a2:.2} times as much as a flat plate's, where decks have 0.3 to 0.7")
    });
    let without_moment = || {
        let [h1, h3, a1, _, a3] = *half;
        let (h1, h3, a1, a3) = (h1?, h3?, a1?, a3?);
        let odd = a1.max(a3) < LEAST_MOMENT && h1.min(h3) > MUCH_LIFT;
        odd.then(|| {
            format!(
                "A1* and A3* are {a1:.2} and {a3:.2} times a flat plate's beside a lift of {h1:.2} and {h3:.2} times its own"
            )
        })
    };
    let found = [
        one_slope(0, 1, "lift"),
        one_slope(2, 4, "moment"),
        damping,
        without_moment(),
    ];
    found.into_iter().flatten().collect()
}

/// What is odd about the numbers.
fn words(own: &Signature) -> String {
    let beyond = |deviations: f64| -> Vec<String> {
        let odd = known(own).filter_map(|(ratio, (d, usual, spread))| {
            if ratio == 0.0 {
                return Some(format!("{d}* is zero"));
            }
            if ratio < 0.0 {
                return Some(format!("{d}* has the sign opposite to a flat plate's"));
            }
            let far = (ratio / usual).ln().abs() > deviations * spread;
            far.then(|| format!("{d}* is {ratio:.2} times a flat plate's"))
        });
        odd.collect()
    };
    let [low, high] = contradictions(own);
    let odd = [beyond(2.0), low].concat();
    // none by itself, but all together
    let odd = match odd.is_empty() && high.is_empty() {
        true => beyond(0.0),
        false => odd,
    };
    let wrong = |i: usize| own[0][i].is_some_and(|ratio| ratio <= 0.0);
    let both = if wrong(0) && wrong(3) {
        " (H1* and A2* both positive: a section that gallops and flutters at once, or PoliMi's h1*, a2*)"
    } else {
        ""
    };
    let said = [("low", odd, both), ("high", high, "")].into_iter();
    let said = said
        .filter(|(_, odd, _)| !odd.is_empty())
        .map(|(at, odd, more)| format!("at {at} V̂ {}{more}", odd.join(", ")));
    said.collect::<Vec<_>>().join("; ")
}

/// The derivative of the flat plate at the reduced velocity of a point.
fn flat_plate(derivative: Derivative, point: &DerivativePoint) -> f64 {
    let place = |dof: Dof| usize::from(dof == Dof::Torsion);
    // the plate answers at every K > 0
    let Ok(g) = FlatPlate::default().transfer(point.k()) else {
        return f64::NAN;
    };
    let entry = g[(place(derivative.force()), place(derivative.motion()))];
    let part = match derivative.part() {
        Part::Real => entry.re,
        Part::Imaginary => entry.im,
    };
    part * point.v_hat * point.v_hat
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A table of some derivatives is judged by those.
    #[test]
    fn what_is_missing_is_no_doubt() {
        let half = [Some(0.85), None, None, None, Some(0.9)];
        assert!(score(&[half, half]) < 1e-9);
    }

    /// Sizes that are odd together, none by itself.
    #[test]
    fn what_is_odd_is_named() {
        let half = USUAL.map(|(_, usual, spread)| Some(usual * (-1.9 * spread).exp()));
        let odd = [half, half];
        assert!(score(&odd) > ODD);
        let words = words(&odd);
        assert!(words.contains("times a flat plate's"), "{words}");
    }

    #[test]
    fn the_flat_plate_is_in_its_own_notation() {
        for v_hats in [
            vec![0.6, 1.0, 2.0, 4.0, 8.0],
            vec![0.1, 0.4, 0.8],
            vec![5.0, 20.0, 40.0],
        ] {
            let hertz = v_hats.iter().map(|v| 4.0 / (std::f64::consts::TAU * v));
            let hertz: Vec<f64> = hertz.collect();
            let table =
                DerivativeTable::sampled("plate", &FlatPlate::default(), 1.0, &[4.0], &hertz);
            let found = of_table(&table.unwrap(), &Convention::default());
            assert!(found.is_empty(), "{v_hats:?}: {found:?}");
        }
    }
}
