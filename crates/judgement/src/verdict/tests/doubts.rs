//! What each doubt weighs.

use super::*;

#[test]
fn an_extrapolated_onset_counts_as_far_as_tests_reach() {
    let mut first = onset(60.0, 1.0);
    first.in_tested_range = Some(false);
    first.at = at(60.0, 0.2);
    let mut evidence = scanned(
        30.0,
        vec![reading("the model", FlutterSearch::Onset(Box::new(first)))],
    );
    evidence.flutter[0].basis = tests(50.0);
    assert_eq!(words(&evidence), "MET");
    evidence.required = Some(RequiredSpeed { speed_m_s: 55.0 });
    let verdict = Verdict::judge(&evidence);
    let Some(Outcome::CannotBeJudged { settled_by, .. }) = verdict.outcome else {
        panic!("{:?}", verdict.outcome);
    };
    assert!(
        settled_by.contains(&"tests at K 0.20–0.30".to_owned()),
        "{settled_by:?}"
    );
}

#[test]
fn an_onset_in_a_gap_between_tests_is_a_doubt() {
    let mut first = onset(60.0, 1.0);
    first.in_tested_range = Some(false);
    first.gap = Some(ReducedFrequencyGap {
        from: k(0.4),
        to: k(1.1),
    });
    let mut evidence = scanned(
        58.0,
        vec![reading("the model", FlutterSearch::Onset(Box::new(first)))],
    );
    evidence.flutter[0].basis = tests(50.0);
    let kinds = severe(&evidence);
    assert!(
        kinds.contains(&DoubtKind::GapInTests {
            k: 0.5,
            gap_from_k: 0.4,
            gap_to_k: 1.1
        }),
        "{kinds:?}"
    );
    let settled = Verdict::judge(&evidence).explanation;
    assert!(settled.contains("tests at K 0.40–1.10"), "{settled}");
}

#[test]
fn an_interval_that_is_not_known_or_too_wide_is_a_doubt() {
    let evidence = scanned(30.0, vec![found("the model", 36.9, 0.0)]);
    assert_eq!(words(&evidence), "CANNOT BE JUDGED");
    assert!(matches!(
        severe(&evidence)[..],
        [DoubtKind::IntervalUnknown { .. }]
    ));
    // no search for half of it reaches it
    let mut half = evidence.clone();
    half.required = Some(RequiredSpeed { speed_m_s: 18.4 });
    assert_eq!(words(&half), "MET");
    half.required = None;
    assert_eq!(Verdict::judge(&half).suggested_m_s, Some(18.4));
    let mut exact = evidence.clone();
    exact.flutter[0].basis = ForceBasis::Exact;
    assert_eq!(words(&exact), "MET");
    // not even "not met": the best estimate is no result
    let wide = scanned(30.0, vec![found("the model", 9.2, 114.0)]);
    assert_eq!(words(&wide), "CANNOT BE JUDGED");
    assert!(matches!(
        severe(&wide)[..],
        [DoubtKind::IntervalUndetermined { .. }]
    ));
    let mut one = scanned(30.0, vec![found("the model", 36.9, 0.3)]);
    one.test_speeds = Some(1);
    assert_eq!(severe(&one), [DoubtKind::OneTestSpeed]);
    // the scatter of other decks in the interval makes it one to be known
    let mut first = onset(36.9, 0.3);
    let between = ErrorParts {
        between_speeds: Some(BetweenSpeeds::Prior),
        ..parts(0.3)
    };
    first.interval = OnsetInterval::about(36.9, 0.3, 20.0, between);
    one.flutter[0].search = FlutterSearch::Onset(Box::new(first));
    assert_eq!(words(&one), "MET");
    assert_eq!(Verdict::judge(&one).doubts[0].kind, DoubtKind::OneTestSpeed);
    // the interval of models beside tables says so as well
    let mut beside = scanned(30.0, vec![found("the tables", 36.9, 0.0)]);
    beside.flutter.push(one.flutter[0].clone());
    assert_eq!(words(&beside), "MET");
    let doubts = Verdict::judge(&beside).doubts;
    assert!(doubts.iter().any(|d| d.kind == DoubtKind::OneTestSpeed));
    one.flutter = vec![found("the model", 36.9, 0.3)];
    one.test_speeds = Some(2);
    assert_eq!(words(&one), "MET");
}

fn band(reduced_frequency: ReducedFrequency) -> GrowthBand {
    GrowthBand {
        from_m_s: 3.1,
        to_m_s: 3.4,
        from_start: false,
        fastest_growth_per_s: 0.02,
        fastest_at_m_s: 3.2,
        frequency_hz: 2.0,
        reduced_frequency,
        tested_from_m_s: None,
        branch: "vertical".to_owned(),
    }
}

