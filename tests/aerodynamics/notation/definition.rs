//! Forces written down from the definition of each notation, with dimensions, against the conversion of tables.

use super::*;
use aerodeck::aerodynamics::derivatives::{DerivativePoint, DerivativeTable, TableHeader};
use aerodeck::units::ReducedVelocity;
use nalgebra::{Complex, Matrix3};
use std::collections::BTreeMap;

const DENSITY: f64 = 1.19;
const WIDTH: f64 = 0.73;
const OMEGA: f64 = 6.1;

/// Amplitudes of lift, drag and moment per length in the axes of the notation, for the amplitudes `(z, x, θ)`.
type Force = fn(&dyn Fn(&str) -> f64, f64, [Complex<f64>; 3]) -> [Complex<f64>; 3];

/// `d/dt` of an amplitude.
fn rate(amplitude: Complex<f64>) -> Complex<f64> {
    Complex::i() * OMEGA * amplitude
}

/// (C.1) with `pressure` for ½ρV² or ρV², K for 2πfB/V, and the moment with B².
fn scanlan(
    pressure: f64,
    c: &dyn Fn(&str) -> f64,
    v: f64,
    [z, x, t]: [Complex<f64>; 3],
) -> [Complex<f64>; 3] {
    let k = OMEGA * WIDTH / v;
    let (dz, dx, dt) = (rate(z) / v, rate(x) / v, rate(t) * WIDTH / v);
    let row = |near: [f64; 2], far: [f64; 2], turn: [f64; 2]| {
        dz * k * near[0]
            + z * k * k * near[1] / WIDTH
            + dx * k * far[0]
            + x * k * k * far[1] / WIDTH
            + dt * k * turn[0]
            + t * k * k * turn[1]
    };
    let lift = row([c("H1"), c("H4")], [c("H5"), c("H6")], [c("H2"), c("H3")]);
    let drag = row([c("P5"), c("P6")], [c("P1"), c("P4")], [c("P2"), c("P3")]);
    let moment = row([c("A1"), c("A4")], [c("A5"), c("A6")], [c("A2"), c("A3")]);
    let scale = pressure * v * v * WIDTH;
    [lift * scale, drag * scale, moment * scale * WIDTH]
}

fn with_half(c: &dyn Fn(&str) -> f64, v: f64, r: [Complex<f64>; 3]) -> [Complex<f64>; 3] {
    scanlan(0.5 * DENSITY, c, v, r)
}

fn without_half(c: &dyn Fn(&str) -> f64, v: f64, r: [Complex<f64>; 3]) -> [Complex<f64>; 3] {
    scanlan(DENSITY, c, v, r)
}

/// (C.2) as printed, with V* = V/(fB) and B² in the moment.
fn polimi(c: &dyn Fn(&str) -> f64, v: f64, [z, x, t]: [Complex<f64>; 3]) -> [Complex<f64>; 3] {
    let v_star = v * std::f64::consts::TAU / (OMEGA * WIDTH);
    let stiff = 2.0 * PI.powi(3) / (v_star * v_star);
    let row = |letter: &str| {
        let n = |digit: &str| c(&format!("{letter}{digit}"));
        -rate(z) * n("1") / v - rate(t) * WIDTH * n("2") / v
            + t * n("3")
            + z * stiff * n("4") / WIDTH
            - rate(x) * n("5") / v
            + x * stiff * n("6") / WIDTH
    };
    let scale = 0.5 * DENSITY * v * v * WIDTH;
    [row("h") * scale, row("p") * scale, row("a") * scale * WIDTH]
}

/// `L = ω²πρb² (c_hh h + c_hp p + b c_hα α)` and so on.
fn starossek(c: &dyn Fn(&str) -> f64, _: f64, r: [Complex<f64>; 3]) -> [Complex<f64>; 3] {
    let b = 0.5 * WIDTH;
    let arms = [("h", 1.0), ("p", 1.0), ("a", b)];
    arms.map(|(m, arm)| {
        let sum: Complex<f64> = arms
            .iter()
            .zip(r)
            .map(|((n, length), amplitude)| {
                let both = Complex::new(c(&format!("c_{m}{n}_re")), c(&format!("c_{m}{n}_im")));
                both * amplitude * *length
            })
            .sum();
        sum * OMEGA * OMEGA * PI * DENSITY * b * b * arm
    })
}

fn force_of(notation: Notation) -> Force {
    match notation {
        Notation::Scanlan | Notation::Simiu => with_half,
        Notation::Classical => without_half,
        Notation::Polimi => polimi,
        Notation::Starossek => starossek,
    }
}

