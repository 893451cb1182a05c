//! The fit to the tests at each mean speed alone.

use super::coefficients::{CoefficientUncertainty, Coordinates, Parameter};
use super::design::Design;
use super::speeds;
use crate::error::Result;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};

impl CoefficientUncertainty {
    /// The fit to the tests at each mean speed alone, with the poles of the fit to all; empty for tests at one speed and
    /// for an estimate that was read from a file.
    ///
    /// The second value is why a speed alone does not tell.
    pub fn at_each_speed(&self) -> Vec<(f64, Result<Self>)> {
        let Some(design) = &self.design else {
            return Vec::new();
        };
        let Some((groups, speeds_m_s)) = speeds::speed_groups(design.blocks()) else {
            return Vec::new();
        };
        let alone = |(g, speed): (usize, f64)| (speed, self.alone(design, &groups, g));
        speeds_m_s.into_iter().enumerate().map(alone).collect()
    }

    /// Reduced frequencies of the blocks, where they have one and are known.
    pub fn tested_range(&self) -> Option<ReducedFrequencyRange> {
        let ks = self.design.as_ref()?.blocks().iter().filter_map(|b| b.k);
        ReducedFrequencyRange::spanning(ks.map(ReducedFrequency::from_full_width))
    }

    fn alone(&self, design: &Design, groups: &[usize], group: usize) -> Result<Self> {
        let mut coordinates = self.coordinates.clone();
        let mut kept = self.parameters.len();
        if let Coordinates::Continuous { searched, .. } = &mut coordinates {
            kept -= searched.len();
            searched.clear();
        }
        let (own, step) = design.alone(groups, group, kept)?;
        let moved = self
            .parameters
            .iter()
            .zip(step.iter())
            .map(|(p, d)| Parameter {
                value: p.value + d,
                ..p.clone()
            });
        Self::new(
            ("blocks of one mean speed".into(), None),
            self.dofs.clone(),
            coordinates,
            moved.collect(),
            own,
        )
    }
}