#[test]
fn growth_where_nothing_was_tested_cannot_be_judged() {
    let mut evidence = scanned(30.0, vec![found("the model", 36.9, 0.3)]);
    evidence.growth.as_mut().unwrap().bands.push(band(k(6.5)));
    let verdict = Verdict::judge(&evidence);
    assert_eq!(words(&evidence), "CANNOT BE JUDGED");
    assert_eq!(
        verdict.critical.governs.unwrap().phenomenon,
        Phenomenon::Growth
    );
    assert!(
        verdict
            .headline
            .contains("growth outside the tests at 3.10 m/s")
    );
    // nobody looked: as bad
    evidence.growth = None;
    let reach = Reach {
        from_m_s: 5.0,
        ..Reach::everywhere()
    };
    evidence.flutter[0].basis =
        ForceBasis::tested(ReducedFrequencyRange::between(k(0.3), k(2.0)), reach);
    assert_eq!(
        severe(&evidence),
        [DoubtKind::NotJudgedBelow { speed_m_s: 5.0 }]
    );
}

#[test]
fn constraints_that_moved_the_onset_are_weighed() {
    let mut evidence = scanned(30.0, vec![found("the model", 36.9, 0.3)]);
    let weight = |evidence: &mut Evidence, without_m_s, with_m_s| {
        evidence.constraints = Some(MovedOnset {
            without_m_s,
            with_m_s,
        });
        let doubts = Verdict::judge(evidence).doubts;
        doubts.first().map(|d| d.severity)
    };
    // by less than a hundredth
    assert_eq!(weight(&mut evidence, Some(36.6), Some(36.9)), None);
    // beyond the interval, but above what is required as well
    assert_eq!(
        weight(&mut evidence, Some(33.0), Some(36.9)),
        Some(Severity::Minor)
    );
    assert_eq!(
        weight(&mut evidence, Some(30.2), Some(36.9)),
        Some(Severity::Severe)
    );
    // no onset that could have been moved
    for without_m_s in [None, Some(1.1)] {
        assert_eq!(
            weight(&mut evidence, without_m_s, Some(36.9)),
            Some(Severity::Minor)
        );
    }
    evidence.constraints = Some(MovedOnset {
        without_m_s: Some(34.0),
        with_m_s: None,
    });
    assert_eq!(
        Verdict::judge(&evidence).doubts[0].severity,
        Severity::Severe
    );
    // the search ends where the data alone flutter: with constraints it may be just beyond
    let mut short = scanned(30.0, vec![stable("the model", 36.9)]);
    assert_eq!(weight(&mut short, Some(36.89), None), Some(Severity::Minor));
    // nothing was found up to 70 m/s, and the data alone grow from nearly no wind: that is no onset
    let mut none = scanned(60.0, vec![stable("the model", 70.0)]);
    assert_eq!(weight(&mut none, Some(1.7), None), Some(Severity::Minor));
    assert_eq!(weight(&mut none, Some(50.0), None), Some(Severity::Severe));
    evidence.required = None;
    assert_eq!(
        weight(&mut evidence, Some(33.0), Some(36.9)),
        Some(Severity::Severe)
    );
}

