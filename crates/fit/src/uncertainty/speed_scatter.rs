//! Scatter between mean speeds: tests at another speed (another run, another Reynolds number, another day) do not find
//! quite the same transfer functions, and no number of periods at one speed shows it.
//!
//! A random effect for every speed is added to the scatter of the blocks: each transfer function is multiplied by
//! `1 + ξ + iη` at a speed, with `ξ` (size) and `η` (phase) of zero mean, independent from one transfer function to
//! the next. What nests in a speed (its runs) is in it. Variances are estimated by moments: sandwich over speeds minus
//! sandwich over blocks, of the transfer functions at reduced frequencies that every speed has.
//!
//! With two speeds each difference has one degree of freedom, with one speed there is none. The variance of a force is
//! therefore pooled over its motions, in absolute size: on measured decks lift due to heave and lift due to rotation, whose
//! transfer functions differ fivefold, scatter by the same amount per unit of dimensionless motion, and so do the moments, at a
//! tenth of it, but those far below the force's largest in proportion to themselves. And its ratio to the variance that independent blocks would give is drawn towards what measured decks
//! show ([`super::speed_prior`]); with tests at one speed it is theirs, and no force is taken to scatter less than theirs do.
//!
//! What each speed says alone is [`CoefficientUncertainty::at_each_speed`].

use super::design::{Design, Effect};
use super::speed_groups::{only_speed, points_of_a_speed, shared_range, speed_groups};
use super::speed_prior::SpeedPrior;
use crate::aerodynamics::TransferMatrix;
use crate::error::Result;
use crate::flutter::BetweenSpeeds;
use crate::section::Dof;
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

/// Reduced frequencies over the tested range at which transfer functions are compared.
pub(super) const POINTS: usize = 16;
/// Transfer functions smaller than this part of their root mean square are taken as that.
const SMALL: f64 = 1e-3;
/// Transfer functions below this part of the largest of their force scatter in proportion to themselves, all others by the same absolute
/// amount. None of the embedded decks is smaller (moment due to sway, 0.02 to 0.05 of that due to rotation).
const SMALLEST: f64 = 0.015;
/// Singular values below this part of the largest are left out where a turned transfer function is sought.
const SINGULAR: f64 = 1e-8;

/// How much the transfer functions differ between mean speeds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpeedScatter {
    /// Mean wind speeds, rising, m/s; empty where they are not stated.
    pub speeds_m_s: Vec<f64>,
    /// Where the variance between speeds is from.
    pub source: BetweenSpeeds,
    /// Variance between speeds over what independent blocks would give, by these tests alone: one if speeds agree. None with one
    /// speed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ratio: Option<f64>,
    /// The same ratio by measured decks, which it is drawn to.
    pub prior_ratio: f64,
    /// Degrees of freedom with which the variance of a force in size or in phase is known, those of the measured decks included.
    pub degrees_of_freedom: f64,
    /// Standard deviations of each force, as they are counted.
    pub forces: Vec<ForceScatter>,
}

/// Standard deviations between speeds of one force, relative to its transfer functions (root mean square over
/// motions and the reduced frequencies that all speeds have).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceScatter {
    /// Force.
    pub force: Dof,
    /// In phase with the transfer function.
    pub size: f64,
    /// In quadrature to it, rad.
    pub phase: f64,
    /// Variance between speeds over that of independent blocks by these tests alone, of the first; none with one speed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size_ratio: Option<f64>,
    /// The same of the second.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phase_ratio: Option<f64>,
}

/// Transfer matrix at one reduced frequency with its derivatives with respect to all parameters.
pub(super) struct Slopes {
    pub k: f64,
    pub value: TransferMatrix,
    pub slopes: Vec<TransferMatrix>,
}

/// Satterthwaite's degrees of freedom of the variance of blocks and effects together.
pub(super) fn degrees_of_freedom(design: &Design, gradient: &DVector<f64>) -> f64 {
    let own = design.degrees_of_freedom(gradient);
    let blocks = design.contributions().tr_mul(gradient).norm_squared();
    let (mut sum, mut squares) = (blocks, blocks * blocks / own);
    for effect in &design.effects {
        let variance = effect.columns.tr_mul(gradient).norm_squared();
        sum += variance;
        squares += (variance * effect.total).powi(2) / effect.degrees_of_freedom;
    }
    match squares > 0.0 {
        true => (sum * sum / squares).max(1.0),
        false => own,
    }
}

