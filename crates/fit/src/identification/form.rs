//! The forms that a continuous model may have.

mod feed_through;

pub use feed_through::FeedThrough;

use crate::error::{Result, counted, ensure, positive};
use serde::{Deserialize, Serialize};

/// Fewest filters of a form that leaves their number to the data: those of the thesis.
pub const LEAST_CHOSEN: usize = 3;
/// Most filters of a form that leaves their number to the data. Constraints bend the fits of the embedded decks to 2.3 % above
/// the onset of their tables with three filters, to 1.5 % with five (four decks of two test speeds, two sections, two and
/// three motions; the fifth deck contradicts itself and stays within 3.5 %); more than five change nothing but the cost.
/// The relative error on speeds and frequencies that are left out cannot choose: it is least with three filters nearly
/// everywhere, by less than its own scatter.
pub const MOST_CHOSEN: usize = 5;

/// Form of a continuous model.
///
/// ```
/// # mod aerodeck { pub use aerodeck_fit::*; }
/// use aerodeck::identification::Form;
///
/// let form: Form = serde_json::from_str(r#"{ "kind": "rational", "lags": 2 }"#).expect("a form");
/// assert_eq!(form, Form::Rational { lags: 2, added_mass: true });
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Form {
    /// `e₀ + e₁ p + e₂ p² + Σ c_l Λ_l(p)` with one pole for all filters of a chain.
    Laguerre {
        /// Number of filters `L`; left out, as many as the data determine from [`LEAST_CHOSEN`] to [`MOST_CHOSEN`], and
        /// [`LEAST_CHOSEN`] without constraints; from records that move sway too no more than four.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        filters: Option<usize>,
        /// Feed-through terms.
        #[serde(default)]
        feed_through: FeedThrough,
        /// A pole for each transfer function instead of one for all.
        #[serde(default)]
        pole_per_transfer_function: bool,
    },
    /// The same with a pole for each filter.
    TakenakaMalmquist {
        /// Number of filters `L`.
        filters: usize,
        /// Feed-through terms.
        #[serde(default)]
        feed_through: FeedThrough,
        /// Poles for each transfer function instead of one set for all.
        #[serde(default)]
        pole_per_transfer_function: bool,
    },
    /// Roger's `a₁ + a₂ p + a₃ p² + Σ a_{l+3} p/(p + d_l)`.
    Rational {
        /// Number of lags.
        #[serde(default = "one")]
        lags: usize,
        /// Whether there is an `a₃`.
        #[serde(default = "yes")]
        added_mass: bool,
    },
    /// The same with lags of each force (row of `G`): the `d_l^y` of the thesis. For tables only.
    RationalPerForce {
        /// Number of lags of a force.
        #[serde(default = "one")]
        lags: usize,
        /// Whether there is an `a₃`.
        #[serde(default = "yes")]
        added_mass: bool,
    },
    /// Karpel's `a₁ + a₂ p + a₃ p² + D (pI − R)⁻¹ E p` with one state per lag. For tables only.
    MinimumState {
        /// Number of lag states.
        #[serde(default = "two")]
        states: usize,
        /// Whether there is an `a₃`.
        #[serde(default = "yes")]
        added_mass: bool,
    },
}

fn two() -> usize {
    2
}

fn one() -> usize {
    1
}

fn yes() -> bool {
    true
}

impl Default for Form {
    fn default() -> Self {
        Self::Laguerre {
            filters: None,
            feed_through: FeedThrough::default(),
            pole_per_transfer_function: false,
        }
    }
}

impl Form {
    /// So many filters with one pole for all transfer functions, and all feed-through terms.
    pub fn laguerre(filters: usize) -> Self {
        Self::Laguerre {
            filters: Some(filters),
            feed_through: FeedThrough::default(),
            pole_per_transfer_function: false,
        }
    }

    /// The same with a pole for each filter.
    pub fn takenaka_malmquist(filters: usize) -> Self {
        Self::TakenakaMalmquist {
            filters,
            feed_through: FeedThrough::default(),
            pole_per_transfer_function: false,
        }
    }

    /// Number of filters or lags.
    pub(crate) fn filters(&self) -> usize {
        match self {
            Self::Laguerre { filters, .. } => filters.unwrap_or(LEAST_CHOSEN),
            Self::TakenakaMalmquist { filters, .. } => *filters,
            Self::Rational { lags, .. } | Self::RationalPerForce { lags, .. } => *lags,
            Self::MinimumState { states, .. } => *states,
        }
    }

