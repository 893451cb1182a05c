//! Adaptive integration of vectors of functions: Gauss and Kronrod's pair of 7 and 15 points.
//!
//! R. Piessens et al., QUADPACK (1983). The interval with the largest error is halved until the sum of all errors is
//! small for every component.

use crate::error::{Error, Result};

/// Halvings at most.
const MAX_HALVINGS: usize = 4000;

/// Points on one side, from the end to the middle, with Kronrod's weights and Gauss's (0 where he has none).
const RULE: [(f64, f64, f64); 8] = [
    (0.991_455_371_120_812_6, 0.022_935_322_010_529_224, 0.0),
    (
        0.949_107_912_342_758_5,
        0.063_092_092_629_978_55,
        0.129_484_966_168_869_7,
    ),
    (0.864_864_423_359_769_1, 0.104_790_010_322_250_18, 0.0),
    (
        0.741_531_185_599_394_4,
        0.140_653_259_715_525_92,
        0.279_705_391_489_276_64,
    ),
    (0.586_087_235_467_691_1, 0.169_004_726_639_267_9, 0.0),
    (
        0.405_845_151_377_397_2,
        0.190_350_578_064_785_4,
        0.381_830_050_505_118_9,
    ),
    (0.207_784_955_007_898_47, 0.204_432_940_075_298_9, 0.0),
    (0.0, 0.209_482_141_084_727_83, 0.417_959_183_673_469_4),
];

struct QuadratureInterval {
    low: f64,
    high: f64,
    value: Vec<f64>,
    error: Vec<f64>,
}

/// `∫ f` over the polygon of `breaks`, each component to the relative `tolerance`; the values and their estimated errors.
///
/// `f` gives the values at many points at once, the same number of components everywhere; peaks are found when they stand near a
/// break.
pub(super) fn integrate(
    f: impl Fn(&[f64]) -> Result<Vec<Vec<f64>>>,
    breaks: &[f64],
    tolerance: f64,
) -> Result<(Vec<f64>, Vec<f64>)> {
    let ends = breaks.windows(2).map(|ends| piece(&f, ends[0], ends[1]));
    let mut pieces = ends.collect::<Result<Vec<_>>>()?;
    for _ in 0..MAX_HALVINGS {
        let (value, error) = totals(&pieces);
        if value.iter().chain(&error).any(|x| !x.is_finite()) {
            return Err(Error::Numerical(
                "integration: a value is not finite".into(),
            ));
        }
        let allowed: Vec<f64> = value.iter().map(|v| tolerance * v.abs()).collect();
        if error.iter().zip(&allowed).all(|(e, a)| e <= a) {
            return Ok((value, error));
        }
        let badness = |p: &QuadratureInterval| {
            let parts = p.error.iter().zip(&allowed);
            parts
                .map(|(e, a)| e / a.max(f64::MIN_POSITIVE))
                .fold(0.0, f64::max)
        };
        let worst = (0..pieces.len())
            .max_by(|i, j| badness(&pieces[*i]).total_cmp(&badness(&pieces[*j])))
            .unwrap_or(0);
        let QuadratureInterval { low, high, .. } = pieces.swap_remove(worst);
        let middle = 0.5 * (low + high);
        pieces.push(piece(&f, low, middle)?);
        pieces.push(piece(&f, middle, high)?);
    }
    Err(Error::Numerical(format!(
        "integration: {MAX_HALVINGS} halvings do not reach a relative error of {tolerance:.0e}"
    )))
}

fn totals(pieces: &[QuadratureInterval]) -> (Vec<f64>, Vec<f64>) {
    let components = pieces.first().map_or(0, |p| p.value.len());
    let sum = |pick: fn(&QuadratureInterval) -> &Vec<f64>| {
        let sums = (0..components).map(|i| pieces.iter().map(|p| pick(p)[i]).sum());
        sums.collect()
    };
    (sum(|p| &p.value), sum(|p| &p.error))
}

fn piece(
    f: &impl Fn(&[f64]) -> Result<Vec<Vec<f64>>>,
    low: f64,
    high: f64,
) -> Result<QuadratureInterval> {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let sides = RULE.iter().flat_map(|(x, kronrod, gauss)| {
        let sides: &[f64] = if *x == 0.0 { &[0.0] } else { &[-1.0, 1.0] };
        let at = sides.iter().map(move |side| middle + side * half * x);
        at.map(move |at| (at, half * kronrod, half * gauss))
    });
    let points: Vec<_> = sides.collect();
    let values = f(&points.iter().map(|p| p.0).collect::<Vec<_>>())?;
    let mut kronrod = vec![0.0; values.first().map_or(0, Vec::len)];
    let mut gauss = kronrod.clone();
    for (values, (_, by_kronrod, by_gauss)) in values.iter().zip(points) {
        for (i, v) in values.iter().enumerate() {
            kronrod[i] += by_kronrod * v;
            gauss[i] += by_gauss * v;
        }
    }
    let both = kronrod.iter().zip(&gauss);
    Ok(QuadratureInterval {
        low,
        high,
        error: both.map(|(k, g)| (k - g).abs()).collect(),
        value: kronrod,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn each(f: impl Fn(f64) -> Result<Vec<f64>>) -> impl Fn(&[f64]) -> Result<Vec<Vec<f64>>> {
        move |points| points.iter().map(|x| f(*x)).collect()
    }

    /// The 15 points integrate polynomials up to the degree 22, Gauss's 7 up to 13.
    #[test]
    fn the_rule_is_exact_for_polynomials() {
        for degree in [0, 2, 10, 12, 22] {
            let power = each(|x: f64| Ok(vec![x.powi(degree)]));
            let p = piece(&power, -1.0, 1.0).unwrap();
            let exact = 2.0 / f64::from(degree + 1);
            assert!((p.value[0] - exact).abs() < 1e-15, "{degree}");
            assert!(degree > 13 || p.error[0] < 1e-15, "{degree}");
        }
    }

    #[test]
    fn narrow_peaks_are_integrated() {
        let width = 1e-6;
        let peak = |x: f64| Ok(vec![width / ((x - 0.3).powi(2) + width * width), x.sin()]);
        let (value, error) = integrate(each(peak), &[0.0, 0.300_01, 1.0], 1e-10).unwrap();
        let exact = (0.7f64 / width).atan() + (0.3f64 / width).atan();
        assert!((value[0] / exact - 1.0).abs() < 1e-10);
        assert!((value[1] - (1.0 - 1f64.cos())).abs() < 1e-12);
        assert!(error[0] <= 1e-10 * value[0]);
    }
}
