//! Steps, instances and strips of an FMU.

use super::{NO_FMU, OWN_FORMAT, PLAIN};
use crate::entry::{Baseline, BenchEntry};
use crate::jobs::steps;

/// Of an FMU that is not ours: there is none with these equations, so the arithmetic alone is the measure.
const PRODUCT: Baseline = Baseline::Here {
    name: "bare product of 12 by 16 numbers, nalgebra",
    package: Some("nalgebra"),
    job: steps::product_in_nalgebra,
    units: 1,
    times: 200_000,
};

/// A step of a section through the C interface.
const STEP: BenchEntry = BenchEntry {
    size: "12 states, L = 4",
    times: 50_000,
    baseline: PRODUCT,
    count: Some([2_000, 12_000]),
    is_step: true,
    ..PLAIN
};

pub(crate) static ENTRIES: &[BenchEntry] = &[
    BenchEntry {
        name: "step",
        what: "FMU, doStep and getReal of four motions",
        job: steps::motion,
        ..STEP
    },
    BenchEntry {
        name: "step-most",
        what: "the same of a deck as it is fitted by default",
        size: "14 states, L = 5",
        job: steps::motion_of_most,
        ..STEP
    },
    BenchEntry {
        name: "step-least",
        what: "the same of a deck with the filters of the thesis",
        size: "10 states, L = 3",
        job: steps::motion_of_least,
        ..STEP
    },
    BenchEntry {
        name: "step-forces",
        what: "the same with two forces among the four",
        job: steps::forces,
        ..STEP
    },
    BenchEntry {
        name: "step-wind",
        what: "the motions, another wind set at every step",
        job: steps::another_wind,
        ..STEP
    },
    BenchEntry {
        name: "step-gusts",
        what: "the motions, two gusts set at every step",
        size: "16 states, L = 4",
        job: steps::gusts,
        ..STEP
    },
    BenchEntry {
        name: "step-discrete",
        what: "discrete model, the motions",
        size: "10 states, L = 3",
        job: steps::discrete,
        ..STEP
    },
    BenchEntry {
        name: "caller",
        what: "the calls of doStep and getReal alone, part of every step above",
        size: "two calls",
        job: steps::caller,
        is_step: false,
        baseline: Baseline::None("it is the overhead of this program"),
        ..STEP
    },
    BenchEntry {
        name: "derivative",
        what: "model exchange, rates of all states",
        job: steps::derivative,
        is_step: false,
        ..STEP
    },
    BenchEntry {
        name: "instance",
        what: "FMU, an instance made and freed",
        size: "12 states, L = 4",
        job: steps::instance,
        times: 500,
        baseline: NO_FMU,
        count: Some([20, 120]),
        ..PLAIN
    },
    BenchEntry {
        name: "instance-rational",
        what: "the same of rational functions",
        size: "8 states, two lags",
        job: steps::instance_rational,
        times: 500,
        baseline: NO_FMU,
        count: Some([20, 120]),
        ..PLAIN
    },
    BenchEntry {
        name: "instance-discrete",
        what: "the same of the discrete model",
        size: "10 states, L = 3",
        job: steps::instance_discrete,
        times: 500,
        baseline: NO_FMU,
        count: Some([20, 120]),
        ..PLAIN
    },
    BenchEntry {
        name: "strip",
        what: "unit of forces, a strip: motion set, step, forces read",
        size: "1000 strips",
        job: steps::strips,
        units: steps::STRIPS,
        times: 20,
        baseline: Baseline::Here {
            name: "a coupled section stepped by itself",
            package: None,
            job: steps::as_many_sections,
            units: steps::STRIPS,
            times: 20,
        },
        count: Some([3, 13]),
        ..PLAIN
    },
    BenchEntry {
        name: "growth-steps",
        what: "ten million steps: memory must not grow",
        size: "12 states, L = 4",
        job: steps::ten_million,
        baseline: OWN_FORMAT,
        judged_peak: true,
        ..PLAIN
    },
    BenchEntry {
        name: "growth-loads",
        what: "a thousand loads of the library: memory must not grow",
        size: "12 states, L = 4",
        job: steps::loads,
        baseline: OWN_FORMAT,
        judged_peak: true,
        ..PLAIN
    },
];
