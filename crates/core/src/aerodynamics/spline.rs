//! Cubic spline with continuous curvature through given points, not-a-knot at the ends.
//!
//! C. de Boor, A Practical Guide to Splines (1978), chapter IV. Polynomials up to the third degree are reproduced
//! exactly, so that a table of a straight line is that line.

/// Fewest points: a cubic through all of them.
pub(super) const POINTS_AT_LEAST: usize = 4;

/// A piecewise cubic, twice continuously differentiable.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Spline {
    x: Vec<f64>,
    y: Vec<f64>,
    /// Second derivatives at the points.
    curvature: Vec<f64>,
}

impl Spline {
    /// The spline through at least [`POINTS_AT_LEAST`] points with strictly rising `x`.
    pub(super) fn new(x: Vec<f64>, y: Vec<f64>) -> Self {
        let curvature = curvatures(&x, &y);
        Self { x, y, curvature }
    }

    /// Value and slope; outside the points the end pieces go on.
    pub(super) fn at(&self, x: f64) -> (f64, f64) {
        let above = self.x.partition_point(|p| *p <= x);
        let i = above.clamp(1, self.x.len() - 1) - 1;
        let h = self.x[i + 1] - self.x[i];
        let (a, b) = ((self.x[i + 1] - x) / h, (x - self.x[i]) / h);
        let (m0, m1) = (self.curvature[i], self.curvature[i + 1]);
        let value = a * self.y[i]
            + b * self.y[i + 1]
            + ((a * a * a - a) * m0 + (b * b * b - b) * m1) * h * h / 6.0;
        let slope = (self.y[i + 1] - self.y[i]) / h
            + ((3.0 * b * b - 1.0) * m1 - (3.0 * a * a - 1.0) * m0) * h / 6.0;
        (value, slope)
    }
}

/// Slopes of the straight lines between neighbouring points.
pub(super) fn secants(x: &[f64], y: &[f64]) -> Vec<f64> {
    let pairs = x.windows(2).zip(y.windows(2));
    pairs.map(|(x, y)| (y[1] - y[0]) / (x[1] - x[0])).collect()
}

/// Second derivatives from continuity of slope inside and of the third derivative at the second and last but one point.
fn curvatures(x: &[f64], y: &[f64]) -> Vec<f64> {
    let n = x.len();
    let h: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
    let d = secants(x, y);
    // unknowns at the inner points; those at the ends are eliminated
    let inner = n - 2;
    let mut diagonal: Vec<f64> = (1..=inner).map(|i| 2.0 * (h[i - 1] + h[i])).collect();
    let mut upper: Vec<f64> = (1..=inner).map(|i| h[i]).collect();
    let mut lower: Vec<f64> = (1..=inner).map(|i| h[i - 1]).collect();
    let mut right: Vec<f64> = (1..=inner).map(|i| 6.0 * (d[i] - d[i - 1])).collect();
    let (first, last) = (h[0] / h[1], h[n - 2] / h[n - 3]);
    diagonal[0] += h[0] * (1.0 + first);
    upper[0] -= h[0] * first;
    diagonal[inner - 1] += h[n - 2] * (1.0 + last);
    lower[inner - 1] -= h[n - 2] * last;
    for i in 1..inner {
        let factor = lower[i] / diagonal[i - 1];
        diagonal[i] -= factor * upper[i - 1];
        right[i] -= factor * right[i - 1];
    }
    let mut m = vec![0.0; n];
    for i in (0..inner).rev() {
        let has_next = i + 1 < inner;
        let next = if has_next { upper[i] * m[i + 2] } else { 0.0 };
        m[i + 1] = (right[i] - next) / diagonal[i];
    }
    m[0] = m[1] * (1.0 + first) - m[2] * first;
    m[n - 1] = m[n - 2] * (1.0 + last) - m[n - 3] * last;
    m
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubics_are_reproduced_with_their_slopes() {
        let cubic = |x: f64| 0.3 - 1.7 * x + 0.9 * x * x - 2.1 * x * x * x;
        let slope = |x: f64| -1.7 + 1.8 * x - 6.3 * x * x;
        for points in [
            vec![-1.0, -0.2, 0.5, 1.5],
            vec![-1.0, -0.7, -0.1, 0.0, 0.4, 1.5],
        ] {
            let y = points.iter().map(|x| cubic(*x)).collect();
            let spline = Spline::new(points, y);
            for i in 0..=50 {
                let x = -1.0 + 0.05 * f64::from(i);
                let (value, derivative) = spline.at(x);
                // rounding of a handful of operations on numbers of order ten
                assert!((value - cubic(x)).abs() < 1e-13, "{x}");
                assert!((derivative - slope(x)).abs() < 1e-12, "{x}");
            }
        }
    }

    /// SciPy: `CubicSpline([0, 1, 2.5, 3, 4.5, 6], [0, 0.8, 0.6, 0.1, -1, -0.3])` at 0.4, 2.7 and 5.9, value and slope.
    #[test]
    fn agrees_with_scipy() {
        let spline = Spline::new(
            vec![0.0, 1.0, 2.5, 3.0, 4.5, 6.0],
            vec![0.0, 0.8, 0.6, 0.1, -1.0, -0.3],
        );
        for (x, value, slope) in SCIPY {
            let found = spline.at(x);
            assert!((found.0 - value).abs() < 1e-14, "{x}: {}", found.0);
            assert!((found.1 - slope).abs() < 1e-14, "{x}: {}", found.1);
        }
    }

    const SCIPY: [(f64, f64, f64); 3] = [
        (0.4, 0.3896079999999999, 0.8675266666666667),
        (2.7, 0.4137619999999998, -1.0030033333333335),
        (5.9, -0.4282446666666664, 1.2153566666666669),
    ];
}
