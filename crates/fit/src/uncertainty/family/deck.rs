//! One deck of the family: section, truth, and a table of its tests.

use super::super::speed_prior::SpeedPrior;
use crate::aerodynamics::derivatives::{Part, TransferSample};
use crate::aerodynamics::{Lags, RationalModel, Transfer, TransferMatrix};
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result};
use crate::flutter::{FlutterSearch, OnsetSearch, find_onset};
use crate::section::{Dof, Rotation, SectionModel, Structure, Translation};
use crate::signal::random_stream;
use crate::units::{ReducedFrequency, in_equal_ratios};
use nalgebra::{Complex, DMatrix};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{ChiSquared, Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

/// Highest speed of the search over the true onset.
pub(super) const SEARCHED: f64 = 2.5;
/// Decks that are drawn until one flutters as it should.
const TRIES: u64 = 200;
/// Speeds between which a true onset is looked for, in units of the speed at which torsion has `K = 1`.
const HIGHEST: f64 = 15.0;
/// Variance of a fitted transfer function over that of a test point at eight test points a speed, in size or in phase: six
/// coefficients from sixteen numbers.
const OF_A_POINT: f64 = 6.0 / 16.0;

/// A family of decks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FamilyPlan {
    /// Number of decks; ranges and numbers of motions take turns.
    pub decks: usize,
    /// Seed of the first deck; each has its own.
    pub seed: u64,
    /// Whether transfer functions scatter between mean speeds as those of measured decks do.
    pub speeds_scatter: bool,
}

impl Default for FamilyPlan {
    fn default() -> Self {
        Self {
            decks: 400,
            seed: 1,
            speeds_scatter: true,
        }
    }
}

/// Where the tests of a deck lie, seen from the reduced frequency of its true onset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FamilyRange {
    /// Around it.
    #[default]
    Normal,
    /// It lies within 8 % of their lowest or highest.
    Edge,
    /// In a gap of ratio 2.5 to 3.3.
    Gap,
    /// All above it.
    Above,
    /// All below it.
    Below,
    /// All ranges together.
    All,
}

impl FamilyRange {
    /// The ranges that decks have.
    pub(super) const ALL: [Self; 5] = [
        Self::Normal,
        Self::Edge,
        Self::Gap,
        Self::Above,
        Self::Below,
    ];

    /// For people.
    pub fn title(self) -> &'static str {
        match self {
            Self::Normal => "around the onset's K",
            Self::Edge => "ending at the onset's K",
            Self::Gap => "a gap around the onset's K",
            Self::Above => "all above the onset's K",
            Self::Below => "all below the onset's K",
            Self::All => "all",
        }
    }

    /// `count` tested `K` for an onset at `k`, rising.
    fn tested(self, k: f64, count: usize, random: &mut ChaCha8Rng) -> Vec<f64> {
        let mut between = |low: f64, high: f64| random.random_range(low..high);
        let (low, high) = match self {
            Self::Normal | Self::All => (k / between(1.6, 2.5), k * between(2.5, 5.0)),
            Self::Edge if between(0.0, 1.0) < 0.5 => {
                (k * between(0.92, 1.0), k * between(3.0, 5.0))
            }
            Self::Edge => (k / between(3.0, 5.0), k * between(1.0, 1.08)),
            Self::Above => (k * between(1.2, 2.5), k * between(4.0, 8.0)),
            Self::Below => (k / between(4.0, 8.0), k / between(1.2, 2.0)),
            Self::Gap => {
                let ratio = between(2.5, 3.3);
                let from = k / f64::powf(ratio, between(0.3, 0.7));
                let below = (count / 2).max(2);
                let ends = (from / between(2.0, 3.0), from * ratio * between(2.0, 3.0));
                let lower = in_equal_ratios(ends.0, from, below);
                let upper = in_equal_ratios(from * ratio, ends.1, count - below);
                return lower.chain(upper).collect();
            }
        };
        in_equal_ratios(low, high, count).collect()
    }
}

/// A deck with known truth.
pub(super) struct SyntheticDeck {
    pub(super) range: FamilyRange,
    pub(super) dofs: Vec<Dof>,
    pub(super) structure: Structure,
    pub(super) truth_m_s: f64,
    pub(super) samples: Vec<TransferSample>,
}

