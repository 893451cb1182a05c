//! A thousand strips of a force unit at 50 Hz: motion set, one step, forces read; against as many coupled sections, each
//! stepped by itself in the same wind, in the same run.
//!
//! `cargo bench --bench strips` prints medians, their ratio and the share of real time; nothing is asserted here.

use aerodeck::fmu::force_options::ForceOptions;
use aerodeck::fmu::instance::Instance;
use aerodeck::fmu::resources::{OptionFiles, Resources};
use std::time::Instant;

const STRIPS: usize = 1000;
const STEP_S: f64 = 0.02;
const STEPS: usize = 20;
const ROUNDS: usize = 5;

fn main() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/data/models/continuous_laguerre.json"
    );
    let json = std::fs::read_to_string(path).expect("a model");
    let mut options = ForceOptions::single(0.5);
    options.strips = vec![options.strips[0].clone(); STRIPS];
    options.named_strips = true;
    let text = options.to_json().expect("options");
    let mut strips = instance(&json, Some(&text));
    let names = |of: &str| {
        (1..=STRIPS)
            .map(|i| format!("strip[{i}].{of}"))
            .collect::<Vec<_>>()
    };
    let motion = references(&strips, [names("heave"), names("rotation")].concat());
    let forces = references(&strips, [names("lift"), names("moment")].concat());
    let mut sections: Vec<_> = (0..STRIPS).map(|_| instance(&json, None)).collect();
    let outputs = references(&sections[0], vec!["lift".to_owned(), "moment".to_owned()]);
    let mut seconds = [vec![], vec![]];
    let mut found = vec![0.0; forces.len()];
    for round in 0..ROUNDS {
        let steps = round * STEPS..(round + 1) * STEPS;
        let begin = Instant::now();
        for n in steps.clone() {
            let t = n as f64 * STEP_S;
            let moved: Vec<f64> = (0..motion.len())
                .map(|i| 0.01 * (6.0 * t + i as f64).sin())
                .collect();
            strips.set_reals(&motion, &moved).expect("motion");
            strips.do_step(t, STEP_S).expect("a step");
            strips.reals(&forces, &mut found).expect("forces");
        }
        seconds[0].push(begin.elapsed().as_secs_f64());
        let begin = Instant::now();
        for n in steps {
            for section in &mut sections {
                section.do_step(n as f64 * STEP_S, STEP_S).expect("a step");
                section.reals(&outputs, &mut [0.0; 2]).expect("forces");
            }
        }
        seconds[1].push(begin.elapsed().as_secs_f64());
    }
    let [ours, theirs] = seconds.map(|mut all| {
        all.sort_by(f64::total_cmp);
        all[ROUNDS / 2] / STEPS as f64
    });
    println!("medians of {ROUNDS} interleaved rounds of {STEPS} steps, one thread");
    println!(
        "{STRIPS} strips: {:.2} ms a step of {:.0} ms ({:.0} % of real time); {STRIPS} coupled sections: {:.2} ms; ratio {:.1}",
        1e3 * ours,
        1e3 * STEP_S,
        100.0 * ours / STEP_S,
        1e3 * theirs,
        ours / theirs
    );
}

fn instance(json: &str, force: Option<&str>) -> Instance {
    let resources = {
        let options = OptionFiles {
            force: force.map(str::as_bytes),
            ..OptionFiles::default()
        };
        Resources::from_bytes(json.as_bytes(), options)
    };
    let mut instance = Instance::new(resources.expect("resources")).expect("an instance");
    instance.enter_initialization();
    instance.exit_initialization().expect("initial values");
    instance
}

fn references(instance: &Instance, names: Vec<String>) -> Vec<u32> {
    let table = instance.table();
    let place = |name: &String| table.find_name(name).expect("a variable") as u32;
    names.iter().map(place).collect()
}
