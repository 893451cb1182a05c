//! The onset of a bridge whose frequencies, damping and derivatives scatter (Monte Carlo).

use super::BridgeStudy;
use super::answers::coupled;
use crate::aerodynamics::{
    ContinuousRealization, Realizable, Realization, Transfer, TransferMatrix,
};
use crate::bridge::Bridge;
use crate::error::{Error, Result, ensure, non_negative};
use crate::flutter::{NearbyOnset, Onset, find_onset_of_modes};
use crate::numbered::{OnDone, numbered};
use crate::section::Dof;
use crate::signal::random_stream;
use crate::uncertainty::{ModelDraws, SampledOnsets, StudentScale};
use crate::units::ReducedFrequency;
use nalgebra::DMatrix;
use rand::Rng;
use rand_distr::StandardNormal;
use serde::Serialize;
use std::sync::Arc;

/// Shortest step from the mean to a sample, as a part of the way: where the motion changes faster, the onset is searched.
const SHORTEST_STEP: f64 = 1.0 / 32.0;
/// Samples at most.
const MOST_SAMPLES: usize = 1_000_000;

/// Standard deviations over the mean; every mode and every entry of the force matrices scatters by itself.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Scatter {
    /// Of the frequencies, normal.
    pub frequency: f64,
    /// Of the damping ratios, log-normal.
    pub damping: f64,
    /// Of the self-excited forces.
    pub derivatives: DerivativeScatter,
    /// Number of samples.
    pub samples: usize,
    /// Seed.
    pub seed: u64,
}

impl Scatter {
    /// Refuses what no bridge can have; the names are those of the first four numbers where they were stated.
    ///
    /// # Errors
    /// [`Error::Input`].
    pub fn check(&self, [frequency, damping, derivatives, samples]: [&str; 4]) -> Result<()> {
        non_negative(frequency, self.frequency)?;
        non_negative(damping, self.damping)?;
        if let DerivativeScatter::Relative(part) = self.derivatives {
            non_negative(derivatives, part)?;
        }
        let expected = format_args!("2 to {MOST_SAMPLES}");
        let holds = (2..=MOST_SAMPLES).contains(&self.samples);
        ensure(holds, samples, expected, self.samples)
    }
}

/// How the self-excited forces scatter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DerivativeScatter {
    /// As far as the tests leave the coefficients of the models open: by the covariance of each section's fit, Student's t with the
    /// degrees of freedom of the onset's interval.
    Measured,
    /// Standard deviation over the mean of each entry of the matrix of self-excited forces, normal: the derivatives of one
    /// force by one motion together.
    #[serde(untagged)]
    Relative(f64),
}

impl std::str::FromStr for DerivativeScatter {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        if text == "measured" {
            return Ok(Self::Measured);
        }
        text.parse().map(Self::Relative).map_err(|_| {
            let expected = "a standard deviation over the mean, or `measured`";
            Error::input("scatter of the derivatives", expected, text)
        })
    }
}

impl std::fmt::Display for DerivativeScatter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Relative(part) => write!(f, "{part}"),
            Self::Measured => f.write_str("measured"),
        }
    }
}

impl BridgeStudy {
    /// The onset when frequencies, damping and forces scatter: that of the mode which flutters in the mean, followed in every
    /// sample from the onset of the mean; where it cannot be followed the onset is searched among all modes. `progress` is called with the samples
    /// done and all of them, from any thread.
    ///
    /// # Errors
    /// [`Error::Input`] for scatter that cannot be; [`Error::Numerical`] when fewer than two samples have an onset.
    pub fn scattered_onset(
        &self,
        onset: &Onset,
        scatter: &Scatter,
        progress: OnDone<'_>,
    ) -> Result<SampledOnsets> {
        scatter.check(["frequency", "damping", "derivatives", "samples"])?;
        let sampler = OnsetSampler {
            study: self,
            scatter,
            forces: self.drawn_forces(scatter.derivatives)?,
            scale: self.student_scale(onset, scatter.derivatives)?,
            nearby: NearbyOnset::new(&self.by_model, &onset.at)?,
        };
        let found = numbered(scatter.samples, progress, |i| sampler.onset(i as u64))?;
        let onsets = SampledOnsets::from(found);
        if onsets.speeds_m_s.len() < 2 {
            return Err(Error::Numerical(
                "scatter: fewer than two samples have an onset".into(),
            ));
        }
        Ok(onsets)
    }

