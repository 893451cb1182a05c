//! What is green and what is not: every way in which an answer looked safer than it was.

mod doubts;

use super::*;
use crate::flutter::{
    BetweenSpeeds, CriticalPoint, ErrorInterval, ErrorParts, FastMotion, FlutterSearch, GrowthBand,
    MovedOnset, Onset, OnsetInterval, OnsetMethod, StableRange, TestedFrom, UnstableStart,
    UnwantedGrowth,
};
use crate::plausibility::Finding;
use crate::units::{ReducedFrequency, ReducedFrequencyGap, ReducedFrequencyRange};

fn k(value: f64) -> ReducedFrequency {
    ReducedFrequency::from_full_width(value)
}

const TESTED: (f64, f64) = (0.3, 2.0);

fn tests(to_m_s: f64) -> ForceBasis {
    let range = ReducedFrequencyRange::between(k(TESTED.0), k(TESTED.1));
    let reach = Reach {
        to_m_s,
        ..Reach::everywhere()
    };
    ForceBasis::tested(range, reach)
}

fn at(speed_m_s: f64, reduced: f64) -> CriticalPoint {
    CriticalPoint::new("m", OnsetMethod::Eigenvalues, speed_m_s, 2.0, k(reduced))
}

/// An onset inside the tested range, with a half width of its interval (0: none).
fn onset(speed_m_s: f64, half_m_s: f64) -> Onset {
    Onset {
        at: at(speed_m_s, 0.5),
        mode: None,
        damping_slope_s_m: None,
        branch: "torsion".to_owned(),
        in_tested_range: Some(true),
        gap: None,
        spurious_speeds_m_s: Vec::new(),
        warnings: Vec::new(),
        interval: match half_m_s > 0.0 {
            true => OnsetInterval::about(speed_m_s, half_m_s, 20.0, parts(half_m_s)),
            false => OnsetInterval::none("no tests"),
        },
    }
}

fn parts(half_m_s: f64) -> ErrorParts {
    ErrorParts {
        scatter_m_s: half_m_s / 2.0,
        ..ErrorParts::default()
    }
}

fn reading(forces: &str, search: FlutterSearch) -> FlutterReading {
    FlutterReading {
        forces: forces.to_owned(),
        search,
        basis: tests(f64::INFINITY),
    }
}

fn found(forces: &str, speed_m_s: f64, half_m_s: f64) -> FlutterReading {
    let onset = onset(speed_m_s, half_m_s);
    reading(forces, FlutterSearch::Onset(Box::new(onset)))
}

fn stable(forces: &str, to_m_s: f64) -> FlutterReading {
    reading(
        forces,
        FlutterSearch::StableUpTo(StableRange::up_to(to_m_s)),
    )
}

fn unstable(forces: &str, speed_m_s: f64) -> FlutterReading {
    let start = UnstableStart {
        at: at(speed_m_s, 1.9),
        growth_rate_per_s: 0.1,
        branch: "torsion".to_owned(),
        in_tested_range: Some(true),
        reason: "there its motion enters".to_owned(),
        warnings: Vec::new(),
        onset_above: None,
        damped_from_m_s: None,
    };
    reading(forces, FlutterSearch::UnstableAtOrBelow(Box::new(start)))
}

/// Evidence of a model that was scanned for growth, against a required speed.
fn scanned(required_m_s: f64, flutter: Vec<FlutterReading>) -> Evidence {
    Evidence {
        required: Some(RequiredSpeed {
            speed_m_s: required_m_s,
        }),
        flutter,
        growth: Some(UnwantedGrowth {
            model: String::new(),
            scanned_to_m_s: 100.0,
            proved: true,
            bands: Vec::new(),
            instability_from_m_s: None,
        }),
        ..Evidence::default()
    }
}

fn words(evidence: &Evidence) -> &'static str {
    Verdict::judge(evidence).outcome.unwrap().words()
}

fn severe(evidence: &Evidence) -> Vec<DoubtKind> {
    let all = Verdict::judge(evidence).doubts.into_iter();
    let severe = all.filter(|d| d.severity == Severity::Severe);
    severe.map(|d| d.kind).collect()
}

