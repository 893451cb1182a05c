//! Real time: what a step takes from the memory of the process.

use super::{KINDS, driven, index, start};
use crate::instance::Instance;
use crate::lifecycle::State;
use crate::variables::{Causality, StartValue};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    static COUNT: Cell<usize> = const { Cell::new(0) };
}

/// The allocator of the system, which counts what a thread takes from it.
struct Counting;

// SAFETY: everything is handed on to the allocator of the system
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.with(|count| count.set(count.get() + 1));
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        COUNT.with(|count| count.set(count.get() + 1));
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn taken(what: impl FnOnce()) -> usize {
    let before = COUNT.get();
    what();
    COUNT.get() - before
}

/// Indices of all real outputs, or inputs.
fn real(unit: &Instance, causality: Causality) -> Vec<u32> {
    let all = unit.table().variables().iter().enumerate();
    let read =
        all.filter(|(_, v)| v.causality == causality && matches!(v.value, StartValue::Real(_)));
    read.map(|(index, _)| index as u32).collect()
}

/// What an importer changes at every step.
#[derive(Debug, Clone, Copy)]
enum Change {
    Nothing,
    /// The wind alone.
    Wind,
    /// Every input: wind, motion, forces, gusts.
    Inputs,
    /// Every input with its rate over the step.
    Ramps,
}

const CHANGES: [Change; 4] = [Change::Nothing, Change::Wind, Change::Inputs, Change::Ramps];

/// Another value at each step.
fn changed(i: usize, input: usize) -> f64 {
    1e-3 * ((i + 3 * input) % 7) as f64
}

/// Sets what is changed for step `i`.
fn set(unit: &mut Instance, inputs: &[u32], change: Change, i: usize) {
    let wind = 12.0 + 100.0 * changed(i, 0);
    let others = match change {
        Change::Nothing => return,
        Change::Wind => 1,
        Change::Inputs | Change::Ramps => inputs.len(),
    };
    for (input, index) in inputs[..others].iter().enumerate() {
        let value = if input == 0 { wind } else { changed(i, input) };
        unit.set_reals(&[*index], &[value]).unwrap();
        if matches!(change, Change::Ramps) {
            unit.set_input_rates(&[*index], &[1], &[0.1 * value])
                .unwrap();
        }
    }
}

/// Wind first.
fn inputs(unit: &Instance) -> Vec<u32> {
    let mut inputs = real(unit, Causality::Input);
    inputs.sort_by_key(|index| *index != index_of_wind(unit));
    inputs
}

fn index_of_wind(unit: &Instance) -> u32 {
    index(unit, "wind_speed")
}

/// Allocations of a step and of reading every output, the most of twenty after ten.
fn of_steps(mut unit: Instance, change: Change) -> usize {
    start(&mut unit);
    let (inputs, read) = (inputs(&unit), real(&unit, Causality::Output));
    let mut values = vec![0.0; read.len()];
    let mut step = |i: usize| {
        taken(|| {
            set(&mut unit, &inputs, change, i);
            unit.do_step(i as f64 * 0.01, 0.01).unwrap();
            unit.reals(&read, &mut values).unwrap();
        })
    };
    (0..30).map(&mut step).skip(10).max().unwrap()
}

/// Those of the rates of the states and all outputs, where an importer integrates.
fn of_rates(mut unit: Instance, change: Change) -> usize {
    start(&mut unit);
    unit.enter(State::ContinuousTimeMode);
    let (inputs, read) = (inputs(&unit), real(&unit, Causality::Output));
    let count = unit.state_count();
    let (mut states, mut rates) = (vec![0.0; count], vec![0.0; count]);
    let mut values = vec![0.0; read.len()];
    unit.continuous_states(&mut states).unwrap();
    let mut evaluate = |i: usize| {
        taken(|| {
            unit.set_time(i as f64 * 0.01).unwrap();
            set(&mut unit, &inputs, change, i);
            states[0] = changed(i, 1);
            unit.set_continuous_states(&states).unwrap();
            unit.state_rates(&mut rates).unwrap();
            unit.reals(&read, &mut values).unwrap();
        })
    };
    (0..20).map(&mut evaluate).skip(10).max().unwrap()
}

/// Nothing, whatever is set and read, once each kind of change has been seen.
#[test]
fn steps_take_no_memory() {
    for gusts in [false, true] {
        for kind in KINDS {
            for change in CHANGES {
                let found = of_steps(driven(kind, gusts), change);
                assert_eq!(found, 0, "{kind:?}, gusts {gusts}, {change:?}");
                if let Ok(unit) = driven(kind, gusts).for_model_exchange() {
                    // an importer that integrates knows no rates of inputs
                    if !matches!(change, Change::Ramps) {
                        let found = of_rates(unit, change);
                        assert_eq!(found, 0, "rates: {kind:?}, gusts {gusts}, {change:?}");
                    }
                }
            }
        }
    }
}
