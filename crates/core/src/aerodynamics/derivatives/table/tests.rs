//! Tests of the table type on a table made from the flat plate.

use super::*;
use crate::aerodynamics::FlatPlate;

/// The eight derivatives of the flat plate at `v_hats` for each speed.
pub(crate) fn flat_plate_table(speeds_m_s: &[f64], v_hats: &[f64]) -> DerivativeTable {
    let mut points = BTreeMap::new();
    for d in coupling(&Dof::TWO) {
        let row = Dof::TWO.iter().position(|x| *x == d.force()).unwrap();
        let column = Dof::TWO.iter().position(|x| *x == d.motion()).unwrap();
        let mut of_one = Vec::new();
        for &speed in speeds_m_s {
            for &v_hat in v_hats {
                let g = FlatPlate::default()
                    .transfer(ReducedFrequency::from_v_hat(v_hat))
                    .unwrap()[(row, column)];
                let part = if d.part() == Part::Real { g.re } else { g.im };
                of_one.push(DerivativePoint {
                    mean_speed_m_s: Some(speed),
                    v_hat,
                    value: part * v_hat * v_hat,
                });
            }
        }
        points.insert(d, of_one);
    }
    DerivativeTable::new("flat plate", 0.5, TableHeader::default(), points).unwrap()
}

fn changed(change: impl FnOnce(&mut BTreeMap<Derivative, Vec<DerivativePoint>>)) -> String {
    let table = flat_plate_table(&[4.0, 8.17], &[10.0, 5.0, 2.0]);
    let mut points = table.points.clone();
    change(&mut points);
    DerivativeTable::new("x", 0.5, TableHeader::default(), points)
        .unwrap_err()
        .to_string()
}

#[test]
fn samples_are_the_transfer_matrix() {
    let table = flat_plate_table(&[4.0], &[10.0, 5.0, 2.0]);
    let samples = table.samples(&Dof::TWO);
    assert_eq!(samples.len(), 24);
    for s in samples {
        let g = FlatPlate::default().transfer(s.k).unwrap();
        let at = |d| Dof::TWO.iter().position(|x| *x == d).unwrap();
        let g = g[(at(s.force), at(s.motion))];
        let expected = if s.part == Part::Real { g.re } else { g.im };
        assert!((s.value - expected).abs() <= 4.0 * f64::EPSILON * expected.abs());
        assert_eq!(s.mean_speed_m_s, Some(4.0));
    }
    assert_eq!(table.samples(&[Dof::Torsion]).len(), 6);
    let range = table.tested_range(&Dof::TWO);
    assert_eq!((range.min.full_width(), range.max.full_width()), (0.1, 0.5));
}

#[test]
fn speed_groups_split_the_table() {
    let groups = near_groups(vec![8.17, 4.0, 8.21], SAME_SPEED);
    assert_eq!(groups, [vec![4.0], vec![8.17, 8.21]]);
    let table = flat_plate_table(&[8.17, 4.0], &[3.0]);
    assert_eq!(table.speed_groups(), [4.0, 8.17]);
    let slow = table.at_speed_group(0).unwrap();
    assert_eq!(slow.points(Derivative::H1).len(), 1);
    let three = flat_plate_table(&[8.17, 4.0, 6.0], &[3.0]);
    let outer = three.at_speed_groups(&[0, 2]).unwrap();
    assert_eq!(outer.speed_groups(), [4.0, 8.17]);
    let message = table.at_speed_group(2).unwrap_err().to_string();
    assert_eq!(
        message,
        "table flat plate: expected a speed group below 2, found 2"
    );
}

#[test]
fn equal_reduced_velocities_at_two_speeds_are_allowed() {
    assert_eq!(
        flat_plate_table(&[4.0, 8.0], &[6.0, 3.0])
            .points(Derivative::A2)
            .len(),
        4
    );
}

#[test]
fn missing_derivatives_are_listed() {
    let message = changed(|p| {
        p.remove(&Derivative::H3);
        p.remove(&Derivative::A1);
    });
    assert!(message.contains("found none for H3, A1"), "{message}");
    let message = changed(|p| {
        let copy = p[&Derivative::H1].clone();
        p.insert(Derivative::P1, copy);
    });
    assert!(message.contains("found none for P4"), "{message}");
    let sway = flat_plate_table(&[4.0], &[3.0]).require(&Dof::THREE);
    assert!(sway.unwrap_err().to_string().contains("none of P1, P2"));
}

#[test]
fn impossible_points_are_named() {
    let set =
        |f: fn(&mut Vec<DerivativePoint>)| changed(|p| f(p.get_mut(&Derivative::H2).unwrap()));
    assert_eq!(
        set(|p| p[4].v_hat = 12.0),
        "H2, point 6: expected reduced velocities V̂ rising steadily in a speed group, found V̂ = 2 after 12"
    );
    assert_eq!(
        set(|p| p[1].v_hat = -5.0),
        "H2, point 2: expected a positive reduced velocity V̂, found -5"
    );
    assert_eq!(
        set(|p| p[2].v_hat = 5.0),
        "H2, point 3: expected every reduced velocity V̂ once in a speed group, found V̂ = 5 after 5"
    );
    assert_eq!(
        set(|p| p[0].value = f64::NAN),
        "H2, point 1: expected a value of the derivative, no larger than 1e12, found NaN"
    );
    // squares and products of it would be infinite
    assert!(set(|p| p[0].value = 1e200).contains("no larger than 1e12"));
    assert_eq!(
        set(|p| p[3].mean_speed_m_s = None),
        "mean speeds: expected a mean speed at every point, or at none, found one at 47 of 48 points"
    );
}