#[test]
fn an_onset_with_its_interval_above_is_met() {
    let verdict = Verdict::judge(&scanned(30.0, vec![found("the model", 36.9, 0.3)]));
    assert!(verdict.is_met() && !verdict.refuses());
    assert_eq!(
        verdict.headline,
        "✓ MET, required 30 m/s: flutter onset 36.9 m/s, 36.6–37.2, inside the tested range"
    );
    assert_eq!(verdict.doubts, Vec::new());
    assert_eq!(
        verdict.explanation,
        "Met: everything critical lies above: flutter at 36.9 m/s by the model, lower end 36.6 m/s."
    );
}

/// "MET, required NaN m/s".
#[test]
fn what_is_no_wind_speed_is_never_met() {
    for required_m_s in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
        let evidence = scanned(required_m_s, vec![found("the model", 36.9, 0.3)]);
        assert_eq!(words(&evidence), "CANNOT BE JUDGED", "{required_m_s}");
    }
}

#[test]
fn which_number_lies_below_is_said() {
    let verdict = Verdict::judge(&scanned(36.7, vec![found("the model", 36.9, 0.3)]));
    let below = Below::LowerEnd;
    assert_eq!(verdict.outcome, Some(Outcome::NotMet { below }));
    assert!(verdict.explanation.contains("only the lower end counts"));
    let verdict = Verdict::judge(&scanned(45.0, vec![found("the model", 36.9, 0.3)]));
    let below = Below::BestEstimate;
    assert_eq!(verdict.outcome, Some(Outcome::NotMet { below }));
    assert!(verdict.refuses());
}

/// Divergence at 79.9 m/s, required 100, no flutter to 110 was a green "Met".
#[test]
fn divergence_below_the_required_speed_is_not_met() {
    let mut evidence = scanned(100.0, vec![stable("the model", 110.0)]);
    assert_eq!(words(&evidence), "MET");
    evidence.divergence = vec![Divergence::at("the model", Some(79.9))];
    let verdict = Verdict::judge(&evidence);
    let below = Below::BestEstimate;
    assert_eq!(verdict.outcome, Some(Outcome::NotMet { below }));
    assert_eq!(
        verdict.headline,
        "✗ NOT MET, required 100 m/s: static divergence at 79.9 m/s (the model); no flutter up to 110.000 m/s"
    );
}

/// An onset of 36.1 m/s (29.1 to 43.2) was the headline of a section that diverges at 30.5.
#[test]
fn divergence_that_is_expected_before_flutter_is_in_the_headline() {
    let mut evidence = scanned(21.0, vec![found("the model", 36.1, 7.0)]);
    evidence.divergence = vec![Divergence::at("the model", Some(30.5))];
    let headline = Verdict::judge(&evidence).headline;
    let says = "; static divergence at 30.5 m/s (the model) comes before it";
    assert!(
        headline.contains("flutter onset 36.1 m/s") && headline.ends_with(says),
        "{headline}"
    );
    evidence.divergence = vec![Divergence::at("the model", Some(36.2))];
    assert!(!Verdict::judge(&evidence).headline.contains("divergence"));
}

/// A bridge that diverges at 62.6 m/s was headed "no flutter up to 120 m/s"; a deck with divergence at 14.8 "onset at 21.2".
#[test]
fn what_begins_first_governs_also_without_a_requirement() {
    let mut evidence = scanned(1.0, vec![stable("the models", 120.0)]);
    evidence.required = None;
    evidence.divergence = vec![Divergence::at("the models", Some(62.6))];
    let verdict = Verdict::judge(&evidence);
    assert!(
        verdict
            .headline
            .starts_with("static divergence at 62.6 m/s")
    );
    assert_eq!((verdict.outcome, verdict.suggested_m_s), (None, Some(62.6)));
    assert!(
        verdict
            .explanation
            .contains("up to 62.6 m/s it would be met")
    );
    evidence.flutter = vec![found("the model", 21.2, 0.4)];
    evidence.divergence = vec![Divergence::at("the table", Some(14.8))];
    let critical = Verdict::judge(&evidence).critical;
    let governs = critical.governs.unwrap();
    assert_eq!(governs.phenomenon, Phenomenon::Divergence);
    assert_eq!((governs.best_m_s, &governs.forces[..]), (14.8, "the table"));
    assert_eq!(critical.others[0].phenomenon, Phenomenon::Flutter);
    // what was assumed at rest makes the lower end
    evidence.divergence[0].lower_m_s = Some(14.0);
    assert_eq!(Verdict::judge(&evidence).critical.least_m_s(), Some(14.0));
    evidence.galloping = Some(CriticalSpeed::galloping("the coefficients", 9.0));
    let governs = Verdict::judge(&evidence).critical.governs.unwrap();
    assert_eq!(governs.phenomenon, Phenomenon::Galloping);
}

