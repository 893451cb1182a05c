//! Buffeting: the response of the coupled section to turbulence, in the frequency and in the time domain.
//!
//! Spectra are one-sided over frequency in Hz, `σ² = ∫₀^∞ S df`. The components `u` (along) and `w` (vertical) of the
//! turbulence are independent. Admittances multiply the amplitude of the gust force; spectra are multiplied by their
//! square modulus. Forces and motion are those of one section: full correlation along its length.

mod admittance;
mod frequency;
mod problem;
mod quadrature;
mod spectrum;
mod stability;
mod synthesis;
mod time;

pub use admittance::Admittance;
pub use frequency::{BuffetingResponse, buffeting_response, response_spectrum};
pub use problem::{BuffetingProblem, Gust, GustForces, Turbulence};
pub use spectrum::{GustComponent, GustSpectrum, SpectrumFormula, SpectrumShape};
pub use stability::unstable_roots;
pub use synthesis::{GustSample, synthesise};
pub use time::{ComponentComparison, Ensemble, TimePlan, compare, time_ensemble};
