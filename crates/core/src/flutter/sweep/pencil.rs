//! The determinant of the impedance at a fixed reduced frequency: a polynomial in `ω` with complex coefficients.
//!
//! With `V = ωB/K` and all rows and columns in units of the rotation, `D(ω) = −ω² A + iωR + K_s`, where
//! `A = M + ½ρB⁴/K² G(iK)` is a full complex matrix and `R`, `K_s` are diagonal. A static unbalance is an entry of `M`
//! beside the diagonal; `G` is about the axis of the section ([`Supports::at_axis`]).

use crate::error::Result;
use crate::flutter::dynamic_stiffness::newton;
use crate::section::{Dof, SectionModel, Suspension};
use crate::state_space::Complex64;

/// Newton steps to a root at most, and the relative size of the last.
const STEPS: usize = 8;
const TOLERANCE: f64 = 1e-6;

/// A supported section of `N` degrees of freedom, in units of the rotation (displacements over `B`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Supports<const N: usize> {
    pub(super) width: f64,
    pub(super) density: f64,
    pub(super) mass: [f64; N],
    pub(super) damping: [f64; N],
    pub(super) stiffness: [f64; N],
    /// Static unbalance, the entry of `M` that couples heave and rotation.
    pub(super) coupling: f64,
    /// Distance of the axis from the reference point of the forces over the width, positive downwind.
    pub(super) axis: f64,
}

impl<const N: usize> Supports<N> {
    /// One entry of the three matrices.
    pub(super) fn entry(&self, i: usize, j: usize) -> Suspension {
        match i.abs_diff(j) {
            0 => Suspension {
                mass: self.mass[i],
                damping: self.damping[i],
                stiffness: self.stiffness[i],
            },
            apart if apart == N - 1 => Suspension {
                mass: self.coupling,
                ..Suspension::default()
            },
            _ => Suspension::default(),
        }
    }

    /// `Tᵀ G T`: heave is the first degree of freedom, rotation the last.
    pub(super) fn at_axis(&self, mut g: [[Complex64; N]; N]) -> [[Complex64; N]; N] {
        if self.axis != 0.0 {
            for row in &mut g {
                row[N - 1] += row[0] * self.axis;
            }
            let lift = g[0];
            for (moment, lift) in g[N - 1].iter_mut().zip(lift) {
                *moment += lift * self.axis;
            }
        }
        g
    }
}

/// Coefficients of `det D(ω)` at one `K`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pencil<const N: usize> {
    diagonal: [Complex64; N],
    damping: [f64; N],
    stiffness: [f64; N],
    /// `A_ij A_ji` for the pairs (0, 1), (0, 2), (1, 2).
    pairs: [Complex64; 3],
    /// `A_01 A_12 A_20 + A_02 A_10 A_21`.
    rings: Complex64,
}

impl<const N: usize> Pencil<N> {
    /// At the reduced frequency `k`, with `g` about the axis.
    pub(super) fn new(s: &Supports<N>, k: f64, g: &[[Complex64; N]; N]) -> Self {
        let mut g = *g;
        let air = 0.5 * s.density * s.width * s.width * s.width * s.width / (k * k);
        // beside the diagonal mass and air stand together
        g[0][N - 1] += s.coupling / air;
        g[N - 1][0] += s.coupling / air;
        let zero = Complex64::new(0.0, 0.0);
        let mut diagonal = [zero; N];
        for i in 0..N {
            diagonal[i] = g[i][i] * air + s.mass[i];
        }
        let square = air * air;
        let mut pairs = [zero; 3];
        let mut rings = zero;
        if N >= 2 {
            pairs[0] = g[0][1] * g[1][0] * square;
        }
        if N == 3 {
            pairs[1] = g[0][2] * g[2][0] * square;
            pairs[2] = g[1][2] * g[2][1] * square;
            rings = (g[0][1] * g[1][2] * g[2][0] + g[0][2] * g[1][0] * g[2][1]) * (square * air);
        }
        Self {
            diagonal,
            damping: s.damping,
            stiffness: s.stiffness,
            pairs,
            rings,
        }
    }