#[test]
fn failures_input_and_rotation_are_weighed() {
    let clean = scanned(30.0, vec![found("the model", 36.9, 0.3)]);
    let failed = |beside_answer| Evidence {
        failures: vec![StageFailure {
            beside_answer,
            ..StageFailure::new("divergence", "no stiffness")
        }],
        ..clean.clone()
    };
    assert_eq!(words(&failed(false)), "CANNOT BE JUDGED");
    assert_eq!(words(&failed(true)), "MET");
    let implausible = Evidence {
        implausible: vec![Finding::unit(
            "section.width_m",
            22e3,
            "no deck is that wide",
        )],
        ..clean.clone()
    };
    assert_eq!(words(&implausible), "CANNOT BE JUDGED");
    let turned = |at_onset_deg| Evidence {
        mean_rotation: Some(MeanRotation {
            rotation_deg: at_onset_deg,
            tested_deg: None,
            speed_m_s: 36.9,
        }),
        ..clean.clone()
    };
    // a bridge at −5.8° with tables of 0°
    assert_eq!(words(&turned(-5.8)), "CANNOT BE JUDGED");
    assert_eq!(words(&turned(-2.0)), "CANNOT BE JUDGED");
    let text = "The deck stands at -1.4° in the mean wind of 36.9 m/s, the forces are those at 0.0°, assumed since no `angle_deg` \
                of the tests is stated";
    assert_eq!(Verdict::judge(&turned(-1.4)).doubts[0].text, text);
    assert_eq!(words(&turned(-1.4)), "MET");
    // tests at the angle at which the deck stands
    let mut tested = turned(-5.8);
    tested.mean_rotation.as_mut().unwrap().tested_deg = Some(-5.0);
    assert_eq!(words(&tested), "MET");
    assert!(Verdict::judge(&tested).doubts.is_empty());
    assert!(Verdict::judge(&turned(0.5)).doubts.is_empty());
    let theory = Evidence {
        flutter: vec![FlutterReading {
            basis: ForceBasis::Stated,
            ..found("quasi-steady theory", 36.9, 0.3)
        }],
        ..clean.clone()
    };
    assert_eq!(severe(&theory), [DoubtKind::Untested]);
    let known = Evidence {
        remarks: vec!["a remark.".to_owned()],
        tested_rotation_deg: Some(2.0),
        ..clean
    };
    assert_eq!(words(&known), "MET");
    let texts: Vec<String> = Verdict::judge(&known)
        .warnings()
        .map(str::to_owned)
        .collect();
    assert_eq!(
        texts,
        [
            "Rotations beyond the 2.00° of the tests are not covered",
            "a remark"
        ]
    );
}

/// Tests at K 0.34–0.97, 10 m/s required, torsion at K 1.6 there: it was met without a word.
#[test]
fn slow_wind_in_which_a_motion_is_faster_than_the_tests_is_told() {
    let mut evidence = scanned(10.0, vec![found("the model", 36.9, 0.3)]);
    let mut below = |below| {
        let from = TestedFrom {
            speed_m_s: 16.4,
            branch: "torsion".to_owned(),
            below,
        };
        let range = ReducedFrequencyRange::between(k(0.34), k(0.97));
        evidence.flutter[0].basis = ForceBasis::tested(range, Reach::of_table(Some(from)));
        Verdict::judge(&evidence)
    };
    // what the conditions of a fit answer for is said, where no test is as fast, in the explanation
    let verdict = below(FastMotion::Damped);
    assert!(verdict.is_met());
    assert_eq!(verdict.critical.judged_from_m_s, 16.4);
    let text = "Below 16.4 m/s the torsion mode lies at K above 0.97, where nothing was tested; by fitted forces heave with \
                rotation, and sway by itself where it moves, lose energy at all higher K";
    assert_eq!(verdict.doubts[0].text, text);
    assert_eq!(verdict.doubts[0].severity, Severity::Minor);
    assert!(verdict.explanation.contains(text));
    let of_table = below(FastMotion::DampedAtTheEnd);
    assert!(of_table.is_met() && of_table.doubts[0].text.contains("the highest K tested"));
    // what no condition holds cannot be judged
    let open = below(FastMotion::Open);
    assert_eq!(open.outcome.unwrap().words(), "CANNOT BE JUDGED");
    let kind = DoubtKind::NotJudgedBelow { speed_m_s: 16.4 };
    assert_eq!(open.doubts[0].kind, kind);
    assert_eq!(
        open.doubts[0].settled_by.as_deref(),
        Some("tests at K above 0.97")
    );
    // nor where motions out of phase grow all the same; a slow one is not settled by tests of a moving deck
    let mut evidence = scanned(10.0, vec![evidence.flutter.remove(0)]);
    let bands = &mut evidence.growth.as_mut().unwrap().bands;
    bands.extend([band(k(6.5)), band(k(0.001))]);
    let doubts = Verdict::judge(&evidence).doubts;
    assert!(
        doubts
            .iter()
            .any(|d| { d.text.ends_with("by the model a motion grows there") })
    );
    let bands = &mut evidence.growth.as_mut().unwrap().bands;
    bands.remove(0);
    let doubts = Verdict::judge(&evidence).doubts;
    let slow = Some("static coefficients, or tests at lower K".to_owned());
    assert!(doubts.iter().any(|d| d.settled_by == slow));
    evidence.growth.as_mut().unwrap().bands.clear();
    // above, it is a note
    evidence.required = Some(RequiredSpeed { speed_m_s: 30.0 });
    let from = TestedFrom {
        speed_m_s: 16.4,
        branch: "torsion".to_owned(),
        below: FastMotion::Damped,
    };
    let range = ReducedFrequencyRange::between(k(0.34), k(0.97));
    evidence.flutter[0].basis = ForceBasis::tested(range, Reach::of_table(Some(from)));
    let verdict = Verdict::judge(&evidence);
    assert!(verdict.is_met() && !verdict.explanation.contains("Below"));
    assert_eq!(verdict.doubts.len(), 1);
}

