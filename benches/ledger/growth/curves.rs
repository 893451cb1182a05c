//! The curves. A new one is one entry here, and its job.

use crate::entry::Job;
use crate::jobs::{growth, steps};

/// Cost over size.
pub(crate) struct GrowthCurve {
    pub(crate) name: &'static str,
    /// What is done.
    pub(crate) what: &'static str,
    /// What the sizes count.
    pub(crate) of: &'static str,
    pub(crate) sizes: &'static [u64],
    pub(crate) job: fn(u64) -> Job,
    /// What theory raises to a power.
    pub(crate) measure: fn(u64) -> f64,
    /// The power.
    pub(crate) exponent: f64,
    /// Why it is that.
    pub(crate) reason: &'static str,
    /// Why it may be more, on a machine as they are; empty where nothing is known that would make it so.
    pub(crate) beyond: &'static str,
    pub(crate) kind: CurveKind,
}

#[derive(Clone, Copy, PartialEq)]
pub(crate) enum CurveKind {
    /// One call of many: what counts is how many go into a minute.
    Call,
    /// A whole job.
    Whole,
    /// A whole job whose memory is the same at every size.
    Streamed,
    /// The sizes are numbers of threads: the answer is the same for each.
    Threads,
}

const PLAIN: GrowthCurve = GrowthCurve {
    name: "",
    what: "",
    of: "states",
    sizes: &[4, 12, 40, 80, 120, 200, 280, 400],
    job: |_| Job::new(|| ()),
    measure: |n| n as f64,
    exponent: 1.0,
    reason: "",
    beyond: "",
    kind: CurveKind::Whole,
};

const BRIDGE: GrowthCurve = GrowthCurve {
    of: "modes, of 63 to 2000 nodes",
    sizes: &[39, 60, 90, 130, 200],
    ..PLAIN
};

const LEAVES_THE_CACHE: &str =
    "matrices of more than 350 states (1 MB) leave the second cache, and come at half the speed";

const THREADS: GrowthCurve = GrowthCurve {
    of: "threads",
    exponent: -1.0,
    reason: "parts that do not wait for one another",
    kind: CurveKind::Threads,
    ..PLAIN
};

pub(crate) static CURVES: &[GrowthCurve] = &[
    GrowthCurve {
        name: "step",
        what: "a step in steady wind",
        job: growth::step,
        exponent: 2.0,
        reason: "a product with the matrix of all states",
        kind: CurveKind::Call,
        ..PLAIN
    },
    GrowthCurve {
        name: "change-of-wind",
        what: "a step in another wind",
        job: growth::change_of_wind,
        exponent: 2.0,
        reason: "some products with the matrix of all states",
        kind: CurveKind::Call,
        ..PLAIN
    },
    GrowthCurve {
        name: "onset",
        what: "the flutter onset",
        job: growth::onset,
        exponent: 3.0,
        reason: "all eigenvalues, at a number of winds that does not depend on the states",
        ..PLAIN
    },
    GrowthCurve {
        name: "strips",
        what: "a step of forces, set and read",
        of: "strips",
        sizes: &[1, 10, 100, 1000, 10_000],
        job: steps::strips_of,
        reason: "strips know nothing of one another",
        kind: CurveKind::Call,
        ..PLAIN
    },
    GrowthCurve {
        name: "assembly",
        what: "a bridge coupled to its forces",
        of: "nodes × modes²",
        job: growth::assembly,
        measure: |modes| growth::nodes(modes) * (modes as f64).powi(2),
        reason: "each pair of modes is summed over the nodes",
        ..BRIDGE
    },
    GrowthCurve {
        name: "sweep",
        what: "all modes at ten winds",
        job: growth::sweep,
        exponent: 3.0,
        reason: "all eigenvalues at each wind",
        beyond: LEAVES_THE_CACHE,
        ..BRIDGE
    },
    GrowthCurve {
        name: "buffeting",
        what: "response, 4096 samples",
        of: "nodes × modes",
        job: growth::buffeting,
        measure: |modes| growth::nodes(modes) * modes as f64,
        reason: "the gusts of each node act on each mode at each sample",
        ..BRIDGE
    },
    GrowthCurve {
        name: "bridge-step",
        what: "a step of the bridge",
        job: growth::bridge_step,
        exponent: 2.0,
        reason: "a product with the matrix of all states, four a mode, whatever the nodes",
        beyond: LEAVES_THE_CACHE,
        kind: CurveKind::Call,
        ..BRIDGE
    },
    GrowthCurve {
        name: "training",
        what: "six filters and least squares",
        of: "samples a motion",
        sizes: &[10_000, 100_000, 1_000_000, 10_000_000, 100_000_000],
        job: growth::training,
        reason: "every sample passes the filters once and is forgotten",
        kind: CurveKind::Streamed,
        ..PLAIN
    },
    GrowthCurve {
        name: "monte-carlo",
        what: "an analysis of scatter",
        of: "samples",
        sizes: &[1000, 10_000, 100_000, 1_000_000, 10_000_000],
        job: growth::monte_carlo,
        reason: "samples are independent and only counted",
        kind: CurveKind::Streamed,
        ..PLAIN
    },
    GrowthCurve {
        name: "threads-training",
        what: "training, eight records",
        job: growth::training_by_threads,
        ..THREADS
    },
    GrowthCurve {
        name: "threads-sweep",
        what: "modes at ten winds",
        job: growth::sweep_by_threads,
        ..THREADS
    },
    GrowthCurve {
        name: "threads-grid",
        what: "a grid of 500 models",
        job: growth::grid_by_threads,
        ..THREADS
    },
    GrowthCurve {
        name: "threads-monte-carlo",
        what: "100 000 samples",
        job: growth::monte_carlo_by_threads,
        ..THREADS
    },
    GrowthCurve {
        name: "threads-buffeting",
        what: "response of a bridge",
        job: growth::buffeting_by_threads,
        ..THREADS
    },
];
