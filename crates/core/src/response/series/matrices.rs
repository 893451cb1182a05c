//! Matrices of the series, in scaled units.

use crate::aerodynamics::Realization;
use crate::aeroelastic::CoupledSection;
use nalgebra::DMatrix;

/// `[A₀; A₁]` on `[q̇, q]` and `[A₂; G]` on `[q, x]`, scaled.
pub(super) fn matrices(
    section: &CoupledSection,
    scale: &[f64],
    rate: f64,
) -> (DMatrix<f64>, DMatrix<f64>) {
    let s = section.structure();
    let n = scale.len();
    let inverse_mass = section.inverse_mass();
    let mut structure = DMatrix::zeros(2 * n, 2 * n);
    // accelerations by rates and by displacements, both in scaled units
    let by_rate = |m: DMatrix<f64>| DMatrix::from_fn(n, n, |i, j| m[(i, j)] * scale[i] / scale[j]);
    let by_motion = |m: DMatrix<f64>| by_rate(m) / rate;
    structure
        .view_mut((0, 0), (n, n))
        .copy_from(&by_rate(-(inverse_mass * &s.damping)));
    structure
        .view_mut((0, n), (n, n))
        .copy_from(&by_motion(-(inverse_mass * &s.stiffness)));
    let Realization::Continuous(c) = section.aerodynamics() else {
        return (structure, DMatrix::zeros(n, n));
    };
    let half_rho = 0.5 * s.air_density_kg_m3;
    structure.view_mut((n, 0), (n, n)).copy_from(&by_rate(
        inverse_mass * s.scaled(&c.e1) * (half_rho * s.width_m),
    ));
    let filters = c.a.nrows();
    let mut aerodynamic = DMatrix::zeros(n + filters, n + filters);
    aerodynamic
        .view_mut((0, 0), (n, n))
        .copy_from(&by_motion(inverse_mass * s.scaled(&c.e0) * half_rho));
    // at 1 m/s
    let by_filters = inverse_mass * section.force_of_filters(&c.c, 1.0);
    for (i, scale) in scale.iter().enumerate() {
        let row = by_filters.row(i) * (scale / rate);
        aerodynamic.view_mut((i, n), (1, filters)).copy_from(&row);
        let drive = s.dofs[i].motion_scale(s.width_m) / (s.width_m * scale);
        aerodynamic
            .view_mut((n, i), (filters, 1))
            .copy_from(&(c.b.column(i) * drive));
    }
    aerodynamic
        .view_mut((n, n), (filters, filters))
        .copy_from(&(&c.a / s.width_m));
    (structure, aerodynamic)
}
