//! More of everything than any importer does: pairs of calls in every state, many threads, many steps, many parameters.

use super::*;
use crate::force_options::{FORCE_FILE, ForceOptions};
use crate::lifecycle::{Interface, State};
use fmi2Status::{fmi2Discard, fmi2Error, fmi2OK};

const KINDS: [&str; 4] = [
    "continuous_laguerre",
    "rational",
    "discrete_laguerre",
    "force",
];

/// The forces of the rational fixture, or the section of another one.
fn unit_of(kind: &str) -> StartedUnit {
    if kind != "force" {
        return StartedUnit::new(kind);
    }
    let mut archive = Extracted::fixture("rational");
    let json = std::fs::read(archive.folder.path().join("model.json")).unwrap();
    let options = ForceOptions::single(0.45).to_json().unwrap();
    std::fs::write(archive.folder.path().join(FORCE_FILE), &options).unwrap();
    let files = [Some(options.as_bytes()), None, None];
    archive.resources = Resources::from_bytes(&json, files).unwrap();
    StartedUnit::instantiate(archive)
}

/// What an importer may call.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Deed {
    Log,
    SetUp,
    Enter,
    Exit,
    Terminate,
    Reset,
    GetInput,
    GetOutput,
    GetText,
    SetInput,
    SetFixed,
    SetRate,
    GetRate,
    Directional,
    SaveAndRestore,
    Step,
    Status,
    Cancel,
}

const DEEDS: [Deed; 18] = {
    use Deed::*;
    [
        Log,
        SetUp,
        Enter,
        Exit,
        Terminate,
        Reset,
        GetInput,
        GetOutput,
        GetText,
        SetInput,
        SetFixed,
        SetRate,
        GetRate,
        Directional,
        SaveAndRestore,
        Step,
        Status,
        Cancel,
    ]
};

/// The machine of states of co-simulation (FMI 2.0.5, figure of section 4.2.4 and the table below it), written down once
/// more, with what docs/fmu.md allows beyond it: the answer, and the state after it.
fn by_the_standard(deed: Deed, state: State) -> (fmi2Status, State) {
    use Deed as D;
    use State as S;
    let ended = matches!(state, S::StepFailed | S::Terminated | S::Error);
    let legal = match deed {
        D::Log | D::Reset | D::GetInput | D::GetText | D::SaveAndRestore => true,
        D::SetUp | D::Enter => state == S::Instantiated,
        D::Exit => state == S::Initialization,
        D::Step => state == S::StepComplete,
        D::Terminate => matches!(state, S::StepComplete | S::StepFailed),
        D::SetInput | D::SetRate => !ended,
        D::SetFixed => matches!(state, S::Instantiated | S::Initialization),
        D::GetOutput | D::Directional => state != S::Instantiated,
        D::GetRate => !matches!(state, S::Instantiated | S::Initialization),
        D::Status => matches!(state, S::StepComplete | S::StepFailed | S::Terminated),
        // there never is a step to cancel: refused without touching the run
        D::Cancel => return (fmi2Error, state),
    };
    if !legal {
        return (fmi2Error, S::Error);
    }
    match deed {
        D::Enter => (fmi2OK, S::Initialization),
        D::Exit => (fmi2OK, S::StepComplete),
        D::Terminate => (fmi2OK, S::Terminated),
        D::Reset => (fmi2OK, S::Instantiated),
        D::Status => (fmi2Discard, state),
        _ => (fmi2OK, state),
    }
}

impl StartedUnit {
    fn state(&self) -> State {
        unsafe { &*self.handle.cast::<guard::Component>() }
            .instance
            .state()
    }

    fn time(&self) -> f64 {
        unsafe { &*self.handle.cast::<guard::Component>() }
            .instance
            .time_s()
    }

