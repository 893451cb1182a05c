//! The 18 derivatives: their places in the transfer matrix, equation (1.17).

use crate::section::Dof;
use serde::{Deserialize, Serialize};

/// One of the 18 aerodynamic derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[allow(missing_docs)] // the names are the documentation
pub enum Derivative {
    P1,
    P2,
    P3,
    P4,
    P5,
    P6,
    H1,
    H2,
    H3,
    H4,
    H5,
    H6,
    A1,
    A2,
    A3,
    A4,
    A5,
    A6,
}

/// Which part of `G/K²` a derivative is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Part {
    /// In phase with the displacement.
    Real,
    /// In phase with the velocity.
    Imaginary,
}

impl Derivative {
    /// All 18, in the order of the NTNU workbooks: `P1` … `P6`, `H1` … `H6`, `A1` … `A6`.
    pub const ALL: [Derivative; 18] = {
        use Derivative::*;
        [
            P1, P2, P3, P4, P5, P6, H1, H2, H3, H4, H5, H6, A1, A2, A3, A4, A5, A6,
        ]
    };

    /// Name without the star: `H1`.
    pub fn name(self) -> &'static str {
        const NAMES: [&str; 18] = [
            "P1", "P2", "P3", "P4", "P5", "P6", "H1", "H2", "H3", "H4", "H5", "H6", "A1", "A2",
            "A3", "A4", "A5", "A6",
        ];
        NAMES[self as usize]
    }

    /// The force it belongs to (row of `G`): `P` drag, `H` lift, `A` moment.
    pub fn force(self) -> Dof {
        match self as usize / 6 {
            0 => Dof::Lateral,
            1 => Dof::Vertical,
            _ => Dof::Torsion,
        }
    }

    /// The motion that causes it (column of `G`).
    pub fn motion(self) -> Dof {
        self.motion_and_part().0
    }

    /// Which part of `G/K²` it is.
    pub fn part(self) -> Part {
        self.motion_and_part().1
    }

    /// The derivative that is `part` of the entry (`force`, `motion`) of `G/K²`.
    pub fn from_entry(force: Dof, motion: Dof, part: Part) -> Self {
        let matches = |d: &Self| (d.force(), d.motion(), d.part()) == (force, motion, part);
        // The 18 derivatives are all 3×3×2 combinations, so the fallback is never taken.
        Self::ALL.into_iter().find(matches).unwrap_or(Self::P1)
    }

    /// Rows of equation (1.17): `P` pairs (4, 1) with sway, (6, 5) with heave; `H` and `A` the other way round; (3, 2) with rotation.
    fn motion_and_part(self) -> (Dof, Part) {
        let sway_first = self.force() == Dof::Lateral;
        let (near, far) = if sway_first {
            (Dof::Lateral, Dof::Vertical)
        } else {
            (Dof::Vertical, Dof::Lateral)
        };
        match self as usize % 6 + 1 {
            1 => (near, Part::Imaginary),
            2 => (Dof::Torsion, Part::Imaginary),
            3 => (Dof::Torsion, Part::Real),
            4 => (near, Part::Real),
            5 => (far, Part::Imaginary),
            _ => (far, Part::Real),
        }
    }
}

read_by_name!(
    /// Reads `H1` or `H1*`, in either case, blanks around it ignored.
    Derivative,
    "name of a derivative",
    |text: &str| {
        let name = text.trim_end_matches('*');
        Self::ALL.into_iter().find(|d| d.name().eq_ignore_ascii_case(name))
    },
    "one of P1 to P6, H1 to H6, A1 to A6"
);

#[cfg(test)]
mod tests {
    use super::*;
    use Derivative::*;

    #[test]
    fn every_entry_of_equation_1_17_is_named_once() {
        // Rows x, y, θ and columns x, y, θ as printed: (imaginary, real).
        let printed = [
            [(P1, P4), (P5, P6), (P2, P3)],
            [(H5, H6), (H1, H4), (H2, H3)],
            [(A5, A6), (A1, A4), (A2, A3)],
        ];
        let order = [Dof::Lateral, Dof::Vertical, Dof::Torsion];
        for (force, row) in order.into_iter().zip(printed) {
            for (motion, (imaginary, real)) in order.into_iter().zip(row) {
                assert_eq!(
                    Derivative::from_entry(force, motion, Part::Imaginary),
                    imaginary
                );
                assert_eq!(Derivative::from_entry(force, motion, Part::Real), real);
            }
        }
    }

    #[test]
    fn names_round_trip() {
        for d in Derivative::ALL {
            assert_eq!(d.name().parse::<Derivative>().unwrap(), d);
            assert_eq!(
                format!(" {}* ", d.name().to_lowercase())
                    .parse::<Derivative>()
                    .unwrap(),
                d
            );
        }
        assert!(
            "H7".parse::<Derivative>()
                .unwrap_err()
                .to_string()
                .contains("H1 to H6")
        );
    }
}
