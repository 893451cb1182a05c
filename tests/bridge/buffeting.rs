//! Buffeting of whole bridges: both domains agree, and fields have the coherence that was asked for.

use crate::bridges::{THREE, TWO, langenuen_text, read};
use aerodeck::study::bridge::BridgeStudy;

/// A lively bridge, so that records are long against the decay of its modes.
fn text() -> String {
    langenuen_text("LN21-5200", TWO, "modified_akima")
        .replace("damping_ratio = 0.002", "damping_ratio = 0.02\nselect = [2, 3, 5, 7, 12, 23]")
        .replace(
            "motions =",
            "static = { drag = 0.08, lift = -0.1, lift_slope = 4.0, moment = 0.02, moment_slope = 1.1 }\nmotions =",
        )
        + "[buffeting]\nnodes = [\"1081\", \"1156\"]\n\
           along = { spectrum = { shape = { kind = \"kaimal\" }, length_m = 150.0, intensity = 0.12 } }\n\
           vertical = { spectrum = { shape = { kind = \"von_karman\" }, length_m = 40.0, intensity = 0.06 }, admittance = { kind = \"liepmann\" } }\n\
           coherence = { along = 9.0, vertical = 6.5 }\n\
           time = { records = 12, duration_s = 1200.0, step_s = 0.1, seed = 7 }\n"
}

/// Against the vertical modes of 0.105 and 0.139 Hz, and sideways to the ground.
const DAMPERS: &str = "[[damper]]\nnode = \"1081\"\nmotion = \"vertical\"\nmass_kg = 90e3\nfrequency_hz = 0.103\ndamping_ratio = 0.1\n\
    [[damper]]\nnode = \"1156\"\nmotion = \"vertical\"\nmass_kg = 90e3\nfrequency_hz = 0.136\ndamping_ratio = 0.1\n\
    [[damper]]\nnode = \"1156\"\nmotion = \"lateral\"\ncoefficient = 1e5\n";

#[test]
fn both_domains_agree() {
    let plain = agreed(&text());
    let damped = agreed(&(text() + DAMPERS));
    for (damped, plain) in damped.iter().zip(&plain) {
        assert!(damped[0] < 0.99 * plain[0], "{damped:?}, {plain:?}");
    }
}

/// Holds both domains against one another; root mean squares of the named nodes.
fn agreed(text: &str) -> Vec<[f64; 3]> {
    let study = read(text);
    let block = study.buffeting_block().unwrap();
    let found = study.buffeting(&block, 35.0, &|_, _| {}).unwrap();
    for n in 0..2 {
        // nothing drives the selected modes sideways but what they share
        for i in [0, 2] {
            // the records are those of the models
            let records = found.time.as_ref().unwrap();
            let by_models = found.models.as_ref().unwrap().response.as_ref().unwrap();
            let (frequency, time) = (by_models.rms[n][i], records.rms[n][i]);
            let error = records.standard_error[n][i];
            println!("node {n}, motion {i}: {frequency:.5e} {time:.5e} ± {error:.1e}");
            assert!(error < 0.06 * time, "records are too short to tell");
            assert!(
                (time - frequency).abs() < 3.5 * error,
                "{frequency} {time} ± {error}"
            );
            // the spectrum holds the variance
            let (f, s) = (
                &found.spectra.frequency_hz,
                &found.spectra.motion[3 * n + i],
            );
            let trapezoid: f64 = (1..f.len())
                .map(|k| 0.5 * (s[k] + s[k - 1]) * (f[k] - f[k - 1]))
                .sum();
            let part = trapezoid / found.frequency.rms[n][i].powi(2);
            assert!((part - 1.0).abs() < 0.02, "{part} of the variance");
            // Davenport's expectation scatters by a few per cent over twelve records
            let peak = records.peak_factor[n][i] / found.expected_peak_factor[n][i];
            assert!((peak - 1.0).abs() < 0.12, "{peak}");
        }
    }
    found.frequency.rms.clone()
}

