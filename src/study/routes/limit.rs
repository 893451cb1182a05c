//! Forces in slow motion, as affine functions of `iK`: the limit of a model, and the flat plate without lag.

use super::super::SpeedRange;
use crate::aerodynamics::{RationalModel, Transfer};
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::flutter::find_onset;
use crate::section::Structure;
use crate::units::ReducedFrequency;
use nalgebra::DMatrix;

/// `G ≈ Re G(K) + iK · Im G(K)/K` at a low `K`: affine in `iK`, the form of quasi-steady theory.
pub(super) fn low_frequency_limit(
    model: &dyn Transfer,
    k: ReducedFrequency,
) -> Result<RationalModel> {
    let g = model.transfer(k)?;
    let (a1, a2) = (g.map(|z| z.re), g.map(|z| z.im / k.full_width()));
    Ok(RationalModel::without_lags(model.dofs(), a1, a2))
}

/// The flat plate with `C = 1` and without apparent mass; its own limit has a logarithm in `K`.
pub(super) fn steady_flat_plate() -> RationalModel {
    let plate = RationalModel::jones_flat_plate();
    let (pi, quarter) = (std::f64::consts::PI, 0.25);
    // the part of the rates that is apparent mass, and what the circulation gives at once
    let rates = [
        -2.0 * pi,
        pi / 2.0 + 2.0 * pi * quarter,
        -pi / 2.0,
        -pi / 8.0 + pi / 2.0 * quarter,
    ];
    RationalModel::without_lags(&plate.dofs, plate.a1, DMatrix::from_row_slice(2, 2, &rates))
}

/// Onset of an affine model, m/s.
pub(super) fn limit_onset(
    speeds: &SpeedRange,
    structure: &Structure,
    limit: &RationalModel,
) -> Result<Option<f64>> {
    let section = CoupledSection::with_model(structure, limit)?;
    let found = find_onset("", &section, &speeds.search(), None)?;
    Ok(found.onset().map(|o| o.at.speed_m_s))
}
