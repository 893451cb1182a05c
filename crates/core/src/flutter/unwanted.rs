//! Growth that a force model makes up: below the onset, at reduced frequencies at which nothing was tested.

use super::answer::FlutterSearch;
use super::critical::all_speeds_are_known;
use super::critical_point::OnsetMethod;
use super::growth_band::GrowthBand;
use super::scan::Scan;
use super::search::{OnsetSearch, find_onset};
use crate::aeroelastic::CoupledSection;
use crate::error::Result;
use crate::units::ReducedFrequencyRange;
use serde::{Deserialize, Serialize};

/// The scan goes this much beyond the onset, to see whether growth below goes on into the tested range.
const BEYOND: f64 = 1.02;
/// Relative distance below the onset from which on growth is not that of the onset itself.
const BELOW: f64 = 1e-6;

/// What a scan from nearly still air to the onset found.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct UnwantedGrowth {
    /// Force model, where there are several.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub model: String,
    /// The scan goes up to the onset, or to the highest speed where there is none, m/s.
    pub scanned_to_m_s: f64,
    /// Bands below it in which the section grows by extrapolation alone.
    pub bands: Vec<GrowthBand>,
    /// Whether all speeds were looked at, so that the bands are proved to be all of the model, and not a grid of speeds.
    pub proved: bool,
    /// Lowest speed of growth that goes on into the tested range, where that begins below, m/s.
    pub instability_from_m_s: Option<f64>,
}

/// Looks for growth below the onset of `section` that rests on no test: all of it at reduced frequencies outside
/// `tested`. Growth that goes on into the tested range is a property of the deck (a bluff one may be unstable from the
/// start) and is left to the search for the onset.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::aerodynamics::RationalModel;
/// use aerodeck::aeroelastic::CoupledSection;
/// use aerodeck::flutter::{OnsetSearch, unwanted_growth};
/// use aerodeck::section::SectionModel;
///
/// let structure = SectionModel::iabse_1_1a().structure()?;
/// let section = CoupledSection::with_model(&structure, &RationalModel::jones_flat_plate())?;
/// let growth = unwanted_growth(&section, &OnsetSearch::default(), None)?;
/// assert!(growth.is_none() && growth.proved);
/// # Ok::<(), aerodeck::Error>(())
/// ```
pub fn unwanted_growth(
    section: &CoupledSection,
    search: &OnsetSearch,
    tested: Option<ReducedFrequencyRange>,
) -> Result<UnwantedGrowth> {
    // a search that fails leaves the whole range to the scan
    let answer = find_onset(OnsetMethod::Eigenvalues.name(), section, search, tested).ok();
    unwanted_growth_below(answer.as_ref(), section, search, tested)
}

/// The same below the answer of [`find_onset`] for this section, where that is known.
///
/// # Errors
/// As [`unwanted_growth`].
pub fn unwanted_growth_below(
    answer: Option<&FlutterSearch>,
    section: &CoupledSection,
    search: &OnsetSearch,
    tested: Option<ReducedFrequencyRange>,
) -> Result<UnwantedGrowth> {
    let highest = search.speed_max_m_s;
    // the scan ends at the first speed, growth counts that begins below the second
    let (limit, below) = match answer.and_then(FlutterSearch::critical) {
        Some(at) if tested.is_some_and(|range| at.reduced_frequency > range.max) => {
            // no mode grows inside the tested range: the answer itself is made up
            (highest, at.speed_m_s * (1.0 + BELOW))
        }
        Some(at) if at.speed_m_s > 0.0 => (at.speed_m_s, at.speed_m_s * (1.0 - BELOW)),
        _ => (highest, highest),
    };
    let bands = Scan::new("", section, tested).bands(limit * BEYOND, false, below)?;
    let (bands, own): (Vec<_>, Vec<_>) = bands.into_iter().partition(GrowthBand::extrapolated);
    Ok(UnwantedGrowth {
        model: String::new(),
        scanned_to_m_s: limit,
        bands,
        proved: all_speeds_are_known(section),
        instability_from_m_s: own.iter().map(|band| band.from_m_s).reduce(f64::min),
    })
}

impl UnwantedGrowth {
    /// Whether there is none.
    pub fn is_none(&self) -> bool {
        self.bands.is_empty()
    }