/// Required 62 and searched to 54 was "NOT met"; tests that end at 4.5 m/s were "no flutter up to 40 m/s".
/// What is required is searched for to twice itself, and so is what is said to be met.
#[test]
fn a_search_answers_for_half_of_its_range() {
    let of_search = |searched_to_m_s, reading| {
        let known = Evidence {
            required: None,
            searched_to_m_s,
            ..scanned(1.0, vec![reading])
        };
        Verdict::judge(&known).suggested_m_s
    };
    let model = "the model";
    assert_eq!(of_search(Some(40.0), stable(model, 40.0)), Some(20.0));
    assert_eq!(of_search(Some(40.0), stable(model, 15.0)), Some(15.0));
    assert_eq!(of_search(None, stable(model, 40.0)), Some(40.0));
    assert_eq!(of_search(Some(40.0), found(model, 38.0, 1.0)), Some(37.0));
    let mut far = scanned(1.0, vec![stable(model, 24.0)]);
    far.divergence = vec![Divergence::at(model, Some(66.9))];
    for (searched_to_m_s, first) in [(24.0, "no flutter up to 24"), (80.0, "static divergence")] {
        far.searched_to_m_s = Some(searched_to_m_s);
        far.required = None;
        let headline = Verdict::judge(&far).headline;
        assert!(headline.starts_with(first), "{headline}");
    }
}

#[test]
fn what_was_not_looked_at_cannot_be_judged() {
    let evidence = scanned(62.0, vec![stable("the model", 54.0)]);
    let verdict = Verdict::judge(&evidence);
    assert_eq!(words(&evidence), "CANNOT BE JUDGED");
    assert!(
        verdict
            .headline
            .starts_with("? CANNOT BE JUDGED, required 62 m/s")
    );
    assert_eq!(
        severe(&evidence),
        [DoubtKind::NotJudgedAbove {
            speed_m_s: 54.0,
            asked_m_s: 62.0
        }]
    );
    let mut tested = scanned(30.0, vec![stable("the model", 40.0)]);
    assert_eq!(words(&tested), "MET");
    tested.flutter[0].basis = tests(4.5);
    assert_eq!(words(&tested), "CANNOT BE JUDGED");
    // an onset far above says nothing of what lies between the tests and the required speed
    tested.flutter = vec![found("the model", 60.0, 1.0)];
    tested.flutter[0].basis = tests(25.0);
    assert_eq!(words(&tested), "CANNOT BE JUDGED");
    tested.flutter[0].basis = tests(31.0);
    assert_eq!(words(&tested), "MET");
    let headline = Verdict::judge(&tested).headline;
    let end = "inside the tested range; all motions judged up to 31.0 m/s only";
    assert!(headline.ends_with(end), "{headline}");
    assert_eq!(words(&scanned(30.0, Vec::new())), "CANNOT BE JUDGED");
}

