//! All critical speeds of a section at once, without a grid.
//!
//! In dimensionless time `s = Vt/B` the coupled system has the state matrix `A(u)`, `u = B/V`, of rows `q: [0, I, 0]`,
//! `v: [E(u), D(u), C]`, `x: [b, 0, A]` with `E = E₀ + u² E₂` and `D = D₀ + u D₁` (stiffness and damping of the structure). Two
//! of its eigenvalues with the sum zero, a pair on the imaginary axis among them, mean that `A X + X Aᵀ = 0` has a solution
//! `X = −Xᵀ ≠ 0` (the bialternate sum is singular; Guckenheimer, Myers and Sturmfels, *Computing Hopf bifurcations I*, 1997):
//! a quadratic eigenvalue problem in `u`. Only the rows of `v` depend on `u`. The others give, block by block,
//!
//! ```text
//! S = X_vq symmetric,   X_vx = −(Q bᵀ + W Aᵀ),   A Z + Z Aᵀ = Wᵀ bᵀ − b W
//! ```
//!
//! with `Q = X_qq`, `W = X_qx`, `Z = X_xx`, so that what is left has the size `n(3n − 1)/2 + nF` instead of `N(N − 1)/2` for
//! `N = 2n + F` states: 17 for 45 with two motions and six filters.

use crate::aerodynamics::{ContinuousRealization, Realization};
use crate::aeroelastic::CoupledSection;
use crate::state_space::{Complex64, eigenvalues};
use nalgebra::{DMatrix, DVector};

/// Largest problem: beyond, a grid of speeds is quicker.
const LARGEST: usize = 72;
/// A solution counts as real when its imaginary part is at most this part of it: double ones come apart by the root of
/// rounding. One more speed to look at costs nothing, one that is missed may hide an onset.
const REAL: f64 = 1e-3;
/// `u` in units of the natural frequencies about which the problem is inverted; no wind has a negative one.
const SHIFT: f64 = -0.7;

/// The speeds (m/s, rising) at which the number of eigenvalues with a positive real part may change, all of them: those of pairs
/// on the imaginary axis, and of divergence, where one is zero; besides these such at which two real eigenvalues have the sum
/// zero, which mean nothing. `None` for sampled and large systems, and
/// where the force model is no stable filter.
pub(super) fn critical_speeds(section: &CoupledSection) -> Option<Vec<f64>> {
    let (system, size) = small(section)?;
    let [c0, c1, c2] = system.pencil(size)?;
    let at = (&c0 + &c1 * SHIFT + &c2 * (SHIFT * SHIFT)).lu();
    let slope = at.solve(&(&c1 + &c2 * (2.0 * SHIFT)))?;
    let bend = at.solve(&c2)?;
    // μ² C(σ) + μ C'(σ) + C₂ with u = σ + 1/μ
    let mut companion = DMatrix::zeros(2 * size, 2 * size);
    companion.view_mut((0, 0), (size, size)).copy_from(&-slope);
    let mut columns = companion.columns_mut(size, size);
    columns.rows_mut(0, size).copy_from(&-bend);
    let mut rows = companion.rows_mut(size, size);
    rows.columns_mut(0, size).fill_with_identity();
    // refused where a number of it is not finite
    let found = eigenvalues(&companion).ok()?.into_iter();
    let speeds = found
        .filter(|mu| mu.norm() > 0.0)
        .map(|mu| mu.inv() + SHIFT);
    let all = speeds.filter(is_positive).map(|u| u.re);
    let all = all.chain(system.at_rest()?);
    let mut speeds: Vec<f64> = all.map(|u| system.unit_m_s / u).collect();
    speeds.sort_by(f64::total_cmp);
    Some(speeds)
}

/// Whether [`critical_speeds`] finds them all.
pub(super) fn all_speeds_are_known(section: &CoupledSection) -> bool {
    small(section).is_some_and(|(system, _)| antisymmetric_lyapunov(&system.a).is_some())
}

