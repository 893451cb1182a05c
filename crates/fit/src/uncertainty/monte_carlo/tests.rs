//! Analyses against closed forms, single searches and other numbers of threads.

use super::*;
use crate::aerodynamics::{RationalModel, Realizable};
use crate::aeroelastic::CoupledSection;
use crate::flutter::{OnsetSearch, find_onset};
use crate::section::SectionModel;
use crate::trained_model::{Experiment, Model, Provenance, SCHEMA_VERSION, TrainedModel};
use crate::units::{ReducedFrequency as K, ReducedFrequencyRange};

fn jones() -> TrainedModel {
    TrainedModel {
        schema_version: SCHEMA_VERSION,
        name: "flat plate".into(),
        section: SectionModel::iabse_1_1a(),
        model: Model::Rational(RationalModel::jones_flat_plate()),
        tested_range: ReducedFrequencyRange::between(
            K::from_full_width(0.05),
            K::from_full_width(2.0),
        ),
        provenance: Provenance {
            source: "R. T. Jones".into(),
            licence: "public".into(),
            method: "closed form".into(),
            aerodeck_version: "0".into(),
            notes: vec![],
        },
        experiment: Experiment {
            wind_speed_m_s: 60.0,
            initial_vertical_m: 0.1,
            initial_rotation_rad: 0.0,
            stop_time_s: 10.0,
            step_size_s: 0.01,
            onset_search_limit_m_s: 120.0,
        },
    }
}

const HEAD: &str = "schema = 1\nmodel = \"model.json\"\nsamples = 4000\nspeed_max_m_s = 120.0\n";

fn plan(rest: &str) -> MonteCarloPlan {
    MonteCarloPlan::from_toml(&format!("{HEAD}{rest}"), "".into()).unwrap()
}

fn refused(rest: &str) -> String {
    let text = format!("{HEAD}{rest}");
    MonteCarloPlan::from_toml(&text, "".into())
        .unwrap_err()
        .to_string()
}

fn run(plan: &MonteCarloPlan) -> MonteCarloResult {
    monte_carlo(plan, &jones(), &|_, _| ()).unwrap()
}

/// With the air density alone random and uniform, quantiles of the onset are onsets at quantiles of the density: at
/// 1.20 and 1.25 kg/m³ 77.2838 and 75.8002 m/s (reference table).
#[test]
fn one_parameter_maps_quantiles() {
    let plan = plan(
        "quantiles = [0.25, 0.75]\n[[parameter]]\nname = \"air_density_kg_m3\"\n\
         distribution = { kind = \"uniform\", lower = 1.175, upper = 1.275 }\n",
    );
    let result = run(&plan);
    assert_eq!((result.onsets, result.stable, result.failed), (4000, 0, 0));
    assert!((result.nominal_m_s.unwrap() - 76.6790).abs() < 5e-5);
    // a quartile of 4000 samples is known to ±√(3/16/4000) = 0.7 % in probability, 0.02 m/s; three times that
    for (quantile, expected) in result.quantiles.iter().zip([75.8002, 77.2838]) {
        assert!(
            (quantile.speed_m_s.unwrap() - expected).abs() < 0.06,
            "{quantile:?}"
        );
    }
    assert_eq!(result.histogram.counts.iter().sum::<u64>(), 4000);
    assert_eq!(result.averaged_in_words(), None);
}

/// A quantile beyond which less than one sample is expected is not stated, whichever the outermost sample is.
#[test]
fn samples_too_few_for_a_quantile_do_not_tell_it() {
    let mut plan = plan(
        "quantiles = [0.09, 0.1, 0.9, 0.95]\n[[parameter]]\nname = \"air_density_kg_m3\"\n\
         distribution = { kind = \"uniform\", lower = 1.175, upper = 1.275 }\n",
    );
    let too_few = |samples: usize, plan: &mut MonteCarloPlan| -> Vec<bool> {
        plan.samples = samples;
        let quantiles = run(plan).quantiles;
        let alike = |q: &Quantile| q.too_few_samples == (q.ends_m_s == [None, None]);
        assert!(
            quantiles
                .iter()
                .all(|q| alike(q) && q.speed_m_s.is_none() == q.too_few_samples)
        );
        quantiles.iter().map(|q| q.too_few_samples).collect()
    };
    assert_eq!(too_few(1, &mut plan), [true; 4]);
    assert_eq!(too_few(10, &mut plan), [true, false, false, true]);
    assert_eq!(too_few(20, &mut plan), [false; 4]);
}

#[test]
fn the_design_check_counts() {
    let plan = plan(
        "design_speed_m_s = 76.0\nseed = 5\n[[parameter]]\nname = \"air_density_kg_m3\"\n\
         distribution = { kind = \"uniform\", lower = 1.175, upper = 1.275 }\n",
    );
    let design = run(&plan).design.unwrap();
    // the density at which the onset is 76 m/s, from the onsets at 1.20 and 1.25 by their nearly straight line
    let density = 1.20 + 0.05 * (77.2838 - 76.0) / (77.2838 - 75.8002);
    let expected = (1.275 - density) / 0.1;
    assert!(
        design.lower < expected && expected < design.upper,
        "{design:?} {expected}"
    );
    assert_eq!(design.probability, design.below as f64 / 4000.0);
}

