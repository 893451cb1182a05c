//! V-g and V-f curves and the onset of any `G(K)` by the p-k iteration.
//!
//! At every wind speed each mode is iterated until the forces are taken at its own frequency; from one speed to the next
//! it starts from the mode before. A table is asked only inside its range: each mode comes in at the speed that belongs
//! to the highest `K` and leaves at that of the lowest. Needs no realisation, so it draws measured tables and Theodorsen's function. Exact at an onset; between onsets its damping
//! means what measured derivatives mean.

use super::answer::{Findings, FlutterSearch, choose};
use super::curves::{FlutterCurves, ModePoint, empty_branches};
use super::determinant::StructureInWind;
use super::following::{Follower, OnsetWatch, dimensionless, growing};
use super::judged::{StableRange, damps_fast_motion, entry_reason};
use super::mode_words::the_mode;
use super::search::OnsetSearch;
use crate::aerodynamics::Transfer;
use crate::error::{Error, Result, ensure, positive};
use crate::section::Structure;
use crate::units::ReducedFrequencyRange;
use nalgebra::Complex;

/// Speeds from still air to that of a single mode.
const STEPS_TO_MODE: usize = 100;

/// Frequencies, damping ratios and shapes over the increasing `speeds_m_s` by the p-k iteration. A branch ends where
/// its mode stops oscillating, and has points only where the model knows the forces
/// ([`Transfer::known_range`]).
///
/// # Errors
/// [`Error::Input`] for speeds that do not increase from above zero.
pub fn pk_curves(
    name: &str,
    structure: &Structure,
    model: &dyn Transfer,
    speeds_m_s: &[f64],
) -> Result<FlutterCurves> {
    let mut last = 0.0;
    for &speed in speeds_m_s {
        let grows = positive("wind speeds", speed)? > last;
        let found = format_args!("{speed} after {last}");
        ensure(grows, "wind speeds", "increasing numbers above zero", found)?;
        last = speed;
    }
    let iteration = StructureInWind::new(structure, model)?;
    let mut branches = empty_branches(structure, speeds_m_s.len());
    iteration.march(speeds_m_s, &mut |_, at| {
        let asked = speeds_m_s.binary_search_by(|v| v.total_cmp(&at.speed));
        for mode in at.all.iter().filter(|_| asked.is_ok()) {
            let size = dimensionless(structure, &mode.shape).norm();
            let point = ModePoint::new(at.speed, mode, size);
            branches[mode.branch].points.push(point);
        }
        Ok(())
    })?;
    Ok(FlutterCurves {
        model: name.to_owned(),
        branches,
        ended: None,
    })
}

/// Eigenvalue (rad/s) at one wind speed of the branch that moves the degree of freedom `dof` (its index) in still air,
/// followed over the wind speed from there; of a table from where that begins.
///
/// # Errors
/// [`Error::Input`] for a speed that is not positive or a `dof` that there is not; [`Error::Numerical`] when the branch
/// has ended before that speed or is outside the range of a table.
pub fn quasi_pk_mode(
    structure: &Structure,
    model: &dyn Transfer,
    speed_m_s: f64,
    dof: usize,
) -> Result<Complex<f64>> {
    positive("wind speed", speed_m_s)?;
    let n = structure.dofs.len();
    let expected = format_args!("an index below {n}");
    ensure(dof < n, "degree of freedom", expected, dof)?;
    let speeds: Vec<f64> = (1..=STEPS_TO_MODE)
        .map(|i| speed_m_s * i as f64 / STEPS_TO_MODE as f64)
        .collect();
    let (mut found, mut last) = (None, None);
    let iteration = StructureInWind::new(structure, model)?;
    iteration.march(&speeds, &mut |_, at| {
        let lambda = at.mode(dof).map(|m| m.lambda);
        found = lambda.filter(|_| at.speed == speed_m_s);
        last = lambda.map(|_| at.speed).or(last);
        Ok(())
    })?;
    found.ok_or_else(|| {
        let mode = the_mode(&iteration.name(dof));
        Error::Numerical(match last {
            Some(speed) => {
                format!("p-k: {mode} ends above {speed:.3} m/s, before {speed_m_s} m/s")
            }
            None => format!("p-k: {mode} cannot be judged up to {speed_m_s} m/s"),
        })
    })
}

