//! Whatever is read first after a parameter was set is that of the parameter.

use super::{Exported, KINDS, driven, index, instance, start};
use crate::instance::layout::{DataType, Source};
use crate::instance::{Instance, Memory};
use crate::lifecycle::{State, gettable_in, settable_in};

/// Indices of the parameters that may be set in a state, with other values for them.
fn parameters(instance: &Instance, state: State) -> Vec<(u32, f64)> {
    let all = instance.table().variables().iter().enumerate();
    let free = all.filter(|(index, v)| {
        let source = instance.layout.access[*index].source;
        matches!(
            source,
            Source::Section | Source::Turbulence | Source::Release | Source::Limit
        ) && instance.layout.access[*index].data_type == DataType::Real
            && settable_in(v.causality, v.variability).contains(state)
    });
    free.map(|(index, v)| {
        let start = instance.now.memory.values[index];
        let other = if start == 0.0 { 0.003 } else { 1.28 * start };
        let allowed = v.min.is_none_or(|min| other >= min) && v.max.is_none_or(|max| other <= max);
        (index as u32, if allowed { other } else { 1.0 })
    })
    .collect()
}

/// Indices of everything that is computed and may be read in a state.
fn computed(instance: &Instance, state: State) -> Vec<u32> {
    let all = instance.table().variables().iter().enumerate();
    let read = all.filter(|(index, v)| {
        let access = &instance.layout.access[*index];
        let stored = matches!(
            access.source,
            Source::Input
                | Source::Section
                | Source::Turbulence
                | Source::Release
                | Source::Limit
                | Source::Constant
        );
        !stored && gettable_in(v.causality, v.variability).contains(state)
    });
    read.map(|(index, _)| index as u32).collect()
}

fn read(instance: &mut Instance, reference: u32) -> f64 {
    let data_type = instance.layout.access[reference as usize].data_type;
    instance.number(reference, data_type).unwrap()
}

/// All of them in the order of the table, read from `first` on and round.
fn read_from(instance: &mut Instance, indices: &[u32], first: usize) -> Vec<u64> {
    let mut values = vec![0; indices.len()];
    for i in (first..indices.len()).chain(0..first) {
        values[i] = read(instance, indices[i]).to_bits();
    }
    values
}

/// A unit with a parameter set before anything else, in this state.
fn fresh(made: &dyn Fn() -> Instance, index: u32, value: f64) -> Instance {
    let mut unit = made();
    unit.set_reals(&[index], &[value]).unwrap();
    unit
}

/// Ways in which a parameter reaches a unit that has shown the values of another.
#[derive(Debug, Clone, Copy)]
enum ChangedBy {
    Set,
    Restored,
}

fn judge(kind: Exported, integrated: bool, state: State) {
    judge_made(kind, integrated, state, &|| {
        instance(kind, integrated).unwrap()
    });
}

