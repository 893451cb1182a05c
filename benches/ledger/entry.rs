//! What a line of the ledger is made of.

use serde_json::Value;
use std::cell::Cell;
use std::fmt::Debug;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::rc::Rc;

/// A line of the ledger.
pub(crate) struct BenchEntry {
    /// Under which it is run and stored.
    pub(crate) name: &'static str,
    /// What is done, in words.
    pub(crate) what: &'static str,
    /// How large.
    pub(crate) size: &'static str,
    pub(crate) threads: Threads,
    /// Made before the process that is measured, for what would spoil its peak or its count.
    pub(crate) prepare: Option<fn()>,
    pub(crate) job: fn() -> Job,
    /// Units in one of the job: times and counts are those of a unit.
    pub(crate) units: u32,
    /// How often in a round.
    pub(crate) times: u32,
    pub(crate) baseline: Baseline,
    /// How often in the two runs whose difference is counted; `None` for what is not counted.
    pub(crate) count: Option<[u32; 2]>,
    /// Whether it is one communication step, of which none may cost much more than the others.
    pub(crate) is_step: bool,
    /// Whether the peak of its process is stored and judged.
    pub(crate) judged_peak: bool,
}

#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Threads {
    One,
    /// All that the machine has.
    All,
}

/// Prepared work.
pub(crate) struct Job {
    work: Box<dyn FnMut()>,
    /// What the baseline has to find as well, within its tolerance; not a number where there is nothing to find.
    answer: Box<dyn Fn() -> Vec<f64>>,
}

impl Job {
    /// Work that is done as often as it is asked for.
    pub(crate) fn new(work: impl FnMut() + 'static) -> Self {
        Self {
            work: Box::new(work),
            answer: Box::new(Vec::new),
        }
    }

    /// With what it finds, asked for once it has been done.
    pub(crate) fn finding(self, answer: impl Fn() -> Vec<f64> + 'static) -> Self {
        Self {
            answer: Box::new(answer),
            ..self
        }
    }

    pub(crate) fn run(&mut self, times: u32) {
        // counted by hand: the program is compiled small, and a range would be a part of what is measured
        let mut left = times;
        while left > 0 {
            (self.work)();
            left -= 1;
        }
    }

    pub(crate) fn answer(&self) -> Vec<f64> {
        (self.answer)()
    }
}

/// What it is weighed against, in the same run.
pub(crate) enum Baseline {
    /// The plain way, in this program.
    Here {
        name: &'static str,
        /// The crate whose version belongs to the name.
        package: Option<&'static str>,
        job: fn() -> Job,
        units: u32,
        times: u32,
    },
    /// A script in `benches/ledger/baselines`.
    Python(Script),
    /// There is none, for this reason.
    None(&'static str),
}

pub(crate) struct Script {
    pub(crate) name: &'static str,
    /// Python packages whose versions belong to the name.
    pub(crate) packages: &'static [&'static str],
    pub(crate) file: &'static str,
    pub(crate) argument: fn() -> Value,
    /// Units of the work that it does in a round, or the part of one: the rest would take as long for each.
    pub(crate) share: f64,
    /// Largest relative difference of its answers from ours.
    pub(crate) tolerance: f64,
}

impl BenchEntry {
    /// This program as a process that does `word` with the entry, prepared.
    pub(crate) fn process(&self, word: &str) -> Result<std::process::Command, String> {
        if let Some(prepare) = self.prepare {
            prepare();
        }
        let program = std::env::current_exe().map_err(|e| e.to_string())?;
        let mut command = std::process::Command::new(program);
        command.args([word, self.name]);
        Ok(command)
    }
}

/// Work whose result, to the last bit, is the answer.
pub(crate) fn finding<T: 'static, R: Debug>(
    of: T,
    work: impl Fn(&T) -> aerodeck::Result<R> + 'static,
) -> Job {
    let found = Rc::new(Cell::new(f64::NAN));
    let answer = Rc::clone(&found);
    let mut hashed = false;
    Job::new(move || {
        let result = work(&of).expect("an answer");
        if !hashed {
            found.set(digest(&result));
            hashed = true;
        }
    })
    .finding(move || vec![answer.get()])
}

/// A number that differs when a bit of the result does: numbers are written so that they read back the same.
fn digest(result: &impl Debug) -> f64 {
    let mut hasher = DefaultHasher::new();
    format!("{result:?}").hash(&mut hasher);
    (hasher.finish() >> 12) as f64
}
