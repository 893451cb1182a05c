//! What a deck itself answers: its onset by the determinant, and its forces at rest.

use super::{Deck, EXACT_RANGE};
use crate::aerodynamics::derivatives::{
    DerivativeTable, Extrapolation, InterpolatedTable, Interpolation,
};
use crate::aerodynamics::{FlatPlate, TransferMatrix};
use crate::error::Result;
use crate::flutter::{AssumedAtRest, FlutterSearch, OnsetInterval, determinant_onset, static_part};
use crate::section::Structure;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};

impl Deck {
    /// The forces on a section that is held, `G` at `K → 0` (n×n), and what a table does not say about them and was
    /// assumed.
    pub(crate) fn static_transfer(&self) -> Result<(TransferMatrix, Option<AssumedAtRest>)> {
        let (model, tested) = self.model()?;
        let Some(range) = tested else {
            let still = ReducedFrequency::from_full_width(0.0);
            return Ok((model.transfer(still)?, None));
        };
        let slopes = static_part(&self.dofs, &model.transfer(range.min)?);
        Ok((slopes, Some(AssumedAtRest::below(range.min)?)))
    }

    /// Onset of the deck itself by the determinant; for a table with the spread between ways of interpolation.
    pub(crate) fn own_onset(
        &self,
        structure: &Structure,
        speed_max_m_s: f64,
    ) -> Result<FlutterSearch> {
        match self.table() {
            Some(table) => {
                let by = self.interpolation;
                let mut search = self.table_onset(by, table, structure, speed_max_m_s)?;
                if let FlutterSearch::Onset(onset) = &mut search {
                    onset.interval = self.spread(table, structure, speed_max_m_s);
                }
                Ok(search)
            }
            None => {
                let range = ReducedFrequencyRange::between(
                    ReducedFrequency::from_full_width(EXACT_RANGE.0),
                    ReducedFrequency::from_full_width(EXACT_RANGE.1),
                );
                let mut search = determinant_onset(
                    &self.own_model_name(),
                    structure,
                    &FlatPlate::default(),
                    range,
                    speed_max_m_s,
                )?;
                if let FlutterSearch::Onset(onset) = &mut search {
                    // exact at every K: there is no tested range to leave
                    onset.in_tested_range = None;
                    onset.interval =
                        OnsetInterval::none("a closed formula, without data that scatter");
                }
                Ok(search)
            }
        }
    }

    fn table_onset(
        &self,
        by: Interpolation,
        table: &DerivativeTable,
        structure: &Structure,
        speed_max_m_s: f64,
    ) -> Result<FlutterSearch> {
        let model = InterpolatedTable::by(by, table, &self.dofs, Extrapolation::Refuse)?;
        let range = model.tested_range();
        let name = self.own_model_name();
        determinant_onset(&name, structure, &model, range, speed_max_m_s)
    }

    /// Onsets of the table by every way of interpolation, from the lowest to the highest.
    fn spread(
        &self,
        table: &DerivativeTable,
        structure: &Structure,
        speed_max_m_s: f64,
    ) -> OnsetInterval {
        let onset = |by: Interpolation| {
            let search = self.table_onset(by, table, structure, speed_max_m_s);
            search.ok()?.onset().map(|o| o.at.speed_m_s)
        };
        let onsets = Interpolation::ALL.map(|by| (by, onset(by)));
        let speeds = || onsets.iter().filter_map(|(_, speed)| *speed);
        let words = onsets.map(|(by, speed)| {
            let speed = speed.map_or("none within the table".to_owned(), |v| format!("{v:.3}"));
            format!("{} {speed}", by.title())
        });
        OnsetInterval::Spread {
            low_m_s: speeds().fold(f64::INFINITY, f64::min),
            high_m_s: speeds().fold(f64::NEG_INFINITY, f64::max),
            of: format!("spread between interpolations: {}", words.join(", ")),
        }
    }
}
