//! Fits to records, and metrics that compare signals.

use super::{NOBODY, OWN_FORMAT, PLAIN};
use crate::entry::{Baseline, BenchEntry, Script, Threads};
use crate::jobs::{fits, metrics};

const fn grid(argument: fn() -> serde_json::Value) -> Baseline {
    Baseline::Python(Script {
        name: "SciPy lfilter and NumPy lstsq a cell",
        packages: &["scipy", "numpy"],
        file: "grid.py",
        argument,
        share: fits::SHARE,
        tolerance: 0.0,
    })
}

const METRIC: BenchEntry = BenchEntry {
    size: "4000 samples",
    baseline: NOBODY,
    threads: Threads::All,
    ..PLAIN
};

pub(crate) static ENTRIES: &[BenchEntry] = &[
    BenchEntry {
        name: "fit",
        what: "fit of one short set of records, default form",
        size: "two speeds, 50 Hz, 4 s a frequency, L chosen (3 to 5)",
        job: fits::short_record,
        times: 5,
        baseline: NOBODY,
        count: Some([1, 3]),
        ..PLAIN
    },
    BenchEntry {
        name: "training",
        what: "filters and least squares, L = 6, one pole",
        size: "172 800 samples a motion",
        job: fits::training,
        baseline: Baseline::Python(Script {
            name: "SciPy lfilter and NumPy lstsq",
            packages: &["scipy", "numpy"],
            file: "training.py",
            argument: fits::training_argument,
            share: 1.0,
            tolerance: 0.0,
        }),
        ..PLAIN
    },
    BenchEntry {
        name: "large-training",
        what: "`aerodeck train`, from its files",
        size: "four records of one hour at 200 Hz, L chosen (3 to 5)",
        threads: Threads::All,
        prepare: Some(fits::prepare_hours),
        job: fits::hours,
        baseline: OWN_FORMAT,
        judged_peak: true,
        ..PLAIN
    },
    BenchEntry {
        name: "grid-discrete",
        what: "grid over L and α, all models and residuals",
        size: "500 cells, L = 1 to 10, 172 800 samples a motion",
        threads: Threads::All,
        job: fits::grid_discrete,
        baseline: grid(fits::grid_discrete_argument),
        ..PLAIN
    },
    BenchEntry {
        name: "grid-continuous",
        what: "grid over L and p, all models and residuals",
        size: "500 cells, L = 1 to 10, 172 800 samples a motion",
        threads: Threads::All,
        job: fits::grid_continuous,
        baseline: grid(fits::grid_continuous_argument),
        ..PLAIN
    },
    BenchEntry {
        name: "judging",
        what: "its cells judged: data left out, onsets, guards",
        size: "500 cells, L = 1 to 10",
        threads: Threads::All,
        job: fits::judging,
        baseline: NOBODY,
        ..PLAIN
    },
    BenchEntry {
        name: "warping",
        what: "dynamic time warping, distance and path",
        size: "20 000 by 20 000 samples",
        job: metrics::warping,
        baseline: Baseline::Python(Script {
            name: "dtaidistance warping_path_fast",
            packages: &["dtaidistance"],
            file: "warping.py",
            argument: metrics::warping_argument,
            share: 1.0,
            tolerance: 1e-12,
        }),
        judged_peak: true,
        ..PLAIN
    },
    BenchEntry {
        name: "metric-phase",
        what: "phase",
        job: metrics::metric_phase,
        ..METRIC
    },
    BenchEntry {
        name: "metric-magnitude-warped",
        what: "warped magnitude",
        job: metrics::metric_magnitude_warped,
        ..METRIC
    },
    BenchEntry {
        name: "metric-wavelet",
        what: "wavelet, 1200 levels",
        job: metrics::metric_wavelet,
        ..METRIC
    },
    BenchEntry {
        name: "metric-density",
        what: "probability density",
        job: metrics::metric_density,
        ..METRIC
    },
    BenchEntry {
        name: "metric-stationarity",
        what: "stationarity, 120 levels",
        job: metrics::metric_stationarity,
        ..METRIC
    },
    BenchEntry {
        name: "metric-bicoherence",
        what: "bicoherence, 120 levels",
        job: metrics::metric_bicoherence,
        ..METRIC
    },
];