/// Four tests at K 0.72–0.97, a model of one lag, torsion untested below 50.6 m/s, 20 m/s required: it was met.
#[test]
fn few_tests_do_not_tell_how_forces_go_over_into_still_air() {
    let outcome = |tests: &[f64]| {
        let range = ReducedFrequencyRange::spanning(tests.iter().map(|x| k(*x))).unwrap();
        let from = TestedFrom {
            speed_m_s: 50.6,
            branch: "torsion".to_owned(),
            below: FastMotion::new(Some(FastMotion::Damped), [range]),
        };
        let mut evidence = scanned(20.0, vec![found("the model", 72.3, 2.0)]);
        evidence.flutter[0].basis = ForceBasis::tested(range, Reach::of_table(Some(from)));
        let verdict = Verdict::judge(&evidence);
        (verdict.outcome.unwrap().words(), verdict.explanation)
    };
    assert_eq!(outcome(&[0.3, 0.4, 0.5, 0.82]).0, "MET");
    let (words, why) = outcome(&[0.72, 0.77, 0.97]);
    assert_eq!(words, "CANNOT BE JUDGED");
    assert!(
        why.contains(
            "by the model damping there is a guess: tests have to reach K 0.8 of their own"
        ),
        "{why}"
    );
    // slow motion alone, and one test beyond a gap
    assert_eq!(outcome(&[0.1, 0.2, 0.4, 0.72]).0, "CANNOT BE JUDGED");
    assert_eq!(outcome(&[0.1, 0.2, 0.4, 0.97]).0, "CANNOT BE JUDGED");
}

/// An onset of a motion that is faster than every test: no test is of it at any speed up to there, however low what is required.
#[test]
fn an_onset_above_the_tests_meets_nothing() {
    let mut evidence = scanned(20.0, vec![found("the model", 72.3, 2.0)]);
    let range = ReducedFrequencyRange::between(k(0.05), k(0.2));
    evidence.flutter[0].basis = ForceBasis::tested(range, Reach::everywhere());
    if let FlutterSearch::Onset(onset) = &mut evidence.flutter[0].search {
        onset.in_tested_range = Some(false);
        onset.at.reduced_frequency = k(0.58);
    }
    let verdict = Verdict::judge(&evidence);
    assert_eq!(verdict.outcome.unwrap().words(), "CANNOT BE JUDGED");
    assert!(verdict.doubts[0].text.contains("outside the tested range"));
}

/// Tests at K 0.42 to 0.97: the model diverged at 9.24 m/s, the table at 61.8, and nothing was said.
#[test]
fn divergence_that_another_reading_contradicts_is_a_doubt() {
    let mut evidence = scanned(40.0, vec![stable("the model", 110.0)]);
    let table = |speed| Divergence::at("the table", speed);
    let said = |evidence: &Evidence| {
        let doubts = Verdict::judge(evidence).doubts;
        let against = |d: &&Doubt| matches!(d.kind, DoubtKind::Contradiction { .. });
        doubts.iter().find(against).map(|d| d.text.clone())
    };
    evidence.divergence = vec![Divergence::at("the model", Some(9.24)), table(Some(61.8))];
    assert_eq!(
        said(&evidence).unwrap(),
        "Contradiction: static divergence at 9.24 m/s by the model, 61.8 m/s by the table"
    );
    let verdict = Verdict::judge(&evidence);
    assert!(
        verdict.headline.starts_with(
            "? CANNOT BE JUDGED, required 40 m/s: static divergence at 9.24 m/s (the model), CONTRADICTED by the table: 61.8 m/s"
        ),
        "{}",
        verdict.headline
    );
    // both lie below, or coefficients measured at rest say so
    evidence.required = Some(RequiredSpeed { speed_m_s: 70.0 });
    assert_eq!(words(&evidence), "NOT MET");
    evidence.required = Some(RequiredSpeed { speed_m_s: 40.0 });
    evidence.divergence[0].measured = true;
    assert_eq!(words(&evidence), "NOT MET");
    evidence.divergence[0].measured = false;
    evidence.divergence[1] = table(None);
    assert!(said(&evidence).unwrap().ends_with("none by the table"));
    evidence.divergence[1] = table(Some(11.0));
    assert_eq!(said(&evidence), None);
    // not where nobody asks
    evidence.divergence = vec![Divergence::at("the model", Some(60.0)), table(Some(90.0))];
    assert_eq!(said(&evidence), None);
}