    /// What makes Gaussian draws of a covariance those of Student's t; none for factors that are stated.
    fn student_scale(
        &self,
        onset: &Onset,
        scatter: DerivativeScatter,
    ) -> Result<Option<StudentScale>> {
        if scatter != DerivativeScatter::Measured {
            return Ok(None);
        }
        let interval = self.onset_interval(onset)?;
        // none where speeds are stated without errors
        let freedom = interval.by_error().map(|error| error.degrees_of_freedom);
        freedom.map(StudentScale::new).transpose()
    }

    /// The covariances of the fits from which the forces of the sections are drawn; none for entries of the mean times factors.
    fn drawn_forces(&self, scatter: DerivativeScatter) -> Result<Vec<Option<ModelDraws<'_>>>> {
        let mut all = Vec::with_capacity(self.sections.len());
        for (block, forces) in self.file.sections.iter().zip(&self.sections) {
            all.push(match (scatter, &forces.uncertainty) {
                // static coefficients are stated without errors
                (DerivativeScatter::Relative(_), _) | (_, Ok(None)) => None,
                (_, Ok(Some(known))) => Some(ModelDraws::new(&known.coefficients)?),
                (_, Err(why)) => {
                    let place = format!("section {}: scatter of the derivatives", block.name);
                    let expected = "a model whose fit left a covariance, or a standard deviation over the mean";
                    return Err(Error::input(place, expected, why.clone()));
                }
            });
        }
        Ok(all)
    }
}

/// What all samples share.
struct OnsetSampler<'a> {
    study: &'a BridgeStudy,
    scatter: &'a Scatter,
    /// In the order of the sections.
    forces: Vec<Option<ModelDraws<'a>>>,
    /// One for the forces of all sections of a sample.
    scale: Option<StudentScale>,
    nearby: NearbyOnset,
}

impl OnsetSampler<'_> {
    /// The onset of one sample, m/s: that of the mean followed, else by a search.
    fn onset(&self, index: u64) -> Result<Option<f64>> {
        if let Some(speed) = self.followed(index)? {
            return Ok(Some(speed));
        }
        let other = coupled(&self.sample(index, 1.0)?)?;
        let (search, tested) = (self.study.search(), self.study.tested_range());
        find_onset_of_modes("sample", &other, &search, tested)
    }

    /// The same motion from the mean to the sample, by as many bridges between them as it takes to know it again.
    fn followed(&self, index: u64) -> Result<Option<f64>> {
        let mut at = self.nearby.clone();
        let (mut done, mut step) = (0.0, 1.0);
        while done < 1.0 {
            let other = coupled(&self.sample(index, done + step)?)?;
            match at.follow(&other).filter(|next| next.resembles(&at)) {
                Some(next) => {
                    at = next;
                    done += step;
                    step = (2.0 * step).min(1.0 - done);
                }
                None if step > SHORTEST_STEP => step *= 0.5,
                None => return Ok(None),
            }
        }
        Ok(Some(at.speed_m_s))
    }

    /// A sample, or the bridge that is `part` of the way from the mean to it.
    fn sample(&self, index: u64, part: f64) -> Result<Bridge> {
        let mut random = random_stream(self.scatter.seed, index);
        let mut normal = || -> f64 { part * random.sample::<f64, _>(StandardNormal) };
        let mut bridge = self.study.by_model.clone();
        // a log-normal factor of mean one
        let damping = self.scatter.damping;
        let spread = (1.0 + damping * damping).ln();
        for mode in &mut bridge.modes {
            mode.frequency_hz *= 1.0 + self.scatter.frequency * normal();
            mode.damping_ratio *= (spread.sqrt() * normal() - 0.5 * part * spread).exp();
            crate::error::positive("scattered frequency", mode.frequency_hz)?;
        }
        self.scatter_forces(&mut bridge, &mut random, part)?;
        Ok(bridge)
    }

    /// Groups of one fit share what was measured; given factors are drawn for each group by itself.
    fn scatter_forces(&self, bridge: &mut Bridge, random: &mut impl Rng, part: f64) -> Result<()> {
        let scale = self.scale.map_or(1.0, |scale| scale.draw(random));
        let part = part * scale;
        let mut models = vec![None; self.forces.len()];
        for (group, section) in bridge.groups.iter_mut().zip(&self.study.section_of_group) {
            let section = self.study.first_of_fit(*section);
            group.forces = match (&self.forces[section], &models[section]) {
                (Some(_), Some(drawn)) => Arc::clone(drawn),
                (Some(draws), None) => Arc::new(draws.model(random, part)?),
                (None, _) => self.scaled(&group.forces, random, part)?,
            };
            models[section] = Some(group.forces.clone());
        }
        Ok(())
    }

    /// The forces that are `part` of the way from the mean to its entries times random factors.
    fn scaled(
        &self,
        mean: &Arc<dyn Transfer>,
        random: &mut impl Rng,
        part: f64,
    ) -> Result<Arc<dyn Transfer>> {
        let deviation = match self.scatter.derivatives {
            DerivativeScatter::Relative(deviation) if deviation != 0.0 => deviation,
            _ => return Ok(mean.clone()),
        };
        let n = mean.dofs().len();
        let mut normal = || -> f64 { random.sample(StandardNormal) };
        let factors = DMatrix::from_fn(n, n, |_, _| 1.0 + part * deviation * normal());
        Ok(Arc::new(Scaled::new(mean.as_ref(), &factors)?))
    }
}

