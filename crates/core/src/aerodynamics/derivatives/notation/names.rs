//! What each notation calls the 18 numbers.

use super::Notation;
use crate::aerodynamics::derivatives::{Derivative, Part};
use crate::error::{Error, Result};
use crate::section::Dof;

/// Rows `p`, `h`, `a` and, in each, columns in the order of [`Derivative::ALL`].
const POLIMI: [&str; 18] = [
    // P1 P4 belong to sway and P5 P6 to heave, p1 p4 to heave and p5 p6 to sway: (C.3) corrected
    "p5", "p2", "p3", "p6", "p1", "p4", "h1", "h2", "h3", "h4", "h5", "h6", "a1", "a2", "a3", "a4",
    "a5", "a6",
];

const STAROSSEK: [&str; 18] = [
    "c_pp_im", "c_pa_im", "c_pa_re", "c_pp_re", "c_ph_im", "c_ph_re", "c_hh_im", "c_ha_im",
    "c_ha_re", "c_hh_re", "c_hp_im", "c_hp_re", "c_ah_im", "c_aa_im", "c_aa_re", "c_ah_re",
    "c_ap_im", "c_ap_re",
];

impl Notation {
    /// Name of a number in this notation: `H1`, `h1`, `c_hh_im`. `derivative` is its place in the matrix: for drag,
    /// PoliMi's `p1` stands where Scanlan's `P5` does.
    pub fn name_of(self, derivative: Derivative) -> &'static str {
        match self {
            Self::Scanlan | Self::Simiu | Self::Classical => derivative.name(),
            Self::Polimi => POLIMI[derivative as usize],
            Self::Starossek => STAROSSEK[derivative as usize],
        }
    }

    /// The number of this name, with or without a star. Capitals count: `H1` and `h1` are different numbers.
    ///
    /// # Errors
    /// [`Error::Input`] with the names of the notation.
    pub fn derivative(self, name: &str) -> Result<Derivative> {
        let bare = name.trim().trim_end_matches('*');
        Derivative::ALL
            .into_iter()
            .find(|d| self.name_of(*d) == bare)
            .ok_or_else(|| {
                Error::input(
                    format!("name of a derivative in the notation {self}"),
                    self.names(),
                    format!("`{name}`"),
                )
            })
    }

    /// All names, in words.
    pub fn names(self) -> &'static str {
        match self {
            Self::Scanlan | Self::Simiu | Self::Classical => "one of P1 to P6, H1 to H6, A1 to A6",
            Self::Polimi => "one of p1 to p6, h1 to h6, a1 to a6",
            Self::Starossek => "c_mn_re or c_mn_im with m, n out of h, p, a",
        }
    }
}

/// Symbol of a number for people: `H₁*` would need a font, `H1*` does not.
pub(super) fn symbol(notation: Notation, derivative: Derivative) -> String {
    let name = notation.name_of(derivative);
    let greek = |dof: Dof| match dof {
        Dof::Vertical => 'h',
        Dof::Lateral => 'p',
        Dof::Torsion => 'α',
    };
    match notation {
        Notation::Starossek => {
            let (m, n) = (greek(derivative.force()), greek(derivative.motion()));
            let prime = match derivative.part() {
                Part::Real => "′",
                Part::Imaginary => "″",
            };
            format!("c{prime}_{m}{n}")
        }
        _ => format!("{name}*"),
    }
}
