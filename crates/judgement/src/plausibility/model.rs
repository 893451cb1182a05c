//! Models: whether their forces look like those of a deck. Data in another unit or of another sign leave a model that fits them well.

use super::{Finding, FindingKind, of_section, of_table};
use crate::aerodynamics::Transfer;
use crate::aerodynamics::derivatives::DerivativeTable;
use crate::aerodynamics::derivatives::notation::Convention;
use crate::section::SectionModel;
use crate::trained_model::TrainedModel;
use crate::units::ReducedFrequencyRange;
use std::f64::consts::TAU;

/// Reduced frequencies that are looked at.
const LOOKED_AT: i32 = 8;

/// What looks wrong in a section and in the forces of the model that it is coupled with.
pub fn of_trained(section: &SectionModel, model: &TrainedModel) -> Vec<Finding> {
    let of_forces = of_model(&model.name, &model.model, model.tested_range, &[]);
    [of_section(section), of_forces].concat()
}

/// What looks wrong in the forces of a model over the range in which they were `tested`, as in a table of them. Empty where the data
/// themselves are `known` to be odd in this way, and where the model does not answer.
pub fn of_model(
    name: &str,
    model: &dyn Transfer,
    tested: ReducedFrequencyRange,
    known: &[Finding],
) -> Vec<Finding> {
    if known.iter().any(|odd| odd.kind == FindingKind::Convention) {
        return Vec::new();
    }
    let (low, high) = (tested.min.full_width(), tested.max.full_width());
    let step = (high / low).powf(1.0 / f64::from(LOOKED_AT - 1));
    let mut frequencies: Vec<f64> = (0..LOOKED_AT).map(|i| low * step.powi(i) / TAU).collect();
    // tests of one frequency
    frequencies.dedup();
    // derivatives have no dimension: any width and speed do
    let table = DerivativeTable::sampled(name, model, 1.0, &[1.0], &frequencies);
    let found = table.map_or_else(|_| Vec::new(), |t| of_table(&t, &Convention::default()));
    let data = "unit and sign of forces and motion, width, wind speed and air density of the data that it was fitted to are to be \
         checked (nothing was changed)";
    let of_data = |odd: Finding| odd.otherwise(data.to_owned());
    found.into_iter().map(of_data).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aerodynamics::RationalModel;
    use crate::units::ReducedFrequency;

    /// Forces of a plate have no finding over many frequencies and at one; half of them and a thousandth have one, once.
    #[test]
    fn forces_in_another_unit_are_found() {
        let plate = RationalModel::jones_flat_plate();
        let k = ReducedFrequency::from_full_width;
        for (low, high) in [(0.07, 1.0), (0.4, 0.4)] {
            let tested = ReducedFrequencyRange::between(k(low), k(high));
            let found =
                |model: &RationalModel, known: &[Finding]| of_model("m", model, tested, known);
            assert_eq!(found(&plate, &[]), []);
            for factor in [0.5, 1e-3, -1.0] {
                let scaled = scaled(&plate, factor);
                let odd = found(&scaled, &[]);
                assert_eq!(odd.len(), 1, "{factor} {odd:?}");
                assert!(found(&scaled, &odd).is_empty());
            }
        }
    }

    fn scaled(model: &RationalModel, factor: f64) -> RationalModel {
        let mut scaled = model.clone();
        let terms = [&mut scaled.a1, &mut scaled.a2, &mut scaled.a3];
        terms
            .into_iter()
            .chain(&mut scaled.lag_terms)
            .for_each(|m| *m *= factor);
        scaled
    }
}