/// The system, if its problem is not too large, and the size of that.
fn small(section: &CoupledSection) -> Option<(Dimensionless, usize)> {
    let Realization::Continuous(aero) = section.aerodynamics() else {
        return None;
    };
    let n = section.structure().dofs.len();
    let size = n * (3 * n - 1) / 2 + n * aero.a.nrows();
    let system = (size <= LARGEST).then(|| Dimensionless::new(section, aero));
    Some((system??, size))
}

/// The state matrix in dimensionless time and displacements, `u` in units of a natural frequency.
struct Dimensionless {
    /// Wind speed at `u = 1`, m/s.
    unit_m_s: f64,
    e0: DMatrix<f64>,
    e2: DMatrix<f64>,
    d0: DMatrix<f64>,
    d1: DMatrix<f64>,
    c: DMatrix<f64>,
    a: DMatrix<f64>,
    b: DMatrix<f64>,
}

impl Dimensionless {
    fn new(section: &CoupledSection, aero: &ContinuousRealization) -> Option<Self> {
        let s = section.structure();
        let (n, width) = (s.dofs.len(), s.width_m);
        let natural = s.still_air_rad_s().filter(|w| *w > 0.0);
        let (sum, count) = natural.fold((0.0, 0), |(sum, count), w| (sum + w.ln(), count + 1));
        let unit = (count > 0).then(|| (sum / f64::from(count)).exp())?;
        let scale = |i: usize| s.dofs[i].motion_scale(width);
        let of_motion = |physical: DMatrix<f64>| {
            let m = section.inverse_mass() * physical;
            DMatrix::from_fn(n, n, |i, j| m[(i, j)] * scale(i) / scale(j))
        };
        let air = 0.5 * s.air_density_kg_m3 * width * width;
        // ½ρB² diag(B, B, B²) C
        let force = section.inverse_mass() * section.force_of_filters(&aero.c, width);
        Some(Self {
            unit_m_s: unit * width,
            e0: of_motion(s.scaled(&aero.e0) * air),
            e2: of_motion(&s.stiffness / -(unit * unit)),
            d0: of_motion(s.scaled(&aero.e1) * air),
            d1: of_motion(&s.damping / -unit),
            c: DMatrix::from_fn(n, aero.a.nrows(), |i, j| force[(i, j)] * scale(i)),
            a: aero.a.clone(),
            b: aero.b.clone(),
        })
    }

    /// The `u` of divergence, at which the stiffness in steady wind is singular: `E₀ − C A⁻¹ b + u² E₂`.
    fn at_rest(&self) -> Option<impl Iterator<Item = f64>> {
        let steady = match self.a.is_empty() {
            true => self.e0.clone(),
            false => &self.e0 - &self.c * self.a.clone().lu().solve(&self.b)?,
        };
        let flexibility = self.e2.clone().try_inverse()?;
        let squares = eigenvalues(&(flexibility * -steady)).ok()?.into_iter();
        Some(squares.filter(is_positive).map(|z| z.re.sqrt()))
    }

    /// The matrices of 1, `u` and `u²`, rows scaled to unit size.
    fn pencil(&self, size: usize) -> Option<[DMatrix<f64>; 3]> {
        let filters = antisymmetric_lyapunov(&self.a)?;
        let mut pencil = [0; 3].map(|_| DMatrix::zeros(size, size));
        for j in 0..size {
            let unknowns = self.unit(j, &filters)?;
            for (power, matrix) in pencil.iter_mut().enumerate() {
                matrix.set_column(j, &self.equations(&unknowns, power, size));
            }
        }
        for i in 0..size {
            let mut rows = pencil.each_mut().map(|m| m.row_mut(i));
            let largest = rows.iter().map(|row| row.amax()).fold(0.0, f64::max);
            if largest > 0.0 {
                rows.iter_mut().for_each(|row| row.unscale_mut(largest));
            }
        }
        Some(pencil)
    }

