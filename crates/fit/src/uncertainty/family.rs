//! Are the answers right? A family of synthetic decks whose truth is known, each tested and judged once.
//!
//! The truth of a deck is R. T. Jones's rational function, scaled and perturbed, with one or two lags of its own and for half of the
//! decks another that feeds torsion in slow motion; its tests lie around the `K` of its onset, at its edge, with a gap about it,
//! above it or below it.

mod deck;

pub use deck::{FamilyPlan, FamilyRange};

use super::coverage::IntervalCoverage;
use super::forms::FormEnsemble;
use super::model::interval_with_forms;
use super::onset::{onset_error, speed_and_omega};
use super::table_covariance::table_uncertainty;
use crate::aeroelastic::CoupledSection;
use crate::error::{Result, ensure};
use crate::flutter::{FlutterSearch, OnsetInterval, OnsetSearch, find_onset};
use crate::identification::{Fitted, FrequencyFit, fit_table};
use crate::numbered::{OnDone, numbered};
use deck::{SEARCHED, SyntheticDeck};
use serde::Serialize;

/// Decks of a family at most: more are days.
const MOST_DECKS: usize = 1_000_000;
/// Required speeds over the true onset with which a deck is asked whether it meets them.
const REQUIRED: [f64; 8] = [0.6, 0.7, 0.8, 0.9, 1.02, 1.1, 1.25, 1.5];

/// What the program says of one deck.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct DeckOutcome {
    /// Number of the deck.
    pub deck: usize,
    /// Where its tests lie.
    pub range: FamilyRange,
    /// Number of motions.
    pub motions: usize,
    /// True onset, m/s.
    pub truth_m_s: f64,
    /// The interval that was stated, m/s.
    pub interval_m_s: Option<(f64, f64)>,
    /// The onset of the model, m/s.
    pub onset_m_s: Option<f64>,
    /// Standard errors by scatter and by form, m/s.
    pub parts_m_s: Option<(f64, f64)>,
    /// The speed up to which it said that there is no flutter, m/s.
    pub no_flutter_up_to_m_s: Option<f64>,
    /// Why neither was said.
    pub refused: Option<String>,
    /// Required speeds above the true onset that it said to be met, over the true onset.
    pub met_above_truth: Vec<f64>,
    /// Required speeds below the true onset that it said to be met.
    pub met_below_truth: usize,
}

/// Outcomes of the decks whose tests lie alike.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RangeCount {
    /// Where the tests lie.
    pub range: FamilyRange,
    /// Number of decks.
    pub decks: usize,
    /// Onsets stated with an interval, and how many hold the truth.
    pub held: IntervalCoverage,
    /// Answers that no onset lies below a speed that was tested, all right.
    pub no_flutter: usize,
    /// Refusals.
    pub refused: usize,
    /// Answers "no flutter" up to a speed above the true onset.
    pub false_no_flutter: usize,
    /// Intervals wholly above the true onset.
    pub unsafe_side: usize,
    /// Required speeds above the true onset that were said to be met.
    pub met_against_truth: usize,
    /// Median half width of the stated intervals, percent of the onset.
    pub median_half_width_percent: Option<f64>,
    /// Root mean square of the errors of stated onsets over their standard errors: one where those are right.
    pub error_over_standard_error: Option<f64>,
}

/// What the family came to.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FamilyReport {
    /// The family.
    pub plan: FamilyPlan,
    /// Counts by range, then of all.
    pub ranges: Vec<RangeCount>,
    /// Every deck.
    pub decks: Vec<DeckOutcome>,
}

/// Makes, tests and judges every deck, in parallel; the same for any number of threads.
///
/// # Errors
/// [`Error::Input`](crate::error::Error::Input) for a family without decks; [`Error::Numerical`](crate::error::Error::Numerical) when no deck that flutters can be drawn.
pub fn family_coverage(plan: &FamilyPlan, progress: OnDone<'_>) -> Result<FamilyReport> {
    ensure(
        (1..=MOST_DECKS).contains(&plan.decks),
        "decks",
        format_args!("1 to {MOST_DECKS}"),
        plan.decks,
    )?;
    let decks = numbered(plan.decks, progress, |number| {
        Ok(judged(number, &SyntheticDeck::draw(plan, number)?))
    })?;
    let ranges = FamilyRange::ALL.into_iter().chain([FamilyRange::All]);
    let counts = ranges.filter_map(|range| RangeCount::count(range, &decks));
    Ok(FamilyReport {
        plan: *plan,
        ranges: counts.collect(),
        decks,
    })
}

