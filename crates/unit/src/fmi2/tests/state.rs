//! Reset, saved and serialised states: replays are the same to the last bit.

use super::*;
use fmi2Status::fmi2Error;

/// A run with everything in it; returns the outputs after every step, as bits.
fn run(unit: &StartedUnit, from: usize) -> Vec<u64> {
    let mut bits = Vec::new();
    for i in from..120 {
        match i {
            10 => unit.set("external_moment", 0.5),
            30 => unit.set_rate("wind_speed", -2.0),
            50 => unit.set("mass", 12.0),
            70 => unit.set_rate("wind_speed", 0.0),
            _ => {}
        }
        let h = if i % 3 == 0 { 0.013 } else { 0.02 };
        let time = (0..i).map(|j| if j % 3 == 0 { 0.013 } else { 0.02 }).sum();
        unit.ok(unit.step(time, h));
        bits.extend(unit.outputs().iter().map(|x| x.to_bits()));
    }
    bits
}

const KINDS: [&str; 3] = ["continuous_laguerre", "rational", "discrete_laguerre"];

#[test]
fn reset_restores_every_default() {
    for kind in KINDS {
        let unit = StartedUnit::new(kind);
        let variables = unit.archive.resources.table.variables().to_vec();
        unit.start();
        let first = run(&unit, 0);
        unit.ok(unit.reset());
        for v in &variables {
            if let crate::variables::StartValue::Real(Some(start)) = v.value {
                assert_eq!(unit.get([v.name.as_str()]), [start], "{}", v.name);
            }
        }
        unit.start();
        assert_eq!(run(&unit, 0), first);
        let fresh = StartedUnit::started(kind);
        assert_eq!(run(&fresh, 0), first);
    }
}

/// Steps of one size under changes of everything; `before` is done before each.
fn changing_run(unit: &StartedUnit, before: impl Fn()) -> Vec<u64> {
    let mut saved: fmi2FMUstate = null();
    let (mut bits, mut restart) = (Vec::new(), 0);
    for i in 0..160 {
        match i {
            10 => unit.set("wind_speed", 14.0),
            20 => unit.set("external_moment", 0.5),
            30 => unit.set("external_moment", 0.0),
            40 => unit.set_rate("wind_speed", -2.0),
            50 => unit.set_rate("wind_speed", 0.0),
            60 => unit.ok(unsafe { fmi2GetFMUstate(unit.handle, &raw mut saved) }),
            65 => unit.set("wind_speed", 9.0),
            75 => unit.set("mass", 12.0),
            85 => {
                unit.ok(unsafe { fmi2SetFMUstate(unit.handle, saved) });
                restart = 85 - 60;
            }
            120 => {
                unit.ok(unit.reset());
                unit.ok(unit.set_up());
                unit.set("wind_speed", 11.0);
                unit.ok(unit.enter());
                bits.extend(unit.outputs().iter().map(|x| x.to_bits()));
                unit.ok(unit.exit());
                restart = 120;
            }
            _ => {}
        }
        before();
        unit.ok(unit.step(f64::from(i - restart) * 0.01, 0.01));
        // read at some steps only: what is read changes nothing
        if i % 3 == 0 {
            bits.extend(unit.outputs().iter().map(|x| x.to_bits()));
        }
        let motion = unit.get(["heave", "heave_rate", "rotation", "rotation_rate"]);
        bits.extend(motion.map(f64::to_bits));
    }
    unit.ok(unsafe { fmi2FreeFMUstate(unit.handle, &raw mut saved) });
    bits
}

/// A step that is only taken again, as long as nothing has changed, has the bits of one that looks at everything.
#[test]
fn a_step_taken_again_is_the_step_itself() {
    for kind in KINDS {
        let (again, anew) = (StartedUnit::started(kind), StartedUnit::started(kind));
        let expected = changing_run(&anew, || anew.set_rate("external_moment", 0.0));
        assert!(changing_run(&again, || ()) == expected, "{kind}");
    }
}

