//! Both domains against each other: exactly for one record, within the sampling error for many.

use super::*;
use crate::aerodynamics::RationalModel;
use crate::aerodynamics::quasi_steady::{Arms, QuasiSteady};
use crate::buffeting::{
    Admittance, FrequencyDomain, Gust, GustSpectrum, SpectrumShape, Turbulence, turbulence_field,
};
use crate::error::Error;
use crate::flutter::impedance;
use crate::section::{SectionModel, Structure, Translation};
use aerodeck_lab::files::coefficients::embedded;
use nalgebra::{Complex, DVector};
use std::f64::consts::{PI, TAU};

fn turbulence(admittance: Admittance) -> Turbulence {
    let gust = |shape, length_m, intensity| Gust {
        spectrum: GustSpectrum {
            shape,
            length_m,
            intensity,
        },
        admittance,
    };
    Turbulence {
        along: Some(gust(SpectrumShape::Kaimal {}, 120.0, 0.1)),
        vertical: Some(gust(SpectrumShape::VonKarman {}, 40.0, 0.06)),
    }
}

fn three_dof() -> (Structure, QuasiSteady) {
    let mut section = SectionModel::iabse_1_1a();
    section.lateral = Some(Translation {
        mass_kg_m: 22_740.0,
        frequency_hz: Some(0.07),
        stiffness_n_m2: None,
        damping_ratio: 0.005,
    });
    let structure = section.structure().unwrap();
    let arms = Arms {
        vertical: -0.25,
        torsion: 0.2,
        lateral: 0.0,
    };
    let table = embedded::coefficients("synthetic box girder").unwrap();
    let theory = QuasiSteady::new(table, arms, &structure.dofs).unwrap();
    (structure, theory)
}

/// The mean square of one record is the sum over its Fourier coefficients of `|H F_k|²`, with the factor `sinc²` that straight
/// lines between samples put on each: no sampling error is left.
fn exact_for_one_record(problem: &BuffetingProblem<'_>, speed: f64) {
    let plan = TimePlan {
        duration_s: Some(4000.0),
        ..TimePlan::default()
    };
    let records = SteppedRecords::new(problem, speed, &plan).unwrap();
    let (samples, step_s) = (records.fourier.length(), records.step_s);
    let stepped = records.mean_squares(5).unwrap();
    let n = problem.structure.dofs.len();
    let forces = records.forces(5).into_iter();
    let spectra = forces.map(|force| records.fourier.spectrum(force));
    let spectra: Vec<Vec<Complex<f64>>> = spectra.collect();
    let mut expected = vec![0.0; n];
    let coefficient = |i: usize, k: usize| spectra[i][k];
    for k in 1..samples / 2 {
        let f = k as f64 / (samples as f64 * step_s);
        let x = PI * f * step_s;
        let line = (x.sin() / x).powi(2) / samples as f64;
        let force = DVector::from_fn(n, |i, _| coefficient(i, k) * line);
        let motion = impedance(&problem.structure, problem.model(), speed, TAU * f)
            .unwrap()
            .lu()
            .solve(&force)
            .unwrap();
        for (sum, q) in expected.iter_mut().zip(motion.iter()) {
            *sum += 2.0 * q.norm_sqr();
        }
    }
    for (a, b) in stepped.iter().zip(&expected) {
        // images of the spectrum above the Nyquist frequency and the rest of the start, both near 1e-6
        assert!((a / b - 1.0).abs() < 1e-5, "{stepped:?} {expected:?}");
    }
}

#[test]
fn one_record_is_the_sum_of_its_frequencies() {
    let (structure, theory) = three_dof();
    let linear = theory.linearised(0.01).unwrap();
    exact_for_one_record(
        &BuffetingProblem::of_section(
            &structure,
            &linear,
            Some(&linear),
            &turbulence(Admittance::Liepmann {}),
        )
        .unwrap(),
        30.0,
    );
    let structure = SectionModel::iabse_1_1a().structure().unwrap();
    exact_for_one_record(
        &BuffetingProblem::of_section(
            &structure,
            &RationalModel::jones_flat_plate(),
            None,
            &turbulence(Admittance::Sears {}),
        )
        .unwrap(),
        45.0,
    );
}

fn section_response(problem: &BuffetingProblem<'_>, speed: f64) -> Result<BuffetingResponse> {
    FrequencyDomain::new(problem, speed)?.section_response(None)
}

