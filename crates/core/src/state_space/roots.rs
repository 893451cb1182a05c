//! Zeros and extrema of functions of one number.

use crate::error::Result;
use std::ops::Range;

/// Relative width of the bracket at which the root search stops: rounding of eigenvalues.
const ROOT_TOLERANCE: f64 = 1e-13;
/// The secant steps converge in about ten; bisection alone in fifty.
const MAX_ROOT_STEPS: usize = 80;
/// Part of an interval that a step of the golden section keeps, `(√5 − 1)/2`.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// A value of a function, and the argument it was taken at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ValueAt<T = f64> {
    /// The argument.
    pub at: f64,
    /// The value.
    pub value: T,
}

impl<T> ValueAt<T> {
    /// The value at an argument.
    pub fn new(at: f64, value: T) -> Self {
        Self { at, value }
    }
}

/// Zero of `f` in a bracket with a sign change, by secant steps kept inside (Illinois) and bisection. Both ends are given
/// with their values.
pub fn root(low: ValueAt, high: ValueAt, f: impl Fn(f64) -> Result<f64>) -> Result<f64> {
    let (mut a, mut fa) = (low.at, low.value);
    let (mut b, mut fb) = (high.at, high.value);
    for step in 0..MAX_ROOT_STEPS {
        if fb == 0.0 || (b - a).abs() <= ROOT_TOLERANCE * b.abs() {
            break;
        }
        let secant = b - fb * (b - a) / (fb - fa);
        let middle = 0.5 * (a + b);
        let inside = (secant - a) * (secant - b) < 0.0;
        let x = if inside && step % 4 != 3 {
            secant
        } else {
            middle
        };
        let fx = f(x)?;
        if (fx >= 0.0) == (fb >= 0.0) {
            (b, fb) = (x, fx);
            fa *= 0.5;
        } else {
            (a, fa) = (x, fx);
            fb *= 0.5;
        }
    }
    Ok(b)
}

/// Zero of a function by secants, from a known value and a number beside it.
///
/// `most` are the longest step and the last one, as parts of the number, and `steps` how many there are. `None` where `f` gives
/// none, and where the steps do not end.
pub fn secant<E>(
    known: ValueAt,
    beside: f64,
    [longest, last]: [f64; 2],
    steps: usize,
    mut f: impl FnMut(f64) -> std::result::Result<Option<f64>, E>,
) -> std::result::Result<Option<f64>, E> {
    let (mut before, mut at) = (known, beside);
    for _ in 0..steps {
        let Some(value) = f(at)? else { return Ok(None) };
        let slope = (value - before.value) / (at - before.at);
        let step = if value == 0.0 { 0.0 } else { -value / slope };
        let most = longest * at.abs();
        let step = if step.abs() > most {
            most.copysign(step)
        } else {
            step
        };
        if step.abs() <= last * at {
            return Ok(Some(at + step));
        }
        if !step.is_finite() {
            break;
        }
        before = ValueAt::new(at, value);
        at += step;
    }
    Ok(None)
}

/// Where a test that holds at one number and fails at another changes, by bisection, no more than `tolerance` of the number
/// wide; for zero between neighbours. Back come the last two numbers at which it was made: where it held, and where it failed.
pub fn boundary<E>(
    mut holds: f64,
    mut fails: f64,
    tolerance: f64,
    mut test: impl FnMut(f64) -> std::result::Result<bool, E>,
) -> std::result::Result<[f64; 2], E> {
    while (holds - fails).abs() > tolerance * holds.abs() {
        let middle = 0.5 * (holds + fails);
        if middle == holds || middle == fails {
            break;
        }
        if test(middle)? {
            holds = middle;
        } else {
            fails = middle;
        }
    }
    Ok([holds, fails])
}

/// Interval about the maximum of a function with one maximum, by the golden section, with the two values inside.
///
/// `at` gives the value at a number, `left_is_higher` compares two, `done` is asked before each step with the width of the
/// interval and the two values.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::state_space::golden_section;
///
/// let parabola = |x: f64| Ok::<f64, aerodeck::Error>(-(x - 2.0) * (x - 2.0));
/// let (interval, _) = golden_section(0.0..5.0, parabola, |a, b| a > b, |width, _, _| width < 1e-6)?;
/// assert!((interval.0 - 2.0).abs() < 1e-6);
/// # Ok::<(), aerodeck::Error>(())
/// ```
pub fn golden_section<T, E>(
    bracket: Range<f64>,
    mut at: impl FnMut(f64) -> std::result::Result<T, E>,
    left_is_higher: impl Fn(&T, &T) -> bool,
    mut done: impl FnMut(f64, &T, &T) -> bool,
) -> std::result::Result<((f64, f64), [T; 2]), E> {
    let Range {
        start: mut low,
        end: mut high,
    } = bracket;
    let mut left = high - GOLDEN * (high - low);
    let mut right = low + GOLDEN * (high - low);
    let (mut at_left, mut at_right) = (at(left)?, at(right)?);
    while !done(high - low, &at_left, &at_right) {
        if left_is_higher(&at_left, &at_right) {
            (high, right, at_right) = (right, left, at_left);
            left = high - GOLDEN * (high - low);
            at_left = at(left)?;
        } else {
            (low, left, at_left) = (left, right, at_right);
            right = low + GOLDEN * (high - low);
            at_right = at(right)?;
        }
    }
    Ok(((low, high), [at_left, at_right]))
}
