//! Orthonormal filter models: the thesis's discrete Laguerre model, and continuous Laguerre and
//! Takenaka–Malmquist filters with feed-through.

mod bank;
mod continuous;
mod discrete;
mod guidelines;

pub use bank::FilterBank;
pub use continuous::{FilterTerm, LaguerreModel};
pub use discrete::{DiscreteLaguerre, DiscreteTerm};
pub use discrete::{advance_filters, discrete_filter_matrices, impulse_response};
pub use guidelines::{alpha_lower_bound, discrete_memory};
