//! Filters, resampling, correlation, harmonics of sampled signals: [`signal`].
#![deny(unsafe_code)]

use aerodeck_core::error;

pub mod signal;
