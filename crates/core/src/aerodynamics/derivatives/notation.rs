//! Notations of aerodynamic derivatives: which numbers a table holds, how they are scaled, which way the axes point.
//!
//! Inside the crate there is one convention, [`Convention::default`]; everything else exists in files only and is
//! converted at the border. All notations describe one matrix `G(K)` and differ, entry by entry, by a real factor
//! that depends on `K` alone, so a conversion keeps every test point and its own reduced velocity.
//!
//! | notation | force due to heave, velocity part | factor on Scanlan's derivative |
//! |---|---|---|
//! | Scanlan with ½; Simiu and Scanlan, h down | `½ρV²B · K H1* ẏ/V` | 1 and signs |
//! | classical, without ½ | `ρV²B · K H1* ḣ/V`, h down | ½ and signs |
//! | PoliMi | `½ρV²B · (−h1* ż/V)` | −K, K² or 2/π |
//! | Küssner/Starossek | `ω²πρb² · i c″_hh h`, h down | 2/π, 4/π, 8/π and signs |

mod convention;
mod expressed;

pub use convention::Convention;
pub use expressed::ExpressedPoint;
pub use expressed::{ExpressedDerivative, ExpressedTable};

use super::{Derivative, Part};
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::units::{ReducedFrequency, ReducedVelocity};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// A way of writing the 18 numbers of a deck.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Notation {
    /// Scanlan's derivatives with ½ρV² and K²: (1.15)–(1.17) of the thesis, (C.1) corrected. The crate's own.
    #[default]
    #[serde(alias = "wawi")]
    Scanlan,
    /// The same with h and lift down, over V/(fB): E. Simiu, R. H. Scanlan, *Wind Effects on Structures* (Wiley, 3rd ed. 1996).
    Simiu,
    /// Scanlan's derivatives as first published, with ρV² instead of ½ρV²: half as large, and usually h down
    /// (R. H. Scanlan, J. J. Tomko, J. Eng. Mech. Div. ASCE 97, 1971, and its extension to 18 numbers).
    Classical,
    /// Politecnico di Milano: `h`, `a`, `p` of (C.2) with V* = V/(fB) and the corrected (C.3).
    #[serde(alias = "zasso")]
    Polimi,
    /// Complex coefficients `c_mn` after H. G. Küssner as U. Starossek uses them (*Brückendynamik*, Vieweg 1992):
    /// `L = ω²πρb² (c_hh h + b c_hα α)`, `M = ω²πρb² (b c_αh h + b² c_αα α)` with the semi-chord `b = B/2`; sway `p` and
    /// drag are scaled like heave and lift.
    #[serde(alias = "kussner", alias = "kuessner", alias = "küssner")]
    Starossek,
}

impl Notation {
    /// All that differ in their numbers or names; [`Notation::Simiu`] is the first of them in other axes.
    pub const ALL: [Self; 4] = [
        Self::Scanlan,
        Self::Classical,
        Self::Polimi,
        Self::Starossek,
    ];

    /// All that have a word of their own.
    pub const NAMED: [Self; 5] = [
        Self::Scanlan,
        Self::Simiu,
        Self::Classical,
        Self::Polimi,
        Self::Starossek,
    ];

