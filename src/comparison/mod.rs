//! Time-history comparison metrics.
