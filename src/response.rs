//! Time response of the coupled section by exact steps.
