//! Both domains against each other: exactly for one record, within the sampling error for many.

use super::*;
use crate::aerodynamics::RationalModel;
use crate::aerodynamics::quasi_steady::{Arms, QuasiSteady};
use crate::buffeting::{
    Admittance, Gust, GustForces, GustSpectrum, SpectrumShape, Turbulence, buffeting_response,
};
use crate::files::coefficients::embedded;
use crate::section::{SectionModel, Structure, Translation};
use crate::signal::Fourier;
use nalgebra::{Complex, DVector};
use std::f64::consts::PI;

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
        along: Some(gust(SpectrumShape::Kaimal, 120.0, 0.1)),
        vertical: Some(gust(SpectrumShape::VonKarman, 40.0, 0.06)),
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
    let model = problem.model.realizable().unwrap();
    let section = CoupledSection::with_model(problem.structure, model).unwrap();
    let grid = grid(problem, &section, speed, &plan).unwrap();
    let (stepped, _) = mean_squares(problem, &section, speed, &grid, 5).unwrap();
    let sample = synthesise(problem, speed, grid.step_s, grid.samples, 5).unwrap();
    let n = problem.structure.dofs.len();
    let forward = Fourier::new(grid.samples);
    let spectra: Vec<Vec<Complex<f64>>> = sample
        .forces
        .iter()
        .map(|force| forward.spectrum(force.iter().copied()))
        .collect();
    let mut expected = vec![0.0; n];
    let coefficient = |i: usize, k: usize| spectra[i][k];
    for k in 1..grid.samples / 2 {
        let f = k as f64 / (grid.samples as f64 * grid.step_s);
        let x = PI * f * grid.step_s;
        let line = (x.sin() / x).powi(2) / grid.samples as f64;
        let force = DVector::from_fn(n, |i, _| coefficient(i, k) * line);
        let motion = problem
            .impedance(f, speed)
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
    let forces = GustForces::quasi_steady(&linear);
    exact_for_one_record(
        &BuffetingProblem {
            structure: &structure,
            model: &linear,
            forces: &forces,
            turbulence: &turbulence(Admittance::Liepmann),
        },
        30.0,
    );
    let structure = SectionModel::iabse_1_1a().structure().unwrap();
    exact_for_one_record(
        &BuffetingProblem {
            structure: &structure,
            model: &RationalModel::jones_flat_plate(),
            forces: &GustForces::flat_plate(),
            turbulence: &turbulence(Admittance::Sears),
        },
        45.0,
    );
}

fn agrees(problem: &BuffetingProblem<'_>, speed: f64, largest_error: f64) {
    let plan = TimePlan {
        records: 64,
        ..TimePlan::default()
    };
    let frequency = buffeting_response(problem, speed, None).unwrap();
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
    let forces = GustForces::quasi_steady(&linear);
    let davenport = Admittance::Davenport { decay: 7.0 };
    agrees(
        &BuffetingProblem {
            structure: &structure,
            model: &linear,
            forces: &forces,
            turbulence: &turbulence(davenport),
        },
        30.0,
        0.02,
    );
    let structure = SectionModel::iabse_1_1a().structure().unwrap();
    agrees(
        &BuffetingProblem {
            structure: &structure,
            model: &RationalModel::jones_flat_plate(),
            forces: &GustForces::flat_plate(),
            turbulence: &turbulence(Admittance::Sears),
        },
        45.0,
        0.02,
    );
}

/// The mean variance of 200 records of `w` against the integral that it is exactly on average.
#[test]
fn gusts_have_the_stated_variance() {
    let structure = SectionModel::iabse_1_1a().structure().unwrap();
    let jones = RationalModel::jones_flat_plate();
    let problem = BuffetingProblem {
        structure: &structure,
        model: &jones,
        forces: &GustForces::flat_plate(),
        turbulence: &turbulence(Admittance::None),
    };
    let variance = |series: &[f64]| series.iter().map(|x| x * x).sum::<f64>() / series.len() as f64;
    let mut expected = [0.0; 2];
    let variances: Vec<[f64; 2]> = (0..200)
        .map(|seed| {
            let sample = synthesise(&problem, 40.0, 0.1, 6000, seed).unwrap();
            expected = sample.expected_variance;
            [
                variance(sample.gusts.along_m_s()),
                variance(sample.gusts.vertical_m_s()),
            ]
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
    let problem = BuffetingProblem {
        structure: &structure,
        model: &jones,
        forces: &GustForces::flat_plate(),
        turbulence: &turbulence(Admittance::None),
    };
    let record = |seed| synthesise(&problem, 40.0, 0.1, 64, seed).unwrap();
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
    let message = buffeting_response(&problem, 80.0, None).unwrap_err();
    assert!(message.to_string().contains("2 growing roots"), "{message}");
    assert!(synthesise(&problem, 40.0, 0.1, 63, 1).is_err());
}
