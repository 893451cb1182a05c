//! The flat plate in each notation against published closed forms, round trips, contradictions.

mod definition;

use aerodeck::aerodynamics::FlatPlate;
use aerodeck::aerodynamics::derivatives::notation::*;
use aerodeck::aerodynamics::derivatives::{Derivative, Part};
use aerodeck::aerodynamics::derivatives::{DerivativePoint, DerivativeTable, TableHeader};
use aerodeck::files::derivatives::StatedConvention;
use aerodeck::files::derivatives::{ReadOptions, parse_csv_in, write_csv_in};
use aerodeck::section::Dof;
use aerodeck::units::ReducedFrequency;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// A table as a convention has it, read again.
pub fn read(written: &ExpressedTable) -> DerivativeTable {
    let of_one = |d: &ExpressedDerivative| {
        let read = |p| written.convention.read_point(d.derivative, p);
        (d.derivative, d.points.iter().map(read).collect())
    };
    let points = written.derivatives.iter().map(of_one).collect();
    let header = written.header.clone();
    DerivativeTable::new(written.name.clone(), written.width_m, header, points).unwrap()
}

fn all_conventions() -> Vec<Convention> {
    let mut all = Vec::new();
    for notation in Notation::ALL {
        for argument in Argument::ALL {
            for axes in Axes::ALL {
                all.push(Convention {
                    notation,
                    argument,
                    axes,
                });
            }
        }
    }
    all
}

/// The flat plate at the semi-chord reduced frequency `k` in the usual form of a notation, by name.
fn plate(notation: Notation, k: f64) -> impl Fn(&str) -> f64 {
    let b = 0.5;
    let speed = std::f64::consts::TAU * b / (2.0 * k);
    let table =
        DerivativeTable::sampled("plate", &FlatPlate::default(), b, &[speed], &[1.0]).unwrap();
    let expressed = Convention::usual(notation).express(&table);
    move |name| {
        let d = expressed.derivatives.iter().find(|d| d.name == name);
        d.unwrap().points[0].value
    }
}

/// Closed forms of the flat plate in Scanlan's classical derivatives (h down, ρV²), e.g. Simiu and Scanlan, *Wind
/// Effects on Structures*, with Theodorsen's tabulated C(0.5) = 0.5979 − 0.1507i: four digits.
#[test]
fn classical_flat_plate() {
    let (k, f, g) = (0.5, 0.5979, -0.1507);
    let found = plate(Notation::Classical, k);
    for (name, expected) in [
        ("H1", -PI * f / (2.0 * k)),
        ("H2", -PI / (8.0 * k) * (1.0 + f + 2.0 * g / k)),
        ("H3", -PI / (4.0 * k * k) * (f - 0.5 * g * k)),
        ("H4", PI / 4.0 * (1.0 + 2.0 * g / k)),
        ("A1", PI * f / (8.0 * k)),
        ("A2", -PI / (32.0 * k) * (1.0 - f - 2.0 * g / k)),
        ("A3", PI / (16.0 * k * k) * (k * k / 8.0 + f - 0.5 * g * k)),
        ("A4", -PI * g / (8.0 * k)),
    ] {
        assert!(
            (found(name) - expected).abs() < 3e-4,
            "{name}: {}",
            found(name)
        );
    }
    // heave and pitch are damped, the torsional stiffness falls, nose-up rotation lifts (down is positive)
    assert!(found("H1") < 0.0 && found("A2") < 0.0 && found("A3") > 0.0);
    assert!(found("H3") < 0.0 && found("A1") > 0.0);
}

/// Starossek's flat plate: c_hh = 1 − 2iC/k, c_hα = −2C/k² − i(1 + C)/k, c_αh = iC/k,
/// c_αα = 1/8 + C/k² − i(1 − C)/(2k), about mid-chord.
#[test]
fn starossek_flat_plate() {
    use nalgebra::Complex;
    let k = 0.5;
    let c = Complex::new(0.5979, -0.1507);
    let i = Complex::<f64>::i();
    let found = plate(Notation::Starossek, k);
    for (name, expected) in [
        ("hh", 1.0 - i * c * 2.0 / k),
        ("ha", -c * 2.0 / (k * k) - i * (c + 1.0) / k),
        ("ah", i * c / k),
        ("aa", c / (k * k) + 0.125 - i * (1.0 - c) / (2.0 * k)),
    ] {
        let value = Complex::new(
            found(&format!("c_{name}_re")),
            found(&format!("c_{name}_im")),
        );
        assert!((value - expected).norm() < 1e-3, "{name}: {value}");
    }
}