impl SyntheticDeck {
    /// Deck of a number.
    pub(super) fn draw(plan: &FamilyPlan, number: usize) -> Result<Self> {
        let range = FamilyRange::ALL[number % 5];
        let sways = number / 5 % 2 == 1;
        let section = section(number / 10 % 5, sways);
        let third = number / 50 % 2 == 1;
        let (structure, dofs) = (section.structure()?, section.dofs());
        let torsion_hz = section.torsion.frequency_hz.unwrap_or(1.0);
        let unit = std::f64::consts::TAU * torsion_hz * section.width_m;
        for attempt in 0..TRIES {
            let mut random = random_stream(plan.seed.wrapping_add(number as u64), attempt);
            let truth = truth(&mut random, sways, third);
            let Some((truth_m_s, k)) = onset(&structure, &truth, HIGHEST * unit)? else {
                continue;
            };
            let count = random.random_range(6..=14);
            let ks = range.tested(k, count, &mut random);
            let noise = random.random_range(0.03..0.10);
            let (speeds, n) = (random.random_range(1..=2), truth.dofs.len());
            let transfer = |k: &f64| truth.transfer(ReducedFrequency::from_full_width(*k));
            let transfers = ks.iter().map(transfer).collect::<Result<Vec<_>>>()?;
            let mut shifts = vec![vec![Complex::new(0.0, 0.0); n * n]; speeds];
            if plan.speeds_scatter {
                shift(&mut shifts, &transfers, noise, &mut random)?;
            }
            let points: Vec<_> = ks.into_iter().zip(transfers).collect();
            let samples = samples(&truth.dofs, &points, noise, &shifts, &mut random);
            return Ok(Self {
                range,
                dofs,
                structure,
                truth_m_s,
                samples,
            });
        }
        Err(Error::Numerical(format!(
            "family: deck {number} does not flutter in {TRIES} draws"
        )))
    }
}

/// One of five sections, with sway or without.
fn section(which: usize, sways: bool) -> SectionModel {
    let mut section = match which {
        0 => SectionModel::table_4_1(),
        1 => SectionModel::iabse_1_1a(),
        // a light streamlined deck, a heavy one of low torsional frequency, a small model of high damping
        2 => {
            let heave = Translation::new(9_000.0, 0.12, 0.005);
            SectionModel::two_dof(20.0, 1.25, heave, Rotation::new(4.0e5, 0.35, 0.005))
        }
        3 => {
            let heave = Translation::new(31_000.0, 0.07, 0.003);
            SectionModel::two_dof(36.0, 1.25, heave, Rotation::new(4.5e6, 0.14, 0.003))
        }
        _ => {
            let heave = Translation::new(6.0, 3.0, 0.01);
            SectionModel::two_dof(0.4, 1.2, heave, Rotation::new(0.11, 8.0, 0.01))
        }
    };
    if sways {
        let heave = section.vertical.frequency_hz.unwrap_or(1.0);
        section.lateral = Some(Translation {
            frequency_hz: Some(0.6 * heave),
            ..section.vertical.clone()
        });
    }
    section
}

/// Jones's function scaled and perturbed, with one or two lags, and perhaps one more that feeds torsion in slow motion.
fn truth(random: &mut ChaCha8Rng, sways: bool, third: bool) -> RationalModel {
    let jones = RationalModel::jones_flat_plate();
    let Lags::Shared(own) = &jones.lags else {
        return jones;
    };
    let mut about = |one: f64, part: f64| {
        let z: f64 = StandardNormal.sample(random);
        one * (part * z.clamp(-2.5, 2.5)).exp()
    };
    let mut scaled = |m: &DMatrix<f64>, part: f64| m.map(|x| about(x, part));
    let [mut a1, mut a2] = [&jones.a1, &jones.a2].map(|m| scaled(m, 0.15));
    let mut a3 = scaled(&jones.a3, 0.2);
    a3[(0, 1)] = a3[(1, 0)];
    let mut lag_terms: Vec<DMatrix<f64>> =
        jones.lag_terms.iter().map(|m| scaled(m, 0.15)).collect();
    let mut lags: Vec<f64> = own.iter().map(|d| about(*d, 0.3)).collect();
    if random.random_range(0.0..1.0) < 0.5 {
        // one lag in the place of two
        let second = lag_terms.remove(1);
        lag_terms[0] += second;
        lags = vec![(lags[0] * lags[1]).sqrt()];
    }
    if third {
        let mut lag_term = DMatrix::zeros(2, 2);
        lag_term[(1, 1)] = random.random_range(0.1..0.6);
        lag_terms.push(lag_term);
        lags.push(random.random_range(0.05..0.3));
    }
    if sways {
        for m in [&mut a1, &mut a2, &mut a3]
            .into_iter()
            .chain(&mut lag_terms)
        {
            *m = m.clone().insert_row(1, 0.0).insert_column(1, 0.0);
        }
        // quasi-steady sway: drag and its slopes
        let drag = random.random_range(0.1..0.5);
        a2[(1, 1)] = -drag;
        a2[(0, 1)] = random.random_range(-0.3..0.3);
        a2[(2, 1)] = random.random_range(-0.05..0.05);
        a2[(1, 0)] = random.random_range(-0.2..0.2);
        a2[(1, 2)] = random.random_range(-0.1..0.1);
        a1[(1, 2)] = random.random_range(-0.4..0.4);
        a3[(1, 1)] = -0.05;
    }
    RationalModel {
        dofs: match sways {
            true => Dof::THREE.to_vec(),
            false => Dof::TWO.to_vec(),
        },
        a1,
        a2,
        a3,
        lags: Lags::Shared(lags),
        lag_terms,
    }
}

