//! Lags of Roger's form.

use crate::error::{Error, Result, positive};
use serde::{Deserialize, Serialize};

/// Lags `d_l > 0`, dimensionless. In files a list of numbers, or a list of such lists.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "a list of lags, or one list for each force")]
pub enum Lags {
    /// The same for all forces.
    Shared(Vec<f64>),
    /// Those of each force, one list a row of `G`, all of one length: the `d_l^y` of (1.23a).
    PerForce(Vec<Vec<f64>>),
}

impl Lags {
    /// Number of lags of a force.
    pub fn count(&self) -> usize {
        match self {
            Self::Shared(lags) => lags.len(),
            Self::PerForce(rows) => rows.first().map_or(0, Vec::len),
        }
    }

    /// Lags of the force in row `i`; of the last row for an `i` beyond it.
    pub fn of_force(&self, i: usize) -> &[f64] {
        match self {
            Self::Shared(lags) => lags,
            Self::PerForce(rows) => rows.get(i).or(rows.last()).map_or(&[], Vec::as_slice),
        }
    }

    /// Checks that there is a list for each of `n` forces, and that lags are positive.
    ///
    /// # Errors
    /// [`Error::Input`] saying what does not fit.
    pub fn validate(&self, n: usize) -> Result<()> {
        const PLACE: &str = "rational model: lags";
        let lists = match self {
            Self::Shared(lags) => std::slice::from_ref(lags),
            Self::PerForce(rows) => {
                if rows.len() != n {
                    let found = rows.len().to_string();
                    return Err(Error::input(
                        PLACE,
                        format!("{n} lists, one a force"),
                        found,
                    ));
                }
                if rows.iter().any(|r| r.len() != rows[0].len()) {
                    return Err(Error::input(
                        PLACE,
                        "lists of one length",
                        "different lengths",
                    ));
                }
                rows
            }
        };
        for d in lists.iter().flatten() {
            positive(PLACE, *d)?;
        }
        Ok(())
    }
}