    /// At which speeds, and why; without the full stop.
    pub fn explain(&self) -> String {
        if self.is_none() {
            let but = self.instability_from_m_s.map_or(String::new(), |from| {
                format!(" but that of the instability itself, which the model carries down to {from:.3} m/s")
            });
            let proved = match self.proved {
                true => ", proved for the model",
                false => "",
            };
            let to = self.scanned_to_m_s;
            return format!(
                "no growing oscillation from nearly still air to {to:.3} m/s{but}{proved}"
            );
        }
        let each: Vec<String> = self.bands.iter().map(GrowthBand::explain).collect();
        format!(
            "grows where it should not, below {:.3} m/s, since the fit feeds energy into motions at reduced frequencies \
             that were not tested: {}",
            self.scanned_to_m_s,
            each.join("; ")
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aerodynamics::{Lags, RationalModel, Realizable};
    use crate::section::SectionModel;
    use crate::units::ReducedFrequency;

    fn range(min: f64, max: f64) -> ReducedFrequencyRange {
        ReducedFrequencyRange::between(
            ReducedFrequency::from_full_width(min),
            ReducedFrequency::from_full_width(max),
        )
    }

    fn found(model: &RationalModel, tested: ReducedFrequencyRange) -> UnwantedGrowth {
        let structure = SectionModel::table_4_1().structure().unwrap();
        let section = CoupledSection::new(structure, model.realize()).unwrap();
        let search = OnsetSearch {
            speed_max_m_s: 80.0,
            speeds: 100,
        };
        unwanted_growth(&section, &search, Some(tested)).unwrap()
    }

    /// Heave is fed energy by `c p²/(p + d)`, which is small at tested K and beats the plate's damping above K 2.6.
    fn feeds_fast_heave() -> RationalModel {
        let (c, d) = (20.0, 6.0);
        let mut model = RationalModel::jones_flat_plate();
        model.a2[(0, 0)] += c;
        let mut lag = model.a2.clone() * 0.0;
        lag[(0, 0)] = -c * d;
        model.lag_terms.push(lag);
        model.lags = Lags::Shared(vec![0.091, 0.6, d]);
        model
    }

    #[test]
    fn a_plate_has_none_and_a_bad_extrapolation_is_named() {
        let tested = range(0.1, 1.5);
        let plate = found(&RationalModel::jones_flat_plate(), tested);
        assert!(plate.is_none(), "{}", plate.explain());
        assert_eq!(plate.instability_from_m_s, None);
        let text = plate.explain();
        assert!(
            text.starts_with("no growing oscillation from nearly still air to 3"),
            "{text}"
        );
        let bad = found(&feeds_fast_heave(), tested);
        assert!(!bad.is_none());
        let band = &bad.bands[0];
        // all of it at higher K than was tested, and far below the onset
        assert!(
            band.reduced_frequency.full_width() > 1.5,
            "{}",
            bad.explain()
        );
        assert!(band.to_m_s < 10.0, "{}", bad.explain());
        assert!(bad.explain().contains("grows where it should not"));
    }

    /// Tested beyond the K of the plate's flutter, the made-up growth is the only onset there is.
    #[test]
    fn growth_above_the_tests_is_unwanted_where_it_is_the_only_onset() {
        let structure = SectionModel::table_4_1().structure().unwrap();
        let model = feeds_fast_heave().realize();
        let section = CoupledSection::new(structure, model).unwrap();
        let search = OnsetSearch {
            speed_max_m_s: 10.0,
            speeds: 100,
        };
        let tested = range(0.1, 1.5);
        let answer = find_onset("", &section, &search, Some(tested)).unwrap();
        let onset = answer.critical().unwrap();
        assert!(onset.reduced_frequency > tested.max, "{answer:?}");
        let bad = unwanted_growth(&section, &search, Some(tested)).unwrap();
        assert!(!bad.is_none(), "{}", bad.explain());
        assert!((bad.scanned_to_m_s - 10.0).abs() < 1e-12);
        assert!(bad.bands[0].from_m_s <= onset.speed_m_s * (1.0 + BELOW));
    }

    /// Growth that comes into the tested range growing is the deck's; where the model starts it is said.
    #[test]
    fn an_instability_says_from_where_the_model_carries_it() {
        let own = found(&feeds_fast_heave(), range(0.1, 4.0));
        assert!(own.is_none(), "{}", own.explain());
        let from = own.instability_from_m_s.expect("growth below the answer");
        assert!(from < own.scanned_to_m_s, "{own:?}");
        assert!(own.explain().contains("but that of the instability itself"));
    }

    #[test]
    fn growth_inside_the_tested_range_is_the_decks_own() {
        let own = found(&feeds_fast_heave(), range(0.01, 500.0));
        assert!(own.is_none(), "{}", own.explain());
    }
}
