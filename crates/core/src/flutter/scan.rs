//! All eigenvalues over wind speed: the speeds at which any oscillation grows, found without following modes; of a bridge with as
//! many states as take long, by the modes and a count of all others (`present_modes`) wherever none of them grows.

use super::critical::critical_speeds;
use super::following::{Mode, dimensionless, growing, oscillates};
use super::growth_band::GrowthBand;
use super::judged::StableRange;
use super::present_modes::PresentModes;
use super::still_air::lowest_speed;
use super::tracking::{Tracker, mode_shape};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result, ensure, positive};
use crate::state_space::{boundary, golden_section};
use crate::threads;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Lowest speed of a scan from still air, as `V/(fB)` of the slowest mode: wind that no test and no site knows.
const NEARLY_STILL: f64 = 0.01;
/// Neighbouring speeds differ by at most this ratio, and at most this part of the highest speed.
const FINE: (f64, f64) = (1.05, 1.0 / 120.0);
/// The same where the structural modes are followed besides.
const COARSE: (f64, f64) = (1.12, 1.0 / 50.0);
/// Branch of an eigenvalue that belongs to no structural mode.
pub(super) const AERODYNAMIC: &str = "aerodynamic";
/// Relative width to which the ends of a band are halved.
const EDGE_TOLERANCE: f64 = 1e-11;
/// Relative distance from a critical speed, known to rounding, at which both sides of it are looked at.
const BESIDE: f64 = 1e-7;
/// States up to which one thread is faster than sharing the speeds among several.
const ALONE: usize = 40;
/// Steps of the golden section between three speeds of the grid: a peak to 1e-5 of their distance.
const PEAK_STEPS: usize = 24;

/// Bands of wind speed from nearly still air up to a speed in which an oscillation grows, in rising order.
///
/// Sections find all speeds at which growth may begin or end at once (`critical`), so that no growth
/// between two speeds is a statement about every one between; what is sampled or large looks at every eigenvalue at speeds a
/// twentieth apart or closer, and at peaks between them; of a bridge it is counted that none but the modes comes near growth. `tested` as in [`find_onset`](super::find_onset).
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::RationalModel;
/// use aerodeck::aeroelastic::CoupledSection;
/// use aerodeck::flutter::{growth_scan};
/// use aerodeck::section::SectionModel;
///
/// let structure = SectionModel::iabse_1_1a().structure()?;
/// let section = CoupledSection::with_model(&structure, &RationalModel::jones_flat_plate())?;
/// assert!(growth_scan(&section, 60.0, None)?.is_empty());
/// let bands = growth_scan(&section, 100.0, None)?;
/// assert!(!bands[0].from_start && bands[0].to_m_s == 100.0);
/// # Ok::<(), aerodeck::Error>(())
/// ```
///
/// # Errors
/// [`Error::Input`] for a speed that is none; [`Error::Numerical`] when eigenvalues cannot be computed.
pub fn growth_scan(
    section: &CoupledSection,
    to_m_s: f64,
    tested: Option<ReducedFrequencyRange>,
) -> Result<Vec<GrowthBand>> {
    Scan::new("", section, tested).bands(to_m_s, false, f64::INFINITY)
}

/// The fastest growing oscillations at one speed.
#[derive(Debug, Clone, Copy)]
pub(super) struct ScanPoint {
    pub(super) speed: f64,
    /// The least damped oscillating eigenvalue, rad/s.
    pub(super) fastest: Option<Complex<f64>>,
    /// The fastest growing oscillation inside the tested range.
    pub(super) inside: Option<Complex<f64>>,
    /// Number of eigenvalues with a positive real part, oscillating or not.
    unstable: usize,
}

impl ScanPoint {
    fn grows(&self) -> bool {
        self.fastest.is_some_and(|z| growing(&z))
    }

    fn rate(&self) -> f64 {
        self.fastest.map_or(f64::NEG_INFINITY, |z| z.re)
    }
}

/// A section whose eigenvalues are looked at.
pub(super) struct Scan<'a> {
    pub(super) model: &'a str,
    pub(super) section: &'a CoupledSection,
    pub(super) tested: Option<ReducedFrequencyRange>,
}