/// Half the wind all along the bridge, twice as fast, is the same wind.
#[test]
fn the_wind_of_a_profile_is_that_at_the_girder() {
    let halved = "[wind]\nprofile = [{ along_m = 0, factor = 0.5 }]\n";
    let [a, b] = [(text(), 30.0), (text() + halved, 60.0)].map(|(text, speed_m_s)| {
        let study = read(&text.replace("records = 12", "records = 2"));
        let block = study.buffeting_block().unwrap();
        let found = study.buffeting(&block, speed_m_s, &|_, _| {}).unwrap();
        [found.frequency.rms, found.time.unwrap().rms].concat()
    });
    for (a, b) in a.as_flattened().iter().zip(b.as_flattened()) {
        assert!((a - b).abs() < 1e-6 * a, "{a} {b}");
    }
}

const STATICS: &str = "static = { drag = 0.08, lift = -0.15, moment = 0.03, lift_slope = 4.5, moment_slope = 1.2 }\nmotions =";
const GUSTS: &str = "[buffeting]\nnodes = [\"1081\", \"1156\"]\n\
    along = { spectrum = { shape = { kind = \"kaimal\" }, length_m = 150.0, intensity = 0.12 } }\n\
    vertical = { spectrum = { shape = { kind = \"kaimal\" }, length_m = 15.0, intensity = 0.06 } }\n\
    coherence = { along = 10.0, vertical = 6.5 }\n\
    time = { records = 2, duration_s = 20.0, step_s = 0.1, seed = 1 }\n";

fn with_gusts(deck: &str, motions: &str) -> BridgeStudy {
    let text = langenuen_text(deck, motions, "linear_v_hat");
    read(&(text.replace("motions =", STATICS) + GUSTS))
}

/// The table is the answer of the frequency domain. Its figures: NumPy, the coherence of all pairs of nodes as a full matrix,
/// trapezoids over 14 000 frequencies (which agree with 5 000 to 4e-4).
#[test]
fn the_frequency_domain_takes_the_table() {
    let study = with_gusts("LN21-5200", THREE);
    let block = study.buffeting_block().unwrap();
    let expected = [
        [0.771_143_79, 0.452_205_55, 0.010_220_64],
        [0.639_031_17, 0.601_053_89, 0.011_336_14],
    ];
    let found = study.buffeting(&block, 45.0, &|_, _| {}).unwrap();
    for (found, expected) in found.frequency.rms.iter().zip(expected) {
        for (found, expected) in found.iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
        }
    }
    // what is stepped in time is a fit, whose rotation is a quarter larger
    let models = found.models.unwrap();
    assert!(models.fits[0].contains("Laguerre"), "{}", models.fits[0]);
    let (node, motion, change) = models.largest().unwrap();
    println!("{:?}", models.change);
    assert_eq!((node, motion), (1, 2));
    assert!((0.24..0.28).contains(&change), "{change}");
    let by_model = models.response.unwrap();
    let ratio = by_model.rms[1][2] / found.frequency.rms[1][2] - 1.0;
    assert!((ratio - change).abs() < 1e-12);
    // but in gusts slower than any test, which move the girder as by their stiffness at rest: there nine tenths of that variance
    // lie, and a table that holds its derivatives knows no such stiffness
    let parts = found.frequency.part_in_tested_range.unwrap();
    assert!(parts[1][2] < 0.12, "{}", parts[1][2]);
    let model_parts = by_model.part_in_tested_range.unwrap();
    for (node, (table, model)) in parts.iter().zip(&model_parts).enumerate() {
        for (i, (table, model)) in table.iter().zip(model).enumerate() {
            assert!((0.0..=1.0).contains(table) && (0.0..=1.0).contains(model));
            let inside = by_model.rms[node][i] * model.sqrt();
            let change = inside / (found.frequency.rms[node][i] * table.sqrt()) - 1.0;
            println!("node {node}, motion {i}: {change:+.4} inside the tested range");
            assert!(change.abs() < 0.04, "{change}");
        }
    }
}

