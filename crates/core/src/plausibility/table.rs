//! Tables of derivatives: whether the numbers look like what they are said to be.
//!
//! Between notations, arguments and axes lie factors of 2, π and K and changes of sign. At low reduced velocities the
//! derivatives `H1*`, `H3*`, `A1*`, `A3*` of streamlined and most bluff girders have the signs of a flat plate's and nearly
//! its size: on the embedded decks 0.65 to 1.1 of it for the lift, 0.85 to 0.95 for the moment. A table that is far from
//! that, and near it when it is read in another convention, was probably written in that one: reduced velocities that are
//! wrong by 2π change `H1*`, `A1*` by that factor against the plate's and `H3*`, `A2*`, `A3*` by its square.

use super::limits::{DECK_WIDTH, beyond};
use super::{Finding, FindingKind};
use crate::aerodynamics::derivatives::notation::{Argument, Axes, Convention, Notation};
use crate::aerodynamics::derivatives::{Derivative, DerivativePoint, DerivativeTable, Part};
use crate::aerodynamics::{FlatPlate, Transfer};
use crate::section::Dof;

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

/// The five numbers at low reduced velocity, over those of the flat plate; `None` where the table has no such derivative.
struct Signature([Option<f64>; 5]);

/// What looks wrong in a table: signs, sizes and units that are those of another convention. Empty when nothing does. `label` is
/// the convention that the file states, or that was stated for it.
pub fn of_table(table: &DerivativeTable, label: &Convention) -> Vec<Finding> {
    let width = format!("{}: width_m", table.name);
    let mut found: Vec<Finding> = beyond(&width, table.width_m, &DECK_WIDTH)
        .into_iter()
        .collect();
    let own = Signature::of(table, &|_, point| *point);
    let score = own.score();
    if score < ODD {
        return found;
    }
    let best = candidates(*label)
        .map(|(words, reading)| (Signature::of(table, &*reading).score(), words))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let odd = Finding::doubt(FindingKind::Convention, &table.name, own.words());
    found.push(match best {
        Some((other, words)) if other < FITS && other + BETTER_BY < score => {
            odd.otherwise(format!(
                "read as {words} they would be those of a bridge deck: is the table labelled wrongly? (nothing was changed)"
            ))
        }
        _ => {
            let odd = odd.otherwise(
                "a streamlined deck has H1* < 0, H3* > 0, A1* < 0, A2* < 0, A3* > 0 at low V̂ (Scanlan, heave up), in size near \
                 a flat plate's: check notation, argument, axes and units (nothing was changed)"
                    .to_owned(),
            );
            // signs by themselves may be those of a bluff deck, which gallops
            if own.has_a_size_of_no_deck() {
                odd
            } else {
                odd.into_note()
            }
        }
    });
    found
}

type Reading = Box<dyn Fn(Derivative, &DerivativePoint) -> DerivativePoint>;

/// Every other way in which numbers labelled as `label` could have been meant, in words.
fn candidates(label: Convention) -> impl Iterator<Item = (String, Reading)> {
    let others = Notation::ALL.into_iter().flat_map(|notation| {
        Argument::ALL.into_iter().flat_map(move |argument| {
            Axes::ALL.into_iter().map(move |axes| Convention {
                notation,
                argument,
                axes,
            })
        })
    });
    let conventions = others.filter(move |c| *c != label).map(move |c| {
        let reading: Reading = Box::new(move |d, p| c.read_point(d, &label.express_point(d, p)));
        (
            format!(
                "{}, over {}, {}",
                c.notation.title(),
                c.argument.definition(),
                c.axes
            ),
            reading,
        )
    });
    let degrees: Reading = Box::new(move |d, p| {
        let per_radian = if d.motion() == Dof::Torsion {
            1f64.to_degrees()
        } else {
            1.0
        };
        DerivativePoint {
            value: p.value * per_radian,
            ..*p
        }
    });
    conventions.chain([("numbers per degree of rotation".to_owned(), degrees)])
}

impl Signature {
    /// Medians over the lower half of the reduced velocities.
    fn of(
        table: &DerivativeTable,
        reading: &dyn Fn(Derivative, &DerivativePoint) -> DerivativePoint,
    ) -> Self {
        Self(USUAL.map(|(derivative, _, _)| {
            let read = table
                .points(derivative)
                .iter()
                .map(|p| reading(derivative, p));
            let mut points: Vec<DerivativePoint> = read.collect();
            points.sort_by(|a, b| a.v_hat.total_cmp(&b.v_hat));
            points.truncate(points.len().div_ceil(2));
            let ratio = |p: &DerivativePoint| p.value / flat_plate(derivative, p);
            let mut ratios: Vec<f64> = points.iter().map(ratio).collect();
            ratios.sort_by(f64::total_cmp);
            ratios.get(ratios.len() / 2).copied()
        }))
    }

    /// Those that the table has, each with its derivative, usual size and spread.
    fn known(&self) -> impl Iterator<Item = (f64, (Derivative, f64, f64))> {
        let all = self.0.into_iter().zip(USUAL);
        all.filter_map(|(ratio, usual)| Some((ratio?, usual)))
    }

    /// Sum over the five of the squared distance from what is usual, in standard deviations.
    fn score(&self) -> f64 {
        let terms = self.known().map(|(ratio, (d, usual, spread))| {
            if ratio > 0.0 {
                ((ratio / usual).ln() / spread).powi(2).min(WRONG_SIGN)
            } else if d == Derivative::A2 {
                0.25 * WRONG_SIGN
            } else {
                WRONG_SIGN
            }
        });
        terms.sum()
    }

    fn has_a_size_of_no_deck(&self) -> bool {
        self.known()
            .any(|(ratio, (_, usual, _))| (ratio / usual).abs().ln().abs() > NO_DECK.ln())
    }

    /// What is odd about the numbers.
    fn words(&self) -> String {
        let odd = self.known().filter_map(|(ratio, (d, usual, spread))| {
            if ratio <= 0.0 {
                return Some(format!("{d}* has the sign opposite to a flat plate's"));
            }
            let far = (ratio / usual).ln().abs() > 2.0 * spread;
            far.then(|| format!("{d}* is {ratio:.2} times a flat plate's"))
        });
        let odd: Vec<String> = odd.collect();
        let wrong = |i: usize| self.0[i].is_some_and(|ratio| ratio <= 0.0);
        let both = if wrong(0) && wrong(3) {
            " (H1* and A2* both positive: a section that gallops and flutters at once, or PoliMi's h1*, a2*)"
        } else {
            ""
        };
        format!("at low V̂ {}{both}", odd.join(", "))
    }
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
    use crate::aerodynamics::derivatives::table::tests::flat_plate_table;

    /// A table of some derivatives is judged by those.
    #[test]
    fn what_is_missing_is_no_doubt() {
        let part = Signature([Some(0.85), None, None, None, Some(0.9)]);
        assert!(part.score() < 1e-9);
    }

    #[test]
    fn the_flat_plate_is_in_its_own_notation() {
        for v_hats in [
            vec![0.6, 1.0, 2.0, 4.0, 8.0],
            vec![0.1, 0.4, 0.8],
            vec![5.0, 20.0, 40.0],
        ] {
            let found = of_table(&flat_plate_table(&[4.0], &v_hats), &Convention::default());
            assert!(found.is_empty(), "{v_hats:?}: {found:?}");
        }
    }
}
