//! The motion of one coordinate between and beyond the points of time at which it was given: a cubic.

/// Points that are kept: with displacements alone a cubic needs four.
pub(super) const POINTS: usize = 4;
/// Numbers of a point: displacement, rate, acceleration, and how many of these three are known.
pub(super) const NUMBERS: usize = 4;
/// Coefficients of a course. A quartic gains nothing at twenty points per period and carries three times the noise of the
/// measured motion into the force.
pub(super) const COEFFICIENTS: usize = 4;

/// `c₀ + c₁ t + c₂ t² + c₃ t³`, with the time `t` from some instant on, s.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct MotionCubic([f64; COEFFICIENTS]);

impl MotionCubic {
    /// From what is known at the newest points (newest first, at `times` in s); `t` counts from the newest.
    ///
    /// The highest derivative that is known at the newest point runs through its last values; below it stands what is
    /// known at the newest point. Displacements and rates of one interval together would see the structure under a
    /// force that was held over it, and take the jumps in between for smooth.
    pub(super) fn through(times: &[f64], points: &[f64]) -> Self {
        let known = |p: usize| (points[p * NUMBERS + NUMBERS - 1] as usize).min(NUMBERS - 1);
        let highest = known(0).saturating_sub(1);
        let most = (COEFFICIENTS - highest).min(times.len());
        let count = (0..most).take_while(|p| known(*p) > highest).count();
        let node = |p: usize| times[p] - times[0];
        let mut difference = [0.0; COEFFICIENTS];
        for (p, d) in difference.iter_mut().enumerate().take(count) {
            *d = points[p * NUMBERS + highest];
        }
        for level in 1..count {
            for p in (level..count).rev() {
                difference[p] = (difference[p] - difference[p - 1]) / (node(p) - node(p - level));
            }
        }
        let mut course = [0.0; COEFFICIENTS];
        for k in (0..count).rev() {
            // times (t − node), plus the difference
            for c in (0..COEFFICIENTS).rev() {
                let lower = if c > 0 { course[c - 1] } else { difference[k] };
                course[c] = lower - node(k) * course[c];
            }
        }
        for below in (0..highest).rev() {
            for c in (1..COEFFICIENTS).rev() {
                course[c] = course[c - 1] / c as f64;
            }
            course[0] = points[below];
        }
        Self(course)
    }

    /// With this value, rate and acceleration at `t` = 0, and no more.
    pub(super) fn now([value, rate, acceleration]: [f64; 3]) -> Self {
        Self([value, rate, 0.5 * acceleration, 0.0])
    }

    /// The same with `t` from `by` seconds later on.
    pub(super) fn from(mut self, by: f64) -> Self {
        for first in 0..COEFFICIENTS {
            for c in (first..COEFFICIENTS - 1).rev() {
                self.0[c] += by * self.0[c + 1];
            }
        }
        self
    }

    /// `factor` times the motion.
    pub(super) fn times(self, factor: f64) -> Self {
        Self(self.0.map(|c| factor * c))
    }

    /// Its coefficients.
    pub(super) fn coefficients(&self) -> &[f64; COEFFICIENTS] {
        &self.0
    }

    /// Value, rate, acceleration and its rate at `t` = 0.
    pub(super) fn derivatives(&self) -> [f64; COEFFICIENTS] {
        let [value, rate, half, sixth] = self.0;
        [value, rate, 2.0 * half, 6.0 * sixth]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `2 − 3t + 0.5t² + 4t³` and its derivatives.
    fn cubic(t: f64) -> [f64; 3] {
        [
            2.0 - 3.0 * t + 0.5 * t * t + 4.0 * t.powi(3),
            -3.0 + t + 12.0 * t * t,
            1.0 + 24.0 * t,
        ]
    }

    fn points(times: &[f64], known: &[usize]) -> Vec<f64> {
        let point = |(t, k): (&f64, &usize)| {
            let [value, rate, acceleration] = cubic(*t);
            [value, rate, acceleration, *k as f64]
        };
        times.iter().zip(known).flat_map(point).collect()
    }

    #[test]
    fn a_cubic_is_found_from_whatever_is_known() {
        let times = [1.3, 1.2, 1.05, 0.8];
        for known in [
            [1, 1, 1, 1],
            [2, 2, 2, 1],
            [3, 3, 1, 1],
            [2, 2, 3, 3],
            [1, 2, 1, 3],
        ] {
            let course = MotionCubic::through(&times, &points(&times, &known));
            for t in [-0.5, -0.1, 0.0, 0.2] {
                let found = course.from(t).derivatives();
                for (found, expected) in found.iter().zip(cubic(1.3 + t)) {
                    assert!(
                        (found - expected).abs() < 1e-11,
                        "{known:?}: {found} {expected}"
                    );
                }
                assert!((found[3] - 24.0).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn the_first_points_give_what_they_can() {
        let one = MotionCubic::through(&[0.5], &[3.0, 0.0, 0.0, 1.0]);
        assert_eq!(one.derivatives(), [3.0, 0.0, 0.0, 0.0]);
        let with_rate = MotionCubic::through(&[0.5], &[3.0, 2.0, 0.0, 2.0]);
        assert_eq!(with_rate.derivatives(), [3.0, 2.0, 0.0, 0.0]);
        let two = MotionCubic::through(&[0.5, 0.25], &[3.0, 0.0, 0.0, 1.0, 2.0, 0.0, 0.0, 1.0]);
        assert_eq!(two.derivatives(), [3.0, 4.0, 0.0, 0.0]);
    }
}
