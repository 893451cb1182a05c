//! Flutter: tracked modes over wind speed, onset, divergence.
