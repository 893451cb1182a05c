//! Second-order cones and their vectors: the product of Jordan's algebra, and the scaling in which slack and multiplier are one.

use nalgebra::DVector;

/// `(t, x, y)`.
pub(super) type Vector = [f64; 3];

/// Nesterov and Todd's scaling `W` with `W z = W⁻¹ s = λ`.
pub(super) struct Scaling {
    size: f64,
    w: Vector,
    pub lambda: Vector,
}

impl Scaling {
    pub(super) fn new(s: &Vector, z: &Vector) -> Option<Self> {
        let (of_s, of_z) = (determinant(s).sqrt(), determinant(z).sqrt());
        let s_bar = s.map(|x| x / of_s);
        let z_bar = z.map(|x| x / of_z);
        let half = (0.5 * (1.0 + dot(&s_bar, &z_bar))).sqrt();
        let z_bar = [z_bar[0], -z_bar[1], -z_bar[2]];
        let w: Vector = std::array::from_fn(|r| 0.5 * (s_bar[r] + z_bar[r]) / half);
        let mut scaling = Self {
            size: (of_s / of_z).sqrt(),
            w,
            lambda: [0.0; 3],
        };
        scaling.lambda = scaling.times(z);
        let finite = scaling.lambda.iter().chain(&w).all(|x| x.is_finite());
        (finite && scaling.size > 0.0).then_some(scaling)
    }

    /// `W v`.
    pub(super) fn times(&self, v: &Vector) -> Vector {
        reflect(&self.w, v).map(|x| x * self.size)
    }

    /// `W⁻¹ v`.
    pub(super) fn divide(&self, v: &Vector) -> Vector {
        let inverse = [self.w[0], -self.w[1], -self.w[2]];
        reflect(&inverse, v).map(|x| x / self.size)
    }
}

/// `[w₀ w₁ᵀ; w₁ I + w₁w₁ᵀ/(1 + w₀)] v`.
fn reflect(w: &Vector, v: &Vector) -> Vector {
    let along = w[1] * v[1] + w[2] * v[2];
    let share = v[0] + along / (1.0 + w[0]);
    [
        w[0] * v[0] + along,
        v[1] + w[1] * share,
        v[2] + w[2] * share,
    ]
}

pub(super) fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn tail(v: &Vector) -> f64 {
    (v[1] * v[1] + v[2] * v[2]).sqrt()
}

/// `t² − x² − y²`, without loss near the boundary.
pub(super) fn determinant(v: &Vector) -> f64 {
    let tail = tail(v);
    (v[0] - tail) * (v[0] + tail)
}

/// Jordan product.
pub(super) fn product(a: &Vector, b: &Vector) -> Vector {
    [
        dot(a, b),
        a[0] * b[1] + b[0] * a[1],
        a[0] * b[2] + b[0] * a[2],
    ]
}

/// The `q` with `product(a, q) = d`.
pub(super) fn quotient(a: &Vector, d: &Vector) -> Vector {
    let first = (a[0] * d[0] - a[1] * d[1] - a[2] * d[2]) / determinant(a);
    [
        first,
        (d[1] - first * a[1]) / a[0],
        (d[2] - first * a[2]) / a[0],
    ]
}

/// How many times `by` fits between `from` and the boundaries of the cones.
pub(super) fn reach(from: &[Vector], by: &[Vector]) -> f64 {
    let one = |(v, d): (&Vector, &Vector)| {
        let a = d[0] * d[0] - d[1] * d[1] - d[2] * d[2];
        let b = v[0] * d[0] - v[1] * d[1] - v[2] * d[2];
        let c = determinant(v);
        let under = b * b - a * c;
        let mut least = f64::INFINITY;
        if under >= 0.0 {
            // the roots of a x² + 2 b x + c, each without cancellation
            let q = -(b + under.sqrt().copysign(b));
            for root in [q / a, c / q] {
                if root > 0.0 && root < least {
                    least = root;
                }
            }
        }
        // the apex of the cone
        if d[0] < 0.0 {
            least = least.min(-v[0] / d[0]);
        }
        least
    };
    from.iter().zip(by).map(one).fold(f64::INFINITY, f64::min)
}

/// `bound − rows · w` is in the cone.
#[derive(Debug, Clone)]
pub(crate) struct Cone {
    pub(super) rows: Vec<DVector<f64>>,
    pub(super) bound: Vector,
}

impl Cone {
    /// `gradient · w ≤ bound`.
    pub(crate) fn half_space(gradient: DVector<f64>, bound: f64) -> Self {
        Self {
            rows: vec![gradient],
            bound: [bound, 0.0, 0.0],
        }
    }

    /// `Σ gradients w ⪯ bound` for the entries 11, 22, 12 of symmetric matrices of order two.
    pub(crate) fn matrix(gradients: [DVector<f64>; 3], bound: Vector) -> Self {
        let [one, two, across] = gradients;
        let root = std::f64::consts::FRAC_1_SQRT_2;
        Self {
            bound: [
                (bound[0] + bound[1]) * root,
                (bound[0] - bound[1]) * root,
                bound[2] / root,
            ],
            rows: vec![(&one + &two) * root, (one - two) * root, across / root],
        }
    }

    /// The same inequality with rows of the size of one.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self {
            rows: self.rows.iter().map(|r| r * factor).collect(),
            bound: self.bound.map(|b| b * factor),
        }
    }

    pub(super) fn size(&self) -> f64 {
        let squares = self.rows.iter().map(DVector::norm_squared);
        squares.sum::<f64>().sqrt()
    }
}