fn judge_made(kind: Exported, integrated: bool, state: State, made: &dyn Fn() -> Instance) {
    let begin = |unit: &mut Instance| match state {
        State::Initialization => unit.enter_initialization(),
        _ => {
            start(unit);
            if !integrated {
                unit.do_step(0.0, 0.01).unwrap();
            }
        }
    };
    let mut unit = made();
    begin(&mut unit);
    let indices = computed(&unit, state);
    let before = unit.snapshot();
    let shown = |unit: &mut Instance, snapshot: &Memory| {
        unit.restore(snapshot).unwrap();
        read_from(unit, &indices, 0)
    };
    for parameter in parameters(&unit, state) {
        let name = unit.table().variables()[parameter.0 as usize].name.clone();
        unit.restore(&before).unwrap();
        unit.set_reals(&[parameter.0], &[parameter.1]).unwrap();
        let changed = unit.snapshot();
        let mut other = fresh(made, parameter.0, parameter.1);
        begin(&mut other);
        let expected = shown(&mut other, &changed);
        for first in 0..indices.len() {
            for way in [ChangedBy::Set, ChangedBy::Restored] {
                shown(&mut unit, &before);
                match way {
                    ChangedBy::Set => unit.set_reals(&[parameter.0], &[parameter.1]).unwrap(),
                    ChangedBy::Restored => unit.restore(&changed).unwrap(),
                }
                let found = read_from(&mut unit, &indices, first);
                for (i, (found, expected)) in found.iter().zip(&expected).enumerate() {
                    let of = &unit.table().variables()[indices[i] as usize].name;
                    let first = &unit.table().variables()[indices[first] as usize].name;
                    let [found, expected] = [found, expected].map(|bits| f64::from_bits(*bits));
                    // the onset of a bridge is followed from that of the last search, until it settles to 1e-9
                    let followed = matches!(kind, Exported::Bridge | Exported::Damped)
                        && (found - expected).abs() <= 1e-8 * expected.abs().max(1.0);
                    assert!(
                        found == expected || followed,
                        "{kind:?}, {state:?}: `{of}` after `{name}` {way:?}, read from `{first}` on: {found}, not {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn what_is_read_while_initialising_is_that_of_the_parameters() {
    for kind in KINDS {
        judge(kind, false, State::Initialization);
    }
}

/// In gusts that act through lags, of an archive that has turbulence.
#[test]
fn what_is_read_in_turbulence_is_that_of_the_parameters() {
    for state in [State::Initialization, State::StepComplete] {
        let kind = Exported::Bridge;
        judge_made(kind, false, state, &|| driven(kind, true));
    }
}

#[test]
fn what_is_read_between_steps_is_that_of_the_parameters() {
    for kind in KINDS {
        judge(kind, false, State::StepComplete);
    }
}

#[test]
fn what_is_read_between_events_is_that_of_the_parameters() {
    for kind in KINDS.into_iter().filter(|k| instance(*k, true).is_some()) {
        judge(kind, true, State::Initialization);
        judge(kind, true, State::EventMode);
    }
}

/// A bridge of one node is the section that it was made of: so is its onset, whatever the parameters.
#[test]
fn the_onset_of_a_bridge_is_that_of_the_parameters() {
    let mut section = instance(Exported::Section("rational"), false).unwrap();
    let mut bridge = instance(Exported::Bridge, false).unwrap();
    for unit in [&mut section, &mut bridge] {
        start(unit);
    }
    for density in [1.19, 1.6, 1.0, 1.6] {
        let onset = |unit: &mut Instance| {
            let [air, onset] = ["air_density", "onset_speed"].map(|name| index(unit, name));
            unit.set_reals(&[air], &[density]).unwrap();
            let mut speed = [f64::NAN];
            unit.reals(&[onset], &mut speed).unwrap();
            speed[0]
        };
        let (expected, found) = (onset(&mut section), onset(&mut bridge));
        // both searches end at 1e-11 of the speed
        assert!((found / expected - 1.0).abs() < 1e-8, "{found}, {expected}");
    }
}

/// The state counts a damper by the root of its mass; where it is, and how fast, is not changed by tuning that.
#[test]
fn a_damper_stays_where_it_is_when_its_mass_changes() {
    for integrated in [false, true] {
        let mut unit = instance(Exported::Damped, integrated).unwrap();
        start(&mut unit);
        if integrated {
            let states: Vec<f64> = (0..unit.state_count()).map(|i| 1e-3 * i as f64).collect();
            unit.set_continuous_states(&states).unwrap();
        } else {
            unit.do_step(0.0, 0.4).unwrap();
        }
        let motion = ["damper[1].stroke", "damper[1].stroke_rate"].map(|name| index(&unit, name));
        let at = |unit: &mut Instance| motion.map(|reference| read(unit, reference));
        let (before, kept) = (at(&mut unit), unit.snapshot());
        let mass = index(&unit, "damper[1].mass");
        let now = read(&mut unit, mass);
        assert!(before.iter().all(|x| x.abs() > 1e-6) && !unit.has_set_states());
        // twice without a look between, after a restored state and back
        for factors in [&[2.0][..], &[0.3, 5.0], &[1.0]] {
            for factor in factors {
                unit.set_reals(&[mass], &[factor * now]).unwrap();
            }
            for (found, expected) in at(&mut unit).iter().zip(before) {
                let off = (found / expected - 1.0).abs();
                assert!(off < 1e-12, "{factors:?}: {found}, {expected}");
            }
            assert!(unit.has_set_states() && !unit.has_set_states());
        }
        unit.set_reals(&[mass], &[3.0 * now]).unwrap();
        unit.restore(&kept).unwrap();
        assert_eq!(at(&mut unit), before);
    }
    let mut released = instance(Exported::Damped, false).unwrap();
    released.enter_initialization();
    let [mass, stroke] = ["damper[1].mass", "damper[1].stroke"].map(|name| index(&released, name));
    released.set_reals(&[mass], &[7.0]).unwrap();
    assert!(read(&mut released, stroke).abs() < 1e-18);
}