    /// Feed-through terms.
    pub fn feed_through(&self) -> FeedThrough {
        match self {
            Self::Laguerre { feed_through, .. } | Self::TakenakaMalmquist { feed_through, .. } => {
                *feed_through
            }
            Self::Rational { added_mass, .. }
            | Self::RationalPerForce { added_mass, .. }
            | Self::MinimumState { added_mass, .. } => FeedThrough {
                e2: *added_mass,
                ..FeedThrough::default()
            },
        }
    }

    /// Whether the poles are those of lag terms instead of filters.
    pub(crate) fn has_lags(&self) -> bool {
        !matches!(self, Self::Laguerre { .. } | Self::TakenakaMalmquist { .. })
    }

    /// How many numbers a search of the poles has to find.
    pub(crate) fn free_poles(&self) -> usize {
        match self {
            Self::Laguerre { .. } => 1,
            _ => self.filters(),
        }
    }

    /// Lower bound of a search over the lowest tested `K`. Several filters of one pole below all tests can follow nothing there but scatter,
    /// which they carry on into forces of steady flow that no deck has.
    pub(crate) fn least_pole(&self) -> f64 {
        match self {
            Self::Laguerre { .. } if self.filters() >= LEAST_CHOSEN => 1.0,
            _ => 0.5,
        }
    }

    /// Whether every transfer function has poles of its own.
    pub(crate) fn pole_per_transfer_function(&self) -> bool {
        match self {
            Self::Laguerre {
                pole_per_transfer_function,
                ..
            }
            | Self::TakenakaMalmquist {
                pole_per_transfer_function,
                ..
            } => *pole_per_transfer_function,
            _ => false,
        }
    }

    /// One pole per filter from the free ones.
    pub(crate) fn expand(&self, free: &[f64]) -> Vec<f64> {
        match self {
            Self::Laguerre { .. } => vec![free[0]; self.filters()],
            _ => free.to_vec(),
        }
    }

    /// The free poles from one pole per filter.
    pub(crate) fn collapse(&self, chain: &[f64]) -> Vec<f64> {
        match self {
            Self::Laguerre { .. } => chain.iter().take(1).copied().collect(),
            _ => chain.to_vec(),
        }
    }

    /// A chain of poles with one of its free ones at another value.
    pub(crate) fn with_pole(&self, chain: &[f64], index: usize, value: f64) -> Vec<f64> {
        let mut moved = chain.to_vec();
        match self {
            Self::Laguerre { .. } => moved.fill(value),
            _ => moved[index] = value,
        }
        moved
    }

    /// The form in words.
    pub fn describe(&self) -> String {
        let feed = self.feed_through();
        let own = match self.pole_per_transfer_function() {
            true => ", poles per transfer function",
            false => "",
        };
        let terms: Vec<_> = feed.orders().map(|o| format!("e{o}")).collect();
        let with = match terms.is_empty() {
            true => "no feed-through".into(),
            false => terms.join(" "),
        };
        match self {
            Self::Laguerre { filters, .. } => {
                let count = filters.map_or("chosen".to_owned(), |l| l.to_string());
                format!("continuous Laguerre, L = {count}, {with}{own}")
            }
            Self::TakenakaMalmquist { filters, .. } => {
                format!("Takenaka–Malmquist, L = {filters}, {with}{own}")
            }
            _ => {
                let (kind, whose) = match self {
                    Self::RationalPerForce { .. } => ("rational functions", " of each force"),
                    Self::MinimumState { .. } => ("minimum-state rational functions", ""),
                    _ => ("rational functions", ""),
                };
                let with = if feed.e2 { "with" } else { "without" };
                let count = counted(self.filters(), "lag");
                format!("{kind}, {count}{whose}, {with} added mass")
            }
        }
    }

    /// The same with another number of filters; `None` for rational functions, whose lags are common to all entries.
    pub(crate) fn with_filters(&self, count: usize) -> Option<Self> {
        let mut form = self.clone();
        match &mut form {
            Self::Laguerre { filters, .. } => *filters = Some(count),
            Self::TakenakaMalmquist { filters, .. } => *filters = count,
            _ => return None,
        }
        Some(form)
    }

    /// Whether the number of filters is left to the data.
    pub(super) fn is_open(&self) -> bool {
        matches!(self, Self::Laguerre { filters: None, .. })
    }