/// A bridge was headed 84.1 m/s where its table said 77.97; 84.6 where the table was unstable from 8.6 on.
#[test]
fn model_and_table_that_contradict_each_other_are_said() {
    let table = found("the tables", 77.97, 0.0);
    let model = found("the models", 84.1, 1.5);
    let evidence = scanned(50.0, vec![table.clone(), model.clone()]);
    let verdict = Verdict::judge(&evidence);
    assert_eq!(words(&evidence), "CANNOT BE JUDGED");
    assert!(
        verdict
            .headline
            .contains("CONTRADICTED by the models: 84.1 m/s (82.6–85.6)")
    );
    assert_eq!(verdict.critical.least_m_s(), Some(77.97));
    // the same, whichever comes first
    let reversed = Verdict::judge(&scanned(50.0, vec![model.clone(), table.clone()]));
    assert_eq!(reversed.critical.least_m_s(), Some(77.97));
    let said = reversed.warnings().next().unwrap();
    assert_eq!(
        said,
        "Contradiction: 84.1 m/s (82.6–85.6) by the models, 78.0 m/s by the tables"
    );
    // lower than required by the table alone
    assert_eq!(words(&scanned(80.0, vec![table.clone(), model])), "NOT MET");
    let verdict = Verdict::judge(&scanned(
        50.0,
        vec![unstable("the tables", 8.6), found("the models", 84.6, 2.0)],
    ));
    let below = Below::BestEstimate;
    assert_eq!(verdict.outcome, Some(Outcome::NotMet { below }));
    assert!(
        verdict
            .doubts
            .iter()
            .any(|d| matches!(d.kind, DoubtKind::Contradiction { .. }))
    );
    // what an undetermined onset leaves open excuses no growth in the tests
    let mut open = found("the models", 84.1, 0.0);
    if let FlutterSearch::Onset(onset) = &mut open.search {
        onset.interval = OnsetInterval::Undetermined {
            error: ErrorInterval {
                low_m_s: -2.9,
                high_m_s: 149.0,
                standard_error_m_s: 19.4,
                degrees_of_freedom: 3.0,
                parts: ErrorParts::default(),
            },
            reason: "scatter".to_owned(),
        };
    }
    let verdict = Verdict::judge(&scanned(15.0, vec![open, unstable("the tables", 7.8)]));
    let said = verdict.explanation;
    assert!(said.contains("unstable at and below 7.80 m/s"), "{said}");
    // neither of two that grow from the lowest speed on knows where it begins
    let both = scanned(50.0, vec![unstable("a", 84.9), unstable("b", 86.1)]);
    assert!(!Verdict::judge(&both).headline.contains("CONTRADICTED"));
    // one finds what the other excludes
    let missed = Verdict::judge(&scanned(
        50.0,
        vec![stable("the tables", 90.0), found("the models", 60.0, 1.0)],
    ));
    assert!(!missed.is_met());
    // a table that ends before says nothing against it
    let ends = Verdict::judge(&scanned(
        50.0,
        vec![found("the models", 60.0, 1.0), stable("the tables", 55.0)],
    ));
    assert!(ends.is_met());
}

/// The table gives the number, the models its interval.
/// Unstable at and below the lowest speed that could be judged: no requirement is met, above or below that speed.
#[test]
fn what_is_unstable_from_the_start_meets_nothing() {
    for (required_m_s, below) in [(10.0, Below::LowerEnd), (20.0, Below::BestEstimate)] {
        let verdict = Verdict::judge(&scanned(required_m_s, vec![unstable("the model", 15.7)]));
        assert_eq!(verdict.outcome, Some(Outcome::NotMet { below }));
        assert!(
            verdict
                .explanation
                .contains("15.7 m/s by the model or at any speed below"),
            "{}",
            verdict.explanation
        );
    }
    let open = Evidence {
        required: None,
        ..scanned(10.0, vec![unstable("the model", 15.7)])
    };
    assert_eq!(Verdict::judge(&open).suggested_m_s, None);
}

#[test]
fn readings_that_agree_share_an_interval() {
    let evidence = scanned(
        70.0,
        vec![
            found("the tables", 77.0, 0.0),
            found("the models", 77.4, 2.0),
        ],
    );
    let verdict = Verdict::judge(&evidence);
    assert_eq!(
        verdict.headline,
        "✓ MET, required 70 m/s: flutter onset 77.0 m/s by the tables, inside the tested range; the models: 77.4 m/s (75.4–79.4)"
    );
    assert_eq!(verdict.critical.least_m_s(), Some(75.4));
    let low = found("the tables", 75.0, 0.0);
    let other = Verdict::judge(&scanned(70.0, vec![found("the models", 77.4, 2.5), low]));
    assert_eq!(other.critical.least_m_s(), Some(74.9));
}

#[test]
fn a_verdict_is_written_and_read() {
    let mut evidence = scanned(62.0, vec![stable("the model", 54.0)]);
    evidence.divergence = vec![Divergence::at("the model", Some(79.9))];
    let verdict = Verdict::judge(&evidence);
    let json = serde_json::to_value(&verdict).unwrap();
    assert_eq!(json["outcome"]["state"], "cannot_be_judged");
    assert_eq!(json["doubts"][0]["kind"], "not_judged_above");
    assert_eq!(json["doubts"][0]["severity"], "severe");
    assert_eq!(json["critical"]["governs"]["phenomenon"], "divergence");
    let read: Verdict = serde_json::from_value(json).unwrap();
    assert_eq!(read, verdict);
}