impl<'a> Scan<'a> {
    pub(super) fn new(
        model: &'a str,
        section: &'a CoupledSection,
        tested: Option<ReducedFrequencyRange>,
    ) -> Self {
        Self {
            model,
            section,
            tested,
        }
    }

    /// Lowest speed of a scan from still air, m/s.
    pub(super) fn lowest(&self, to_m_s: f64) -> Result<f64> {
        let s = self.section.structure();
        let hertz = s.still_air_rad_s().map(|omega| omega / TAU);
        let slowest_hz = hertz.filter(|f| *f > 0.0).fold(f64::INFINITY, f64::min);
        let nearly_still = (NEARLY_STILL * slowest_hz * s.width_m).min(1e-3 * to_m_s);
        Ok(nearly_still.max(lowest_speed(self.section)?))
    }

    /// What a scan from still air covers.
    pub(super) fn looked_at(&self, to_m_s: f64) -> Result<StableRange> {
        let lowest = lowest_speed(self.section)?;
        let expected = format_args!(
            "more than {lowest:.3} m/s, below which the sampled model has too few samples per period"
        );
        let found = format_args!("{to_m_s} m/s");
        ensure(lowest < to_m_s, "highest wind speed", expected, found)?;
        Ok(StableRange {
            from_m_s: lowest,
            to_m_s,
            not_judged: (lowest > 0.0).then(|| {
                format!("below {lowest:.3} m/s the sampled model has too few samples per period")
            }),
        })
    }

    /// Speeds of a scan, m/s.
    fn speeds(&self, to_m_s: f64, coarse: bool) -> Result<Vec<f64>> {
        positive("highest wind speed", to_m_s)?;
        let (ratio, part) = if coarse { COARSE } else { FINE };
        let mut all = Vec::new();
        let mut speed = self.lowest(to_m_s)?;
        while speed < to_m_s {
            all.push(speed);
            speed = (ratio * speed).min(speed + to_m_s * part);
        }
        all.push(to_m_s);
        Ok(all)
    }

    /// Every band of growth up to a speed that begins below another; `coarse` where the structural modes are followed
    /// besides.
    pub(super) fn bands(
        &self,
        to_m_s: f64,
        coarse: bool,
        below_m_s: f64,
    ) -> Result<Vec<GrowthBand>> {
        let grid = self.speeds(to_m_s, coarse)?;
        let points = match critical_speeds(self.section) {
            Some(critical) => self.between(&critical, &grid)?,
            None => {
                let mut points = self.by_modes(&grid)?;
                self.add_peaks(&mut points)?;
                points
            }
        };
        let mut bands = Vec::new();
        let mut i = 0;
        while i < points.len() {
            let count = points[i..].iter().take_while(|p| p.grows()).count();
            if count > 0 && self.begins_below(below_m_s, &points[..=i])? {
                bands.push(self.band(&points, i, i + count)?);
            }
            i += count.max(1);
        }
        bands.retain(|band| band.from_m_s < below_m_s);
        Ok(bands)
    }

    /// Whether a band may begin below a speed whose first point is the last of `points`: its end need not be found if not.
    fn begins_below(&self, speed: f64, points: &[ScanPoint]) -> Result<bool> {
        Ok(match points {
            [.., first] if first.speed < speed => true,
            [.., before, _] if before.speed < speed => self.at(speed)?.grows(),
            _ => false,
        })
    }

    /// Whether the motion with this eigenvalue lies between the lowest and the highest tested `K`; `None` when there are none.
    pub(super) fn inside(&self, speed: f64, lambda: Complex<f64>) -> Option<bool> {
        let width = self.section.structure().width_m;
        let k = ReducedFrequency::from_circular(lambda.im, width, speed);
        self.tested.map(|range| range.spans(k))
    }