    /// From wherever it is into a state.
    fn bring(&self, state: State) {
        self.ok(self.reset());
        if state == State::Error {
            assert_eq!(self.step(0.0, 1.0), fmi2Error);
        }
        if matches!(state, State::Instantiated | State::Error) {
            return;
        }
        self.ok(self.set_up());
        self.ok(self.enter());
        if state == State::Initialization {
            return;
        }
        self.ok(self.exit());
        if state == State::StepFailed {
            self.set_rate("wind_speed", -1000.0);
            assert_eq!(self.step(0.0, 1.0), fmi2Discard);
        }
        if state == State::Terminated {
            self.ok(unsafe { fmi2Terminate(self.handle) });
        }
    }

    fn carry_out(&self, deed: Deed) -> fmi2Status {
        let c = self.handle;
        let names = if self.archive.resources.force.is_some() {
            ["heave", "motion_derivatives", "lift"]
        } else {
            ["external_lift", "initial_heave", "lift"]
        };
        let [input, fixed, output] = names.map(|name| [self.archive.reference(name)]);
        let text = [self.archive.reference("model_kind")];
        let (mut number, mut words, mut status) = ([0.0], [std::ptr::null()], fmi2OK);
        unsafe {
            match deed {
                Deed::Log => fmi2SetDebugLogging(c, 0, 0, null()),
                Deed::SetUp => self.set_up(),
                Deed::Enter => self.enter(),
                Deed::Exit => self.exit(),
                Deed::Terminate => fmi2Terminate(c),
                Deed::Reset => self.reset(),
                Deed::GetInput => fmi2GetReal(c, input.as_ptr(), 1, number.as_mut_ptr()),
                Deed::GetOutput => fmi2GetReal(c, output.as_ptr(), 1, number.as_mut_ptr()),
                Deed::GetText => fmi2GetString(c, text.as_ptr(), 1, words.as_mut_ptr()),
                Deed::SetInput => fmi2SetReal(c, input.as_ptr(), 1, [0.01].as_ptr()),
                Deed::SetFixed => fmi2SetReal(c, fixed.as_ptr(), 1, [1.0].as_ptr()),
                Deed::SetRate => {
                    fmi2SetRealInputDerivatives(c, input.as_ptr(), 1, [1].as_ptr(), [0.1].as_ptr())
                }
                Deed::GetRate => fmi2GetRealOutputDerivatives(
                    c,
                    output.as_ptr(),
                    1,
                    [1].as_ptr(),
                    number.as_mut_ptr(),
                ),
                Deed::Directional => fmi2GetDirectionalDerivative(
                    c,
                    output.as_ptr(),
                    1,
                    input.as_ptr(),
                    1,
                    [1.0].as_ptr(),
                    number.as_mut_ptr(),
                ),
                Deed::SaveAndRestore => {
                    let mut saved = null();
                    let answers = [
                        fmi2GetFMUstate(c, &raw mut saved),
                        fmi2SetFMUstate(c, saved),
                        fmi2FreeFMUstate(c, &raw mut saved),
                    ];
                    answers.into_iter().find(|s| *s != fmi2OK).unwrap_or(fmi2OK)
                }
                Deed::Step => self.step(self.time(), 0.01),
                Deed::Status => fmi2GetStatus(c, 0, &raw mut status),
                Deed::Cancel => fmi2CancelStep(c),
            }
        }
    }
}

/// Every two calls one after the other, from every state, in every kind: the answers and the states after them are those
/// of the standard.
#[test]
fn every_pair_of_calls_in_every_state() {
    for kind in KINDS {
        let unit = unit_of(kind);
        let states = State::ALL.into_iter();
        for begin in states.filter(|s| s.interface() != Some(Interface::ModelExchange)) {
            for first in DEEDS {
                for second in DEEDS {
                    unit.bring(begin);
                    let mut state = begin;
                    for deed in [first, second] {
                        let (answer, next) = by_the_standard(deed, state);
                        let found = unit.carry_out(deed);
                        let index = format!("{kind}: {first:?}, {second:?} from {begin:?}");
                        assert_eq!(found, answer, "{index}: {:?}", unit.last_message());
                        assert_eq!(unit.state(), next, "{index}");
                        state = next;
                    }
                }
            }
        }
    }
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|x| x.to_bits()).collect()
}