    /// Frequencies of the degrees of freedom by themselves, the apparent mass included.
    pub(super) fn uncoupled(&self) -> [Complex64; N] {
        std::array::from_fn(|i| {
            let mass = self.diagonal[i].re;
            let omega = (self.stiffness[i] / mass).sqrt();
            Complex64::new(omega, self.damping[i] / (2.0 * mass))
        })
    }

    /// `det D(ω)` and its derivative.
    fn at(&self, omega: Complex64) -> (Complex64, Complex64) {
        let w = -omega * omega;
        let dw = omega * -2.0;
        let mut d = [Complex64::new(1.0, 0.0); 3];
        let mut dd = [Complex64::new(0.0, 0.0); 3];
        for i in 0..N {
            let (a, r, k) = (self.diagonal[i], self.damping[i], self.stiffness[i]);
            d[i] = w * a + Complex64::new(k - r * omega.im, r * omega.re);
            dd[i] = dw * a + Complex64::new(0.0, r);
        }
        let (w2, dw2) = (w * w, w * dw * 2.0);
        let mut value = d[0] * d[1] - w2 * self.pairs[0];
        let mut slope = dd[0] * d[1] + d[0] * dd[1] - dw2 * self.pairs[0];
        if N == 3 {
            let others = d[0] * self.pairs[2] + d[1] * self.pairs[1];
            let d_others = dd[0] * self.pairs[2] + dd[1] * self.pairs[1];
            slope = slope * d[2] + value * dd[2] - dw2 * others - w2 * d_others
                + w2 * dw * self.rings * 3.0;
            value = value * d[2] - w2 * others + w2 * w * self.rings;
        }
        (value, slope)
    }

    /// The root next to `start` by Newton's method; `None` when it does not settle.
    pub(super) fn root(&self, start: Complex64) -> Option<Complex64> {
        newton(start, STEPS, TOLERANCE, |omega| {
            let (value, slope) = self.at(omega);
            value / slope
        })
    }
}

/// Highest reduced frequency: still air.
const K_STILL: f64 = 1000.0;
/// Below this reduced frequency the roots move: nearly still air.
pub(super) const K_MAX: f64 = 10.0;
/// Points of the grid for a factor e of `K`, above and below that.
const POINTS_PER_E: (f64, f64) = (3.0, 10.0);

/// Reduced frequencies from still air down to `k_min`, with the ends of the tested range among them.
pub(super) fn grid(k_min: f64, ends: impl Iterator<Item = f64>) -> Vec<f64> {
    let part = |from: f64, to: f64, points_per_e: f64| {
        let steps = (points_per_e * (from / to).ln()).ceil();
        (0..steps as usize).map(move |i| from * (to / from).powf(i as f64 / steps))
    };
    let mut grid: Vec<f64> = part(K_STILL, K_MAX, POINTS_PER_E.0)
        .chain(part(K_MAX, k_min, POINTS_PER_E.1))
        .chain([k_min])
        .chain(ends.filter(|k| (k_min..K_STILL).contains(k)))
        .collect();
    grid.sort_by(|a, b| b.total_cmp(a));
    grid.dedup();
    grid
}

/// Mass, damping, stiffness of the supports in units of the rotation. Does not allocate for values that are right.
pub(super) fn supports<const N: usize>(section: &SectionModel) -> Result<Supports<N>> {
    let usual = section.supports()?;
    let square = section.width_m * section.width_m;
    let mut s = Supports {
        width: section.width_m,
        density: section.air_density_kg_m3,
        mass: [0.0; N],
        damping: [0.0; N],
        stiffness: [0.0; N],
        // the row of heave in units of the rotation
        coupling: section.width_m * section.static_coupling(),
        axis: section.axis_offset_m.unwrap_or(0.0) / section.width_m,
    };
    let mut used = 0;
    for (dof, support) in Dof::THREE.into_iter().zip(usual) {
        let (Some(support), true) = (support, used < N) else {
            continue;
        };
        let scale = if dof == Dof::Torsion { 1.0 } else { square };
        s.mass[used] = scale * support.mass;
        s.damping[used] = scale * support.damping;
        s.stiffness[used] = scale * support.stiffness;
        used += 1;
    }
    Ok(s)
}