    /// Other words for it: a program, an author.
    pub fn aliases(self) -> &'static [&'static str] {
        match self {
            Self::Scanlan => &["wawi"],
            Self::Simiu | Self::Classical => &[],
            Self::Polimi => &["zasso"],
            Self::Starossek => &["kussner", "kuessner", "küssner"],
        }
    }

    /// Words for all notations, as messages list them.
    pub fn words() -> String {
        Self::NAMED.map(Self::name).join(", ")
    }

    /// The word for it in files, studies and commands.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scanlan => "scanlan",
            Self::Simiu => "simiu",
            Self::Classical => "classical",
            Self::Polimi => "polimi",
            Self::Starossek => "starossek",
        }
    }

    /// The notation for people.
    pub fn title(self) -> &'static str {
        match self {
            Self::Scanlan => "Scanlan with 1/2",
            Self::Simiu => "Simiu and Scanlan (Scanlan with 1/2, heave down)",
            Self::Classical => "classical (Scanlan without 1/2)",
            Self::Polimi => "PoliMi",
            Self::Starossek => "Küssner/Starossek",
        }
    }

    /// The definition, as it stands in the header of files: force per unit length due to harmonic motion `e^{iωt}`, `z`
    /// heave, `x` sway, `theta` rotation, in the axes stated beside it.
    pub fn definition(self) -> &'static str {
        match self {
            Self::Scanlan | Self::Simiu => {
                "with K = omega B/V: lift = (rho V^2 B/2) K^2 [(H4 + i H1) z/B + (H6 + i H5) x/B + (H3 + i H2) theta]; drag the same with (P6 + i P5) z/B + (P4 + i P1) x/B + (P3 + i P2) theta; moment = (rho V^2 B^2/2) K^2 [(A4 + i A1) z/B + (A6 + i A5) x/B + (A3 + i A2) theta]"
            }
            Self::Classical => {
                "with K = omega B/V: lift = (rho V^2 B) K^2 [(H4 + i H1) z/B + (H6 + i H5) x/B + (H3 + i H2) theta]; drag the same with (P6 + i P5) z/B + (P4 + i P1) x/B + (P3 + i P2) theta; moment = (rho V^2 B^2) K^2 [(A4 + i A1) z/B + (A6 + i A5) x/B + (A3 + i A2) theta]"
            }
            Self::Polimi => {
                "with V* = V/(f B): lift = (rho V^2 B/2) [-h1 z'/V - h2 B theta'/V + h3 theta + (2 pi^3/V*^2) h4 z/B - h5 x'/V + (2 pi^3/V*^2) h6 x/B], ' = d/dt; drag the same with p1 to p6; moment the same with a1 to a6 and rho V^2 B^2/2"
            }
            Self::Starossek => {
                "with b = B/2 and c = c_re + i c_im: lift = omega^2 pi rho b^2 (c_hh z + c_hp x + b c_ha theta); drag = omega^2 pi rho b^2 (c_ph z + c_pp x + b c_pa theta); moment = omega^2 pi rho b^2 (b c_ah z + b c_ap x + b^2 c_aa theta)"
            }
        }
    }

    /// What a value of Scanlan's with ½ is multiplied with to give the value in this notation, in the same axes.
    pub fn factor(self, derivative: Derivative, k: ReducedFrequency) -> f64 {
        let k = k.full_width();
        let turning = |dof: Dof| i32::from(dof == Dof::Torsion);
        match self {
            Self::Scanlan | Self::Simiu => 1.0,
            Self::Classical => 0.5,
            // (C.3), rows h and a as printed; −h1 ż/V stands for K H1 ż/V, h3 θ for K² H3 θ
            Self::Polimi => match (derivative.part(), derivative.motion()) {
                (Part::Imaginary, _) => -k,
                (Part::Real, Dof::Torsion) => k * k,
                (Part::Real, _) => 2.0 / PI,
            },
            // ½ρV²B K²/B = 2 ω²ρb², and a factor B/b = 2 more for every rotation or moment
            Self::Starossek => {
                let doublings = turning(derivative.force()) + turning(derivative.motion());
                2.0 / PI * 2f64.powi(doublings)
            }
        }
    }
}

read_by_name!(
    /// Reads the word for a notation, or another word for it.
    Notation,
    "notation",
    |text: &str| {
        let word = text.to_lowercase();
        let is_meant = |n: &Self| n.name() == word || n.aliases().contains(&word.as_str());
        Self::NAMED.into_iter().find(is_meant)
    },
    format!("one of {}", Self::words())
);

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
fn symbol(notation: Notation, derivative: Derivative) -> String {
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

/// Which way heave and lift point. Rotation and moment are nose-up (windward edge up), sway and drag downwind in both.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Axes {
    /// Heave and lift positive up. The crate's own.
    #[default]
    HeaveUp,
    /// Heave `h` and lift positive down.
    HeaveDown,
}