/// In slow motion PoliMi's numbers are slopes of the static coefficients: h1 = h3 = C_L′ = 2π and a1 = a3 = C_M′ = π/2
/// of the thin plate, all positive; at k = 1e-5 Theodorsen's function is 1 to within 1e-4.
#[test]
fn polimi_flat_plate_tends_to_static_slopes() {
    let found = plate(Notation::Polimi, 1e-5);
    for (name, slope) in [
        ("h1", 2.0 * PI),
        ("h3", 2.0 * PI),
        ("a1", PI / 2.0),
        ("a3", PI / 2.0),
    ] {
        assert!((found(name) / slope - 1.0).abs() < 1e-4, "{name}");
    }
    assert!(plate(Notation::Polimi, 0.5)("a2") > 0.0, "pitch is damped");
}

/// Scanlan with ½ and heave up: the same facts with their signs.
#[test]
fn scanlan_flat_plate() {
    let found = plate(Notation::Scanlan, 1e-5);
    let v_hat = 1.0 / 2e-5;
    // H1 = −C_L′ V̂, H3 = C_L′ V̂², A1 = −C_M′ V̂, A3 = C_M′ V̂²: a rising plate sees the wind from above
    for (name, slope) in [
        ("H1", -2.0 * PI * v_hat),
        ("H3", 2.0 * PI * v_hat * v_hat),
        ("A1", -PI / 2.0 * v_hat),
        ("A3", PI / 2.0 * v_hat * v_hat),
    ] {
        assert!((found(name) / slope - 1.0).abs() < 1e-4, "{name}");
    }
    assert!(plate(Notation::Scanlan, 0.5)("A2") < 0.0);
}

fn table_of(v_hats: &[f64], values: &[f64]) -> DerivativeTable {
    let points = Derivative::ALL
        .into_iter()
        .zip(values.chunks(v_hats.len()))
        .map(|(d, values)| {
            let mut of_one: Vec<_> = v_hats
                .iter()
                .zip(values)
                .map(|(v_hat, value)| DerivativePoint {
                    mean_speed_m_s: Some(8.17),
                    v_hat: *v_hat,
                    value: *value,
                })
                .collect();
            of_one.sort_by(|a, b| a.v_hat.total_cmp(&b.v_hat));
            (d, of_one)
        })
        .collect::<BTreeMap<_, _>>();
    DerivativeTable::new("random", 0.5, TableHeader::default(), points).unwrap()
}

fn assert_same(a: &DerivativeTable, b: &DerivativeTable, what: &str) {
    for d in Derivative::ALL {
        for (p, q) in a.points(d).iter().zip(b.points(d)) {
            assert!((p.v_hat / q.v_hat - 1.0).abs() < 1e-12, "{what}: {d}");
            let error = (p.value - q.value).abs();
            assert!(error <= 1e-12 * p.value.abs(), "{what}: {d} {error:e}");
        }
    }
}

/// All 18 numbers from any convention to any other and back, through tables and through the text of files.
#[test]
fn every_pair_of_conventions_round_trips() {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..24 {
        // three different reduced velocities
        let v_hats = [1.0, 1e3, 1e6].map(|decade| decade * random.random_range(1e-3..0.9));
        let values: Vec<f64> = (0..54).map(|_| random.random_range(-50.0..50.0)).collect();
        let table = table_of(&v_hats, &values);
        for from in all_conventions() {
            let mut text = Vec::new();
            write_csv_in(&table, &from, &mut text).unwrap();
            let text = String::from_utf8(text).unwrap();
            let (read, said) = parse_csv_in(&text, &ReadOptions::default()).unwrap();
            assert_eq!(said, from);
            assert_same(&table, &read, &from.to_string());
            for to in all_conventions() {
                let there = super::notation::read(&to.express(&read));
                let back = from.express(&there);
                let original = from.express(&table);
                for (a, b) in original.derivatives.iter().zip(&back.derivatives) {
                    for (p, q) in a.points.iter().zip(&b.points) {
                        assert!((p.argument / q.argument - 1.0).abs() < 1e-12);
                        assert!((p.value - q.value).abs() <= 1e-12 * p.value.abs());
                    }
                }
            }
        }
    }
}

