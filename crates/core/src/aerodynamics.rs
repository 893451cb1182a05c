//! Linear models of the self-excited forces: all of them a transfer matrix `q̂(K) = G(K) r̂(K)`.
//!
//! `r` is the dimensionless motion (`y/B`, `x/B`, `θ`), `q` the dimensionless force (`F/(½ρV²B)`, `M/(½ρV²B²)`),
//! `K = ωB/V` the reduced frequency. Models that are more than a table also have a realisation in
//! dimensionless time `s = Vt/B`.

pub mod derivatives;
pub mod flat_plate;
mod gust;
mod gust_force;
pub mod laguerre;
pub mod quasi_steady;
pub mod rational;
mod realization;
mod spline;

pub use flat_plate::FlatPlate;
pub use gust::GustSeries;
pub(crate) use gust_force::LAGS;
pub use gust_force::{GustComponent, GustForce, RationalAdmittance};
pub use laguerre::{DiscreteLaguerre, FilterBank, FilterTerm, LaguerreModel};
pub use rational::{Lags, MinimumStateModel, RationalModel};
pub use realization::DiscreteRealization;
pub use realization::{ContinuousRealization, Realization};

use crate::error::{Place, Result, ensure};
use crate::section::Dof;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use nalgebra::{Complex, DMatrix};

/// `G(K)`, n×n, dimensionless.
pub type TransferMatrix = DMatrix<Complex<f64>>;

/// Refuses a matrix of a model of another size, or with a number that is not finite.
fn check_matrix(
    place: impl Into<Place>,
    m: &DMatrix<f64>,
    rows: usize,
    columns: usize,
) -> Result<()> {
    let holds = m.shape() == (rows, columns) && m.iter().all(|x| x.is_finite());
    let expected = format_args!("a finite {rows}x{columns} matrix");
    let (rows, columns) = m.shape();
    let found = format_args!("{rows}x{columns}, or a number that is not finite");
    ensure(holds, place, expected, found)
}

/// A linear model of the self-excited forces.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::{Transfer, TransferMatrix};
/// use aerodeck::section::Dof;
/// use aerodeck::units::ReducedFrequency;
/// use nalgebra::Complex;
///
/// /// A moment in phase with the rotation.
/// struct Steady;
///
/// impl Transfer for Steady {
///     fn dofs(&self) -> &[Dof] {
///         &[Dof::Torsion]
///     }
///
///     fn transfer(&self, _: ReducedFrequency) -> aerodeck::Result<TransferMatrix> {
///         Ok(TransferMatrix::from_element(1, 1, Complex::new(1.2, 0.0)))
///     }
/// }
///
/// assert!(Steady.realizable().is_none() && Steady.known_range().is_none());
/// ```
pub trait Transfer: Send + Sync {
    /// Degrees of freedom, in the order of rows and columns of [`Transfer::transfer`].
    fn dofs(&self) -> &[Dof];

    /// The transfer matrix `G(K)`.
    ///
    /// # Errors
    /// When the model does not say anything at this `K` (a table outside its range).
    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix>;

    /// Reduced frequencies to which the model's own statements are confined; `None` when it speaks at every `K`.
    ///
    /// A table knows nothing beyond its points. Outside this range it refuses or holds values, so that a mode can be
    /// followed; no answer may rest on what is held.
    fn known_range(&self) -> Option<ReducedFrequencyRange> {
        None
    }

    /// The model as one with a realisation; `None` when it is known only as a `G(K)`.
    fn realizable(&self) -> Option<&dyn Realizable> {
        None
    }
}

impl std::fmt::Debug for dyn Transfer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "forces of {:?}", self.dofs())
    }
}

/// A force model with a state-space realisation.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::{RationalModel, Realizable, Realization};
///
/// let plate = RationalModel::jones_flat_plate();
/// let Realization::Continuous(filters) = plate.realize() else { panic!() };
/// assert_eq!(filters.a.nrows(), 4); // two lags of two motions
/// ```
pub trait Realizable: Transfer {
    /// Its realisation in dimensionless time `s = Vt/B`; the frequency response is [`Transfer::transfer`].
    fn realize(&self) -> Realization;
}