    pub(super) fn at(&self, speed: f64) -> Result<ScanPoint> {
        let mut all = self.section.at(speed)?.eigenvalues()?;
        let unstable = all.iter().filter(|z| z.re > 0.0).count();
        all.retain(oscillates);
        all.sort_by(|a, b| b.re.total_cmp(&a.re));
        let inside = |z: &&Complex<f64>| growing(z) && self.inside(speed, **z) != Some(false);
        Ok(ScanPoint {
            speed,
            fastest: all.first().copied(),
            inside: all.iter().find(inside).copied(),
            unstable,
        })
    }

    /// What is found for each of many, on all cores where the section has so many states that it pays.
    fn shared<T: Sync, U: Send>(
        &self,
        of: &[T],
        find: impl Fn(&T) -> Result<U> + Sync,
    ) -> Result<Vec<U>> {
        let found = threads::each(of, self.section.states() > ALONE, find);
        found.into_iter().collect()
    }

    fn all_at(&self, speeds: &[f64]) -> Result<Vec<ScanPoint>> {
        self.shared(speeds, |v| self.at(*v))
    }

    /// The same at rising speeds, by the modes alone where these decay and everything else decays faster.
    fn by_modes(&self, speeds: &[f64]) -> Result<Vec<ScanPoint>> {
        let mut modes = PresentModes::of_many(self.section);
        let mut follow = |speed: &f64| modes.as_mut()?.follow(self.section, *speed);
        // up to where a mode is lost
        let followed: Vec<_> = speeds.iter().map_while(&mut follow).collect();
        let places: Vec<usize> = (0..speeds.len()).collect();
        self.shared(&places, |place| {
            let (speed, all) = (speeds[*place], followed.get(*place));
            let known = modes.as_ref().zip(all);
            match known.and_then(|(modes, all)| modes.slowest_decay(all, speed)) {
                None => self.at(speed),
                decaying => Ok(ScanPoint {
                    speed,
                    fastest: decaying,
                    inside: None,
                    unstable: 0,
                }),
            }
        })
    }

    /// Points on both sides of all critical speeds and half way between them. Where no two eigenvalues have a positive real
    /// part there, none have up to the next, and no oscillation grows. Where two have, the speeds of the grid are added: for the
    /// fastest growth and the tested range, and since two that are real may meet and oscillate.
    fn between(&self, critical: &[f64], grid: &[f64]) -> Result<Vec<ScanPoint>> {
        let (low, high) = (grid[0], grid[grid.len() - 1]);
        let inside = critical.iter().filter(|v| (low..high).contains(*v));
        let sides = inside.flat_map(|v| [v * (1.0 - BESIDE), *v, v * (1.0 + BESIDE)]);
        let mut ends: Vec<f64> = sides.filter(|v| (low..high).contains(v)).collect();
        ends.extend([low, high]);
        ends.sort_by(f64::total_cmp);
        let middles: Vec<f64> = ends.windows(2).map(|w| (w[0] * w[1]).sqrt()).collect();
        ends.extend(middles);
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        let mut points = self.all_at(&ends)?;
        let two = |w: &[ScanPoint]| w[0].unstable > 1 || w[1].unstable > 1;
        let within = |w: &[ScanPoint], v: f64| w[0].speed < v && v < w[1].speed;
        let more = |v: &&f64| points.windows(2).any(|w| two(w) && within(w, **v));
        let more: Vec<f64> = grid.iter().filter(more).copied().collect();
        points.extend(self.all_at(&more)?);
        points.sort_by(|a, b| a.speed.total_cmp(&b.speed));
        if points.iter().any(|p| p.unstable > 1 && !p.grows()) {
            self.add_peaks(&mut points)?;
        }
        Ok(points)
    }

    /// Adds growth that is met only between the speeds looked at.
    fn add_peaks(&self, points: &mut Vec<ScanPoint>) -> Result<()> {
        let is_peak = |three: &&[ScanPoint]| {
            let rate = |i: usize| three[i].rate();
            // one that stands no higher over its neighbours than below growth does not reach it
            let reaches = 2.0 * rate(1) >= rate(0).min(rate(2));
            reaches && !three[1].grows() && rate(1) >= rate(0) && rate(1) >= rate(2)
        };
        let around: Vec<&[ScanPoint]> = points.windows(3).filter(is_peak).collect();
        let highest = |three: &&[ScanPoint]| self.peak(three[0].speed, three[2].speed);
        let peaks = self.shared(&around, highest)?;
        points.extend(peaks.into_iter().flatten());
        points.sort_by(|a, b| a.speed.total_cmp(&b.speed));
        Ok(())
    }