#[test]
fn saved_states_are_replayed() {
    for kind in KINDS {
        let unit = StartedUnit::started(kind);
        let all = run(&unit, 0);
        unit.ok(unit.reset());
        unit.start();
        let c = unit.handle;
        let mut saved: fmi2FMUstate = null();
        let mut time = 0.0;
        for i in 0..40 {
            match i {
                10 => unit.set("external_moment", 0.5),
                30 => unit.set_rate("wind_speed", -2.0),
                _ => {}
            }
            let h = if i % 3 == 0 { 0.013 } else { 0.02 };
            unit.ok(unit.step(time, h));
            time += h;
        }
        unit.ok(unsafe { fmi2GetFMUstate(c, &raw mut saved) });
        assert!(!saved.is_null());
        let rest = run(&unit, 40);
        assert_eq!(all[all.len() - rest.len()..], rest[..]);
        unit.ok(unsafe { fmi2SetFMUstate(c, saved) });
        assert_eq!(run(&unit, 40), rest);
        unit.ok(unsafe { fmi2SetFMUstate(c, saved) });
        // reuse of the given state, and freeing twice
        let given = saved;
        unit.ok(unsafe { fmi2GetFMUstate(c, &raw mut saved) });
        assert_eq!(given, saved);
        unit.ok(unsafe { fmi2FreeFMUstate(c, &raw mut saved) });
        assert!(saved.is_null());
        unit.ok(unsafe { fmi2FreeFMUstate(c, &raw mut saved) });
        unit.ok(unsafe { fmi2FreeFMUstate(c, null()) });
    }
}

/// Bytes of the current state.
fn serialize(unit: &StartedUnit) -> Vec<fmi2Byte> {
    let c = unit.handle;
    let (mut saved, mut size): (fmi2FMUstate, usize) = (null(), 0);
    unit.ok(unsafe { fmi2GetFMUstate(c, &raw mut saved) });
    unit.ok(unsafe { fmi2SerializedFMUstateSize(c, saved, &raw mut size) });
    let mut bytes = vec![0; size];
    unit.ok(unsafe { fmi2SerializeFMUstate(c, saved, bytes.as_mut_ptr(), size) });
    unit.ok(unsafe { fmi2FreeFMUstate(c, &raw mut saved) });
    bytes
}

fn deserialize(unit: &StartedUnit, bytes: &[fmi2Byte]) -> (fmi2Status, fmi2FMUstate) {
    let mut saved: fmi2FMUstate = null();
    let status = unsafe {
        fmi2DeSerializeFMUstate(unit.handle, bytes.as_ptr(), bytes.len(), &raw mut saved)
    };
    (status, saved)
}

#[test]
fn serialised_states_go_on_in_another_instance() {
    for kind in KINDS {
        let unit = StartedUnit::started(kind);
        let mut time = 0.0;
        for i in 0..20 {
            if i == 10 {
                unit.set("external_moment", 0.5);
            }
            let h = if i % 3 == 0 { 0.013 } else { 0.02 };
            unit.ok(unit.step(time, h));
            time += h;
        }
        let bytes = serialize(&unit);
        let rest = run(&unit, 20);
        let other = StartedUnit::new(kind); // not even initialised
        let (status, mut saved) = deserialize(&other, &bytes);
        other.ok(status);
        other.ok(unsafe { fmi2SetFMUstate(other.handle, saved) });
        assert_eq!(serialize(&other), bytes);
        assert_eq!(run(&other, 20), rest);
        other.ok(unsafe { fmi2FreeFMUstate(other.handle, &raw mut saved) });
    }
}

/// Makes the digest at the end that of the bytes before.
fn sign(bytes: &mut [fmi2Byte]) {
    let end = bytes.len() - 16;
    let before: Vec<u8> = bytes[..end].iter().map(|b| *b as u8).collect();
    let guid = uuid::Uuid::from_slice(&before[12..28]).unwrap();
    let digest = uuid::Uuid::new_v5(&guid, &before).into_bytes();
    for (index, new) in bytes[end..].iter_mut().zip(digest) {
        *index = new as fmi2Byte;
    }
}

