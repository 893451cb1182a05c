//! Gusts on a bridge that is exported: against equal external forces, against lags integrated strip by strip, and against
//! buffeting in the time domain.

use crate::bridges::lively;
use aerodeck::aerodynamics::RationalAdmittance;
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::fmu::instance::Instance;
use aerodeck::fmu::package::Export;
use aerodeck::fmu::resources::Resources;
use aerodeck::response::{Inputs, SectionState, Stepper};
use aerodeck::section::Dof;
use aerodeck::study::bridge::{BridgeExportOptions, BridgeStudy};
use aerodeck::trained_model::TrainedModel;

const WIND: f64 = 35.0;

/// An instance that runs, by names.
struct GustUnit(Instance);

impl GustUnit {
    fn new(model: &TrainedModel, export: &Export) -> Self {
        Self::starting(model, export, 0.0)
    }

    fn starting(model: &TrainedModel, export: &Export, time: f64) -> Self {
        let json = export
            .turbulence
            .as_ref()
            .map(|t| serde_json::to_string(t).unwrap());
        let bridge = export.bridge.as_ref().unwrap();
        let resources = Resources::of_bridge(
            model.to_json().unwrap().as_bytes(),
            bridge.to_json().unwrap().as_bytes(),
            json.as_deref().map(str::as_bytes),
        );
        let mut instance = Instance::new(resources.unwrap()).unwrap();
        instance.set_up_experiment(time, None).unwrap();
        instance.enter_initialization();
        Self(instance)
    }

    fn place(&self, name: &str) -> u32 {
        let place = self.0.table().find_name(name);
        place.unwrap_or_else(|| panic!("no {name}")) as u32
    }

    fn set(&mut self, name: &str, value: f64) {
        self.0.set_reals(&[self.place(name)], &[value]).unwrap();
    }

    fn set_rate(&mut self, name: &str, rate: f64) {
        let place = self.place(name);
        self.0.set_input_rates(&[place], &[1], &[rate]).unwrap();
    }

    fn get(&mut self, name: &str) -> f64 {
        let mut value = [0.0];
        self.0.reals(&[self.place(name)], &mut value).unwrap();
        value[0]
    }

    /// Begins at rest in this wind.
    fn run(mut self, wind: f64) -> Self {
        self.set("wind_speed", wind);
        for number in [2, 3, 5, 12, 14, 16, 17, 23] {
            self.set(&format!("mode[{number}].initial_coordinate"), 0.0);
        }
        self.0.exit_initialization().unwrap();
        self
    }
}

fn wanted(strips: usize, admittance: RationalAdmittance) -> BridgeExportOptions {
    BridgeExportOptions {
        nodes: vec!["1081".into(), "1156".into()],
        gust_strips: Some(strips),
        admittance,
        ..BridgeExportOptions::default()
    }
}

/// Gust of a strip at a time: u, w.
fn gust(strip: usize, time: f64) -> [f64; 2] {
    let s = strip as f64;
    [
        3.0 * (0.7 * time + s).sin(),
        1.5 * (1.9 * time - 0.6 * s).cos(),
    ]
}

/// Force on the mass-normalised modes per 1 m/s of wind by gusts of every node, summed here once more.
fn by_gusts(study: &BridgeStudy, export: &Export, of_node: &dyn Fn(usize) -> [f64; 2]) -> Vec<f64> {
    let bridge = &study.by_model;
    let gusts = export.bridge.as_ref().and_then(|b| b.gusts.as_ref());
    let a = gusts.unwrap().coefficients[0];
    let width = bridge.width_m();
    bridge
        .modes
        .iter()
        .map(|mode| {
            let at = |n: usize| -> f64 {
                let [u, w] = of_node(n);
                let each = Dof::THREE.into_iter().map(|dof| {
                    let i = dof as usize;
                    let scale = if dof == Dof::Torsion {
                        width * width
                    } else {
                        width
                    };
                    mode.shape[n][i] * scale * (a[i][0] * u + a[i][1] * w)
                });
                0.5 * bridge.air_density_kg_m3 * bridge.nodes[n].length_m * each.sum::<f64>()
            };
            (0..bridge.nodes.len()).map(at).sum::<f64>() / mode.generalised_mass.sqrt()
        })
        .collect()
}

fn stepper(study: &BridgeStudy) -> Stepper {
    let bridge = &study.by_model;
    let realised = bridge.forces().realize().unwrap();
    Stepper::new(CoupledSection::new(bridge.structure(), realised).unwrap())
}

/// Strip of each node when they are split evenly.
fn strip_of(node: usize, strips: usize, nodes: usize) -> usize {
    (0..strips)
        .rfind(|s| (s * nodes).div_ceil(strips) <= node)
        .unwrap()
}

/// Coordinates of all modes of a unit, mass-normalised.
fn coordinates(unit: &mut GustUnit, study: &BridgeStudy) -> Vec<f64> {
    let modes = study.by_model.modes.iter();
    modes
        .map(|m| unit.get(&format!("mode[{}].coordinate", m.number)) * m.generalised_mass.sqrt())
        .collect()
}

