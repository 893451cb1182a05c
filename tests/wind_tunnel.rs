//! From raw virtual campaigns with every disturbance to derivatives and onset.

use aerodeck::aerodynamics::derivatives::Part;
use aerodeck::aerodynamics::{FlatPlate, Realizable};
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::files::derivatives::embedded;
use aerodeck::flutter::{OnsetSearch, find_onset};
use aerodeck::identification::derivatives::{
    DerivativeOptions, IdentifiedDerivatives, identify_derivatives,
};
use aerodeck::identification::{Fitted, TimeFit, fit_records};
use aerodeck::section::{Dof, SectionModel};
use aerodeck::wind_tunnel::processing::{ProcessingOptions, process};
use aerodeck::wind_tunnel::virtual_campaign::{VirtualCampaign, VirtualCampaignPlan};
use aerodeck::wind_tunnel::{Record, RecordSource};

fn sources(records: &[Record]) -> Vec<&dyn RecordSource> {
    records.iter().map(|r| r as &dyn RecordSource).collect()
}

/// Onset of the Table 4.1 section with the default Laguerre model of the records, m/s.
fn onset_m_s(records: &[Record]) -> f64 {
    let Fitted { model, report } =
        fit_records(&sources(records), &TimeFit::default(), &|_, _| {}).unwrap();
    let structure = SectionModel::table_4_1().structure().unwrap();
    let section = CoupledSection::new(structure, model.realize()).unwrap();
    let search = OnsetSearch {
        speed_max_m_s: 60.0,
        speeds: 120,
    };
    find_onset("model", &section, &search, Some(report.tested_range))
        .unwrap()
        .onset()
        .unwrap()
        .at
        .speed_m_s
}

/// Greatest error of the real and imaginary parts of the dominant entries, relative to the entry.
struct Errors {
    greatest: f64,
    place: String,
    rms: f64,
    count: usize,
}

/// Dominant: |G| above 10 % of the largest of the same force in the same run group (speed).
fn errors(made: &VirtualCampaign, found: &IdentifiedDerivatives) -> Errors {
    let points = &made.points;
    let largest = |force: Dof| {
        points
            .iter()
            .filter(|p| p.force == force)
            .map(|p| p.real.hypot(p.imaginary))
            .fold(0.0, f64::max)
    };
    let mut result = Errors {
        greatest: 0.0,
        place: String::new(),
        rms: 0.0,
        count: 0,
    };
    for p in points {
        let size = p.real.hypot(p.imaginary);
        if size < 0.1 * largest(p.force) {
            continue;
        }
        let part = |part| {
            let derivative = aerodeck::aerodynamics::derivatives::Derivative::from_entry(
                p.force, p.motion, part,
            );
            let e = found
                .each(derivative)
                .find(|e| e.run == p.run && (e.frequency_hz / p.frequency_hz - 1.0).abs() < 0.01)
                .unwrap();
            e.value / (e.v_hat * e.v_hat)
        };
        let (re, im) = (part(Part::Real), part(Part::Imaginary));
        let error = (re - p.real).hypot(im - p.imaginary) / size;
        result.rms += error * error;
        result.count += 1;
        if error > result.greatest {
            result.greatest = error;
            result.place = format!("{} {:.2} Hz {:?}", p.run, p.frequency_hz, p.force);
        }
    }
    result.rms = (result.rms / result.count as f64).sqrt();
    result
}

fn measure(name: &str, seed: u64) -> (f64, f64) {
    let mut plan = VirtualCampaignPlan::realistic();
    plan.tunnel.seed = seed;
    let made = if name == "flat plate" {
        plan.from_model(&FlatPlate::default(), name, 0.5).unwrap()
    } else {
        plan.from_table(&embedded::deck(name).unwrap(), &Dof::TWO)
            .unwrap()
    };
    let processed = process(&made.raw, &ProcessingOptions::default(), &|_, _| {}).unwrap();
    let found =
        identify_derivatives(&sources(&processed.records), &DerivativeOptions::default()).unwrap();
    let errors = errors(&made, &found);
    let onset = onset_m_s(&processed.records);
    let clean = onset_m_s(&made.records);
    let off = onset / clean - 1.0;
    println!(
        "{name} seed {seed}: greatest {:.3} % ({}), RMS {:.3} % of {}; onset {onset:.3} against {clean:.3} m/s, {:+.3} %; lag {:.4} ms",
        100.0 * errors.greatest,
        errors.place,
        100.0 * errors.rms,
        errors.count,
        100.0 * off,
        1e3 * processed.report.lag_s
    );
    (errors.greatest, off)
}

