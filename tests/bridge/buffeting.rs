//! Buffeting of whole bridges: both domains agree, and fields have the coherence that was asked for.

use crate::bridges::{TWO, langenuen_text, read};

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

#[test]
fn both_domains_agree() {
    let study = read(&text());
    let block = study.buffeting_block().unwrap();
    let found = study.buffeting(&block, 35.0, &|_, _| {}).unwrap();
    for n in 0..2 {
        // nothing drives the selected modes sideways but what they share
        for i in [0, 2] {
            let (frequency, time) = (found.frequency.rms[n][i], found.time.rms[n][i]);
            let error = found.time.standard_error[n][i];
            println!("node {n}, motion {i}: {frequency:.5e} {time:.5e} ± {error:.1e}");
            assert!(error < 0.06 * time, "records are too short to tell");
            assert!(
                (time - frequency).abs() < 3.5 * error,
                "{frequency} {time} ± {error}"
            );
            // the spectrum holds the variance
            let (f, s) = (
                &found.spectra.frequencies_hz,
                &found.spectra.densities[n][i],
            );
            let trapezoid: f64 = (1..f.len())
                .map(|k| 0.5 * (s[k] + s[k - 1]) * (f[k] - f[k - 1]))
                .sum();
            let part = trapezoid / (frequency * frequency);
            assert!((part - 1.0).abs() < 0.02, "{part} of the variance");
            // Davenport's expectation scatters by a few per cent over twelve records
            let peak = found.time.peak_factor[n][i] / found.expected_peak_factor[n][i];
            assert!((peak - 1.0).abs() < 0.12, "{peak}");
        }
    }
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