/// Speed (m/s) and reduced frequency of the true onset, where a deck that is stable in slow wind has one.
fn onset(
    structure: &Structure,
    truth: &RationalModel,
    highest_m_s: f64,
) -> Result<Option<(f64, f64)>> {
    let section = CoupledSection::with_model(structure, truth)?;
    let search = OnsetSearch::up_to(highest_m_s / SEARCHED);
    Ok(match find_onset("truth", &section, &search, None)? {
        FlutterSearch::Onset(o) => Some((o.at.speed_m_s, o.at.reduced_frequency.full_width())),
        FlutterSearch::UnstableAtOrBelow(_) | FlutterSearch::StableUpTo(_) => None,
    })
}

/// Tests of transfer matrices at their `K`, which take turns between mean speeds: with the relative shift of every transfer function at its
/// speed, and `noise`, the standard deviation of one at a test point, relative.
fn samples(
    dofs: &[Dof],
    tested: &[(f64, TransferMatrix)],
    noise: f64,
    shifts: &[Vec<Complex<f64>>],
    random: &mut ChaCha8Rng,
) -> Vec<TransferSample> {
    let n = dofs.len();
    let component = noise / std::f64::consts::SQRT_2;
    let mut samples = Vec::new();
    let mut points: Vec<_> = tested.iter().enumerate().collect();
    points.sort_by_key(|(p, _)| p % shifts.len());
    for (p, (k, g)) in points {
        let speed = p % shifts.len();
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let mut normal = || -> f64 { StandardNormal.sample(random) };
            let noise = Complex::new(normal(), normal()) * component;
            let found = g[(i, j)] * (1.0 + noise + shifts[speed][i * n + j]);
            for (part, value) in [(Part::Real, found.re), (Part::Imaginary, found.im)] {
                samples.push(TransferSample {
                    force: dofs[i],
                    motion: dofs[j],
                    part,
                    k: ReducedFrequency::from_full_width(*k),
                    value,
                    mean_speed_m_s: Some(5.0 + 3.0 * speed as f64),
                });
            }
        }
    }
    samples
}

/// Draws the relative shift of every transfer function at every mean speed: the same in absolute size for the motions of a force, with a
/// variance that is drawn as measured decks have it.
fn shift(
    shifts: &mut [Vec<Complex<f64>>],
    transfers: &[TransferMatrix],
    noise: f64,
    random: &mut ChaCha8Rng,
) -> Result<()> {
    let n = shifts[0].len().isqrt();
    let size = |i: usize, j: usize| {
        let sum: f64 = transfers.iter().map(|g| g[(i, j)].norm_sqr()).sum();
        (sum / transfers.len() as f64).sqrt()
    };
    let prior = SpeedPrior::measured(None);
    let nu = prior.degrees_of_freedom;
    let chi = ChiSquared::new(nu).map_err(|e| Error::Numerical(e.to_string()))?;
    let of_block = 0.5 * noise.powi(2) * OF_A_POINT;
    for i in 0..n {
        let mut deviation = || -> f64 {
            let ratio = nu * prior.ratio / chi.sample(random);
            ((ratio - 1.0).max(0.0) * of_block).sqrt()
        };
        let (in_size, in_phase) = (deviation(), deviation());
        let squares = (0..n).map(|j| size(i, j).powi(2)).sum::<f64>() / n as f64;
        for j in 0..n {
            let part = match size(i, j) {
                own if own > 0.0 => (squares.sqrt() / own).min(3.0),
                _ => 0.0,
            };
            for speed in &mut *shifts {
                let mut normal = || -> f64 { StandardNormal.sample(random) };
                speed[i * n + j] = Complex::new(in_size * normal(), in_phase * normal()) * part;
            }
        }
    }
    Ok(())
}
