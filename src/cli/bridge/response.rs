//! The mode that flutters over time, released below, at and above the onset.

use crate::flutter::{BridgeMotion, ModePoint, NodeMotion};
use crate::report::{PlottedSeries, TimePanel};
use crate::study::bridge::BridgeFlutter;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Speeds over the onset.
const AROUND: [f64; 3] = [0.95, 1.0, 1.05];
/// Periods that are shown, and points of each.
const PERIODS: (usize, usize) = (16, 40);
/// Rotation at the release, degrees.
const RELEASED_DEG: f64 = 1.0;

/// Vertical and lateral displacement (m) and rotation (degrees) of the node that turns most, by the shape at the onset and the
/// eigenvalues at the speeds of the curves nearest to those around it; `None` where no mode that flutters was followed.
pub(super) fn panels(results: &BridgeFlutter) -> Option<Vec<TimePanel>> {
    let answer = results.answers.last()?;
    let onset = answer.search.onset()?;
    let z = displaced(answer.motion.as_ref()?)?;
    let branch = results
        .curves
        .branches
        .iter()
        .find(|b| b.name == onset.branch)?;
    let mut runs = Vec::with_capacity(AROUND.len());
    for factor in AROUND {
        let wanted = factor * onset.at.speed_m_s;
        let distance = |p: &&ModePoint| (p.speed_m_s - wanted).abs();
        let nearest = branch.points.iter();
        let nearest = nearest.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        let at_onset = factor == 1.0;
        let (speed, lambda) = match at_onset {
            true => (
                onset.at.speed_m_s,
                Complex::new(0.0, TAU * onset.at.frequency_hz),
            ),
            false => {
                let lambda = nearest.eigenvalue;
                (nearest.speed_m_s, Complex::new(lambda.re, lambda.im))
            }
        };
        let percent = 100.0 * (speed / onset.at.speed_m_s - 1.0);
        let label = match at_onset {
            true => format!("{speed:.1} m/s, the onset"),
            false => format!("{speed:.1} m/s ({percent:+.1} %)"),
        };
        runs.push((label, lambda));
    }
    let period = TAU / runs[0].1.im;
    let names = ["vertical y (m)", "lateral x (m)", "rotation θ (°)"];
    let panel = |(i, name): (usize, &str)| TimePanel {
        y_label: name.to_owned(),
        series: runs
            .iter()
            .map(|(label, lambda)| {
                let points = (0..=PERIODS.0 * PERIODS.1).map(|n| {
                    let t = period * n as f64 / PERIODS.1 as f64;
                    (t, (z[i] * (lambda * t).exp()).re)
                });
                PlottedSeries::new(label.clone(), points.collect())
            })
            .collect(),
    };
    Some(names.into_iter().enumerate().map(panel).collect())
}

/// Motion of the node that turns most, with that rotation 1° and real.
fn displaced(motion: &BridgeMotion) -> Option<[Complex<f64>; 3]> {
    let complex = |z: [f64; 2]| Complex::new(z[0], z[1]);
    let turns = |n: &&NodeMotion| complex(n.motion[2]).norm();
    let nodes = motion.nodes.iter();
    let most = nodes.max_by(|a, b| turns(a).total_cmp(&turns(b)))?;
    let [y, x, theta] = most.motion.map(complex);
    let unit = theta / RELEASED_DEG.to_radians();
    Some([y / unit, x / unit, theta / unit * 1f64.to_degrees()])
}