#[test]
fn damaged_bytes_are_refused() {
    let started = || StartedUnit::started("rational");
    let right = serialize(&started());
    let byte = |x: u8| x as fmi2Byte;
    let damaged = |change: &dyn Fn(&mut Vec<fmi2Byte>)| {
        let mut bytes = right.clone();
        change(&mut bytes);
        bytes
    };
    let header = 8 + 4 + 16;
    let numbers = header + 16 + 2;
    let nan = f64::NAN.to_le_bytes().map(byte);
    let negative = (-1.0_f64).to_le_bytes().map(byte);
    for (bytes, word) in [
        (damaged(&|b| b[0] = byte(b'X')), "magic"),
        (damaged(&|b| b[8] = byte(9)), "version"),
        (damaged(&|b| b[12] ^= byte(1)), "identity"),
        (damaged(&|b| b[header] = byte(200)), "values"),
        (damaged(&|b| b[header + 16] = byte(3)), "state"),
        (damaged(&|b| b[header + 17] = byte(2)), "experiment"),
        (
            damaged(&|b| b[numbers + 24..numbers + 32].copy_from_slice(&nan)),
            "finite",
        ),
        // the first value is the wind speed
        (
            damaged(&|b| {
                b[numbers + 24..numbers + 32].copy_from_slice(&negative);
                sign(b);
            }),
            "wind_speed",
        ),
        (damaged(&|b| b[numbers + 24] ^= byte(1)), "digest"),
        (damaged(&|b| b.truncate(100)), "more bytes"),
        (damaged(&|b| b.push(byte(0))), "end"),
        (Vec::new(), "magic"),
    ] {
        let unit = started();
        let (status, saved) = deserialize(&unit, &bytes);
        unit.refused(status, fmi2Error, &["serialised state", word]);
        assert!(saved.is_null());
        unit.ok(unit.step(0.0, 0.1)); // the run goes on
    }
    // a state of another model, and too little room
    let unit = StartedUnit::started("continuous_laguerre");
    let (status, _) = deserialize(&unit, &right);
    unit.refused(status, fmi2Error, &["identity"]);
    let unit = started();
    let mut saved: fmi2FMUstate = null();
    unit.ok(unsafe { fmi2GetFMUstate(unit.handle, &raw mut saved) });
    let mut room = [0; 10];
    let status = unsafe { fmi2SerializeFMUstate(unit.handle, saved, room.as_mut_ptr(), 10) };
    unit.refused(status, fmi2Error, &["room for"]);
    let status = unsafe { fmi2SetFMUstate(unit.handle, null()) };
    unit.refused(status, fmi2Error, &["FMUstate", "NULL"]);
    let other = StartedUnit::started("continuous_laguerre");
    let status = unsafe { fmi2SetFMUstate(other.handle, saved) };
    other.refused(
        status,
        fmi2Error,
        &["saved state", "expected one of the model"],
    );
    unit.ok(unsafe { fmi2FreeFMUstate(unit.handle, &raw mut saved) });
}

/// A saved state is the way out of an error.
#[test]
fn a_saved_state_leads_out_of_an_error() {
    let unit = StartedUnit::started("rational");
    let mut saved: fmi2FMUstate = null();
    unit.ok(unit.step(0.0, 0.1));
    unit.ok(unsafe { fmi2GetFMUstate(unit.handle, &raw mut saved) });
    assert_eq!(unit.step(0.1, -0.1), fmi2Error);
    assert_eq!(unit.step(0.1, 0.1), fmi2Error);
    unit.ok(unsafe { fmi2SetFMUstate(unit.handle, saved) });
    unit.ok(unit.step(0.1, 0.1));
    unit.ok(unsafe { fmi2FreeFMUstate(unit.handle, &raw mut saved) });
}
