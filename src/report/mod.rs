//! Figures and pages from result structs; nothing is computed here.