fn agrees(problem: &BuffetingProblem<'_>, speed: f64, largest_error: f64) {
    let plan = TimePlan {
        records: 64,
        ..TimePlan::default()
    };
    let frequency = section_response(problem, speed).unwrap();
    let time = time_ensemble(problem, speed, &plan, &|_, _| ()).unwrap();
    for c in compare(&problem.structure.dofs, &frequency, &time) {
        // within three standard errors, which are small enough for this to say something
        let relative = c.standard_error / c.frequency_rms;
        assert!(c.deviations.abs() < 3.0, "{c:?}");
        assert!(relative < largest_error, "{c:?}");
    }
}

/// 64 records of 40 decay times: the standard errors are 2 % and less.
#[test]
fn domains_agree_within_the_sampling_error() {
    let (structure, theory) = three_dof();
    let linear = theory.linearised(0.0).unwrap();
    let davenport = Admittance::Davenport { decay: 7.0 };
    agrees(
        &BuffetingProblem::of_section(&structure, &linear, Some(&linear), &turbulence(davenport))
            .unwrap(),
        30.0,
        0.02,
    );
    let structure = SectionModel::iabse_1_1a().structure().unwrap();
    agrees(
        &BuffetingProblem::of_section(
            &structure,
            &RationalModel::jones_flat_plate(),
            None,
            &turbulence(Admittance::Sears {}),
        )
        .unwrap(),
        45.0,
        0.02,
    );
}

/// The mean variance of 200 records of `w` against the integral that it is exactly on average.
#[test]
fn gusts_have_the_stated_variance() {
    let structure = SectionModel::iabse_1_1a().structure().unwrap();
    let jones = RationalModel::jones_flat_plate();
    let gusts = turbulence(Admittance::None {});
    let problem = BuffetingProblem::of_section(&structure, &jones, None, &gusts).unwrap();
    let variance = |series: &[f64]| series.iter().map(|x| x * x).sum::<f64>() / series.len() as f64;
    let expected = problem.expected_variance(40.0, 0.1, 6000);
    let variances: Vec<[f64; 2]> = (0..200)
        .map(|seed| {
            let field = turbulence_field(&problem, 40.0, 0.1, 6000, seed).unwrap();
            field.map(|rows| variance(&rows[0]))
        })
        .collect();
    let whole = [16.0, (0.06 * 40.0f64).powi(2)];
    for j in 0..2 {
        let mean = variances.iter().map(|v| v[j]).sum::<f64>() / 200.0;
        let scatter = variances.iter().map(|v| (v[j] - mean).powi(2)).sum::<f64>() / 199.0;
        let error = (scatter / 200.0).sqrt();
        assert!(
            (mean - expected[j]).abs() < 3.0 * error,
            "{mean} {} {error}",
            expected[j]
        );
        // what lies below 1/2T and above the Nyquist frequency is missing, a few per cent
        assert!(
            expected[j] < whole[j] && expected[j] > 0.93 * whole[j],
            "{expected:?}"
        );
    }
}

#[test]
fn records_repeat_with_their_seed_and_plans_are_checked() {
    let structure = SectionModel::iabse_1_1a().structure().unwrap();
    let jones = RationalModel::jones_flat_plate();
    let gusts = turbulence(Admittance::None {});
    let problem = BuffetingProblem::of_section(&structure, &jones, None, &gusts).unwrap();
    let record = |seed| turbulence_field(&problem, 40.0, 0.1, 64, seed).unwrap();
    assert_eq!(record(3), record(3));
    assert_ne!(record(3), record(4));
    let plan = TimePlan {
        duration_s: Some(20.0),
        ..TimePlan::default()
    };
    let message = time_ensemble(&problem, 40.0, &plan, &|_, _| ()).unwrap_err();
    assert!(message.to_string().contains("decay times"), "{message}");
    let message = time_ensemble(&problem, 80.0, &TimePlan::default(), &|_, _| ()).unwrap_err();
    assert!(matches!(message, Error::Unstable(_)), "{message}");
    let message = section_response(&problem, 80.0).unwrap_err();
    assert!(message.to_string().contains("2 growing roots"), "{message}");
    assert!(turbulence_field(&problem, 40.0, 0.1, 63, 1).is_err());
}