/// Forces of a model, each entry multiplied by a factor.
struct Scaled {
    dofs: Vec<Dof>,
    realization: Realization,
}

impl Scaled {
    fn new(forces: &dyn Transfer, factors: &DMatrix<f64>) -> Result<Self> {
        let unfit = || {
            Error::input(
                "scatter of the derivatives",
                "forces with filters of single motions",
                "others",
            )
        };
        let Some(Realization::Continuous(r)) = forces.realizable().map(Realizable::realize) else {
            return Err(unfit());
        };
        let mut c = r.c.clone();
        for (l, mut column) in c.column_iter_mut().enumerate() {
            let motion = driver(&r, l).ok_or_else(unfit)?;
            column.component_mul_assign(&factors.column(motion));
        }
        Ok(Self {
            dofs: forces.dofs().to_vec(),
            realization: Realization::Continuous(ContinuousRealization {
                c,
                e0: r.e0.component_mul(factors),
                e1: r.e1.component_mul(factors),
                e2: r.e2.component_mul(factors),
                ..r
            }),
        })
    }
}

/// The one motion that drives a filter.
fn driver(r: &ContinuousRealization, filter: usize) -> Option<usize> {
    let mut motions = (0..r.b.ncols()).filter(|j| r.b[(filter, *j)] != 0.0);
    motions.next().filter(|_| motions.next().is_none())
}

impl Transfer for Scaled {
    fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        self.realization.transfer(k)
    }

    fn realizable(&self) -> Option<&dyn Realizable> {
        Some(self)
    }
}

impl Realizable for Scaled {
    fn realize(&self) -> Realization {
        self.realization.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::bridge::BridgeFile;
    use crate::flutter::find_onset;

    /// Frequencies that scatter change the motion at flutter; what is followed is what a search finds.
    #[test]
    fn what_is_followed_is_what_a_search_finds() {
        let text = super::super::demo_bridge_text().replace("model = ", "# model = ");
        let file = BridgeFile::from_toml(&text, std::path::PathBuf::new()).unwrap();
        let study = BridgeStudy::new(file).unwrap();
        let search = study.search();
        let mean = coupled(&study.by_model).unwrap();
        let mean = find_onset("mean", &mean, &search, study.tested_range()).unwrap();
        let scatter = Scatter {
            frequency: 0.02,
            damping: 0.3,
            derivatives: DerivativeScatter::Measured,
            samples: 4,
            seed: 1,
        };
        let sampler = OnsetSampler {
            study: &study,
            scatter: &scatter,
            forces: study.drawn_forces(scatter.derivatives).unwrap(),
            scale: None,
            nearby: NearbyOnset::new(&study.by_model, &mean.onset().unwrap().at).unwrap(),
        };
        let mut searched = 0;
        for index in 0..scatter.samples as u64 {
            let speed = sampler
                .followed(index)
                .unwrap()
                .expect("a motion that is known again");
            let other = coupled(&sampler.sample(index, 1.0).unwrap()).unwrap();
            let all = other.at(speed).unwrap().eigenvalues().unwrap();
            assert!(
                all.iter().any(|l| l.im > 1.0 && l.re.abs() < 1e-9),
                "{index}"
            );
            let found = find_onset("sample", &other, &search, study.tested_range()).unwrap();
            let of_modes =
                find_onset_of_modes("sample", &other, &search, study.tested_range()).unwrap();
            assert_eq!(of_modes, found.critical_speed_m_s());
            // where the onset lies outside the tested range the search names the end of that instead
            if let Some(onset) = found.onset() {
                assert!((speed / onset.at.speed_m_s - 1.0).abs() < 1e-8, "{index}");
                searched += 1;
            }
        }
        assert!(searched >= 3, "{searched}");
    }
}
