//! Modes of nearly one frequency by tables.

use crate::bridges::SEARCH;
use aerodeck::aerodynamics::Transfer;
use aerodeck::aerodynamics::derivatives::{Extrapolation, InterpolatedTable};
use aerodeck::bridge::{Bridge, BridgeMode, Node, StripGroup};
use aerodeck::files::derivatives::embedded::deck;
use aerodeck::flutter::pk_onset;
use aerodeck::section::Dof;
use std::f64::consts::PI;
use std::sync::Arc;

/// Two torsional modes of nearly one frequency, in wind that is not the same along the girder, are two: the first breath of wind mixes
/// their shapes, and both must not come on one root where the table begins. Half a millihertz moves the onset little.
#[test]
fn modes_of_one_frequency_are_followed_apart() {
    let table = deck("LN21-5200").unwrap();
    let onset = |second_hz: f64| {
        let nodes: Vec<Node> = (0..21)
            .map(|i| Node {
                name: format!("{}", i + 1),
                along_m: -500.0 + 50.0 * f64::from(i),
                length_m: if i % 20 == 0 { 25.0 } else { 50.0 },
            })
            .collect();
        let wave = |n: f64, at: &Node| (n * PI * (at.along_m + 500.0) / 1000.0).sin();
        let spec = [
            (0, 1.0, 0.10),
            (0, 2.0, 0.14),
            (2, 1.0, 0.278),
            (2, 2.0, second_hz),
        ];
        let modes = (1..).zip(spec).map(|(number, (motion, waves, hertz))| {
            let shape: Vec<[f64; 3]> = nodes
                .iter()
                .map(|node| {
                    let mut at = [0.0; 3];
                    at[motion] = wave(waves, node);
                    at
                })
                .collect();
            let mass = if motion == 0 { 22_740.0 } else { 2.47e6 };
            BridgeMode {
                number,
                frequency_hz: hertz,
                damping_ratio: 0.003,
                generalised_mass: 500.0 * mass,
                shape,
            }
        });
        let modes: Vec<BridgeMode> = modes.collect();
        let forces = InterpolatedTable::new(&table, &Dof::TWO, Extrapolation::Refuse).unwrap();
        let forces: Arc<dyn Transfer> = Arc::new(forces);
        let groups = (0..21).map(|node| StripGroup {
            name: "girder".into(),
            width_m: 31.0,
            wind_factor: 0.6 + 0.02 * node as f64,
            nodes: vec![node],
            forces: forces.clone(),
        });
        let bridge = Bridge::new("girder", 1.22, nodes, modes, groups.collect()).unwrap();
        let (forces, structure) = (bridge.forces(), bridge.structure());
        let found = pk_onset("table", &structure, &forces, &SEARCH, forces.known_range());
        found.unwrap().critical_speed_m_s().unwrap()
    };
    let (near, apart) = (onset(0.2785), onset(0.279));
    assert!((near / apart - 1.0).abs() < 0.01, "{near} {apart}");
}
