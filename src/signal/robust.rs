//! Location and spread that a few wild values do not move.

/// A normal variable has its quartiles at this part of its standard deviation, inverted.
const NORMAL_MAD: f64 = 1.482_602_218_505_602;

/// Median; the mean of the two in the middle for an even count, zero for none.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    match n {
        0 => 0.0,
        _ => 0.5 * (sorted[(n - 1) / 2] + sorted[n / 2]),
    }
}

/// Standard deviation of a normal variable with the median absolute deviation of `values` from their median.
pub fn robust_deviation(values: &[f64]) -> f64 {
    let centre = median(values);
    let distances: Vec<f64> = values.iter().map(|x| (x - centre).abs()).collect();
    NORMAL_MAD * median(&distances)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outliers_do_not_count() {
        let mut values: Vec<f64> = (0..101).map(f64::from).collect();
        assert_eq!(median(&values), 50.0);
        assert!((robust_deviation(&values) - NORMAL_MAD * 25.0).abs() < 1e-12);
        values[100] = 1e9;
        assert_eq!(median(&values), 50.0);
        assert_eq!(median(&[1.0, 3.0]), 2.0);
        assert_eq!(median(&[]), 0.0);
    }
}