fn written(convention: &Convention) -> String {
    let table = table_of(&[1.0, 2.0], &[0.5; 36]);
    let mut text = Vec::new();
    write_csv_in(&table, convention, &mut text).unwrap();
    String::from_utf8(text).unwrap()
}

#[test]
fn headers_state_the_convention_in_words() {
    let text = written(&Convention::usual(Notation::Polimi));
    for line in [
        "# notation: polimi\n",
        "# argument: v_star = V/(f B)\n",
        "# axes: heave and lift up, rotation and moment nose-up, sway and drag downwind\n",
        "# definition: with V* = V/(f B): lift = (rho V^2 B/2) [-h1 z'/V",
        "derivative,point,mean_speed_m_s,v_star,value\np5,1,8.17,6.28",
    ] {
        assert!(text.contains(line), "{line}\n{text}");
    }
}

fn stating(convention: StatedConvention) -> ReadOptions {
    ReadOptions {
        convention,
        ..ReadOptions::default()
    }
}

#[test]
fn contradictions_are_refused() {
    let polimi = written(&Convention::usual(Notation::Polimi));
    let says = |text: &str, stated: StatedConvention| {
        parse_csv_in(text, &stating(stated))
            .unwrap_err()
            .to_string()
    };
    let nothing = StatedConvention::default();
    let as_scanlan = StatedConvention::notation(Notation::Scanlan);
    assert_eq!(
        says(&polimi, as_scanlan),
        "notation: expected `scanlan` as stated on import, found `polimi` stated in the file"
    );
    let down = StatedConvention {
        axes: Some(Axes::HeaveDown),
        ..nothing
    };
    assert_eq!(
        says(&polimi, down),
        "axes: expected `heave_down` as stated on import, found `heave_up` stated in the file"
    );
    let cases = [
        (
            "# notation: polimi",
            "# notation: classical",
            "(definition): expected that of classical",
        ),
        (
            "# notation: polimi\n",
            "",
            "(definition): expected a line `# notation: …` with it",
        ),
        (
            "# notation: polimi",
            "# notation: milan",
            "(notation): expected one of scanlan, simiu, classical",
        ),
        (
            "= V/(f B)\n",
            "= V/(w B)\n",
            "(argument): expected one of v_hat = V/(omega B)",
        ),
        (
            "lift up,",
            "lift left,",
            "(axes): expected heave_up or heave_down",
        ),
        (
            "m_s,v_star",
            "m_s,v_hat",
            "expected a column `v_star` as the header says, found `v_hat`",
        ),
        (
            "m_s,v_star",
            "m_s,v_hat,v_star",
            "expected one column of reduced velocities",
        ),
        (
            "\np5,",
            "\nP5,",
            "expected one of p1 to p6, h1 to h6, a1 to a6, found `P5`",
        ),
    ];
    for (old, new, expected) in cases {
        let bad = polimi.replacen(old, new, 1);
        assert_ne!(bad, polimi, "{old}");
        let message = says(&bad, nothing);
        assert!(message.contains(expected), "{message}");
    }
    let silent: String = polimi
        .lines()
        .filter(|l| !l.starts_with("# notation") && !l.starts_with("# definition"))
        .map(|l| format!("{l}\n"))
        .collect();
    assert!(says(&silent, nothing).starts_with("notation: expected it stated in the file or"));
    let stated = StatedConvention::notation(Notation::Polimi);
    let (table, _) = parse_csv_in(&silent, &stating(stated)).unwrap();
    assert_same(
        &table,
        &parse_csv_in(&polimi, &stating(nothing)).unwrap().0,
        "stated",
    );
    let over_k = written(&Convention::usual(Notation::Starossek));
    let negative = over_k.replacen("c_pp_im,1,8.17,0.5", "c_pp_im,1,8.17,-0.5", 1);
    assert!(says(&negative, nothing).contains("column k_semi: expected a positive number"));
}

#[test]
fn words_are_read_back() {
    for notation in Notation::ALL {
        assert_eq!(notation.name().parse::<Notation>().unwrap(), notation);
        for d in Derivative::ALL {
            assert_eq!(notation.derivative(notation.name_of(d)).unwrap(), d);
        }
    }
    assert_eq!("Küssner".parse::<Notation>().unwrap(), Notation::Starossek);
    for argument in Argument::ALL {
        assert_eq!(argument.name().parse::<Argument>().unwrap(), argument);
    }
    let classical = StatedConvention::notation(Notation::Classical).or_usual();
    assert_eq!(classical.axes, Axes::HeaveDown);
}