impl Axes {
    /// Both.
    pub const ALL: [Self; 2] = [Self::HeaveUp, Self::HeaveDown];

    /// The word for it in commands and studies.
    pub fn name(self) -> &'static str {
        match self {
            Self::HeaveUp => "heave_up",
            Self::HeaveDown => "heave_down",
        }
    }

    /// The axes in words, as in the header of files.
    pub fn words(self) -> &'static str {
        match self {
            Self::HeaveUp => {
                "heave and lift up, rotation and moment nose-up, sway and drag downwind"
            }
            Self::HeaveDown => {
                "heave and lift down, rotation and moment nose-up, sway and drag downwind"
            }
        }
    }

    /// −1 for a derivative that changes its sign when heave and lift are turned round: those that couple heave or lift
    /// with something else.
    pub fn sign(self, derivative: Derivative) -> f64 {
        let couples =
            (derivative.force() == Dof::Vertical) != (derivative.motion() == Dof::Vertical);
        if self == Self::HeaveDown && couples {
            -1.0
        } else {
            1.0
        }
    }
}

read_by_name!(
    /// Reads the word, or the axes in words.
    Axes,
    "axes",
    |text: &str| Self::ALL.into_iter().find(|a| a.name() == text || a.words() == text),
    "heave_up or heave_down"
);

/// Reduced velocity or reduced frequency of a test point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Argument {
    /// `V̂ = V/(ωB)`, as in the NTNU workbooks. The crate's own.
    #[default]
    VHat,
    /// `V* = V/(fB)`.
    VStar,
    /// `K = ωB/V`, full width.
    KFull,
    /// `k = ωb/V`, semi-chord `b = B/2`.
    KSemi,
}

impl Argument {
    /// All arguments.
    pub const ALL: [Self; 4] = [Self::VHat, Self::VStar, Self::KFull, Self::KSemi];

    /// The word for it in commands and studies, and the name of its column.
    pub fn name(self) -> &'static str {
        match self {
            Self::VHat => "v_hat",
            Self::VStar => "v_star",
            Self::KFull => "k_full",
            Self::KSemi => "k_semi",
        }
    }

    /// Name with definition, as it stands in the header of files.
    pub fn definition(self) -> &'static str {
        match self {
            Self::VHat => "v_hat = V/(omega B)",
            Self::VStar => "v_star = V/(f B)",
            Self::KFull => "k_full = omega B/V",
            Self::KSemi => "k_semi = omega b/V, b = B/2",
        }
    }

    /// Its value where the reduced velocity is `V̂`; `V̂` itself is kept bit for bit.
    pub fn at_v_hat(self, v_hat: f64) -> f64 {
        let k = ReducedFrequency::from_v_hat(v_hat);
        match self {
            Self::VHat => v_hat,
            Self::VStar => ReducedVelocity::from(k).v_star(),
            Self::KFull => k.full_width(),
            Self::KSemi => k.semi_chord(),
        }
    }

    /// The reduced velocity `V̂` at which it has this value.
    pub fn to_v_hat(self, value: f64) -> f64 {
        match self {
            Self::VHat => value,
            Self::VStar => ReducedFrequency::from(ReducedVelocity::new(value)).v_hat(),
            Self::KFull => ReducedFrequency::from_full_width(value).v_hat(),
            Self::KSemi => ReducedFrequency::from_semi_chord(value).v_hat(),
        }
    }
}

read_by_name!(
    /// Reads the word, alone or with its definition.
    Argument,
    "argument",
    |text: &str| Self::ALL.into_iter().find(|a| a.name() == text || a.definition() == text),
    format!("one of {}", Self::ALL.map(Self::definition).join("; "))
);