/// A mean in another unit is odd against the model and by itself; one of the model's order is neither.
#[test]
fn means_of_another_order_are_found() {
    let found = |name: &str, distribution: &str| {
        let text =
            format!("[[parameter]]\nname = \"{name}\"\ndistribution = {{ {distribution} }}\n");
        run(&plan(&text)).findings
    };
    let mass = "vertical.mass_kg_m";
    let light = "kind = \"normal\", mean = 23.0, coefficient_of_variation = 0.05";
    let of_mass = &found(mass, light)[0];
    assert_eq!((of_mass.place.as_str(), of_mass.value), (mass, Some(23.0)));
    assert!(
        of_mass.text.ends_with("where the model has 22740"),
        "{of_mass}"
    );
    let damping = found(
        "torsion.damping_ratio",
        "kind = \"uniform\", lower = 0.2, upper = 0.4",
    );
    let places: Vec<_> = damping.iter().map(|f| f.place.as_str()).collect();
    assert_eq!(
        places,
        ["torsion.damping_ratio", "section.torsion.damping_ratio"]
    );
    let heavier = "kind = \"lognormal\", mean = 25000.0, coefficient_of_variation = 0.05";
    assert_eq!(found(mass, heavier), []);
}

const EVERYTHING: &str = "seed = 11\n\
    [aerodynamics]\nrelative_scatter = 0.03\n\
    [[parameter]]\nname = \"torsion.damping_ratio\"\n\
    distribution = { kind = \"lognormal\", coefficient_of_variation = 0.4 }\n\
    [[parameter]]\nname = \"vertical.mass_kg_m\"\n\
    distribution = { kind = \"normal\", coefficient_of_variation = 0.05 }\n\
    [[parameter]]\nname = \"torsion.inertia_kg_m2_m\"\n\
    distribution = { kind = \"normal\", coefficient_of_variation = 0.05, lower = 2.0e6 }\n\
    [[correlation]]\nbetween = [\"vertical.mass_kg_m\", \"torsion.inertia_kg_m2_m\"]\ncoefficient = 0.7\n";

#[test]
fn the_number_of_threads_changes_nothing() {
    let plan = plan(EVERYTHING);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| run(&plan))
    };
    let one = with(1);
    assert_eq!(one, with(3));
    assert!(one.standard_deviation_m_s.unwrap() > 0.5);
}

/// The same samples through the sweep and, one by one, through the search by eigenvalues.
#[test]
fn samples_are_those_of_single_searches() {
    let plan = plan(EVERYTHING);
    let model = jones();
    let (values, _) = coefficients::list(&model.model);
    let sampler = sampler::Sampler::new(&plan, &model.section, &values, None).unwrap();
    let mut sample = sampler.empty();
    let mut speeds = Vec::new();
    for index in 0..1000 {
        sampler.draw(index, &mut sample);
        let mut changed = model.model.clone();
        coefficients::replace(&mut changed, &sample.coefficients);
        assert_eq!(coefficients::list(&changed).0, sample.coefficients);
        let structure = sample.section.structure().unwrap();
        let coupled = CoupledSection::new(structure, changed.realize()).unwrap();
        let search = OnsetSearch {
            speed_max_m_s: 120.0,
            speeds: 100,
        };
        let found = find_onset("", &coupled, &search, Some(model.tested_range)).unwrap();
        speeds.push(found.onset().unwrap().at.speed_m_s);
    }
    let mean = speeds.iter().sum::<f64>() / 1000.0;
    let fewer = MonteCarloPlan {
        samples: 1000,
        ..plan
    };
    let result = run(&fewer);
    assert_eq!((result.onsets, result.searched_in_full), (1000, 0));
    assert!((result.mean_m_s.unwrap() / mean - 1.0).abs() < 1e-11);
}

