//! Orthonormal filter models: the thesis's discrete Laguerre model, and continuous Laguerre and
//! Takenaka–Malmquist filters with feed-through.

mod bank;
mod continuous;
mod discrete;

pub use bank::FilterBank;
pub use continuous::{FilterTerm, LaguerreModel};
pub use discrete::{
    DiscreteLaguerre, alpha_lower_bound, discrete_filter_matrices, impulse_response,
};