/// The random effects of mean speeds, drawn towards `prior`; with tests at one speed they are those of the prior.
///
/// `own` lists the coefficients of every transfer function, row by row; `at` are points over all tested `K`.
pub(super) fn between_speeds(
    design: &Design,
    prior: SpeedPrior,
    dofs: &[Dof],
    values: &DVector<f64>,
    own: &[Vec<usize>],
    at: &[Slopes],
) -> Result<(SpeedScatter, Vec<Effect>)> {
    let blocks = &design.blocks;
    let several = speed_groups(blocks);
    let source = match &several {
        Some(_) => BetweenSpeeds::Tests,
        None => BetweenSpeeds::Prior,
    };
    let (groups, speeds_m_s) =
        several.unwrap_or_else(|| (vec![0; blocks.len()], only_speed(blocks)));
    let count = speeds_m_s.len().max(1);
    let prior = prior.at_points(points_of_a_speed(blocks, &groups, count));
    let clusters = design.clusters(&groups, count);
    let judge = Judge {
        grams: clusters.iter().map(|c| c.rows.tr_mul(&c.rows)).collect(),
        of_speeds: match source {
            BetweenSpeeds::Tests => Some(design.with_blocks(clusters)?.contributions()),
            BetweenSpeeds::Prior => None,
        },
        of_blocks: design.contributions(),
        design,
        at,
        common: common_points(shared_range(blocks, &groups), at),
        values,
        own,
        n: dofs.len(),
    };
    let n = judge.n;
    let spare = (n * (count - 1)) as f64;
    let mut scatter = SpeedScatter {
        speeds_m_s,
        source,
        ratio: None,
        prior_ratio: prior.ratio,
        degrees_of_freedom: prior.degrees_of_freedom + spare,
        forces: Vec::new(),
    };
    let both = |i: usize| [false, true].map(|turned| judge.effect(i, turned));
    let units: Vec<[Option<UnitEffect>; 2]> = (0..n).map(both).collect();
    let known = units.iter().flatten().flatten();
    let ratios: Vec<f64> = known.filter_map(|u| u.ratio).collect();
    let mut of_deck = prior;
    if !ratios.is_empty() {
        let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
        of_deck = prior.for_deck(mean, spare * ratios.len() as f64);
        scatter.ratio = Some(mean);
        scatter.degrees_of_freedom = of_deck.degrees_of_freedom + spare;
    }
    let mut effects = Vec::new();
    for (i, (&force, units)) in dofs.iter().zip(units).enumerate() {
        let size: f64 = (0..n).map(|j| judge.mean_square(i, j)).sum::<f64>() / n as f64;
        let [size_ratio, phase_ratio] = [0, 1].map(|t| units[t].as_ref().and_then(|u| u.ratio));
        let least = match force {
            Dof::Torsion => [of_deck.least[2], of_deck.least[3]],
            Dof::Lateral | Dof::Vertical => [of_deck.least[0], of_deck.least[1]],
        };
        let mut least = least.into_iter().map(|relative| relative * relative * size);
        let [size, phase] = units.map(|unit| {
            let least = least.next().unwrap_or(0.0);
            let effect = unit.and_then(|u| u.drawn(of_deck, spare, least));
            let Some((variance, effect)) = effect.filter(|_| size > 0.0) else {
                return 0.0;
            };
            effects.push(effect);
            (variance / size).sqrt()
        });
        scatter.forces.push(ForceScatter {
            force,
            size,
            phase,
            size_ratio,
            phase_ratio,
        });
    }
    Ok((scatter, effects))
}

/// The points at which all speeds have transfer functions; all of them where they share none or do not say.
fn common_points(shared: Option<(f64, f64)>, at: &[Slopes]) -> Vec<&Slopes> {
    let inside = |s: &&Slopes| shared.is_none_or(|(low, high)| low <= s.k && s.k <= high);
    let common: Vec<&Slopes> = at.iter().filter(inside).collect();
    match common.is_empty() {
        true => at.iter().collect(),
        false => common,
    }
}

/// An effect of unit absolute standard deviation.
struct UnitEffect {
    columns: DMatrix<f64>,
    /// Variance that independent blocks would give.
    of_blocks: f64,
    /// Variance between speeds over that, where there are several.
    ratio: Option<f64>,
}

impl UnitEffect {
    /// Its variance and the effect, drawn towards a prior; none where the speeds scatter no more than the blocks. With tests at one
    /// speed the variance is not below `least`.
    fn drawn(self, prior: SpeedPrior, spare: f64, least: f64) -> Option<(f64, Effect)> {
        let known = match self.ratio {
            Some(ratio) => prior.after(ratio, spare),
            None => prior.at_least(least / self.of_blocks),
        };
        let variance = (known.ratio - 1.0) * self.of_blocks;
        (variance > 0.0).then(|| {
            let effect = Effect {
                columns: self.columns * variance.sqrt(),
                total: known.ratio / (known.ratio - 1.0),
                degrees_of_freedom: known.degrees_of_freedom,
            };
            (variance, effect)
        })
    }
}

/// What the scatter of all forces is judged by.
struct Judge<'a> {
    design: &'a Design,
    at: &'a [Slopes],
    common: Vec<&'a Slopes>,
    grams: Vec<DMatrix<f64>>,
    of_speeds: Option<DMatrix<f64>>,
    of_blocks: DMatrix<f64>,
    /// The estimates, and the places of the coefficients of every transfer function among them, row by row.
    values: &'a DVector<f64>,
    own: &'a [Vec<usize>],
    /// Number of motions.
    n: usize,
}

