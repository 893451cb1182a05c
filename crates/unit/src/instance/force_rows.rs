//! Outputs of forces alone: the forces of each strip, and rows of numbers that follow from wind, motion and forces.

use super::force_parts::{StripsUnderModel, coordinate};
use super::force_unit::ForceUnit;
use super::memory::Memory;
use crate::section::Dof;
use crate::variables::{ComputedNumber, Dual, Known, Present, Response, Role, StripParameter};

impl ForceUnit {
    /// Writes the outputs of all strips.
    pub(super) fn put_out(&self, memory: &mut Memory) {
        for part in &self.parts {
            let n = part.forces.dofs().len();
            let own = part.coordinates.clone();
            let indices = self.outputs[own.clone()].chunks(n);
            let found = indices.zip(self.work.forces[own].chunks(n));
            for (strip, (indices, found)) in self.strips[part.strips.clone()].iter().zip(found) {
                let length = memory.values[strip[1]];
                for ([per_length, total], force) in indices.iter().zip(found) {
                    memory.values[*per_length] = force.value;
                    memory.values[*total] = force.value * length;
                }
            }
        }
        for (index, s, number) in &self.rows {
            let present = self.read(memory, *s, number, &|_| 0.0);
            memory.values[*index] = number.evaluate(&present).value;
        }
    }

    /// What a row reads of strip `s`, with the forces that were found last; `slope` is that of an input, a length or a force.
    pub(super) fn read(
        &self,
        memory: &Memory,
        s: usize,
        number: &ComputedNumber,
        slope: &dyn Fn(Role) -> f64,
    ) -> Present {
        let dofs = StripsUnderModel::new(&self.parts, s).forces.dofs();
        let stored = |index: usize, role| Dual::new(memory.values[index], slope(role));
        let motion = |response, dof| match (response, coordinate(&self.parts, s, dof)) {
            _ if !dofs.contains(&dof) => Dual::default(),
            (Response::SelfExcitedForce, i) => {
                Dual::new(self.work.forces[i].value, slope(Role::Force(s, dof)))
            }
            (response, i) => {
                let index = self.inputs[1 + 3 * i + response as usize];
                stored(index, Role::Motion(s, response, dof))
            }
        };
        let mut present = Present::default();
        for known in number.reads {
            match *known {
                Known::Wind => present.wind_m_s = stored(self.inputs[0], Role::WindSpeed),
                Known::Length => {
                    let role = Role::Strip(s, StripParameter::Length);
                    present.length_m = stored(self.strips[s][1], role);
                }
                Known::Rotation => {
                    present.rotation_rad = motion(Response::Displacement, Dof::Torsion);
                }
                Known::Motion(response, dof) => {
                    *present.motion_mut(response, dof) = motion(response, dof);
                }
                Known::Onset | Known::Damping | Known::TestedWind => {}
            }
        }
        present
    }

    /// Rate of an output, and of what rows read, with the forces that were found last.
    pub(super) fn rate(&self, memory: &Memory, role: Role) -> f64 {
        let of_input = |input: usize| memory.input_rates[input];
        match role {
            Role::OfStrip(s, number) => {
                let rate = |of| self.rate(memory, of);
                number.evaluate(&self.read(memory, s, number, &rate)).slope
            }
            Role::WindSpeed => of_input(0),
            Role::Motion(s, response, dof) => {
                of_input(1 + 3 * coordinate(&self.parts, s, dof) + response as usize)
            }
            force => self.entry(memory, force).slope,
        }
    }
}
