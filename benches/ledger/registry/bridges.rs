//! Whole bridges.

use super::{NO_FMU, NOBODY, OWN_FORMAT, PLAIN};
use crate::entry::{Baseline, BenchEntry, Script, Threads};
use crate::jobs::bridge;

const BRIDGE: BenchEntry = BenchEntry {
    size: "39 modes, 195 states, L = 3",
    prepare: Some(bridge::prepare_whole),
    times: 2000,
    ..PLAIN
};

pub(crate) static ENTRIES: &[BenchEntry] = &[
    BenchEntry {
        name: "bridge-step",
        what: "FMU of a bridge, doStep and two readings",
        job: bridge::step,
        baseline: Baseline::Here {
            name: "bare product of 195 by 195 numbers, nalgebra",
            package: Some("nalgebra"),
            job: bridge::product,
            units: 1,
            times: 2000,
        },
        count: Some([50, 550]),
        is_step: true,
        ..BRIDGE
    },
    BenchEntry {
        name: "bridge-step-wind",
        what: "the same, another wind set at every step",
        job: bridge::step_in_another_wind,
        times: 200,
        baseline: Baseline::Here {
            name: "bare product of 195 by 195 numbers, nalgebra",
            package: Some("nalgebra"),
            job: bridge::product,
            units: 1,
            times: 2000,
        },
        count: Some([10, 60]),
        is_step: true,
        ..BRIDGE
    },
    BenchEntry {
        name: "bridge-damping",
        what: "the same unit, damping_now in another wind",
        job: bridge::damping,
        times: 100,
        baseline: Baseline::Here {
            name: "all eigenvalues, by this library",
            package: None,
            job: bridge::all_eigenvalues,
            units: 1,
            times: 5,
        },
        count: Some([10, 60]),
        ..BRIDGE
    },
    BenchEntry {
        name: "bridge-onset",
        what: "FMU of a bridge, onset_speed after another density",
        size: "8 modes, L = 3",
        prepare: Some(bridge::prepare_few_modes),
        job: bridge::onset,
        times: 5,
        baseline: NO_FMU,
        count: Some([1, 4]),
        ..PLAIN
    },
    BenchEntry {
        name: "bridge-sweep",
        what: "modes of a bridge over wind speed",
        size: "39 modes, 195 states, L = 3, 60 speeds",
        job: bridge::sweep,
        baseline: Baseline::Python(Script {
            name: "NumPy eigvals of the same matrices",
            packages: &["numpy"],
            file: "eigenvalues.py",
            argument: bridge::sweep_argument,
            share: 1.0,
            tolerance: 0.0,
        }),
        ..PLAIN
    },
    BenchEntry {
        name: "bridge-profile",
        what: "flutter of a bridge in a wind profile, table and model",
        size: "39 modes, 50 speeds",
        threads: Threads::All,
        job: bridge::flutter_in_profile,
        baseline: Baseline::Here {
            name: "the same in uniform wind",
            package: None,
            job: bridge::flutter,
            units: 1,
            times: 1,
        },
        ..PLAIN
    },
    BenchEntry {
        name: "bridge-buffeting",
        what: "both domains, two records of 600 s",
        size: "39 modes, 63 nodes, 12 000 samples",
        threads: Threads::All,
        job: bridge::buffeting,
        baseline: NOBODY,
        ..PLAIN
    },
    BenchEntry {
        name: "bridge-field",
        what: "field of turbulence",
        size: "100 strips, 12 000 samples",
        threads: Threads::All,
        job: bridge::field,
        baseline: NOBODY,
        ..PLAIN
    },
    BenchEntry {
        name: "bridge-response",
        what: "response to that field",
        size: "39 modes, 100 strips, 12 000 samples",
        threads: Threads::All,
        job: bridge::response,
        baseline: NOBODY,
        ..PLAIN
    },
    BenchEntry {
        name: "large-bridge",
        what: "coupled, modes at 20 speeds, one step",
        size: "1000 nodes, 100 modes",
        threads: Threads::All,
        job: bridge::thousand_nodes,
        baseline: OWN_FORMAT,
        judged_peak: true,
        ..PLAIN
    },
];