impl Judge<'_> {
    fn mean_square(&self, i: usize, j: usize) -> f64 {
        let squares = self.common.iter().map(|s| s.value[(i, j)].norm_sqr());
        let sum: f64 = squares.sum();
        sum / self.common.len() as f64
    }

    /// The effect of force `i` in size or, where its transfer functions are `turned`, in phase.
    fn effect(&self, i: usize, turned: bool) -> Option<UnitEffect> {
        let mut columns: Vec<DVector<f64>> = Vec::new();
        let (mut of_speeds, mut of_blocks, mut weight) = (0.0, 0.0, 0.0);
        let sizes = (0..self.n).map(|j| self.mean_square(i, j));
        let smallest = SMALLEST.powi(2) * sizes.fold(0.0, f64::max);
        for j in 0..self.n {
            let size = self.mean_square(i, j);
            let own = &self.own[i * self.n + j];
            if size == 0.0 || own.is_empty() {
                continue;
            }
            let relative = self.relative_rows(i, j, turned, size.sqrt());
            let square =
                |m: &DMatrix<f64>| (&relative * m).norm_squared() / relative.nrows() as f64;
            let moved = self.moved(i, j, turned, size.sqrt());
            let mut scattered = DVector::zeros(self.values.len());
            for (p, value) in own.iter().zip(moved.iter()) {
                scattered[*p] = *value;
            }
            let of_speed = |gram: &DMatrix<f64>| &self.design.inverse * (gram * &scattered);
            let of_each: Vec<DVector<f64>> = self.grams.iter().map(of_speed).collect();
            let scattering = size.max(smallest);
            weight += size / scattering * square(&DMatrix::from_columns(&of_each));
            of_speeds += size * self.of_speeds.as_ref().map_or(0.0, square);
            of_blocks += size * square(&self.of_blocks);
            columns.extend(of_each.into_iter().map(|c| c / scattering.sqrt()));
        }
        (weight > 0.0 && of_blocks > 0.0).then(|| UnitEffect {
            columns: DMatrix::from_columns(&columns),
            of_blocks: of_blocks / weight,
            ratio: self.of_speeds.as_ref().map(|_| of_speeds / of_blocks),
        })
    }

    /// Change of an entry relative to itself with all parameters, one row per common `K`.
    fn relative_rows(&self, i: usize, j: usize, turned: bool, size: f64) -> DMatrix<f64> {
        let parameters = self.common[0].slopes.len();
        DMatrix::from_fn(self.common.len(), parameters, |q, p| {
            let s = self.common[q];
            let own = s.value[(i, j)];
            let ratio =
                s.slopes[p][(i, j)] * own.conj() / own.norm_sqr().max((SMALL * size).powi(2));
            if turned { ratio.im } else { ratio.re }
        })
    }

    /// Coefficients of an entry for the same entry, or for the entry turned by a right angle as well as its columns can
    /// over all tested `K`.
    fn moved(&self, i: usize, j: usize, turned: bool, size: f64) -> DVector<f64> {
        let (entry, own) = ((i, j), &self.own[i * self.n + j]);
        let as_it_is = || DVector::from_iterator(own.len(), own.iter().map(|p| self.values[*p]));
        if !turned {
            return as_it_is();
        }
        let count = self.at.len();
        let weight = |q: usize| self.at[q].value[entry].norm().max(SMALL * size).recip();
        let columns = DMatrix::from_fn(2 * count, own.len(), |r, c| {
            let (q, z) = (r % count, self.at[r % count].slopes[own[c]][entry]);
            weight(q) * if r < count { z.re } else { z.im }
        });
        let turned = DVector::from_fn(2 * count, |r, _| {
            let (q, z) = (r % count, self.at[r % count].value[entry]);
            weight(q) * if r < count { -z.im } else { z.re }
        });
        let svd = columns.svd(true, true);
        let cut = SINGULAR * svd.singular_values.max();
        svd.solve(&turned, cut).unwrap_or_else(|_| as_it_is())
    }
}

impl SpeedScatter {
    /// In words.
    pub fn describe(&self) -> String {
        let speeds: Vec<String> = self.speeds_m_s.iter().map(|v| format!("{v:.2}")).collect();
        let speeds = match speeds.is_empty() {
            true => String::new(),
            false => format!(" {} m/s", speeds.join(", ")),
        };
        let of_force = |f: &ForceScatter| {
            let (name, size, phase) = (f.force.name(), 100.0 * f.size, f.phase.to_degrees());
            format!("{name} force {size:.1} % in size, {phase:.1}° in phase")
        };
        let forces: Vec<String> = self.forces.iter().map(of_force).collect();
        let (forces, prior) = (forces.join("; "), self.prior_ratio);
        match self.ratio {
            Some(ratio) => format!(
                "scatter between the mean speeds{speeds}: its variance is {ratio:.1} times that of independent blocks by these \
                 tests, {prior:.1} times by measured decks; counted as a random effect of each speed, pooled over the motions of \
                 a force and drawn towards those decks (standard deviations: {forces})"
            ),
            None => format!(
                "one mean speed{speeds}: what another speed would change is taken from measured decks, not from these tests \
                 (variance {prior:.1} times that of independent blocks, and no force less than those decks do; standard deviations: \
                 {forces})"
            ),
        }
    }
}
