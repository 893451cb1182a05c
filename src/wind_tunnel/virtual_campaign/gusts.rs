//! Simple coloured gusts.

use super::plan::Turbulence;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Downwind and vertical gust over the mean speed, one a sample.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Gusts {
    pub u: Vec<f64>,
    pub w: Vec<f64>,
}

impl Gusts {
    /// A first-order process in each direction: variance `I²`, correlation `exp(−V τ/length)`, hence a spectrum that is
    /// flat below `V/(2π length)` Hz and falls as `f⁻²` above. None without turbulence.
    pub fn new(
        turbulence: Option<&Turbulence>,
        samples: usize,
        travelled_m_a_sample: f64,
        random: &mut ChaCha8Rng,
    ) -> Self {
        let Some(t) = turbulence else {
            return Self {
                u: vec![0.0; samples],
                w: vec![0.0; samples],
            };
        };
        let kept = (-travelled_m_a_sample / t.length_m).exp();
        let drive = (1.0 - kept * kept).sqrt();
        let mut process = |intensity: f64| {
            let mut value: f64 = StandardNormal.sample(random);
            (0..samples)
                .map(|_| {
                    let now = intensity * value;
                    let new: f64 = StandardNormal.sample(random);
                    value = kept * value + drive * new;
                    now
                })
                .collect()
        };
        Self {
            u: process(t.intensity_u),
            w: process(t.intensity_w),
        }
    }
}