    /// The form with a number of filters that `rows` rows of the least-squares problem of one transfer function determine:
    /// two rows to judge each coefficient by, and no more than `most`. Only filters that are common to all have one number.
    pub(crate) fn for_rows(&self, rows: usize, most: usize) -> Self {
        if !self.is_open() {
            return self.clone();
        }
        let most = match self.pole_per_transfer_function() {
            true => LEAST_CHOSEN,
            false => most,
        };
        let determined = (rows / 2).saturating_sub(self.feed_through().count());
        let filters = determined.clamp(LEAST_CHOSEN, most);
        self.with_filters(filters).unwrap_or_default()
    }

    pub(crate) fn validate(&self) -> Result<()> {
        number_of_filters("form.filters (or form.lags)", self.filters())
    }

    /// Whether every force has poles of its own.
    pub(crate) fn poles_per_force(&self) -> bool {
        matches!(self, Self::RationalPerForce { .. })
    }

    /// Whether it is fitted to tables only.
    pub(super) fn is_of_tables(&self) -> bool {
        self.poles_per_force() || matches!(self, Self::MinimumState { .. })
    }

    /// Checks the form for a fit to records.
    pub(super) fn validate_for_records(&self) -> Result<()> {
        ensure(
            !self.is_of_tables(),
            "form.kind",
            "laguerre, takenaka_malmquist or rational for a fit to records",
            format_args!("{}, which is fitted to tables", self.describe()),
        )?;
        self.validate()
    }
}

/// Where the poles (lags) come from: fixed, or searched for within bounds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PoleSearch {
    /// Poles to be used as they are; one for Laguerre filters, else one per filter. For lags of each force either one list
    /// for all of them, or the lists of the forces one after the other.
    pub fixed: Option<Vec<f64>>,
    /// Where the nonlinear step starts; left out, the best point of a grid.
    pub start: Option<Vec<f64>>,
    /// Lower bound; left out, half the lowest tested `K`, and the lowest itself for three Laguerre filters or more, which share a pole.
    pub min: Option<f64>,
    /// Upper bound; left out, twice the highest tested `K`.
    pub max: Option<f64>,
    /// Least ratio of neighbouring poles when there are several: closer ones have nearly equal columns, whose
    /// coefficients grow and cancel.
    pub min_ratio: f64,
    /// Points of the first, logarithmic grid (one pole; fewer an axis for several).
    pub grid_points: usize,
}

impl Default for PoleSearch {
    fn default() -> Self {
        Self {
            fixed: None,
            start: None,
            min: None,
            max: None,
            min_ratio: 1.5,
            grid_points: 41,
        }
    }
}

impl PoleSearch {
    /// No search: these poles.
    pub fn fixed(poles: &[f64]) -> Self {
        Self {
            fixed: Some(poles.to_vec()),
            ..Self::default()
        }
    }

    pub(crate) fn validate(&self, form: &Form) -> Result<()> {
        for (key, list) in [("fixed", &self.fixed), ("start", &self.start)] {
            let Some(list) = list else { continue };
            let place = format_args!("poles.{key}");
            let (count, one) = (list.len(), form.free_poles());
            let several = key == "fixed" && form.poles_per_force();
            let fits = count == one || several && count > 0 && count.is_multiple_of(one);
            let expected = format!("{} for {}", counted(one, "number"), form.describe());
            ensure(fits, place, expected, count)?;
            for p in list {
                positive(place, *p)?;
            }
        }
        for (key, bound) in [("poles.min", self.min), ("poles.max", self.max)] {
            if let Some(bound) = bound {
                positive(key, bound)?;
            }
        }
        if let (Some(min), Some(max)) = (self.min, self.max) {
            ensure(min < max, "poles.max", "more than poles.min", max)?;
        }
        let (ratio, points) = (self.min_ratio, self.grid_points);
        let apart = ratio > 1.0 && ratio.is_finite();
        ensure(apart, "poles.min_ratio", "more than 1", ratio)?;
        ensure(points >= 5, "poles.grid_points", "at least 5", points)
    }
}

/// Filters or lags of one chain at most: ten times what any measured deck supports, and still fitted in seconds.
const MOST_FILTERS: usize = 100;

/// Checks a number of filters or lags.
///
/// # Errors
/// [`Error::Input`](crate::error::Error::Input) naming `place` for none, and for more than any data could support.
pub(crate) fn number_of_filters(place: &str, count: usize) -> Result<()> {
    let expected = match count {
        0 => "at least 1".to_owned(),
        _ => format!("at most {MOST_FILTERS}"),
    };
    ensure((1..=MOST_FILTERS).contains(&count), place, expected, count)
}
