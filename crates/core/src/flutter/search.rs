//! Onset by the eigenvalues of the coupled state matrix.

use super::answer::{Findings, FlutterSearch, choose};
use super::following::{Follower, OnsetWatch, growing, oscillates};
use super::judged::{Exit, MovedOnset, StableRange, TestedFrom, damps_fast_motion};
use super::scan::Scan;
use super::still_air::lowest_speed;
use super::tracking::Tracker;
use crate::aerodynamics::Realization;
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result, ensure, positive};
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use nalgebra::Complex;
use serde::{Deserialize, Serialize};

/// States at most of which all eigenvalues are looked at, a hundred times or more: those of some 700 take a second each.
const SCANNED_STATES: usize = 700;

/// More wind speeds than any search needs.
const MOST_SPEEDS: usize = 10_000;

/// Where and how densely to look.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::flutter::OnsetSearch;
///
/// let search = OnsetSearch { speed_max_m_s: 60.0, speeds: 3 };
/// assert_eq!(search.speeds_m_s()?, [20.0, 40.0, 60.0]);
/// assert!(OnsetSearch { speeds: 1, ..search }.speeds_m_s().is_err());
/// assert!(OnsetSearch { speeds: usize::MAX, ..search }.speeds_m_s().is_err());
/// # Ok::<(), aerodeck::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OnsetSearch {
    /// Highest wind speed searched, m/s.
    pub speed_max_m_s: f64,
    /// Number of speeds between still air and the highest.
    pub speeds: usize,
}

impl Default for OnsetSearch {
    fn default() -> Self {
        Self::new(100.0, 200)
    }
}

impl OnsetSearch {
    /// Up to a wind speed, m/s, in so many steps.
    pub fn new(speed_max_m_s: f64, speeds: usize) -> Self {
        Self {
            speed_max_m_s,
            speeds,
        }
    }

    /// The same in the usual number of steps.
    pub fn up_to(speed_max_m_s: f64) -> Self {
        Self::new(speed_max_m_s, Self::default().speeds)
    }

    /// The wind speeds that are looked at, m/s: equally spaced, still air left out.
    ///
    /// # Errors
    /// [`Error::Input`] for a highest speed that is not positive, fewer than two speeds or more than ten thousand.
    pub fn speeds_m_s(&self) -> Result<Vec<f64>> {
        let highest = positive("flutter.speed_max_m_s", self.speed_max_m_s)?;
        let speeds = self.speeds;
        let expected = format_args!("a number from 2 to {MOST_SPEEDS}");
        let counted = (2..=MOST_SPEEDS).contains(&speeds);
        ensure(counted, "flutter.speeds", expected, speeds)?;
        let speed = |i: usize| highest * i as f64 / self.speeds as f64;
        Ok((1..=self.speeds).map(speed).collect())
    }
}

/// Wind speeds of curves, m/s: `count` of them from the lowest to the highest, equally spaced.
pub fn curve_speeds_m_s(lowest_m_s: f64, highest_m_s: f64, count: usize) -> Vec<f64> {
    let last = count.saturating_sub(1) as f64;
    let span = highest_m_s - lowest_m_s;
    let speed = |i: usize| lowest_m_s + span * i as f64 / last;
    (0..count).map(speed).collect()
}