/// A run with a wind of its own, in parts at another wind; outputs as bits.
fn run(kind: &str, wind: f64) -> Vec<u64> {
    let unit = StartedUnit::started(kind);
    unit.set("wind_speed", wind);
    let mut found = Vec::new();
    for n in 0..60 {
        if n % 20 == 10 {
            unit.set("wind_speed", wind + 0.1 * f64::from(n));
        }
        unit.ok(unit.step(f64::from(n) * 0.01, 0.01));
        found.extend(bits(&unit.outputs()));
    }
    found
}

/// Sixty-four threads at once give the bits that one alone gives.
#[test]
fn sixty_four_threads_do_not_notice_each_other() {
    let case = |i: usize| (KINDS[i % 3], 10.0 + (i / 3) as f64);
    let alone: Vec<_> = (0..64).map(|i| run(case(i).0, case(i).1)).collect();
    let threads: Vec<_> = (0..64)
        .map(|i| std::thread::spawn(move || run(case(i).0, case(i).1)))
        .collect();
    for (i, thread) in threads.into_iter().enumerate() {
        assert!(thread.join().unwrap() == alone[i], "{:?}", case(i));
    }
}

/// Many steps against one, which is the closed form `exp(AT) z₀`; each small step is right to rounding, of which a
/// drift remains that grows with their number.
fn many_steps(count: u32) {
    let unit = |kind| {
        let unit = StartedUnit::new(kind);
        // what does not decay keeps its size over the run
        for name in ["heave_damping_ratio", "torsion_damping_ratio"] {
            unit.set(name, 0.0);
        }
        unit.set("wind_speed", 0.0);
        unit.set("initial_heave", 0.01);
        unit.start();
        unit
    };
    const DURATION: f64 = 64.0;
    let (whole, parts) = (unit("rational"), unit("rational"));
    whole.ok(whole.step(0.0, DURATION));
    let step = DURATION / f64::from(count);
    for n in 0..count {
        parts.ok(parts.step(f64::from(n) * step, step));
    }
    let [expected, found] = [&whole, &parts].map(|u| u.get(["heave", "rotation"]));
    let off = (0..2).map(|i| (expected[i] - found[i]).abs() / 0.01);
    let off = off.fold(0.0, f64::max);
    println!("{count} steps: {off:.1e} of the amplitude");
    assert!(
        off < 1e-11 + f64::from(count) * 10.0 * f64::EPSILON,
        "{off:e}"
    );
}

#[test]
fn a_million_steps_are_one() {
    many_steps(1 << 20);
}

/// `cargo test --release --lib a_hundred_million -- --ignored --nocapture`
#[test]
#[ignore = "half a minute"]
fn a_hundred_million_steps_are_one() {
    many_steps(100_000_000);
}

/// An instance that is reset over and over, with other parameters each time, gives the bits of a fresh one.
fn resets(count: u32) {
    for kind in ["rational", "discrete_laguerre"] {
        let used = StartedUnit::new(kind);
        for n in 0..count {
            let part = f64::from(n) / f64::from(count);
            let run = |unit: &StartedUnit| {
                unit.set("mass", 10.0 + 10.0 * part);
                unit.set("wind_speed", 5.0 + 40.0 * (7.0 * part).fract());
                unit.set("initial_rotation", 0.01 * (0.1 + part));
                unit.start();
                for i in 0..3 {
                    unit.ok(unit.step(0.02 * f64::from(i), 0.02));
                }
                let onset = unit.get(["onset_speed", "onset_frequency"]);
                [bits(&unit.outputs()), bits(&onset)].concat()
            };
            used.ok(used.reset());
            // what a reset has to take back
            used.set("width", 0.3 + part);
            used.ok(used.reset());
            assert!(
                run(&used) == run(&StartedUnit::new(kind)),
                "{kind}, set {n}"
            );
        }
    }
}

#[test]
fn a_reset_instance_is_a_fresh_one() {
    resets(100);
}

/// `cargo test --release --lib a_hundred_thousand_resets -- --ignored`
#[test]
#[ignore = "minutes"]
fn a_hundred_thousand_resets_are_fresh() {
    resets(100_000);
}
