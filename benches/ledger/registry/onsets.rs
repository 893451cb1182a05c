//! Changes at run time, onsets and modes, and many of them.

use super::{NOBODY, PLAIN};
use crate::entry::{Baseline, BenchEntry, Job, Script, Threads};
use crate::jobs::{changes, onset, samples};

const fn exponential(job: fn() -> Job) -> Baseline {
    Baseline::Here {
        name: "a matrix exponential a step, by this library",
        package: None,
        job,
        units: 1,
        times: 2000,
    }
}

const fn search(job: fn() -> Job) -> Baseline {
    Baseline::Here {
        name: "the search of all eigenvalues, by this library",
        package: None,
        job,
        units: 1,
        times: 20,
    }
}

const CHANGE: BenchEntry = BenchEntry {
    size: "12 states, L = 4",
    times: 2000,
    ..PLAIN
};

pub(crate) static ENTRIES: &[BenchEntry] = &[
    BenchEntry {
        name: "change-died-out",
        what: "step in steady wind, died out",
        job: changes::died_out,
        baseline: exponential(changes::exponential_continuous),
        ..CHANGE
    },
    BenchEntry {
        name: "change-wind",
        what: "step with another wind",
        job: changes::held_continuous,
        baseline: exponential(changes::exponential_continuous),
        ..CHANGE
    },
    BenchEntry {
        name: "change-wind-discrete",
        what: "the same of the discrete model",
        size: "10 states, L = 3",
        job: changes::held_discrete,
        baseline: exponential(changes::exponential_discrete),
        ..CHANGE
    },
    BenchEntry {
        name: "change-ramps",
        what: "step with the wind on a ramp",
        job: changes::ramps_continuous,
        baseline: exponential(changes::exponential_continuous),
        ..CHANGE
    },
    BenchEntry {
        name: "change-ramps-discrete",
        what: "the same of the discrete model",
        size: "10 states, L = 3",
        job: changes::ramps_discrete,
        baseline: exponential(changes::exponential_discrete),
        ..CHANGE
    },
    BenchEntry {
        name: "change-gusts",
        what: "step with gusts on top of the ramp",
        size: "16 states, L = 4",
        job: changes::gusts_on_ramps,
        baseline: Baseline::Here {
            name: "wind on ramps alone",
            package: None,
            job: changes::ramps_continuous,
            units: 1,
            times: 2000,
        },
        ..CHANGE
    },
    BenchEntry {
        name: "onset",
        what: "onset_speed after another mass",
        job: changes::onset_continuous,
        times: 20,
        baseline: search(changes::search_continuous),
        count: Some([10, 60]),
        ..CHANGE
    },
    BenchEntry {
        name: "onset-discrete",
        what: "the same of the discrete model",
        size: "10 states, L = 3",
        job: changes::onset_discrete,
        times: 20,
        baseline: search(changes::search_discrete),
        count: Some([10, 60]),
        ..CHANGE
    },
    BenchEntry {
        name: "sweep",
        what: "V-g sweep with modes",
        size: "12 states, L = 4, 24 speeds",
        job: onset::sweep,
        times: 50,
        baseline: Baseline::Python(Script {
            name: "NumPy eig with tracking",
            packages: &["numpy"],
            file: "sweep.py",
            argument: onset::sweep_argument,
            share: 1.0,
            tolerance: 1e-9,
        }),
        count: Some([5, 25]),
        ..PLAIN
    },
    BenchEntry {
        name: "pk",
        what: "p-k iteration",
        size: "two motions, L = 4, 24 speeds",
        job: onset::pk,
        times: 20,
        baseline: NOBODY,
        count: Some([5, 25]),
        ..PLAIN
    },
    BenchEntry {
        name: "samples",
        what: "an onset of a random section",
        size: "10 states, L = 3, 300 sections",
        job: samples::onsets,
        units: samples::SAMPLES,
        times: 20,
        baseline: Baseline::Python(Script {
            name: "NumPy loop, stacked eigvals and regula falsi",
            packages: &["numpy"],
            file: "onsets.py",
            argument: samples::onsets_argument,
            share: samples::SAMPLES as f64,
            tolerance: 1e-6,
        }),
        ..PLAIN
    },
    BenchEntry {
        name: "monte-carlo",
        what: "a whole analysis, 28 random numbers a sample",
        size: "10 states, L = 3, 1000 samples",
        job: samples::thousand,
        times: 5,
        baseline: NOBODY,
        count: Some([1, 3]),
        ..PLAIN
    },
    BenchEntry {
        name: "large-monte-carlo",
        what: "the same",
        size: "10 states, L = 3, 1 000 000 samples",
        threads: Threads::All,
        job: samples::million,
        baseline: NOBODY,
        judged_peak: true,
        ..PLAIN
    },
];