    /// What `u` to this power multiplies in the rows of `v` of `A X + X Aᵀ`.
    fn equations(&self, x: &[DMatrix<f64>; 6], power: usize, size: usize) -> DVector<f64> {
        let ([q, s, t, w, y, z], (n, filters)) = (x, self.c.shape());
        let (mut vq, mut vx) = (DMatrix::zeros(n, n), DMatrix::zeros(n, filters));
        let mut vv = DMatrix::zeros(n, n);
        if let Some(e) = [Some(&self.e0), None, Some(&self.e2)][power] {
            vq += e * q;
            vx += e * w;
            vv -= e * s;
        }
        if let Some(d) = [Some(&self.d0), Some(&self.d1), None][power] {
            vq += d * s;
            vx += d * y;
            vv += d * t;
        }
        if power == 0 {
            vq += t - &self.c * w.transpose();
            vx += &self.c * z + s * self.b.transpose() + y * self.a.transpose();
            vv -= &self.c * y.transpose();
        }
        let below = pairs(n).map(|(i, j)| vv[(i, j)] - vv[(j, i)]);
        let all = vq.iter().chain(vx.iter()).copied().chain(below);
        DVector::from_iterator(size, all)
    }

    /// The blocks `[q, s, t, w, y, z]` of `X` of which only the free number `j` is 1: those of `q` and `t`, antisymmetric, of `s`,
    /// symmetric, and of `w` in turn; `y` and `z` follow from them.
    fn unit(&self, j: usize, filters: &Factors) -> Option<[DMatrix<f64>; 6]> {
        let (n, f) = self.c.shape();
        let [mut q, mut s, mut t] = [0; 3].map(|_| DMatrix::zeros(n, n));
        let mut w = DMatrix::zeros(n, f);
        let below: Vec<_> = pairs(n).collect();
        let (first, second) = (below.len(), 2 * below.len());
        let third = second + n * (n + 1) / 2;
        if j < second {
            let matrix = if j < first { &mut q } else { &mut t };
            let (row, column) = below[j % first];
            matrix[(row, column)] = 1.0;
            matrix[(column, row)] = -1.0;
        } else if j < third {
            let mut all = below.into_iter().chain((0..n).map(|i| (i, i)));
            let (row, column) = all.nth(j - second)?;
            s[(row, column)] = 1.0;
            s[(column, row)] = 1.0;
        } else {
            w[((j - third) % n, (j - third) / n)] = 1.0;
        }
        let y = -(&q * self.b.transpose() + &w * self.a.transpose());
        let product = &self.b * &w;
        let right = product.transpose() - product;
        let below = pairs(f).map(|place| right[place]);
        let mut solved = DVector::from_vec(below.collect());
        // factors of no rows solve nothing
        if !solved.is_empty() {
            solved = filters.solve(&solved)?;
        }
        let mut z = DMatrix::zeros(f, f);
        for ((i, j), value) in pairs(f).zip(solved.iter()) {
            z[(i, j)] = *value;
            z[(j, i)] = -value;
        }
        Some([q, s, t, w, y, z])
    }
}

/// Whether a number is real but for rounding, and positive.
fn is_positive(z: &Complex64) -> bool {
    z.re > 0.0 && z.im.abs() <= REAL * z.re
}

/// Places below the diagonal.
fn pairs(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(|i| (0..i).map(move |j| (i, j)))
}

type Factors = nalgebra::LU<f64, nalgebra::Dyn, nalgebra::Dyn>;

/// The factors of `A Z + Z Aᵀ = R` for antisymmetric `R` and `Z`, of which the numbers below the diagonal stand in the order of
/// [`pairs`]; `None` when two eigenvalues of `A` have the sum zero.
fn antisymmetric_lyapunov(a: &DMatrix<f64>) -> Option<Factors> {
    let places: Vec<_> = pairs(a.nrows()).collect();
    // (A Z + Z Aᵀ)_ij = Σ a_ik z_kj + a_jk z_ik
    let operator = DMatrix::from_fn(places.len(), places.len(), |row, column| {
        let ((i, j), (p, q)) = (places[row], places[column]);
        let left = |from: usize, to: usize| if j == to { a[(i, from)] } else { 0.0 };
        let right = |from: usize, to: usize| if i == from { a[(j, to)] } else { 0.0 };
        // z_pq = 1, z_qp = −1
        left(p, q) - left(q, p) + right(p, q) - right(q, p)
    });
    let factors = operator.lu();
    factors.is_invertible().then_some(factors)
}