/// `G` in the order y, x, θ from the definition: forces due to unit motions, made dimensionless as in this crate.
fn transfer_by_definition(
    convention: Convention,
    c: &dyn Fn(&str) -> f64,
    k: f64,
) -> Matrix3<Complex<f64>> {
    let v = OMEGA * WIDTH / k;
    let up = if convention.axes == Axes::HeaveDown {
        -1.0
    } else {
        1.0
    };
    let one = Complex::new(1.0, 0.0);
    let zero = Complex::new(0.0, 0.0);
    // y/B = 1, x/B = 1, θ = 1, each in the axes of the notation
    let motions = [
        [one * WIDTH * up, zero, zero],
        [zero, one * WIDTH, zero],
        [zero, zero, one],
    ];
    let q = 0.5 * DENSITY * v * v * WIDTH;
    Matrix3::from_columns(&motions.map(|r| {
        let [lift, drag, moment] = force_of(convention.notation)(c, v, r);
        nalgebra::Vector3::new(lift * up / q, drag / q, moment / (q * WIDTH))
    }))
}

/// A table of 18 numbers without any symmetry at one reduced frequency.
fn arbitrary_table(k: f64) -> DerivativeTable {
    let points = Derivative::ALL
        .into_iter()
        .enumerate()
        .map(|(i, d)| {
            let value = (1.0 + i as f64).sqrt() * if i % 3 == 0 { -1.3 } else { 0.7 };
            let point = DerivativePoint {
                mean_speed_m_s: None,
                v_hat: 1.0 / k,
                value,
            };
            (d, vec![point])
        })
        .collect::<BTreeMap<_, _>>();
    DerivativeTable::new("arbitrary", WIDTH, TableHeader::default(), points).unwrap()
}

/// (1.17) of the table itself.
fn transfer_of(table: &DerivativeTable) -> Matrix3<Complex<f64>> {
    let mut g = Matrix3::zeros();
    for s in table.samples(&Dof::THREE) {
        let part = match s.part {
            Part::Real => Complex::new(s.value, 0.0),
            Part::Imaginary => Complex::new(0.0, s.value),
        };
        g[(s.force as usize, s.motion as usize)] += part;
    }
    g
}

/// Every notation over every argument in both axes: the matrix built from its definition is that of the table. Both
/// paths round a handful of times; 1e-13 of the largest entry leaves room for a hundred.
#[test]
fn matrices_from_the_definitions_are_those_of_the_tables() {
    for k in [0.08, 0.6, 2.3] {
        let table = arbitrary_table(k);
        let expected = transfer_of(&table);
        for notation in Notation::NAMED {
            for argument in Argument::ALL {
                for axes in Axes::ALL {
                    let convention = Convention {
                        notation,
                        argument,
                        axes,
                    };
                    let expressed = convention.express(&table);
                    let value = |name: &str| {
                        let d = expressed.derivatives.iter().find(|d| d.name == name);
                        d.unwrap().points[0].value
                    };
                    let written = expressed.derivatives[0].points[0].argument;
                    let meant = match argument {
                        Argument::VHat => 1.0 / k,
                        Argument::VStar => ReducedVelocity::from(
                            aerodeck::units::ReducedFrequency::from_full_width(k),
                        )
                        .v_star(),
                        Argument::KFull => k,
                        Argument::KSemi => 0.5 * k,
                    };
                    assert!((written / meant - 1.0).abs() < 1e-15);
                    let g = transfer_by_definition(convention, &value, k);
                    let largest = expected.iter().map(|z| z.norm()).fold(0.0, f64::max);
                    for (a, b) in g.iter().zip(&expected) {
                        assert!((a - b).norm() < 1e-13 * largest, "{convention}: {a} {b}");
                    }
                }
            }
        }
    }
}

/// Appendix C of the thesis in numbers: the rows of h and a as printed, those of p with heave and sway swapped.
#[test]
fn polimi_factors_are_those_of_appendix_c() {
    let k = ReducedFrequency::from_v_hat(2.5);
    let v_star = ReducedVelocity::from(k).v_star();
    let (rate, turn, stiff) = (-2.0 * PI / v_star, (2.0 * PI / v_star).powi(2), 2.0 / PI);
    for (polimi, scanlan, factor) in [
        ("h1", "H1", rate),
        ("h2", "H2", rate),
        ("h3", "H3", turn),
        ("h4", "H4", stiff),
        ("h5", "H5", rate),
        ("h6", "H6", stiff),
        ("a1", "A1", rate),
        ("a3", "A3", turn),
        ("a4", "A4", stiff),
        ("p1", "P5", rate),
        ("p2", "P2", rate),
        ("p3", "P3", turn),
        ("p4", "P6", stiff),
        ("p5", "P1", rate),
        ("p6", "P4", stiff),
    ] {
        let d = Notation::Polimi.derivative(polimi).unwrap();
        assert_eq!(d.name(), scanlan);
        assert!((Notation::Polimi.factor(d, k) / factor - 1.0).abs() < 1e-15);
    }
}