/// Draws by a covariance with degrees of freedom are Student's t with one scale for all: of its quantiles for 4 degrees of freedom
/// (2.776 at 95 %, 4.604 at 99 %, tables) as many draws lie outside as it says. Gaussian draws leave 0.55 % and 4e-6 there.
#[test]
fn draws_by_a_fit_have_the_tails_of_its_degrees_of_freedom() {
    let (model, plan) = (jones(), plan(EVERYTHING));
    let (values, _) = coefficients::list(&model.model);
    let plan = MonteCarloPlan {
        aerodynamics: AerodynamicScatter::default(),
        ..plan
    };
    let factor = scatter::CovarianceFactor {
        places: vec![0, 1],
        factor: nalgebra::DMatrix::from_diagonal_element(2, 2, 0.1),
        draws: DrawnForces {
            degrees_of_freedom: Some(4.0),
            ..DrawnForces::default()
        },
    };
    let sampler = sampler::Sampler::new(&plan, &model.section, &values, Some(factor)).unwrap();
    let mut sample = sampler.empty();
    let (mut beyond, mut both) = ([0.0; 2], 0.0);
    const SAMPLES: u32 = 20_000;
    for index in 0..SAMPLES {
        sampler.draw(u64::from(index), &mut sample);
        let standard = [0, 1].map(|i| ((sample.coefficients[i] - values[i]) / 0.1).abs());
        beyond[0] += f64::from(standard[0] > 2.776);
        beyond[1] += f64::from(standard[0] > 4.604);
        both += f64::from(standard.iter().all(|s| *s > 4.604));
    }
    let share = |count: f64| count / f64::from(SAMPLES);
    // three times the standard deviation of a counted share
    for (count, expected) in beyond.into_iter().zip([0.05_f64, 0.01]) {
        let scatter = (expected * (1.0 - expected) / f64::from(SAMPLES)).sqrt();
        assert!((share(count) - expected).abs() < 3.0 * scatter, "{count}");
    }
    // independent ones would be there together in 1e-4
    assert!(share(both) > 5e-4, "{both}");
}

#[test]
fn impossible_samples_are_counted_and_named() {
    let mut plan = plan(
        "[[parameter]]\nname = \"vertical.mass_kg_m\"\n\
         distribution = { kind = \"normal\", coefficient_of_variation = 0.5 }\n",
    );
    plan.design_speed_m_s = Some(1.0);
    plan.quantiles = vec![0.01, 0.5];
    let result = run(&plan);
    // they may flutter anywhere: not safe at the design speed, and below every quantile or above it
    let design = result.design.unwrap();
    assert_eq!(design.undecided, result.failed as u64);
    assert_eq!(design.probability, result.failed as f64 / 4000.0);
    assert!(design.upper > design.probability && design.below == 0 && design.lower == 0.0);
    let [first, median] = &result.quantiles[..] else {
        panic!("{:?}", result.quantiles);
    };
    assert_eq!((first.ends_m_s[0], first.speed_m_s), (Some(0.0), None));
    let [Some(low), Some(high)] = median.ends_m_s else {
        panic!("{median:?}");
    };
    assert!(low < high && high < 1.05 * low, "{low}, {high}");
    // Φ(−2) = 2.3 % of the masses are negative
    assert!((60..130).contains(&result.failed), "{}", result.failed);
    assert!(
        result.failures[0].reason.contains("vertical.mass_kg_m"),
        "{:?}",
        result.failures[0]
    );
    assert_eq!(result.onsets + result.stable + result.failed, 4000);
    // mean and standard deviation are those of the rest
    let of = result.averaged_in_words().unwrap();
    let expected = format!("of the {} of 4000 samples with an onset", result.onsets);
    assert!(of.starts_with(&expected), "{of}");
}

#[test]
fn samples_that_all_fail_are_no_distribution() {
    let mut all = plan(
        "[[parameter]]\nname = \"torsion.frequency_hz\"\n\
         distribution = { kind = \"normal\", mean = -5.0, standard_deviation = 0.1 }\n",
    );
    all.design_speed_m_s = Some(35.0);
    let said = monte_carlo(&all, &jones(), &|_, _| ()).unwrap_err();
    let said = said.to_string();
    assert!(
        said.contains("expected some with an answer, found none; the first: "),
        "{said}"
    );
    assert!(said.contains("torsion.frequency_hz"), "{said}");
}

#[test]
fn wrong_files_are_refused_with_their_line() {
    let parameter = "[[parameter]]\nname = \"width_m\"\ndistribution = { kind = \"uniform\", lower = 1.0, upper = 2.0 }\n";
    for (rest, said) in [
        ("", "something random"),
        ("design_speed_m_s = 130.0\n", "line 5, design_speed_m_s"),
        ("confidence = 1.5\n", "line 5, confidence"),
        ("quantiles = [0.5, 1.0]\n", "line 5, quantiles[1]"),
        ("[[parameter]]\nname = \"weight\"\n", "line 6"),
        (
            "[[parameter]]\nname = \"width_m\"\ndistribution = { kind = \"cauchy\" }\n",
            "line 7",
        ),
        (&format!("{parameter}{parameter}"), "parameter[1].name"),
        (
            &format!(
                "{parameter}[[correlation]]\nbetween = [\"width_m\", \"air_density_kg_m3\"]\ncoefficient = 0.1\n"
            ),
            "not random",
        ),
        (
            "[aerodynamics]\nrelative_scatter = -0.1\n",
            "line 6, aerodynamics.relative_scatter",
        ),
    ] {
        let message = refused(rest);
        assert!(message.contains(said), "`{said}` is not in: {message}");
    }
    // what does not fit the model
    let plan = plan(
        "[[parameter]]\nname = \"torsion.stiffness_n\"\ndistribution = { kind = \"uniform\", lower = 1.0, upper = 2.0 }\n",
    );
    let message = monte_carlo(&plan, &jones(), &|_, _| ())
        .unwrap_err()
        .to_string();
    assert!(message.contains("parameter[0].name"), "{message}");
}
