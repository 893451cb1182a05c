//! Units that were probably meant, by the usual sizes of a section model and its motion.

use super::file::Campaign;
use super::findings::Finding;
use crate::plausibility::{DECK_WIDTH, MODEL_LENGTH, MODEL_WIDTH, SAMPLING, WIND_SPEED, hint};
use crate::section::Dof;
use crate::wind_tunnel::RawRecording;

/// Usual amplitudes of a forced motion: displacements over the width, rotations in rad.
const AMPLITUDES: [(f64, f64); 2] = [(1e-3, 0.5), (5e-4, 0.6)];

/// Hints about the numbers of the campaign file.
pub(super) fn of_file(campaign: &Campaign) -> Vec<Finding> {
    let mut said = Vec::new();
    match &campaign.rig {
        Some(rig) => {
            said.push(hint("rig.model_width_m", rig.model_width_m, &MODEL_WIDTH));
            said.push(hint(
                "rig.model_length_m",
                rig.model_length_m,
                &MODEL_LENGTH,
            ));
            for (i, cell) in rig.cells.iter().enumerate() {
                let farthest = cell.position_m.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
                let key = format!("rig.cells[{i}].position_m");
                said.push(hint(&key, farthest, &MODEL_LENGTH).filter(|_| farthest > 1.0));
            }
        }
        None => said.extend(
            campaign
                .section
                .width_m
                .map(|b| hint("section.width_m", b, &DECK_WIDTH)),
        ),
    }
    let sampling = campaign.recording.sampling_hz;
    said.extend(sampling.map(|hz| hint("recording.sampling_hz", hz, &SAMPLING)));
    for (i, run) in campaign.runs.iter().enumerate() {
        let key = format!("run[{i}].mean_speed_m_s");
        said.extend(run.mean_speed_m_s.map(|v| hint(&key, v, &WIND_SPEED)));
    }
    said.into_iter()
        .flatten()
        .map(|what| Finding::of_run("", what))
        .collect()
}

/// Hints about the motions of a recording, of which `stated` are meant to move.
pub(super) fn of_motion(
    (run, name): (&str, &str),
    recording: &RawRecording,
    stated: &[Dof],
    width_m: f64,
) -> Vec<Finding> {
    let mut found = Vec::new();
    for (dof, motion) in Dof::THREE.into_iter().zip(&recording.motion) {
        let low = motion.iter().copied().fold(f64::INFINITY, f64::min);
        let high = motion.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let amplitude = 0.5 * (high - low);
        let size = amplitude * dof.motion_scale(width_m);
        let (unit, large, small, (least, most)) = match dof {
            Dof::Torsion => (
                "rad",
                "degrees for radians",
                "radians for degrees",
                AMPLITUDES[1],
            ),
            _ => (
                "m",
                "millimetres for metres",
                "metres for millimetres",
                AMPLITUDES[0],
            ),
        };
        let is_small = size > 0.0 && size < least && stated.contains(&dof);
        if size > most || is_small {
            let units = if is_small { small } else { large };
            let what = format!(
                "{name}: {} motion of {amplitude:.3e} {unit} in amplitude on a model of {width_m} m: {units}?",
                dof.name()
            );
            found.push(Finding::of_run(run, what));
        }
    }
    found
}
