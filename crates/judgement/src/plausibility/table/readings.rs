//! The ways in which the numbers of a table could have been meant.

use crate::aerodynamics::derivatives::notation::{Argument, Axes, Convention, Notation};
use crate::aerodynamics::derivatives::{Derivative, DerivativePoint, DerivativeTable};
use crate::section::Dof;

/// The points of a derivative as they could have been meant.
pub(super) type Reading<'a> = Box<dyn Fn(Derivative) -> Vec<DerivativePoint> + 'a>;

/// Every other way in which numbers labelled as `label` could have been meant, in words.
pub(super) fn candidates(
    table: &DerivativeTable,
    label: Convention,
) -> impl Iterator<Item = (String, Reading<'_>)> {
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
        let (notation, argument) = (c.notation.title(), c.argument.definition());
        let words = format!("read as {notation}, over {argument}, {}", c.axes);
        let read = move |d, p: &_| c.read_point(d, &label.express_point(d, p));
        (words, by_point(table, read))
    });
    let scaled = |words: &str, factor: fn(Derivative) -> f64| {
        let reading = by_point(table, move |d, p| times(p, factor(d)));
        (words.to_owned(), reading)
    };
    let per_degree = scaled("read as numbers per degree of rotation", |d| {
        match d.motion() {
            Dof::Torsion => 1f64.to_degrees(),
            _ => 1.0,
        }
    });
    let nose_down = scaled(
        "read as moments nose-down beside rotations nose-up",
        |d| match d.force() {
            Dof::Torsion => -1.0,
            _ => 1.0,
        },
    );
    let by_semi_chord = by_point(table, move |d, p| {
        let mut point = label.express_point(d, p);
        point.argument *= 0.5;
        label.read_point(d, &point)
    });
    let words = "read over reduced velocities by the semi-chord b = B/2";
    // between reduced frequencies this factor is another argument
    let by_velocity = matches!(label.argument, Argument::VHat | Argument::VStar);
    let by_semi_chord = by_velocity.then(|| (words.to_owned(), by_semi_chord));
    let others = [per_degree, nose_down, about_mid_chord(table)];
    conventions.chain(others).chain(by_semi_chord)
}

/// Moments moved by half a width from the leading edge to mid-chord, where the lift was measured as well.
fn about_mid_chord(table: &DerivativeTable) -> (String, Reading<'_>) {
    let reading: Reading<'_> = Box::new(|d| {
        let mut points = table.points(d).to_vec();
        if d.force() == Dof::Torsion {
            let lift = Derivative::from_entry(Dof::Vertical, d.motion(), d.part());
            for p in &mut points {
                let is_same = |l: &&DerivativePoint| (l.v_hat / p.v_hat - 1.0).abs() < 1e-6;
                let lift = table.points(lift).iter().find(is_same);
                p.value += lift.map_or(0.0, |l| 0.5 * l.value);
            }
        }
        points
    });
    let words = "read as moments about the leading edge (A* + H*/2 about mid-chord)";
    (words.to_owned(), reading)
}

/// Two derivatives exchanged, and one that couples the motions with its sign turned.
pub(super) fn single_slips(
    table: &DerivativeTable,
    label: Convention,
) -> impl Iterator<Item = (String, Reading<'_>)> {
    let two = |d: &Derivative| Dof::TWO.contains(&d.force()) && Dof::TWO.contains(&d.motion());
    let of_two = move || table.derivatives().filter(two);
    let pairs = of_two().flat_map(move |a| of_two().map(move |b| (a, b)));
    let exchanged = pairs.filter(|(a, b)| a < b).map(move |(a, b)| {
        let reading: Reading<'_> = Box::new(move |d| {
            let from = match d {
                _ if d == a => b,
                _ if d == b => a,
                _ => d,
            };
            let read = |p| label.read_point(d, &label.express_point(from, p));
            table.points(from).iter().map(read).collect()
        });
        (format!("with {a}* and {b}* exchanged"), reading)
    });
    let turned = [Derivative::H3, Derivative::A1, Derivative::A3].map(|turned| {
        let read = move |d, p: &_| times(p, if d == turned { -1.0 } else { 1.0 });
        let words = format!("with the sign of {turned}* turned");
        (words, by_point(table, read))
    });
    exchanged.chain(turned)
}

fn by_point<'a>(
    table: &'a DerivativeTable,
    read: impl Fn(Derivative, &DerivativePoint) -> DerivativePoint + 'a,
) -> Reading<'a> {
    Box::new(move |d| table.points(d).iter().map(|p| read(d, p)).collect())
}

fn times(point: &DerivativePoint, factor: f64) -> DerivativePoint {
    DerivativePoint {
        value: point.value * factor,
        ..*point
    }
}