/// First wind speed at which a mode of `section` loses its damping.
///
/// Modes are followed from nearly still air and every crossing up to the highest speed is refined; beside that all
/// eigenvalues are looked at ([`growth_scan`](super::growth_scan)), so that growth of what is not followed, between the
/// speeds, or of modes that cannot be told apart, is found too. See [`FlutterSearch`] for which one is the answer.
/// `tested` is the range of reduced frequencies in which the model was tested: a mode that grows already where it
/// enters it is unstable at and below that speed, whatever the model says outside.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::RationalModel;
/// use aerodeck::aeroelastic::CoupledSection;
/// use aerodeck::flutter::{OnsetSearch, determinant_onset, find_onset};
/// use aerodeck::section::SectionModel;
/// use aerodeck::units::{ReducedFrequency, ReducedFrequencyRange};
///
/// let structure = SectionModel::iabse_1_1a().structure()?;
/// let plate = RationalModel::jones_flat_plate();
/// let section = CoupledSection::with_model(&structure, &plate)?;
/// let found = find_onset("plate", &section, &OnsetSearch::default(), None)?;
/// // the determinant has the same root
/// let k = ReducedFrequency::from_full_width;
/// let range = ReducedFrequencyRange::between(k(0.02), k(10.0));
/// let other = determinant_onset("plate", &structure, &plate, range, 100.0)?;
/// let [a, b] = [found, other].map(|f| f.critical_speed_m_s().expect("flutter"));
/// assert!((a / b - 1.0).abs() < 1e-9);
/// # Ok::<(), aerodeck::Error>(())
/// ```
///
/// # Errors
/// [`Error::Input`] for a search range that is none; [`Error::Numerical`] when eigenvalues cannot be computed.
pub fn find_onset(
    model: &str,
    section: &CoupledSection,
    search: &OnsetSearch,
    tested: Option<ReducedFrequencyRange>,
) -> Result<FlutterSearch> {
    let scan = Scan::new(model, section, tested);
    let (mut found, ended) = scan.followed(search, |_| false)?;
    let lost = ended.is_some();
    if let Some(why) = ended {
        // without names the answer still stands
        found.warnings.push(format!(
            "{why}: modes beyond that were not followed but found among all eigenvalues"
        ));
    }
    if section.states() <= SCANNED_STATES {
        scan.add_missed(&mut found, search.speed_max_m_s)?;
    } else {
        found.warnings.push(format!(
            "{} states are too many to look at all eigenvalues: the {} structural modes alone were followed",
            section.states(),
            section.structure().dofs.len()
        ));
    }
    if found.is_empty() {
        scan.bound(&mut found, lost, &search.speeds_m_s()?)?;
    }
    Ok(choose(found, tested))
}

impl MovedOnset {
    /// Of constraints that left the onset `with`; `alone` is the section in the forces of the data alone, at reduced frequencies
    /// `tested`. An account only: what cannot be searched has none.
    pub fn new(
        alone: Option<&CoupledSection>,
        with: &FlutterSearch,
        search: &OnsetSearch,
        tested: ReducedFrequencyRange,
    ) -> Self {
        let without = alone.and_then(|s| find_onset("data alone", s, search, Some(tested)).ok());
        let speed = |found: &FlutterSearch| found.onset().map(|o| o.at.speed_m_s);
        Self {
            without_m_s: without.as_ref().and_then(speed),
            with_m_s: speed(with),
        }
    }
}

/// Part of a speed by which it may lie below that of the end of the tests which it was followed to.
const AT_THE_END: f64 = 1e-6;

/// The speeds at which every mode of `section` is inside what was tested, or above it where the forces damp every such motion, as
/// [`find_onset`] judges them, whether anything grows or not; and from where on every mode is among the tests or below, `None`
/// where all are from the beginning.
///
/// # Errors
/// As [`find_onset`].
pub fn judged_speeds(
    section: &CoupledSection,
    search: &OnsetSearch,
    tested: Option<ReducedFrequencyRange>,
) -> Result<(StableRange, Option<TestedFrom>)> {
    let scan = Scan::new("", section, tested);
    let (mut found, ended) = scan.followed(search, |_| false)?;
    scan.bound(&mut found, ended.is_some(), &search.speeds_m_s()?)?;
    let reach = found.reach;
    Ok((reach.judged(found.looked_at), reach.tested_from(tested)))
}

/// Which mode of `section` leaves what was `tested` first below the highest speed of a search, its onset, and where, in words; `None` where
/// none does. Of an onset below the lowest speed at which a sampled model can be judged this is said.
///
/// # Errors
/// As [`find_onset`].
pub fn left_tests(
    section: &CoupledSection,
    search: &OnsetSearch,
    tested: ReducedFrequencyRange,
) -> Result<Option<String>> {
    if let Realization::Discrete(_) = section.aerodynamics()
        && let lowest = lowest_speed(section)?
        && search.speed_max_m_s <= lowest
    {
        return Ok(Some(format!(
            "the onset lies at or below {lowest:.3} m/s, the lowest wind speed at which the sampled model knows its forces"
        )));
    }
    let scan = Scan::new("", section, Some(tested));
    let (mut found, ended) = scan.followed(search, |found| !found.reach.exits.is_empty())?;
    if ended.is_some() {
        scan.bound(&mut found, true, &search.speeds_m_s()?)?;
    }
    // an onset at the very end of the tests has not left them
    Ok(found.reach.end(search.speed_max_m_s * (1.0 - AT_THE_END)))
}

