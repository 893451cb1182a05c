//! Real time: what a step takes from the memory of the process.

use super::{KINDS, Kind, instance, place, start};
use crate::fmu::instance::Instance;
use crate::fmu::lifecycle::State;
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

/// What a master reads at every step: all real outputs that belong to the motion or the present.
fn outputs(unit: &Instance) -> Vec<u32> {
    let all = unit.table().variables().iter().enumerate();
    let read = all.filter(|(_, v)| {
        v.causality == crate::fmu::variables::Causality::Output
            && matches!(v.value, crate::fmu::variables::Value::Real(_))
    });
    read.map(|(place, _)| place as u32).collect()
}

/// Allocations of a step and its readings, the most of twenty after ten; `wind` is that of each step.
fn of_steps(kind: Kind, wind: impl Fn(usize) -> f64) -> usize {
    let mut unit = instance(kind, false).unwrap();
    start(&mut unit);
    let (speed, read) = (place(&unit, "wind_speed"), outputs(&unit));
    let mut values = vec![0.0; read.len()];
    let mut step = |i: usize| {
        taken(|| {
            unit.set_reals(&[speed], &[wind(i)]).unwrap();
            unit.do_step(i as f64 * 0.01, 0.01).unwrap();
            unit.reals(&read, &mut values).unwrap();
        })
    };
    (0..30).map(&mut step).skip(10).max().unwrap()
}

/// Those of the rates of the states, where an importer integrates.
fn of_rates(kind: Kind) -> Option<usize> {
    let mut unit = instance(kind, true)?;
    start(&mut unit);
    unit.enter(State::ContinuousTimeMode);
    let count = unit.state_count();
    let (mut states, mut rates) = (vec![0.0; count], vec![0.0; count]);
    unit.continuous_states(&mut states).unwrap();
    let mut evaluate = |i: usize| {
        taken(|| {
            unit.set_time(i as f64 * 0.01).unwrap();
            unit.set_continuous_states(&states).unwrap();
            unit.state_rates(&mut rates).unwrap();
        })
    };
    (0..20).map(&mut evaluate).skip(10).max()
}

/// Nothing in steady wind for what is simulated in its forces, whatever is read; what is above nothing may fall, and not rise: one
/// of a sampled model, those of forces alone, of steps in another wind, and of the rates that an importer integrates.
#[test]
fn steps_take_no_more_than_is_promised() {
    let most = [
        (0, 24, Some(11)),
        (0, 24, Some(11)),
        (1, 74, None),
        (7, 7, Some(8)),
        (7, 7, None),
        (0, 24, Some(11)),
    ];
    for (kind, (steady, changing, rates)) in KINDS.into_iter().zip(most) {
        let found = of_steps(kind, |_| 12.0);
        assert!(found <= steady, "{kind:?}, steady wind: {found}");
        let found = of_steps(kind, |i| 12.0 + 0.1 * (i % 7) as f64);
        assert!(found <= changing, "{kind:?}, another wind: {found}");
        let found = of_rates(kind);
        assert!(found <= rates, "{kind:?}, rates: {found:?}");
    }
}