#[test]
fn derivatives_within_two_per_cent_and_onset_within_half_a_per_cent() {
    for (deck, seed) in [("flat plate", 1), ("LN21-5200", 2), ("LN21-6100", 3)] {
        let (greatest, off) = measure(deck, seed);
        assert!(greatest < 0.02, "{deck}, seed {seed}: {greatest}");
        assert!(off.abs() < 0.005, "{deck}, seed {seed}: {off}");
    }
}

/// The figures of `docs/processing.md`: `cargo test --release --test wind_tunnel -- --ignored --nocapture`
#[test]
#[ignore = "five minutes: every deck, five seeds"]
fn figures_of_many_campaigns() {
    for deck in [
        "flat plate",
        "LN20-5500",
        "LN21-5200",
        "LN21-5500",
        "LN21-5800",
        "LN21-6100",
    ] {
        for seed in 1..=5 {
            measure(deck, seed);
        }
    }
}

/// Where the deviation of the onset comes from: noise alone on clean records, and processing without noise.
#[test]
#[ignore = "minutes: the most sensitive deck, four ways"]
fn shares_of_the_deviation_of_the_onset() {
    for name in ["LN21-6100", "LN21-5800"] {
        let table = embedded::deck(name).unwrap();
        let mut plan = VirtualCampaignPlan::realistic();
        plan.tunnel.noise_fraction = 0.0;
        let clean = onset_m_s(&plan.tunnel.records_from_table(&table, &Dof::TWO).unwrap());
        let quiet = plan.from_table(&table, &Dof::TWO).unwrap();
        let with = |options: &ProcessingOptions| {
            onset_m_s(&process(&quiet.raw, options, &|_, _| {}).unwrap().records)
        };
        let mut options = ProcessingOptions::default();
        let processed = with(&options);
        options.low_pass.order = 0;
        let unfiltered = with(&options);
        println!(
            "{name}: clean {clean:.3}; processed without noise {:+.3} %, without low-pass {:+.3} %",
            100.0 * (processed / clean - 1.0),
            100.0 * (unfiltered / clean - 1.0)
        );
        for seed in 1..=4 {
            plan.tunnel.noise_fraction = 0.05;
            plan.tunnel.seed = seed;
            let noisy = plan.tunnel.records_from_table(&table, &Dof::TWO).unwrap();
            println!(
                "  noise alone, seed {seed}: {:+.3} %",
                100.0 * (onset_m_s(&noisy) / clean - 1.0)
            );
        }
    }
}

/// Drift stands in the axes of the cells, which turn with the model: P2*, P3* and their standard errors must not notice. The deck's
/// own errors of the ramps are a few 1e-3 of an entry, so that only the noise of a test is compared.
#[test]
fn drift_of_the_cells_leaves_drag_due_to_rotation_and_its_errors() {
    let table = embedded::deck("LN21-5200").unwrap();
    let of = |drift_n: f64, seed: u64| {
        let mut plan = VirtualCampaignPlan::default();
        plan.tunnel.noise_fraction = 0.02;
        plan.tunnel.seed = seed;
        plan.disturbances.drift_n = drift_n;
        let made = plan.from_table(&table, &Dof::THREE).unwrap();
        let processed = process(&made.raw, &ProcessingOptions::default(), &|_, _| {}).unwrap();
        identify_derivatives(&sources(&processed.records), &DerivativeOptions::default()).unwrap()
    };
    use aerodeck::aerodynamics::derivatives::Derivative;
    let mut ratios = Vec::new();
    for seed in 1..=2 {
        let (still, drifting) = (of(0.0, seed), of(0.6, seed));
        for d in [
            Derivative::P2,
            Derivative::P3,
            Derivative::H2,
            Derivative::H3,
        ] {
            for (a, b) in still.each(d).zip(drifting.each(d)) {
                let size = (b.value - a.value).abs() / b.standard_error;
                ratios.push(size);
                assert!(
                    size < 2.0,
                    "{d} {} {:.2} Hz: {size} standard errors",
                    b.run,
                    b.frequency_hz
                );
            }
        }
    }
    let rms = (ratios.iter().map(|r| r * r).sum::<f64>() / ratios.len() as f64).sqrt();
    println!(
        "drift moves P2*, P3*, H2*, H3* by {rms:.3} standard errors, root mean square of {}",
        ratios.len()
    );
    // same noise in both: what differs is the drift that is left
    assert!(rms < 0.5, "{rms}");
}