/// The critical speed alone, m/s, by the modes that are followed, without all eigenvalues: for one of many sections of which another
/// was searched whole. Where modes cannot be told apart all eigenvalues are looked at after all.
///
/// # Errors
/// As [`find_onset`].
pub fn find_onset_of_modes(
    model: &str,
    section: &CoupledSection,
    search: &OnsetSearch,
    tested: Option<ReducedFrequencyRange>,
) -> Result<Option<f64>> {
    let scan = Scan::new(model, section, tested);
    // what is found above an onset inside the tested range does not matter
    let inside = |found: &Findings| {
        let mut crossings = found.crossings.iter();
        crossings.any(|o| tested.is_none_or(|range| range.spans(o.at.reduced_frequency)))
    };
    let search = match scan.followed(search, inside)? {
        (found, None) => choose(found, tested),
        (_, Some(_)) => find_onset(model, section, search, tested)?,
    };
    Ok(search.critical_speed_m_s())
}

impl Scan<'_> {
    /// What the structural modes do, up to where it is `enough`, and why they could not be followed to the end, if so.
    fn followed(
        &self,
        search: &OnsetSearch,
        enough: impl Fn(&Findings) -> bool,
    ) -> Result<(Findings, Option<String>)> {
        let speeds = search.speeds_m_s()?;
        let mut found = Findings::between(self.looked_at(search.speed_max_m_s)?);
        let ended = match self.follow(&speeds, &mut found, enough) {
            Err(Error::NotDistinct(why) | Error::Numerical(why)) => Some(why),
            other => other.map(|()| None)?,
        };
        Ok((found, ended))
    }

    /// What the structural modes do between the lowest and the highest speed of a scan, up to where it is `enough`.
    fn follow(
        &self,
        speeds: &[f64],
        found: &mut Findings,
        enough: impl Fn(&Findings) -> bool,
    ) -> Result<()> {
        let tracker = Tracker::new(self.section);
        let watch = OnsetWatch {
            model: self.model,
            follower: &tracker,
            tested: self.tested,
            judged: self.tested,
        };
        let highest = speeds[speeds.len() - 1];
        let lowest = self.lowest(highest)?;
        let mut modes = tracker.at(lowest)?;
        for mode in modes.all.iter().filter(|m| growing(&m.lambda)) {
            let reason = "the lowest speed looked at".to_owned();
            found.starts.push(watch.start(lowest, mode, reason));
        }
        found.followed_to_m_s = lowest;
        for &speed in speeds.iter().filter(|v| **v > lowest) {
            let next = tracker.advance(&modes, speed)?;
            watch.step(&modes, &next, found)?;
            modes = next;
            found.followed_to_m_s = speed;
            if enough(found) {
                return Ok(());
            }
        }
        if let Some(range) = self.tested {
            let above = modes.all.iter().map(|mode| {
                let part = tracker.k(highest, mode).full_width() / range.max.full_width();
                (part, tracker.name(mode.branch))
            });
            // beyond the search a mode comes among the tests about where its last frequency does
            let never = above.filter(|(part, _)| *part > 1.0);
            let entries = never.map(|(part, name)| (part * highest, name));
            found.reach.entries.extend(entries);
        }
        Ok(())
    }

    /// Completes what is known of the speeds that can be judged: beyond where modes were `lost` by all eigenvalues, each of
    /// which has to lie inside the tested range or above it; in slow wind by what the forces do to fast motion.
    fn bound(&self, found: &mut Findings, lost: bool, speeds: &[f64]) -> Result<()> {
        let Some(range) = self.tested else {
            return Ok(());
        };
        let s = self.section.structure();
        // of a whole bridge the forces of each strip would have to be asked
        let damps = s.is_modal() || {
            let forces = self.section.aerodynamics();
            damps_fast_motion(&s.dofs, range.max, |k| forces.transfer(k))?
        };
        found.reach.damped_before = damps;
        let reached = found.followed_to_m_s;
        for &speed in speeds.iter().filter(|v| lost && **v > reached) {
            let mut all = self.section.at(speed)?.eigenvalues()?;
            all.retain(oscillates);
            let is_known = |z: &Complex<f64>| {
                let k = ReducedFrequency::from_circular(z.im, s.width_m, speed);
                range.contains(k) || k > range.max
            };
            let known: Vec<bool> = all.iter().map(is_known).collect();
            if known.len() < s.dofs.len() || known.contains(&false) {
                let nameless = "slowest".to_owned();
                found.reach.exits.push((speed, nameless, Exit::Lost));
                break;
            }
        }
        Ok(())
    }
}
