//! Reliability against flutter: the distribution of the onset speed when section and forces are random.
//!
//! A [`MonteCarloPlan`] states distributions of numbers of the section (mass, frequency, damping, width, air density)
//! and the scatter of the coefficients of the force model, relative or by a covariance. [`monte_carlo`] draws samples
//! and finds the onset of each: its quantiles, a histogram, and the probability of an onset below a design speed with an
//! exact confidence interval. Samples without onset are counted, those that fail are named.

mod coefficients;
mod distribution;
mod plan;
mod results;
mod run;
mod sampler;
mod scatter;

pub use distribution::Distribution;
pub use plan::{
    AerodynamicScatter, Correlation, MAX_SAMPLES, MonteCarloPlan, RandomParameter, SectionProperty,
};
pub use results::{DesignCheck, FailedSample, Histogram, MonteCarloResult, Quantile, Tally};
pub use run::{many_onsets, monte_carlo, summarise, tally};
pub use scatter::DrawnForces;

#[cfg(test)]
mod tests;