/// First wind speed at which a mode of the p-k iteration loses its damping; `tested` as in
/// [`find_onset`](super::find_onset).
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::FlatPlate;
/// use aerodeck::flutter::{OnsetSearch, pk_onset};
/// use aerodeck::section::SectionModel;
///
/// let structure = SectionModel::iabse_1_1a().structure()?;
/// let plate = FlatPlate { rotary_inertia: false };
/// let found = pk_onset("plate", &structure, &plate, &OnsetSearch::default(), None)?;
/// assert!((found.onset().expect("flutter").at.speed_m_s - 77.48).abs() < 0.01);
/// # Ok::<(), aerodeck::Error>(())
/// ```
///
/// # Errors
/// [`Error::Input`] for a search range that is none.
pub fn pk_onset(
    name: &str,
    structure: &Structure,
    model: &dyn Transfer,
    search: &OnsetSearch,
    tested: Option<ReducedFrequencyRange>,
) -> Result<FlutterSearch> {
    let iteration = StructureInWind::new(structure, model)?;
    let known = model.known_range();
    let watch = OnsetWatch {
        model: name,
        follower: &iteration,
        // into the range of a table modes come where they are known first
        tested: tested.filter(|_| known.is_none()),
        judged: tested.or(known),
    };
    let mut found = Findings::between(StableRange::up_to(search.speed_max_m_s));
    let (entries, reach) = iteration.march(&search.speeds_m_s()?, &mut |low, high| {
        watch.step(low, high, &mut found)
    })?;
    match tested.filter(|_| known.is_none()) {
        Some(range) => {
            let damps = damps_fast_motion(&structure.dofs, range.max, |k| model.transfer(k))?;
            found.reach.damped_before = damps;
        }
        None => found.reach.entries = reach.entries,
    }
    found.reach.exits.extend(reach.exits);
    // a mode that is known only beyond the search answers nothing that was asked
    let searched = entries
        .iter()
        .filter(|(speed, mode)| *speed <= search.speed_max_m_s && growing(&mode.lambda));
    for (speed, mode) in searched {
        let reason = known.map_or("the lowest speed looked at".to_owned(), |range| {
            entry_reason(range.max)
        });
        let mut start = watch.start(*speed, mode, reason);
        if known.is_some() {
            start.in_tested_range = tested.map(|_| true);
        }
        found.starts.push(start);
    }
    Ok(choose(found, tested))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aerodynamics::FlatPlate;
    use crate::flutter::{determinant_onset, divergence_with_forces};
    use crate::section::{Dof, SectionModel};
    use crate::units::ReducedFrequency;

    #[test]
    fn forces_of_other_motions_are_refused() {
        let structure = SectionModel::iabse_1_1a().structure().unwrap();
        let heave = structure.only(&[Dof::Vertical]);
        let (plate, search) = (FlatPlate::default(), OnsetSearch::default());
        let [low, high] = [0.02, 10.0].map(ReducedFrequency::from_full_width);
        let range = ReducedFrequencyRange::between(low, high);
        for found in [
            pk_onset("", &heave, &plate, &search, None),
            determinant_onset("", &heave, &plate, range, 100.0),
        ] {
            let message = found.unwrap_err().to_string();
            let expected = "forces: expected those of vertical motion, found vertical, torsion";
            assert_eq!(message, expected);
        }
        let message = divergence_with_forces(&heave, &plate)
            .unwrap_err()
            .to_string();
        let expected = "forces: expected 1 by 1, of vertical motion, found 2 by 2";
        assert_eq!(message, expected);
    }
}