    /// The highest point between two speeds, if it grows.
    fn peak(&self, low: f64, high: f64) -> Result<Option<ScanPoint>> {
        let mut steps = 0;
        let done = |_, left: &ScanPoint, right: &ScanPoint| {
            steps += 1;
            left.grows() || right.grows() || steps > PEAK_STEPS
        };
        let higher = |a: &ScanPoint, b: &ScanPoint| a.rate() > b.rate();
        let (_, [left, right]) = golden_section(low..high, |v| self.at(v), higher, done)?;
        let highest = if higher(&left, &right) { left } else { right };
        Ok(highest.grows().then_some(highest))
    }

    /// The band of the points `from..to`, its ends refined.
    fn band(&self, points: &[ScanPoint], from: usize, to: usize) -> Result<GrowthBand> {
        let within = &points[from..to];
        let end = |last: &ScanPoint, beyond: Option<&ScanPoint>| match beyond {
            Some(beyond) => self.edge(last.speed, beyond.speed, ScanPoint::grows),
            None => Ok(last.speed),
        };
        let before = from.checked_sub(1).map(|before| &points[before]);
        let from_m_s = end(&points[from], before)?;
        let to_m_s = end(&points[to - 1], points.get(to))?;
        let fastest = within.iter().max_by(|a, b| a.rate().total_cmp(&b.rate()));
        let fastest = fastest.unwrap_or(&points[from]);
        let lambda = fastest.fastest.unwrap_or_default();
        let width = self.section.structure().width_m;
        Ok(GrowthBand {
            from_m_s,
            to_m_s,
            from_start: from == 0,
            fastest_growth_per_s: lambda.re,
            fastest_at_m_s: fastest.speed,
            frequency_hz: lambda.im / TAU,
            reduced_frequency: ReducedFrequency::from_circular(lambda.im, width, fastest.speed),
            tested_from_m_s: self.tested_from(from_m_s, within)?,
            branch: self.branch(fastest.speed, lambda),
        })
    }

    fn tested_from(&self, from_m_s: f64, within: &[ScanPoint]) -> Result<Option<f64>> {
        let is_inside = |p: &ScanPoint| p.inside.is_some();
        let Some(first) = within.iter().position(is_inside) else {
            return Ok(None);
        };
        let before = first.checked_sub(1).map_or(from_m_s, |i| within[i].speed);
        self.edge(within[first].speed, before, is_inside).map(Some)
    }

    /// The last speed from `yes` towards `no` at which the test still holds.
    fn edge(&self, yes: f64, no: f64, test: impl Fn(&ScanPoint) -> bool) -> Result<f64> {
        let found = boundary(yes, no, EDGE_TOLERANCE, |v| {
            Ok::<_, Error>(test(&self.at(v)?))
        })?;
        Ok(found[0])
    }

    /// The structural mode that `lambda` belongs to, followed from still air; where modes cannot be followed, the degree
    /// of freedom that moves most.
    pub(super) fn branch(&self, speed: f64, lambda: Complex<f64>) -> String {
        let structure = self.section.structure();
        let row = match Tracker::new(self.section).at(speed) {
            Ok(tracked) => {
                let is_it = |m: &&Mode| (m.lambda - lambda).norm() < 1e-6 * lambda.norm();
                tracked.all.iter().find(is_it).map(|m| m.branch)
            }
            Err(_) => {
                let system = self.section.at(speed);
                let shape = system.and_then(|system| mode_shape(self.section, &system, lambda));
                let sizes = shape.map(|s| dimensionless(structure, &s).map(|z| z.norm()));
                sizes.ok().map(|sizes| sizes.imax())
            }
        };
        row.map_or(AERODYNAMIC.to_owned(), |row| structure.branch_name(row))
    }
}
