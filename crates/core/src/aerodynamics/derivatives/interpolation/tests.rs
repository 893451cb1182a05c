//! Tests of the curves against SciPy, of merging, and of the onset of flat-plate tables.

use super::*;

const X: [f64; 6] = [0.0, 1.0, 2.5, 3.0, 4.5, 6.0];
const Y: [f64; 6] = [0.0, 0.8, 0.6, 0.1, -1.0, -0.3];
const AT: [f64; 4] = [0.4, 2.7, 3.3, 5.9];

fn curve(interpolation: Interpolation) -> Curve {
    Curve {
        interpolation,
        part: Part::Real,
        x: X.to_vec(),
        y: Y.to_vec(),
        slopes: interpolation.slopes(&X, &Y),
    }
}

/// SciPy 1.x: `Akima1DInterpolator(X, Y, method='makima')`, `PchipInterpolator`, `CubicSpline` at the same places.
#[test]
fn curves_agree_with_scipy() {
    let expected = [
        (
            Interpolation::ModifiedAkima,
            [
                0.41294412010008347,
                0.42283534136546164,
                -0.1638746987951806,
                -0.38068148148148095,
            ],
        ),
        (
            Interpolation::PchipVHat,
            [
                0.45056,
                0.446268480189237,
                -0.181136842105263,
                -0.4018370370370369,
            ],
        ),
        (
            Interpolation::CubicSpline,
            [
                0.3896079999999999,
                0.4137619999999998,
                -0.20276399999999983,
                -0.4282446666666664,
            ],
        ),
    ];
    for (interpolation, values) in expected {
        let curve = curve(interpolation);
        for (x, value) in AT.into_iter().zip(values) {
            let found = curve.quantity(x);
            assert!(
                (found - value).abs() < 1e-14,
                "{interpolation} at {x}: {found}"
            );
        }
    }
}

fn point(v_hat: f64, value: f64, group: usize) -> (DerivativePoint, usize) {
    let point = DerivativePoint {
        mean_speed_m_s: Some(5.0),
        v_hat,
        value,
    };
    (point, group)
}

/// Two speeds nearly meet at V̂ 4 with scatter: one point in between, so that no steep slope arises. Two points of one
/// speed are two points unless one is the other measured again, and the polygon over V̂ keeps all of them.
#[test]
fn points_of_two_speeds_that_nearly_coincide_count_as_one() {
    let of_two = [
        point(1.0, 1.0, 0),
        point(4.0, 16.0, 0),
        point(4.1, 20.0, 1),
        point(9.0, 81.0, 1),
    ];
    let merged = Curve::new(Interpolation::ModifiedAkima, Part::Real, &of_two);
    assert_eq!(merged.x.len(), 3);
    assert!((merged.y[1] - 0.5 * (16.0 / 16.0 + 20.0 / (4.1 * 4.1))).abs() < 1e-14);
    let of_one = of_two.map(|(p, _)| (p, 0));
    let mut again = of_one;
    again[2].0.v_hat = 4.001;
    let merged = Curve::new(Interpolation::ModifiedAkima, Part::Real, &again);
    assert_eq!(merged.x.len(), 3);
    for (points, interpolation) in [
        (of_one, Interpolation::ModifiedAkima),
        (of_two, Interpolation::LinearVHat),
    ] {
        assert_eq!(Curve::new(interpolation, Part::Real, &points).x.len(), 4);
    }
}

/// One, two and three points: constant, straight, parabola or monotone; never a panic.
#[test]
fn few_points_are_enough() {
    for interpolation in Interpolation::ALL {
        for count in 1..=4 {
            let v_hats = [2.0, 4.0, 6.0, 9.0];
            let points: Vec<_> = v_hats[..count]
                .iter()
                .map(|v| point(*v, v * v, 0))
                .collect();
            let curve = Curve::new(interpolation, Part::Real, &points);
            for v in &v_hats[..count] {
                let found = curve.at(ReducedFrequency::from_v_hat(*v));
                assert!(
                    (found - 1.0).abs() < 1e-14,
                    "{interpolation}, {count} points"
                );
            }
        }
    }
}

#[test]
fn names_round_trip() {
    for interpolation in Interpolation::ALL {
        let read: Interpolation = interpolation.name().parse().unwrap();
        assert_eq!(read, interpolation);
        let json = format!("\"{interpolation}\"");
        assert_eq!(serde_json::to_string(&interpolation).unwrap(), json);
    }
    let error = "akima".parse::<Interpolation>().unwrap_err().to_string();
    assert!(
        error.contains("one of modified_akima, cubic_spline"),
        "{error}"
    );
}