/// The answer of the program, as `study` gives it: a failure is a refusal.
fn judged(number: usize, deck: &SyntheticDeck) -> DeckOutcome {
    let mut outcome = DeckOutcome {
        deck: number,
        range: deck.range,
        motions: deck.dofs.len(),
        truth_m_s: deck.truth_m_s,
        ..DeckOutcome::default()
    };
    if let Err(error) = outcome.answer(deck) {
        outcome.refused = Some(error.to_string());
    }
    outcome
}

impl DeckOutcome {
    fn answer(&mut self, deck: &SyntheticDeck) -> Result<()> {
        let (samples, dofs, fit) = (&deck.samples, &deck.dofs, FrequencyFit::default());
        let search = OnsetSearch::up_to(SEARCHED * deck.truth_m_s);
        let Fitted { model, report } = fit_table(samples, dofs, &fit)?;
        let section = CoupledSection::with_model(&deck.structure, &model)?;
        let found = find_onset("", &section, &search, Some(report.tested_range))?;
        let spread =
            FormEnsemble::new(samples, dofs, &|_| None)?.spread(&deck.structure, &search)?;
        match found {
            FlutterSearch::Onset(onset) => {
                let estimate = table_uncertainty(samples, dofs, &fit, &report, None)?;
                let error = onset_error(&estimate, &deck.structure, speed_and_omega(&onset), None)?;
                self.onset_m_s = Some(onset.at.speed_m_s);
                let interval = interval_with_forms(&error, &[spread]);
                let parts = interval.by_error().map(|error| error.parts);
                self.parts_m_s = parts.map(|p| (p.scatter_m_s, p.form_m_s.unwrap_or(0.0)));
                match interval {
                    OnsetInterval::Known(error) => {
                        self.interval_m_s = Some((error.low_m_s, error.high_m_s));
                        if onset.in_tested_range == Some(true) {
                            self.meet(error.low_m_s);
                        }
                    }
                    other => self.refused = other.reason().map(str::to_owned),
                }
            }
            FlutterSearch::UnstableAtOrBelow(start) => self.refused = Some(start.explain()),
            FlutterSearch::StableUpTo(range) => match spread.lowest_onset_m_s() {
                Some(other) if other < range.to_m_s => {
                    self.refused = Some(format!("another form has an onset at {other:.3} m/s"));
                }
                _ if range.from_m_s > 0.0 => self.refused = Some(range.explain()),
                _ => {
                    self.no_flutter_up_to_m_s = Some(range.to_m_s);
                    self.meet(range.to_m_s);
                }
            },
        }
        Ok(())
    }

    /// Required speeds that are met where nothing happens below a speed.
    fn meet(&mut self, safe_m_s: f64) {
        for required in REQUIRED {
            if required * self.truth_m_s > safe_m_s {
                continue;
            }
            if required > 1.0 {
                self.met_above_truth.push(required);
            } else {
                self.met_below_truth += 1;
            }
        }
    }
}

impl RangeCount {
    fn count(range: FamilyRange, decks: &[DeckOutcome]) -> Option<Self> {
        let is_own = |d: &&DeckOutcome| range == FamilyRange::All || d.range == range;
        let own: Vec<&DeckOutcome> = decks.iter().filter(is_own).collect();
        let interval = |d: &&DeckOutcome| Some((d.truth_m_s, d.interval_m_s?));
        let stated = || own.iter().filter_map(interval);
        let wrong = |d: &&DeckOutcome| Some(d.truth_m_s < d.no_flutter_up_to_m_s?);
        let calm = || own.iter().filter_map(wrong);
        let half = |(_, (low, high)): (f64, (f64, f64))| 100.0 * (high - low) / (high + low);
        let mut halves: Vec<f64> = stated().map(half).collect();
        halves.sort_by(f64::total_cmp);
        let error = |d: &&DeckOutcome| {
            let (scatter_m_s, form_m_s) = d.interval_m_s.and(d.parts_m_s)?;
            Some((d.onset_m_s? - d.truth_m_s) / scatter_m_s.hypot(form_m_s))
        };
        let squares: Vec<f64> = own.iter().filter_map(error).map(|z| z * z).collect();
        let holds = |(truth, (low, high)): (f64, (f64, f64))| low <= truth && truth <= high;
        (!own.is_empty()).then(|| Self {
            range,
            decks: own.len(),
            held: IntervalCoverage::count(stated().map(holds)),
            no_flutter: calm().filter(|wrong| !wrong).count(),
            refused: own.iter().filter(|d| d.refused.is_some()).count(),
            false_no_flutter: calm().filter(|wrong| *wrong).count(),
            unsafe_side: stated().filter(|(truth, (low, _))| truth < low).count(),
            met_against_truth: own.iter().map(|d| d.met_above_truth.len()).sum(),
            median_half_width_percent: super::sample_quantile(&halves, halves.len(), 0.5),
            error_over_standard_error: (!squares.is_empty())
                .then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()),
        })
    }
}
