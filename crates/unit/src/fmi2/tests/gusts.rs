//! Gusts as inputs: against external forces, against differently cut steps, against the frequency domain.

use super::model_exchange::exchanged;
use super::*;
use crate::aerodynamics::{GustForce, RationalAdmittance, Transfer};
use crate::section::Dof;
use nalgebra::{Complex, DVector};
use std::f64::consts::TAU;

const KINDS: [&str; 3] = ["continuous_laguerre", "rational", "discrete_laguerre"];
const COEFFICIENTS: [[f64; 2]; 2] = [[0.3, -5.0], [0.05, 1.2]];

fn force(admittance: RationalAdmittance) -> GustForce {
    GustForce {
        dofs: Dof::TWO.to_vec(),
        coefficients: COEFFICIENTS.to_vec(),
        admittance,
        source: "test".into(),
    }
}

fn in_gusts(kind: &str, admittance: RationalAdmittance) -> Extracted {
    let plain = Extracted::fixture(kind);
    let gusts = serde_json::to_vec(&force(admittance)).unwrap();
    std::fs::write(plain.folder.path().join("gusts.json"), &gusts).unwrap();
    let model = std::fs::read(plain.folder.path().join("model.json")).unwrap();
    let options = [None, Some(&gusts[..]), None];
    Extracted {
        resources: Resources::from_bytes(&model, options).unwrap(),
        ..plain
    }
}

fn off(a: &[f64], b: &[f64]) -> f64 {
    let size = a.iter().fold(0.0_f64, |s, x| s.max(x.abs()));
    let off = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    off.fold(0.0, f64::max) / size
}

/// Without admittance a gust is a force that everybody can compute.
#[test]
fn a_gust_acts_as_its_force() {
    for kind in KINDS {
        let blown = StartedUnit::instantiate(in_gusts(kind, RationalAdmittance::None));
        let pushed = StartedUnit::new(kind);
        let section = &blown.archive.model().section;
        let (wind, width) = (20.0, section.width_m);
        let scale = 0.5 * section.air_density_kg_m3 * wind * width;
        let [lift, moment] = COEFFICIENTS.map(|row| row.map(|c| scale * c));
        for unit in [&blown, &pushed] {
            unit.set("wind_speed", wind);
            unit.start();
        }
        for step in 0..40 {
            let (u, w) = (f64::from(step % 7) - 3.0, f64::from(step % 5) - 2.0);
            let (u_rate, w_rate) = (2.0, -7.0);
            blown.set("gust_u", u);
            blown.set("gust_w", w);
            blown.set_rate("gust_u", u_rate);
            blown.set_rate("gust_w", w_rate);
            for (name, row, size) in [
                ("external_lift", lift, 1.0),
                ("external_moment", moment, width),
            ] {
                pushed.set(name, size * (row[0] * u + row[1] * w));
                pushed.set_rate(name, size * (row[0] * u_rate + row[1] * w_rate));
            }
            assert!(off(&pushed.outputs(), &blown.outputs()) < 1e-11, "{kind}");
            let time = f64::from(step) * 0.05;
            for unit in [&blown, &pushed] {
                unit.ok(unit.step(time, 0.05));
            }
        }
        assert!(off(&pushed.outputs(), &blown.outputs()) < 1e-10, "{kind}");
    }
}

/// Gusts and wind on straight lines: one step, fifty, and the equations integrated by somebody else.
#[test]
fn a_step_is_exact_however_it_is_cut() {
    for admittance in [
        RationalAdmittance::None,
        RationalAdmittance::Sears,
        RationalAdmittance::Liepmann,
    ] {
        for kind in KINDS {
            let run = |steps: u32| {
                let unit = StartedUnit::instantiate(in_gusts(kind, admittance));
                unit.set("gust_u", 1.0);
                unit.start();
                unit.set("wind_speed", 20.0);
                unit.set("gust_w", -2.0);
                unit.set_rate("gust_u", -3.0);
                unit.set_rate("gust_w", 5.0);
                unit.set_rate("wind_speed", -15.0);
                let step = 1.0 / f64::from(steps);
                for i in 0..steps {
                    unit.ok(unit.step(f64::from(i) * step, step));
                }
                unit.outputs()
            };
            let (whole, parts) = (run(1), run(50));
            assert!(
                off(&whole, &parts) < 1e-11,
                "{kind}, {admittance:?}: {:e}",
                off(&whole, &parts)
            );
        }
    }
}

#[test]
fn an_importer_that_integrates_feels_the_same_gusts() {
    for kind in &KINDS[..2] {
        let mut errors = Vec::new();
        for steps in [1000u32, 2000] {
            let own = StartedUnit::instantiate(in_gusts(kind, RationalAdmittance::Sears));
            let foreign = exchanged(in_gusts(kind, RationalAdmittance::Sears));
            for unit in [&own, &foreign] {
                unit.start();
                unit.set("wind_speed", 20.0);
                unit.set("gust_w", 2.0);
            }
            foreign.integrate_from_event();
            let step = 1.0 / f64::from(steps);
            for i in 0..steps {
                foreign.runge_kutta(f64::from(i) * step, step, 0.0);
            }
            own.ok(own.step(0.0, 1.0));
            assert_eq!(own.get(["gust_filter[1]"]), [0.0]);
            assert!(own.get(["gust_filter[8]"])[0] > 1.99);
            errors.push(off(&own.outputs(), &foreign.outputs()));
        }
        assert!(
            errors[1] < 1e-6 && errors[0] > 8.0 * errors[1],
            "{kind}: {errors:?}"
        );
    }
}

