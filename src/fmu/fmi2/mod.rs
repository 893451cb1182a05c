//! The FMI 2.0 shell around the neutral instance: C types, exports, guard, logger.