/// The onset by this table is 76.384 m/s, by the model above it: the table decides what is refused.
#[test]
fn beyond_the_onset_of_the_table_there_is_no_response() {
    let study = with_gusts("LN21-5200", TWO);
    let block = study.buffeting_block().unwrap();
    assert!(study.buffeting(&block, 76.3, &|_, _| {}).is_ok());
    let refused = study.buffeting(&block, 76.45, &|_, _| {}).unwrap_err();
    let text = refused.to_string();
    assert!(text.contains("2 growing roots near 0.330"), "{text}");
    assert!(text.contains("inside the tested range"), "{text}");
}

/// A table whose sway feeds the motion where its tests end says where it does.
#[test]
fn growth_where_nothing_was_tested_is_named() {
    let study = with_gusts("LN21-5500", THREE);
    let block = study.buffeting_block().unwrap();
    let refused = study.buffeting(&block, 20.0, &|_, _| {}).unwrap_err();
    let text = refused.to_string();
    assert!(text.contains("where nothing was tested"), "{text}");
}

#[test]
fn fields_are_seeded_and_have_their_variance_and_coherence() {
    let study = read(&text());
    let block = study.buffeting_block().unwrap();
    let field = study.first_field(&block, 35.0).unwrap();
    assert_eq!(field, study.first_field(&block, 35.0).unwrap());
    assert_eq!(field.samples(), 12_000);
    let mean =
        |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(a, b)| a * b).sum::<f64>() / x.len() as f64;
    let variances: Vec<f64> = field.gusts[1].iter().map(|row| mean(row, row)).collect();
    let average = variances.iter().sum::<f64>() / variances.len() as f64;
    // σ = 0.06 · 35 m/s, less what lies beyond 5 Hz and below 1/2400 Hz
    assert!((average / (2.1 * 2.1) - 1.0).abs() < 0.06, "{average}");
    // neighbours are nearly alike, the ends of the bridge are not
    let last = field.gusts[1].len() - 1;
    let correlation = |a: usize, b: usize| {
        mean(&field.gusts[1][a], &field.gusts[1][b]) / (variances[a] * variances[b]).sqrt()
    };
    assert!(correlation(30, 31) > 0.5 && correlation(0, last).abs() < 0.2);
}

/// Lines 1/600 Hz apart fall beside a resonance of 0.055 Hz with a decay time of 24 minutes, or upon it: the RMS was 1.6 times as large.
#[test]
fn records_of_no_stated_length_resolve_every_mode() {
    let lateral = |time: &str| {
        let text = langenuen_text("LN21-5200", TWO, "linear_v_hat").replace("motions =", STATICS);
        let text = text.replace(
            "damping_ratio = 0.002",
            "damping_ratio = 0.002\nselect = [1, 2, 3]",
        );
        let mut gusts = GUSTS
            .lines()
            .filter(|l| !l.starts_with("time"))
            .collect::<Vec<_>>();
        gusts.push(time);
        let study = read(&(text + &gusts.join("\n")));
        let block = study.buffeting_block().unwrap();
        let found = study.buffeting(&block, 30.0, &|_, _| {}).unwrap();
        let models = found.models.unwrap().response.unwrap();
        (
            models.rms[1][1],
            found.expected_peak_factor[1][1],
            found.time.unwrap(),
        )
    };
    let (frequency, peak, records) = lateral("time = { records = 64, step_s = 0.4 }");
    let (time, error) = (records.rms[1][1], records.standard_error[1][1]);
    println!(
        "{frequency:.4} {time:.4} ± {error:.4} m, {} s, peak {peak:.3}",
        records.record_s
    );
    assert!((6000.0..=7800.0).contains(&records.record_s) && records.too_short.is_none());
    assert!(error < 0.05 * time && (time - frequency).abs() < 3.0 * error);
    // stated, it is taken, and doubted
    let (_, of_600, short) = lateral("time = { records = 2, step_s = 0.4, duration_s = 600.0 }");
    assert!(peak == of_600 && short.record_s == 600.0);
    let why = short.too_short.unwrap();
    assert!(
        why.contains("decay times of the least damped mode at 30 m/s, found 600 s"),
        "{why}"
    );
}