fn same(found: &[f64], expected: &[f64], tolerance: f64) {
    let size = expected.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
    assert!(size > 0.0);
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= tolerance * size, "{a} {b}, size {size}");
    }
}

/// Without an admittance a gust is a force, in steady wind and in wind that rises.
#[test]
fn gusts_are_equal_forces() {
    let study = lively();
    let (strips, nodes, step) = (7, study.by_model.nodes.len(), 0.1);
    let (model, export) = study
        .export(&wanted(strips, RationalAdmittance::None))
        .unwrap();
    for rise in [0.0, 0.8] {
        let mut unit = GustUnit::new(&model, &export).run(WIND);
        let mut stepper = stepper(&study);
        let mut state = stepper.released(&[0.0; 8], &[0.0; 8]).unwrap();
        let mut inputs = Inputs::steady(WIND, 8);
        for i in 0..300 {
            let (now, next) = (i as f64 * step, (i + 1) as f64 * step);
            // a product of two straight lines is none: hold the gusts where the wind rises
            let later = if rise == 0.0 { next } else { now };
            for s in 0..strips {
                for (j, name) in ["u", "w"].into_iter().enumerate() {
                    let name = format!("strip[{}].gust_{name}", s + 1);
                    unit.set(&name, gust(s, now)[j]);
                    unit.set_rate(&name, (gust(s, later)[j] - gust(s, now)[j]) / step);
                }
            }
            unit.set("wind_speed", WIND + rise * now);
            unit.set_rate("wind_speed", rise);
            unit.0.do_step(now, step).unwrap();
            let of = |t: f64| by_gusts(&study, &export, &|n| gust(strip_of(n, strips, nodes), t));
            let (begin, end) = (of(now), of(later));
            inputs.wind_speed_m_s = WIND + rise * now;
            inputs.wind_speed_rate_m_s2 = rise;
            for m in 0..8 {
                let (a, b) = (
                    begin[m] * inputs.wind_speed_m_s,
                    end[m] * (WIND + rise * next),
                );
                (inputs.force[m], inputs.force_rate[m]) = (a, (b - a) / step);
            }
            stepper.advance(&mut state, &inputs, step).unwrap();
        }
        same(&coordinates(&mut unit, &study), &state.values[..8], 1e-10);
    }
}

/// Lags of every node and component for themselves, all integrated by Runge and Kutta's rule.
#[test]
fn lags_of_modes_are_those_of_strips() {
    let study = lively();
    let (nodes, step, parts) = (study.by_model.nodes.len(), 0.2, 40);
    let (model, export) = study
        .export(&wanted(nodes, RationalAdmittance::Sears))
        .unwrap();
    let mut unit = GustUnit::new(&model, &export).run(WIND);
    // poles and weights of the admittance, from its source
    let lags = [
        [0.082_32, 0.1522],
        [0.4902, 0.4716],
        [2.415, 0.2428],
        [17.54, 0.1334],
    ];
    let width = study.by_model.width_m();
    let mut stepper = stepper(&study);
    let released = stepper.released(&[0.0; 8], &[0.0; 8]).unwrap();
    let states = released.values.len();
    let mut z = [released.values, vec![0.0; nodes * 8]].concat();
    let mut derivative = |z: &[f64], now: &dyn Fn(usize) -> [f64; 2]| -> Vec<f64> {
        let felt = |n: usize| -> [f64; 2] {
            std::array::from_fn(|j| {
                (0..4)
                    .map(|l| lags[l][1] * z[states + 8 * n + 4 * j + l])
                    .sum()
            })
        };
        let mut inputs = Inputs::steady(WIND, 8);
        inputs.force = by_gusts(&study, &export, &felt)
            .iter()
            .map(|f| f * WIND)
            .collect();
        let state = SectionState {
            values: z[..states].to_vec(),
            ..SectionState::default()
        };
        let mut all = stepper.state_derivative(&state, &inputs).unwrap();
        for n in 0..nodes {
            let gust = now(n);
            all.extend(
                (0..8)
                    .map(|i| lags[i % 4][0] * WIND / width * (gust[i / 4] - z[states + 8 * n + i])),
            );
        }
        all
    };
    for i in 0..60 {
        let now = i as f64 * step;
        let slope = |n: usize| {
            let (a, b) = (gust(n, now), gust(n, now + step));
            [(b[0] - a[0]) / step, (b[1] - a[1]) / step]
        };
        for n in 0..nodes {
            for (j, name) in ["u", "w"].into_iter().enumerate() {
                let name = format!("strip[{}].gust_{name}", n + 1);
                unit.set(&name, gust(n, now)[j]);
                unit.set_rate(&name, slope(n)[j]);
            }
        }
        unit.0.do_step(now, step).unwrap();
        let h = step / parts as f64;
        for part in 0..parts {
            let at = |t: f64| {
                move |n: usize| {
                    let (g, s) = (gust(n, now), slope(n));
                    [g[0] + t * s[0], g[1] + t * s[1]]
                }
            };
            let t = part as f64 * h;
            let moved = |k: &[f64], by: f64| -> Vec<f64> {
                z.iter().zip(k).map(|(z, k)| z + by * k).collect()
            };
            let k1 = derivative(&z, &at(t));
            let k2 = derivative(&moved(&k1, 0.5 * h), &at(t + 0.5 * h));
            let k3 = derivative(&moved(&k2, 0.5 * h), &at(t + 0.5 * h));
            let k4 = derivative(&moved(&k3, h), &at(t + h));
            for (i, z) in z.iter_mut().enumerate() {
                *z += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
            }
        }
    }
    same(&coordinates(&mut unit, &study), &z[..8], 1e-8);
}

