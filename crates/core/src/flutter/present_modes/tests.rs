//! All eigenvalues, and bridges of which a mode is left out.

use super::*;
use crate::aerodynamics::RationalModel;
use crate::bridge::{Bridge, BridgeMode, Node, StripGroup};
use std::f64::consts::PI;

/// The vertical, lateral and torsional sines of a girder of 1200 m and 40 nodes, in turn, on the flat plate.
fn section(modes: usize) -> CoupledSection {
    const NODES: usize = 40;
    let along = |node: usize| (node as f64 + 0.5) / NODES as f64;
    let nodes: Vec<Node> = (0..NODES)
        .map(|node| Node {
            name: node.to_string(),
            along_m: 1200.0 * along(node),
            length_m: 1200.0 / NODES as f64,
        })
        .collect();
    let mode = |number: usize| {
        let (motion, waves) = (number % 3, (number / 3 + 1) as f64);
        let mut shape = vec![[0.0; 3]; NODES];
        for (node, shape) in shape.iter_mut().enumerate() {
            shape[motion] = (PI * waves * along(node)).sin();
        }
        // a cable's frequencies rise with their waves, a girder's faster
        let first_hz = [0.08, 0.04, 0.28][motion];
        BridgeMode {
            number: number + 1,
            frequency_hz: first_hz * waves * (1.0 + 0.05 * waves),
            generalised_mass: [1.2e7, 1.2e7, 1.6e9][motion],
            damping_ratio: 0.003,
            shape,
        }
    };
    let group: StripGroup = StripGroup {
        name: "girder".into(),
        width_m: 31.0,
        wind_factor: 1.0,
        nodes: (0..NODES).collect(),
        forces: Arc::new(RationalModel::jones_flat_plate()),
    };
    let modes = (0..modes).map(mode).collect();
    let bridge = Bridge::new("bridge", 1.25, nodes, modes, vec![group]).unwrap();
    CoupledSection::new(bridge.structure(), bridge.forces().realize().unwrap()).unwrap()
}

fn by_all_eigenvalues(section: &CoupledSection, wind: f64) -> f64 {
    let all = section.at(wind).unwrap().eigenvalues().unwrap();
    let oscillating = all.into_iter().filter(|z| z.im > 0.0);
    oscillating.map(damping_ratio).fold(1.0, f64::min)
}

/// What grows without oscillating has no frequency, and is not damped.
#[test]
fn a_section_that_diverges_is_not_damped() {
    let mut section = crate::section::SectionModel::iabse_1_1a();
    section.vertical.frequency_hz = Some(0.5);
    section.torsion.frequency_hz = Some(0.1);
    let structure = section.structure().unwrap();
    let plate = RationalModel::jones_flat_plate();
    let coupled = CoupledSection::with_model(&structure, &plate).unwrap();
    assert!(smallest_damping(&coupled, 5.0).unwrap() > 0.0);
    assert_eq!(smallest_damping(&coupled, 60.0).unwrap(), -1.0);
}

/// Up, down, far at once, through the onset and back: by two ways.
#[test]
fn the_least_damping_is_that_of_all_eigenvalues() {
    let mut growing = 0;
    for modes in [3, 12, 39] {
        let section = section(modes);
        let mut present = PresentModes::new(&section).unwrap();
        for wind in [30.0, 30.2, 31.0, 8.0, 0.5, 45.0, 44.9, 90.0, 2.0, 60.0] {
            let found = present.smallest_damping(&section, wind);
            let expected = by_all_eigenvalues(&section, wind);
            let found = found.unwrap_or_else(|| panic!("{modes} modes, {wind} m/s: not followed"));
            // all eigenvalues of some hundred states are known to a few hundred roundings of the largest
            assert!(
                (found - expected).abs() < 1e-10,
                "{modes} modes, {wind} m/s: {found}, {expected}"
            );
            growing += usize::from(expected < 0.0);
        }
    }
    assert!((1..9).contains(&growing), "{growing}");
}

/// A mode that was taken for another leaves its own eigenvalue uncounted.
#[test]
fn a_mode_that_was_lost_is_seen() {
    let section = section(12);
    let mut present = PresentModes::new(&section).unwrap();
    for wind in [5.0, 30.0, 60.0] {
        let least = present.smallest_damping(&section, wind).unwrap();
        let ratio = least + MARGIN;
        let all = present.follow(&section, wind).unwrap();
        assert_eq!(present.none_below(&all, wind, ratio), Some(true));
        for lost in 0..all.len() {
            if damping_ratio(all[lost]) > 0.9 * ratio {
                continue;
            }
            let mut wrong = all.clone();
            // found on the negative axis, among the filters
            wrong[lost] = Complex::new(-2.0, 0.3);
            assert_ne!(
                present.none_below(&wrong, wind, ratio),
                Some(true),
                "{wind}, {lost}"
            );
        }
    }
}

/// Zeros over as many poles on the negative axis, on a ray close to the imaginary axis.
fn counted(zeros: &[Complex<f64>]) -> Option<bool> {
    let ray = Complex::from_polar(1.0, 1.6);
    turn(
        |r| {
            let lambda = ray * r;
            let factor = |z: &Complex<f64>| (lambda - z) / (lambda + 1.5);
            Some(zeros.iter().map(factor).product())
        },
        [1e-2, 1e3],
    )
}

#[test]
fn zeros_in_the_sector_are_seen() {
    let pair = |re: f64, im: f64| [Complex::new(re, im), Complex::new(re, -im)];
    let left = [pair(-1.0, 0.3), pair(-0.4, 2.0)].concat();
    assert_eq!(counted(&left), Some(true));
    // beyond the ray by little, on the right, far away, on the axis
    for (re, im) in [(-0.01, 2.0), (0.3, 1.0), (1e-4, 30.0), (2.0, 0.0)] {
        let found = counted(&[&left[..], &pair(re, im)].concat());
        assert_ne!(found, Some(true), "{re}, {im}: {found:?}");
    }
    assert_ne!(counted(&[&left[..], &[2.0.into()]].concat()), Some(true));
    // as close to it, on the left
    let near = [&left[..], &pair(-0.2, 2.0)].concat();
    assert_eq!(counted(&near), Some(true));
}
