//! Forces alone and a structure outside, integrated together: the section in one piece.

use super::force_exchange::{KINDS, What, alone};
use super::model_exchange::exchanged;
use super::*;
use crate::section::{Dof, Structure};
use nalgebra::{DMatrix, DVector};

/// The forces of a unit and the structure of its model, integrated together.
struct Beside {
    forces: StartedUnit,
    structure: Structure,
    /// Mass less the forces by acceleration.
    inertia: DMatrix<f64>,
    ramp: f64,
}

impl Beside {
    fn new(archive: Extracted, ramp: f64, q: &[f64]) -> Self {
        let structure = archive.model().section.structure().unwrap();
        let forces = exchanged(archive);
        forces.set("wind_speed", 20.0);
        let this = Self {
            inertia: structure.mass.clone(),
            forces,
            structure,
            ramp,
        };
        for (name, value) in this.names("").iter().zip(q) {
            this.forces.set(name, *value);
        }
        let gusts = this.forces.archive.resources.gusts.is_some();
        if gusts {
            this.forces.set("gust_w", 1.5);
        }
        this.forces.start();
        if gusts {
            this.forces.set("gust_u", -1.0);
        }
        this.forces.integrate_from_event();
        let n = this.structure.dofs.len();
        let (force, acceleration) = (this.forces_names(), this.names("_acceleration"));
        let by = DMatrix::from_fn(n, n, |i, j| {
            this.forces.directional(force[i], &acceleration[j])
        });
        Self {
            inertia: &this.structure.mass - by,
            ..this
        }
    }

    fn names(&self, ending: &str) -> Vec<String> {
        let name = |dof: &Dof| match dof {
            Dof::Vertical => "heave",
            Dof::Lateral => "sway",
            Dof::Torsion => "rotation",
        };
        let dofs = self.forces.archive.model().section.dofs();
        dofs.iter()
            .map(|d| format!("{}{ending}", name(d)))
            .collect()
    }

    fn forces_names(&self) -> Vec<&'static str> {
        let all = self.forces.archive.model().section.dofs();
        let name = |dof: &Dof| match dof {
            Dof::Vertical => "lift",
            Dof::Lateral => "drag",
            Dof::Torsion => "moment",
        };
        all.iter().map(name).collect()
    }

    /// Rates of displacements, their rates and the states of the unit.
    fn rates(&self, time: f64, z: &[f64]) -> Vec<f64> {
        let n = self.structure.dofs.len();
        let (q, rest) = z.split_at(n);
        let (v, x) = rest.split_at(n);
        self.forces.set("wind_speed", 20.0 + self.ramp * time);
        for (ending, values) in [("", q), ("_rate", v), ("_acceleration", &vec![0.0; n])] {
            for (name, value) in self.names(ending).iter().zip(values) {
                self.forces.set(name, *value);
            }
        }
        let states = self.forces.rates_at(time, x);
        let mut force = vec![f64::NAN; n];
        self.forces
            .ok(self.forces.try_get(&self.forces_names(), &mut force));
        let s = &self.structure;
        let (q, velocity) = (DVector::from_row_slice(q), DVector::from_row_slice(v));
        let sum = DVector::from_vec(force) - &s.damping * velocity - &s.stiffness * q;
        let acceleration = self.inertia.clone().lu().solve(&sum).unwrap();
        [v, acceleration.as_slice(), &states].concat()
    }

    /// The classical Runge–Kutta method from `q` at rest over a second.
    fn run(&self, q: &[f64], steps: u32) -> Vec<f64> {
        let h = 1.0 / f64::from(steps);
        let mut z = [q, &vec![0.0; q.len()], &self.forces.states()].concat();
        for i in 0..steps {
            let t = f64::from(i) * h;
            let moved = |k: &[f64], by: f64| -> Vec<f64> {
                z.iter().zip(k).map(|(z, k)| z + by * k).collect()
            };
            let k1 = self.rates(t, &z);
            let k2 = self.rates(t + 0.5 * h, &moved(&k1, 0.5 * h));
            let k3 = self.rates(t + 0.5 * h, &moved(&k2, 0.5 * h));
            let k4 = self.rates(t + h, &moved(&k3, h));
            let mean = |i: usize| (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]) / 6.0;
            z = (0..z.len()).map(|i| z[i] + h * mean(i)).collect();
        }
        self.rates(1.0, &z);
        self.forces.completed();
        z
    }
}

/// Forces and structure together against the section's own exact steps, in steady and in growing wind and in gusts; half the
/// step leaves a sixteenth of the difference.
#[test]
fn with_a_structure_outside_it_is_the_section() {
    let plain: [fn() -> Extracted; 3] = [
        || Extracted::fixture(KINDS[0]),
        || Extracted::fixture(KINDS[1]),
        Extracted::three_dof,
    ];
    let plain = plain.into_iter().map(|a| (a, false));
    let gusty: [(fn() -> Extracted, bool); 1] = [(|| Extracted::fixture(KINDS[1]), true)];
    let cases = plain.chain(gusty);
    for ((fixture, gusts), ramp) in cases.flat_map(|c| [(c, 0.0), (c, 15.0)]) {
        let section = What {
            strips: None,
            gusts,
        };
        let own = StartedUnit::instantiate(fixture().exported(section));
        own.set("wind_speed", 20.0);
        if gusts {
            own.set("gust_w", 1.5);
        }
        own.start();
        own.set_rate("wind_speed", ramp);
        let indices = own.archive.resources.table.state_rates();
        let table = &own.archive.resources.table;
        let state = |i: usize| {
            let of = table.variables()[indices[i]].derivative_of.unwrap();
            table.variables()[of].name.clone()
        };
        let names: Vec<String> = (0..indices.len()).map(state).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let n = own.archive.model().section.dofs().len();
        let read = || {
            let mut values = vec![f64::NAN; names.len()];
            own.ok(own.try_get(&names, &mut values));
            values
        };
        let q = read()[..n].to_vec();
        if gusts {
            own.set("gust_u", -1.0);
        }
        own.ok(own.step(0.0, 1.0));
        let expected = read();
        let mut errors = Vec::new();
        for steps in [1000u32, 2000] {
            let beside = Beside::new(fixture().exported(What { gusts, ..alone() }), ramp, &q);
            let found = beside.run(&q, steps);
            let off = |range: std::ops::Range<usize>| {
                let size = expected[range.clone()]
                    .iter()
                    .fold(0.0_f64, |s, x| s.max(x.abs()));
                let off = range.map(|i| (expected[i] - found[i]).abs());
                off.fold(0.0, f64::max) / size
            };
            errors.push(off(0..n).max(off(2 * n..expected.len())));
        }
        assert!(errors[1] < 1e-6, "{errors:?}");
        assert!(
            (12.0..20.0).contains(&(errors[0] / errors[1])),
            "{errors:?}"
        );
    }
}