/// A field in the archive gives what buffeting in the time domain gives, once its first period has died out.
#[test]
fn turbulence_of_the_archive_is_buffeting() {
    let study = lively();
    let block = study.buffeting_block().unwrap();
    let field = study.first_field(&block, WIND).unwrap();
    let expected = study.buffeting_by(&block, WIND, &field).unwrap();
    let step_s = field.step_s;
    let (model, export) = study
        .export(&BridgeExportOptions {
            nodes: block.nodes.clone(),
            turbulence: Some(field),
            ..BridgeExportOptions::default()
        })
        .unwrap();
    let mut unit = GustUnit::new(&model, &export).run(WIND);
    let mut rows: Vec<Vec<f64>> = vec![Vec::new(); 6];
    for i in 0..6000 {
        // steps that do not fall on the samples every second time
        for part in [0.03, 0.07] {
            let time = unit.0.time_s();
            unit.0.do_step(time, part).unwrap();
        }
        if i >= 4000 {
            for (n, node) in block.nodes.iter().enumerate() {
                for (j, motion) in ["heave", "sway", "rotation"].into_iter().enumerate() {
                    rows[3 * n + j].push(unit.get(&format!("node[{node}].{motion}")));
                }
            }
        }
    }
    for (row, values) in rows.iter().enumerate() {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let square = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / values.len() as f64;
        let found = square.sqrt() / expected.rms[row / 3][row % 3];
        println!("{row}: {found}");
        assert!((found - 1.0).abs() < 1e-6, "{row}: {found}");
    }
    // it repeats itself, however often
    let record_s = step_s * export.turbulence.as_ref().unwrap().u[0].len() as f64;
    let [first, later @ ..] = [0.0, 1e3, 1e7].map(|records| {
        let start = records * record_s;
        let mut unit = GustUnit::starting(&model, &export, start).run(WIND);
        unit.0.do_step(start, 5.0).unwrap();
        unit.get("node[1156].heave")
    });
    // the last time is known to 2.4e-7 s
    for heave in later {
        assert!((heave / first - 1.0).abs() < 1e-6, "{heave} {first}");
    }
    // without it nothing moves
    let mut calm = GustUnit::new(&model, &export);
    calm.set("turbulence_factor", 0.0);
    let mut calm = calm.run(WIND);
    calm.0.do_step(0.0, 5.0).unwrap();
    assert_eq!(calm.get("node[1156].heave"), 0.0);
}

/// Derivatives against differences: by gusts, by parameters, by the wind.
#[test]
fn derivatives_are_differences() {
    let study = lively();
    let (model, export) = study.export(&wanted(3, RationalAdmittance::Sears)).unwrap();
    let unknowns = [
        "node[1156].heave_acceleration",
        "mode[23].force",
        "flutter_margin",
        "damping_now",
    ];
    for (known, size) in [
        ("strip[2].gust_w", 0.1),
        ("air_density", 1e-3),
        ("mode[23].frequency", 1e-4),
        ("mode[5].damping_ratio", 1e-4),
        ("wind_speed", 1e-2),
    ] {
        let at = |shift: f64| {
            let mut unit = GustUnit::new(&model, &export);
            unit.set("wind_speed", WIND);
            unit.set("mode[23].initial_coordinate", 1.0);
            unit.set("strip[2].gust_w", 1.0);
            let value = unit.get(known);
            unit.set(known, value + shift);
            let values = unknowns.map(|u| unit.get(u));
            let references = unknowns.map(|u| unit.place(u));
            let mut slopes = [0.0; 4];
            let known = [unit.place(known)];
            unit.0
                .directional_derivative(&references, &known, &[1.0], &mut slopes)
                .unwrap();
            (values, slopes)
        };
        let ((below, _), (_, slopes), (above, _)) = (at(-size), at(0.0), at(size));
        for i in 0..4 {
            let expected = (above[i] - below[i]) / (2.0 * size);
            let scale = expected.abs().max(1e-6 * above[i].abs() / size);
            assert!(
                (slopes[i] - expected).abs() <= 2e-3 * scale + 1e-12,
                "{} by {known}: {} {expected}",
                unknowns[i],
                slopes[i]
            );
        }
    }
}