/// A gust needs the series, whose parts are counted before: a step of ages is refused at once, in all kinds.
#[test]
fn a_step_of_ages_under_a_gust_is_refused_at_once() {
    for kind in KINDS {
        let unit = StartedUnit::instantiate(in_gusts(kind, RationalAdmittance::Sears));
        unit.set("wind_speed", 1e-3);
        unit.start();
        unit.set("gust_w", 1.0);
        unit.refused(unit.step(0.0, 1e9), fmi2Status::fmi2Discard, &["sub-steps"]);
    }
}

/// A harmonic gust, long after its beginning, against `(−ω²M + iωR + K − ½ρV² P(G))⁻¹ F`.
#[test]
fn a_harmonic_gust_gives_the_response_of_the_frequency_domain() {
    let (kind, wind, frequency, parts) = ("continuous_laguerre", 20.0, 3.1, 400u32);
    let unit = StartedUnit::instantiate(in_gusts(kind, RationalAdmittance::Sears));
    unit.set("wind_speed", wind);
    unit.start();
    let step = 1.0 / (frequency * f64::from(parts));
    let gust = |i: u32| (TAU * f64::from(i % parts) / f64::from(parts)).sin();
    let periods = 150;
    let mut last = Vec::new();
    for i in 0..periods * parts {
        unit.set("gust_w", gust(i));
        unit.set_rate("gust_w", (gust(i + 1) - gust(i)) / step);
        unit.ok(unit.step(f64::from(i) * step, step));
        if i >= (periods - 1) * parts {
            last.push(unit.get(["heave", "rotation"]));
        }
    }
    let model = unit.archive.model();
    let structure = model.section.structure().unwrap();
    let omega = TAU * frequency;
    let impedance =
        crate::flutter::impedance(&structure, &model.model as &dyn Transfer, wind, omega).unwrap();
    let k = omega * structure.width_m / wind;
    let lag = |[p, w]: &[f64; 2]| Complex::from(w * p) / Complex::new(*p, k);
    let passed: Complex<f64> = RationalAdmittance::Sears.lags().iter().map(lag).sum();
    let scale = 0.5 * structure.air_density_kg_m3 * wind * structure.width_m;
    let by_gust = DVector::from_fn(2, |i, _| {
        passed * (scale * COEFFICIENTS[i][1] * structure.width_m.powi(i as i32))
    });
    let expected = impedance.lu().solve(&by_gust).unwrap();
    for dof in 0..2 {
        // what belongs to the frequency in the last period; the sample after step i is that of i + 1
        let found: Complex<f64> = last
            .iter()
            .enumerate()
            .map(|(i, x)| {
                x[dof] * Complex::from_polar(2.0, -TAU * (i + 1) as f64 / f64::from(parts))
            })
            .sum::<Complex<f64>>()
            / f64::from(parts);
        // a sine is −i times the cosine; straight lines lose (ωh)²/12 of the gust
        let off = (found - expected[dof] * Complex::new(0.0, -1.0)).norm() / expected[dof].norm();
        assert!(off < 1e-4, "{dof}: {off:e}");
    }
}

#[test]
fn gusts_come_in_saved_states_and_derivatives() {
    let unit = StartedUnit::instantiate(in_gusts("rational", RationalAdmittance::Sears));
    unit.start();
    unit.set("gust_w", 3.0);
    unit.ok(unit.step(0.0, 0.2));
    let c = unit.handle;
    let mut saved = null();
    unit.ok(unsafe { fmi2GetFMUstate(c, &raw mut saved) });
    let mut size = 0;
    unit.ok(unsafe { fmi2SerializedFMUstateSize(c, saved, &raw mut size) });
    let mut bytes = vec![0; size];
    unit.ok(unsafe { fmi2SerializeFMUstate(c, saved, bytes.as_mut_ptr(), size) });
    unit.ok(unit.step(0.2, 0.3));
    let after = unit.outputs();
    let mut again = null();
    unit.ok(unsafe { fmi2DeSerializeFMUstate(c, bytes.as_ptr(), size, &raw mut again) });
    unit.ok(unsafe { fmi2SetFMUstate(c, again) });
    unit.ok(unit.step(0.2, 0.3));
    assert_eq!(unit.outputs(), after);
    unit.ok(unsafe { fmi2FreeFMUstate(c, &raw mut saved) });
    unit.ok(unsafe { fmi2FreeFMUstate(c, &raw mut again) });

    let force = StartedUnit::instantiate(in_gusts("rational", RationalAdmittance::None));
    force.start();
    let scale = {
        let section = &force.archive.model().section;
        0.5 * section.air_density_kg_m3 * section.width_m
    };
    let [wind] = force.get(["wind_speed"]);
    // by the external lift and moment that the gust is
    let by = |unknown: &str| {
        let lift = force.directional(unknown, "external_lift");
        let moment = force.directional(unknown, "external_moment");
        let width = force.archive.model().section.width_m;
        scale * wind * (lift * COEFFICIENTS[0][1] + width * moment * COEFFICIENTS[1][1])
    };
    for unknown in ["heave_acceleration", "rotation_acceleration", "lift"] {
        let (found, expected) = (force.directional(unknown, "gust_w"), by(unknown));
        assert!(
            (found - expected).abs() < 1e-12 * expected.abs().max(1.0),
            "{unknown}: {found} {expected}"
        );
    }
}
