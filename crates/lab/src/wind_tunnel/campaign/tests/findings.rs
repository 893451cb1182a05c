//! What is odd in recordings that can be read.

use super::*;
use crate::plausibility::FindingSeverity;
use crate::wind_tunnel::RunFinding;

fn findings(a: &str, b: &str) -> Vec<String> {
    let reading = load(&small(), a, b).unwrap();
    reading.findings.iter().map(RunFinding::to_string).collect()
}

#[test]
fn what_does_not_stop_reading_is_a_finding() {
    let (a, b) = (recording(200, |_, _| {}), recording(200, still));
    let clipped = recording(200, |_, r| r[1] = r[1].min(0.05));
    // above half of the amplitude for a third of a period of 50 samples, three whole times in the record
    assert_eq!(
        findings(&clipped, &b),
        [
            "run `one`, in wind, `d`, sample 42: stays at its highest value 0.050000 for 17 samples (clipped? 51 such samples in all)"
        ]
    );
    // digitised in steps of half of its amplitude it dwells at its peaks for 11 samples and is not taken for clipped
    let digitised = recording(200, |_, r| r[1] = (r[1] * 20.0).round() / 20.0);
    assert_eq!(findings(&digitised, &b), Vec::<String>::new());
    let stuck = recording(200, |_, r| r[3] = 0.25);
    assert_eq!(
        findings(&stuck, &b),
        ["run `one`, in wind, `m`: is 0.25 all the time"]
    );
    assert_eq!(
        findings(&a, &recording(180, still)),
        ["run `one`: 200 samples in wind, 180 in still air; only the first 180 have both"]
    );
    assert_eq!(
        findings(
            &a,
            &recording(200, |i, r| if i > 90 {
                r[4] = f64::NAN
            })
        ),
        [
            "run `one`, still air, `v`, sample 91: wind speed is not a number or of another length; ignored"
        ]
    );
    let found = findings(&a, &a);
    assert!(
        found.len() == 1
            && found[0].starts_with("run `one`: the still-air recording has a wind of 8.0"),
        "{found:?}"
    );
    assert_eq!(
        findings(&recording(200, |_, r| r[0] = 0.0), &b),
        ["run `one`: in wind: no vertical motion"]
    );
    let off = small().replace("name = \"one\"", "name = \"one\"\nmean_speed_m_s = 9");
    let found = load(&off, &a, &b).unwrap().findings;
    assert_eq!(found[0].severity, FindingSeverity::Doubt);
    assert!(
        found[0]
            .to_string()
            .contains("the mean speed is 9.000 m/s, its channel says 8.0")
    );
}

/// The mean of the channel is that of the run: what no turbulence about it explains is a doubt.
#[test]
fn a_wind_that_is_not_one_is_a_doubt() {
    type Change = fn(f64, &mut f64);
    let found = |change: Change| {
        let a = recording(2000, |i, r| change(i as f64, &mut r[4]));
        let reading = load(&small(), &a, &recording(2000, still)).unwrap();
        let of_wind = |f: &&RunFinding| f.what.starts_with("the wind speed is");
        let doubts = reading.findings.iter().filter(of_wind);
        doubts
            .map(|f| (f.severity, f.what.clone()))
            .collect::<Vec<_>>()
    };
    // gusts of a tenth, some of them as long as half of the recording
    let gusts: Change = |i, v| *v += 0.8 * ((0.37 * i).sin() + (TAU * i / 1300.0).cos());
    assert_eq!(found(gusts), []);
    let wrong: [(Change, &str); 4] = [
        (
            |i, v| {
                if i % 50.0 == 0.0 {
                    *v = 60.0
                }
            },
            "drops out",
        ),
        (
            |i, v| {
                if i < 460.0 {
                    *v = 0.0
                }
            },
            "begins late",
        ),
        (
            |i, v| {
                if i > 1500.0 {
                    *v = 0.0
                }
            },
            "or stops",
        ),
        (|i, v| *v *= 1.0 + 0.2 * i / 2000.0, "drifts"),
    ];
    for (change, words) in wrong {
        let found = found(change);
        assert!(
            found.len() == 1 && found[0].0 == FindingSeverity::Doubt && found[0].1.contains(words),
            "{words}: {found:?}"
        );
    }
}
