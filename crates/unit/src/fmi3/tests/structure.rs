//! The number of strips that an importer chooses, and what it is told of dependencies.

use super::*;

const KINDS: [&str; 3] = ["continuous_laguerre", "rational", "discrete_laguerre"];

impl NewStandardUnit {
    fn configure(&self, strips: u64) -> fmi2Status {
        self.ok(unsafe { fmi3EnterConfigurationMode(self.handle) });
        let vr = self.groups.strips_reference().unwrap();
        let status = unsafe { fmi3SetUInt64(self.handle, &raw const vr, 1, &raw const strips, 1) };
        if status == fmi2Status::fmi2OK {
            self.ok(unsafe { fmi3ExitConfigurationMode(self.handle) });
        }
        status
    }

    fn strips(&self) -> u64 {
        let (vr, mut strips) = (self.groups.strips_reference().unwrap(), 0);
        self.ok(unsafe { fmi3GetUInt64(self.handle, &raw const vr, 1, &raw mut strips, 1) });
        strips
    }

    /// Lifts of a run in which every strip moves in its own way.
    fn lifts(&self, strips: usize) -> Vec<f64> {
        self.start();
        let mut all = Vec::new();
        for i in 0..20 {
            let of = |s: usize| 0.01 * (0.3 * f64::from(i) + s as f64).sin();
            self.set("rotation", &(0..strips).map(of).collect::<Vec<_>>());
            self.ok(self.step(0.01 * f64::from(i), 0.01));
            all.extend(self.get("lift", strips));
        }
        all
    }
}

/// More strips or fewer, what has been set before, and as exported after a reset: the same bits as a unit that was exported so.
#[test]
fn any_number_of_strips_is_that_of_an_export() {
    for kind in KINDS {
        for strips in [1, 2, 3, 7] {
            let exported = NewStandardUnit::new(kind, Some(strips), false);
            exported.set("wind_speed", &[17.0]);
            let unit = NewStandardUnit::new(kind, Some(3), false);
            assert_eq!(unit.strips(), 3);
            unit.set("wind_speed", &[17.0]);
            unit.ok(unit.configure(strips as u64));
            assert_eq!(unit.strips(), strips as u64);
            assert_eq!(unit.lifts(strips), exported.lifts(strips), "{kind}");
            unit.ok(unsafe { fmi3Reset(unit.handle) });
            assert_eq!(unit.strips(), 3);
            let three = NewStandardUnit::new(kind, Some(3), false);
            assert_eq!(unit.lifts(3), three.lifts(3), "{kind}");
        }
    }
}

#[test]
fn what_is_no_number_of_strips_is_refused() {
    let unit = NewStandardUnit::new("rational", Some(3), false);
    for strips in [0, 10_001, u64::MAX] {
        assert_eq!(unit.configure(strips), fmi2Status::fmi2Discard);
        unit.ok(unsafe { fmi3ExitConfigurationMode(unit.handle) });
        assert_eq!(unit.strips(), 3);
    }
    let status = unsafe { fmi3ExitConfigurationMode(unit.handle) };
    unit.refused(status, "was not entered");
    let mut state = null_mut();
    unit.ok(unsafe { fmi3GetFMUState(unit.handle, &raw mut state) });
    unit.ok(unit.configure(5));
    let status = unsafe { fmi3SetFMUState(unit.handle, state) };
    unit.refused(status, "as many strips");
    unit.ok(unsafe { fmi3FreeFMUState(unit.handle, &raw mut state) });
    unit.ok(unsafe { fmi3Reset(unit.handle) });
    unit.ok(unsafe { fmi3EnterConfigurationMode(unit.handle) });
    let status = unsafe { fmi3EnterInitializationMode(unit.handle, 0, 0.0, 0.0, 0, 0.0) };
    unit.refused(status, "was not left");
    unit.ok(unsafe { fmi3Reset(unit.handle) });
    unit.start();
    let (vr, four) = (unit.groups.strips_reference().unwrap(), 4);
    let status = unsafe { fmi3SetUInt64(unit.handle, &raw const vr, 1, &raw const four, 1) };
    unit.refused(status, "configuration mode only");
    let section = NewStandardUnit::new("rational", None, false);
    let status = unsafe { fmi3EnterConfigurationMode(section.handle) };
    section.refused(status, "no structural parameters");
    section.start();
}

/// Every element of an array depends on its own strip, and on the wind of all.
#[test]
fn every_strip_depends_on_itself() {
    let unit = NewStandardUnit::new("rational", Some(3), false);
    unit.start();
    let lift = unit.reference("lift");
    let mut count = 0;
    unit.ok(unsafe { fmi3GetNumberOfVariableDependencies(unit.handle, lift, &raw mut count) });
    let (mut own, mut on) = (vec![0; count], vec![0; count]);
    let (mut of, mut kinds) = (vec![0; count], vec![-1; count]);
    unit.ok(unsafe {
        fmi3GetVariableDependencies(
            unit.handle,
            lift,
            own.as_mut_ptr(),
            on.as_mut_ptr(),
            of.as_mut_ptr(),
            kinds.as_mut_ptr(),
            count,
        )
    });
    let indices = &unit.groups.all()[lift as usize];
    let direct = |i: usize| &unit.resources.table.variables()[indices[i] as usize].direct_inputs;
    assert_eq!(count, (0..3).map(|i| direct(i).len()).sum::<usize>());
    let wind = unit.reference("wind_speed");
    for i in 0..count {
        assert_eq!(kinds[i], 5);
        assert!(if on[i] == wind {
            of[i] == 1
        } else {
            of[i] == own[i]
        });
        let index = unit.groups.all()[on[i] as usize][of[i] - 1] as usize;
        assert!(direct(own[i] - 1).iter().any(|d| d.on == index));
    }
    let status = unsafe { fmi3GetNumberOfVariableDependencies(unit.handle, 9999, &raw mut count) };
    unit.refused(status, "no such variable");
    // and the run goes on
    unit.ok(unit.step(0.0, 0.01));
    let (none, mut real, mut integers) = (9999, 0.0, [0; 3]);
    let status = unsafe { fmi3GetFloat64(unit.handle, &raw const none, 1, &raw mut real, 1) };
    let last = unit.groups.strips_reference().unwrap();
    unit.refused(status, &format!("no such variable, the last one is {last}"));
    let status = unsafe { fmi3GetInt32(unit.handle, &raw const lift, 1, integers.as_mut_ptr(), 3) };
    unit.refused(status, "is a real number, not an integer");
}
