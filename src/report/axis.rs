//! Range, ticks and tick labels of one axis.

/// What an axis shows and how.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Axis {
    /// Name, symbol and unit.
    pub(super) label: String,
    /// Fixed ends instead of those of the data.
    pub(super) range: Option<(f64, f64)>,
    /// Shows of the data what lies in this window; all of it when nothing does.
    pub(super) within: Option<(f64, f64)>,
    /// Ends exactly at the data.
    pub(super) tight: bool,
    /// Starts at zero when nothing is negative.
    pub(super) zero_based: bool,
    /// Logarithmic, when all values are positive; for values over more than a decade.
    pub(super) logarithmic: bool,
}

impl Axis {
    pub(super) fn new(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            ..Self::default()
        }
    }
    pub(super) fn tight(mut self) -> Self {
        self.tight = true;
        self
    }
    pub(super) fn zero_based(mut self) -> Self {
        self.zero_based = true;
        self
    }
    pub(super) fn logarithmic(mut self) -> Self {
        self.logarithmic = true;
        self
    }

    /// The scale for finite `values` with about `ticks` ticks.
    pub(super) fn scale(&self, values: impl IntoIterator<Item = f64>, ticks: usize) -> Scale {
        let (low, high) = self.range.unwrap_or_else(|| ends(values));
        if self.logarithmic && low > 0.0 {
            return Scale::logarithmic(low, high, ticks);
        }
        let window = self.within.unwrap_or((f64::MIN, f64::MAX));
        let (inner_low, inner_high) = (low.max(window.0), high.min(window.1));
        let (mut low, mut high) = match inner_high - inner_low > 1e-9 * low.abs().max(high.abs()) {
            true => (inner_low, inner_high),
            false => widened(low, high),
        };
        if self.range.is_none() && !self.tight {
            let margin = 0.05 * (high - low);
            let bounded = self.zero_based && low >= 0.0;
            low = if bounded { 0.0 } else { low - margin };
            high += margin;
        }
        Scale {
            min: low,
            max: high,
            step: nice_step((high - low) / ticks as f64),
            logarithmic: false,
        }
    }
}

/// Lowest and highest of `values`.
pub(super) fn ends(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let nothing = (f64::INFINITY, f64::NEG_INFINITY);
    let wider = |(low, high): (f64, f64), v: f64| (low.min(v), high.max(v));
    values.into_iter().fold(nothing, wider)
}

/// A range of some size around values that are all the same.
fn widened(low: f64, high: f64) -> (f64, f64) {
    let size = low.abs().max(high.abs());
    if high - low > 1e-9 * size {
        return (low, high);
    }
    let half = if size > 0.0 { 0.1 * size } else { 1.0 };
    (low - half, high + half)
}

/// 1, 2 or 5 times a power of ten: the first that is not much below `step`.
fn nice_step(step: f64) -> f64 {
    let power = 10f64.powf(step.log10().floor());
    let lead = step / power;
    let mut steps = [1.0, 2.0, 5.0].into_iter();
    let nice = steps.find(|n| lead <= n * 1.2).unwrap_or(10.0);
    nice * power
}

/// Ends and ticks of an axis; on a logarithmic one all numbers are decimal logarithms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scale {
    pub(super) min: f64,
    pub(super) max: f64,
    /// Distance of the ticks.
    pub(super) step: f64,
    pub(super) logarithmic: bool,
}

impl Scale {
    /// A whole number of decades between ticks.
    fn logarithmic(low: f64, high: f64, ticks: usize) -> Self {
        let (low, high) = widened(low.log10(), high.log10());
        let margin = 0.05 * (high - low);
        Self {
            min: low - margin,
            max: high + margin,
            step: ((high - low) / ticks as f64).ceil(),
            logarithmic: true,
        }
    }

    /// Where a value stands between the ends: the value itself or its decimal logarithm.
    pub(super) fn place(&self, value: f64) -> f64 {
        match self.logarithmic {
            true => value.log10(),
            false => value,
        }
    }

    /// How a tick is written: with as many decimals as the step has, as a power of ten on a logarithmic axis.
    pub(super) fn tick_label(&self, tick: f64) -> String {
        if self.logarithmic {
            return format!("10{}", superscript(tick.round() as i32));
        }
        let largest = self.min.abs().max(self.max.abs());
        let exponent = largest.log10().floor() as i32;
        let step_exponent = self.step.log10().floor() as i32;
        if (-3..6).contains(&exponent) {
            let decimals = (-step_exponent).max(0) as usize;
            return signed(format!("{tick:.decimals$}"));
        }
        if tick == 0.0 {
            return "0".to_owned();
        }
        let decimals = (exponent - step_exponent).max(0) as usize;
        let lead = tick / 10f64.powi(exponent);
        signed(format!("{lead:.decimals$}·10{}", superscript(exponent)))
    }

    /// The ticks, between the ends.
    pub(super) fn ticks(&self) -> Vec<f64> {
        let first = (self.min / self.step).ceil() as i64;
        let last = (self.max / self.step).floor() as i64;
        (first..=last).map(|i| i as f64 * self.step).collect()
    }
}

fn superscript(n: i32) -> String {
    n.to_string()
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            digit => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹']
                [digit.to_digit(10).unwrap_or(0) as usize],
        })
        .collect()
}

/// With a true minus sign, and no sign at a rounded zero.
pub(super) fn signed(number: String) -> String {
    match number.strip_prefix('-') {
        Some(digits) if digits.chars().all(|c| "0.".contains(c)) => digits.to_owned(),
        Some(digits) => format!("−{digits}"),
        None => number,
    }
}

/// Four significant digits without an exponent.
pub(super) fn significant(value: f64) -> String {
    let decimals = match value.abs() > 0.0 {
        true => (3.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize,
        false => 0,
    };
    signed(format!("{value:.decimals$}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers_inside_the_range() {
        let scale = Axis::new("x").scale([-0.03, 0.29], 5);
        assert_eq!(scale.step, 0.1);
        let labels: Vec<String> = scale.ticks().iter().map(|t| scale.tick_label(*t)).collect();
        assert_eq!(labels, ["0.0", "0.1", "0.2", "0.3"]);
        let speed = Axis::new("V").tight().scale([0.0, 120.0], 6);
        assert_eq!((speed.min, speed.max, speed.step), (0.0, 120.0, 20.0));
    }

    #[test]
    fn equal_values_still_make_an_axis() {
        for value in [0.0, -4.0, 1e-9] {
            let scale = Axis::new("x").scale([value, value], 5);
            assert!(scale.min < value && value < scale.max);
            assert!(scale.ticks().len() >= 2);
        }
    }

    #[test]
    fn very_small_and_large_numbers_are_written_with_powers() {
        let scale = Axis::new("x").scale([-2e-7, 4e-7], 3);
        assert_eq!(scale.tick_label(-2e-7), "−2·10⁻⁷");
        assert_eq!(signed("-0.00".into()), "0.00");
        let log = Axis {
            logarithmic: true,
            ..Axis::new("x")
        };
        let scale = log.scale([1e-14, 1.0], 5);
        let labels: Vec<String> = scale.ticks().iter().map(|t| scale.tick_label(*t)).collect();
        assert_eq!(labels, ["10⁻¹²", "10⁻⁹", "10⁻⁶", "10⁻³", "10⁰"]);
        assert_eq!(scale.place(1e-6), -6.0);
        assert!(!log.scale([0.0, 1.0], 5).logarithmic);
    }
}
