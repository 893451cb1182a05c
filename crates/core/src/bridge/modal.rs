//! The bridge as a structure in generalised coordinates with self-excited forces of as many rows.
//!
//! Modes are mass-normalised: `η' = √M_m η`, so that all rows are of one size. Reduced frequencies refer to the width of the first
//! group and the wind speed of the bridge; a group of width `B_g` in the wind `p V` sees `K_g = K B_g/(p B)`.
//!
//! Filters live on modal coordinates, not on strips: the filter states of node `i` are `x_i = Φ_i X` with
//! `X' = (V/B)(A X + b η)`, exact, modes × filters states for a group and a set of poles instead of nodes × filters × motions.
//! Groups of one section in different winds share filters (`banks`).

use super::banks::{ModalBank, merged};
use super::{Bridge, StripGroup};
use crate::aerodynamics::{ContinuousRealization, Realization, Transfer, TransferMatrix};
use crate::error::{Error, Result};
use crate::section::{Dof, Structure};
use crate::state_space::is_diagonal;
use crate::units::{ReducedFrequency, ReducedFrequencyRange};
use nalgebra::{Complex, DMatrix, DVector, DVectorView};
use std::f64::consts::TAU;

/// Self-excited forces on the mass-normalised modal coordinates, over `½ρV²B²` with the width and the wind of the bridge.
#[derive(Debug, Clone)]
pub struct ModalForces {
    width_m: f64,
    dofs: Vec<Dof>,
    groups: Vec<GroupSums>,
}

impl Bridge {
    /// Mass, damping and stiffness of the mass-normalised modes and of the dampers.
    pub fn structure(&self) -> Structure {
        let n = self.coordinates();
        let (mut damping, mut stiffness) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
        for (i, mode) in self.modes.iter().enumerate() {
            let omega = TAU * mode.frequency_hz;
            damping[(i, i)] = 2.0 * mode.damping_ratio * omega;
            stiffness[(i, i)] = omega * omega;
        }
        self.damp(&mut damping, &mut stiffness);
        Structure::modal(
            self.width_m(),
            self.air_density_kg_m3,
            [DMatrix::identity(n, n), damping, stiffness],
            self.mode_names(),
        )
    }

    /// The forces of the wind on the mass-normalised modes.
    pub fn forces(&self) -> ModalForces {
        let blown = self.groups.iter().filter(|g| g.wind_factor > 0.0);
        ModalForces {
            width_m: self.width_m(),
            dofs: vec![Dof::Torsion; self.coordinates()],
            groups: blown.map(|g| GroupSums::new(self, g)).collect(),
        }
    }
}

impl ModalForces {
    /// `B_g/(p B)`: the reduced frequency of a group over that of the bridge.
    fn frequency_ratio(&self, group: &StripGroup) -> f64 {
        group.width_m / (group.wind_factor * self.width_m)
    }

    /// Matrices of one group over those of the bridge: pressure and area.
    fn pressure_ratio(&self, group: &StripGroup) -> f64 {
        (group.wind_factor / self.width_m).powi(2)
    }

    /// Reduced frequencies of the bridge at which every group is inside the range that `of` states for it; `None` where no
    /// group has one.
    pub fn common_range(
        &self,
        of: impl Fn(&StripGroup) -> Option<ReducedFrequencyRange>,
    ) -> Option<ReducedFrequencyRange> {
        let ranges = self.groups.iter().filter_map(|GroupSums { group, .. }| {
            let to_bridge = self.frequency_ratio(group).recip();
            of(group).map(|range| range.scaled(to_bridge))
        });
        ranges.reduce(ReducedFrequencyRange::intersection)
    }

    /// Part of each group in what the wind does to all modes, 0 to 1: in the sum over them of the work of unit forces `G = I`, with
    /// the pressure and the width of the group.
    pub fn shares(&self) -> Vec<(&StripGroup, f64)> {
        let work = |sums: &GroupSums| {
            let n = sums.group.forces.dofs().len();
            let unit = DMatrix::<f64>::identity(n, n);
            sums.modal(&unit).trace() * self.pressure_ratio(&sums.group)
        };
        let each: Vec<f64> = self.groups.iter().map(work).collect();
        let all: f64 = each.iter().sum();
        let groups = self.groups.iter().map(|sums| &sums.group);
        groups.zip(each.into_iter().map(|w| w / all)).collect()
    }

    /// Filters and feed-through on the modal coordinates.
    ///
    /// # Errors
    /// [`Error::Input`] when a group has forces without a realisation that is continuous in time.
    pub fn realize(&self) -> Result<Realization> {
        let n = self.dofs.len();
        let mut total = ContinuousRealization {
            a: DMatrix::zeros(0, 0),
            b: DMatrix::zeros(0, n),
            c: DMatrix::zeros(n, 0),
            e0: DMatrix::zeros(n, n),
            e1: DMatrix::zeros(n, n),
            e2: DMatrix::zeros(n, n),
        };
        let mut banks: Vec<ModalBank> = Vec::new();
        for sums in &self.groups {
            let group = &sums.group;
            let Some(Realization::Continuous(aero)) =
                group.forces.realizable().map(|r| r.realize())
            else {
                return Err(Error::input(
                    format!("section {}", group.name),
                    "a model with filters continuous in time (continuous Laguerre, rational functions, quasi-steady)",
                    "a table or a sampled model",
                ));
            };
            let (pressure, k) = (self.pressure_ratio(group), self.frequency_ratio(group));
            total.e0 += sums.modal(&aero.e0) * pressure;
            total.e1 += sums.modal(&aero.e1) * (pressure * k);
            total.e2 += sums.modal(&aero.e2) * (pressure * k * k);
            // filters run with the wind of their own group
            for bank in section_banks(sums, &aero, 1.0 / k, pressure) {
                let alike =
                    |b: &&mut ModalBank| b.rate == bank.rate && b.a == bank.a && b.b == bank.b;
                match banks.iter_mut().find(alike) {
                    Some(known) => {
                        let outputs = known.outputs.iter_mut().zip(bank.outputs);
                        outputs.for_each(|(sum, own)| *sum += own);
                    }
                    None => banks.push(bank),
                }
            }
        }
        assemble(&mut total, &merged(banks));
        Ok(Realization::Continuous(total))
    }
}

/// The filters of a section, one bank for each motion that drives some. Filters without links are scaled to a unit drive, so that lags
/// shared by several motions are one bank.
fn section_banks(
    sums: &GroupSums,
    aero: &ContinuousRealization,
    rate: f64,
    pressure: f64,
) -> Vec<ModalBank> {
    let (states, inputs) = aero.b.shape();
    let chain = |input: usize| {
        let mut driven: Vec<bool> = (0..states).map(|l| aero.b[(l, input)] != 0.0).collect();
        // what a driven filter feeds is driven too
        while let Some(next) = (0..states)
            .find(|&l| !driven[l] && (0..states).any(|m| driven[m] && aero.a[(l, m)] != 0.0))
        {
            driven[next] = true;
        }
        let kept: Vec<usize> = (0..states).filter(|l| driven[*l]).collect();
        let a = aero.a.select_rows(&kept).select_columns(&kept);
        let mut b = DVector::from_iterator(kept.len(), kept.iter().map(|l| aero.b[(*l, input)]));
        let mut c = aero.c.select_columns(&kept);
        if is_diagonal(&a) {
            for (l, drive) in b.iter_mut().enumerate() {
                c.column_mut(l).scale_mut(*drive);
                *drive = 1.0;
            }
        }
        // Σ_i s_ij c_i I^ij of the motion j that drives a filter
        let output = |c: DVectorView<'_, f64>| {
            let mut only = DMatrix::zeros(aero.e0.nrows(), inputs);
            only.set_column(input, &c);
            let mut output = sums.modal(&only) * pressure;
            // a zero has no sign
            output.iter_mut().for_each(|x| *x += 0.0);
            output
        };
        let outputs = c.column_iter().map(output).collect();
        ModalBank {
            a,
            b,
            rate,
            outputs,
        }
    };
    let banks = (0..inputs).map(chain);
    banks.filter(|bank| !bank.b.is_empty()).collect()
}

/// All banks side by side, mode by mode.
fn assemble(total: &mut ContinuousRealization, banks: &[ModalBank]) {
    let n = total.e0.nrows();
    let states: usize = banks.iter().map(|bank| n * bank.b.len()).sum();
    total.a = DMatrix::zeros(states, states);
    total.b = DMatrix::zeros(states, n);
    total.c = DMatrix::zeros(n, states);
    let mut at = 0;
    for bank in banks {
        let filters = bank.b.len();
        for mode in 0..n {
            let mut place = total.a.view_mut((at, at), (filters, filters));
            place.copy_from(&(&bank.a * bank.rate));
            let mut place = total.b.view_mut((at, mode), (filters, 1));
            place.copy_from(&(&bank.b * bank.rate));
            for (l, output) in bank.outputs.iter().enumerate() {
                total.c.column_mut(at + l).copy_from(&output.column(mode));
            }
            at += filters;
        }
    }
}

impl Transfer for ModalForces {
    fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        let n = self.dofs.len();
        let (mut real, mut imaginary) = (vec![0.0; n * n], vec![0.0; n * n]);
        for sums in &self.groups {
            let group = &sums.group;
            let of_group = k.full_width() * self.frequency_ratio(group);
            let of_group = ReducedFrequency::from_full_width(of_group);
            let g = group.forces.transfer(of_group)?;
            let pressure = self.pressure_ratio(group);
            sums.add_modal(&g, pressure, &mut real, &mut imaginary);
        }
        let parts = real.into_iter().zip(imaginary);
        let all = parts.map(|(re, im)| Complex::new(re, im));
        Ok(TransferMatrix::from_iterator(n, n, all))
    }

    fn known_range(&self) -> Option<ReducedFrequencyRange> {
        self.common_range(|group| group.forces.known_range())
    }
}

/// A group and its sums in mass-normalised modes, one matrix for each force and motion.
#[derive(Debug, Clone)]
struct GroupSums {
    group: StripGroup,
    /// Row by row in the order of its degrees of freedom, each modes×modes.
    sums: Vec<DMatrix<f64>>,
}

impl GroupSums {
    /// Of the group's nodes, with each shape divided by the root of its generalised mass; dampers move no node.
    fn new(bridge: &Bridge, group: &StripGroup) -> Self {
        let dofs = group.forces.dofs();
        let weighted = |dof: &Dof, power: f64| {
            DMatrix::from_fn(group.nodes.len(), bridge.coordinates(), |n, m| {
                let (node, mode) = (group.nodes[n], bridge.modes.get(m));
                mode.map_or(0.0, |mode| {
                    let value = mode.shape[node][*dof as usize];
                    value * bridge.nodes[node].length_m.powf(power) / mode.generalised_mass.sqrt()
                })
            })
        };
        let forces: Vec<_> = dofs.iter().map(|d| weighted(d, 1.0).transpose()).collect();
        let motions: Vec<_> = dofs.iter().map(|d| weighted(d, 0.0)).collect();
        let pairs = forces
            .iter()
            .flat_map(|f| motions.iter().map(move |m| f * m));
        Self {
            sums: pairs.collect(),
            group: group.clone(),
        }
    }

    /// `Σ_ij s_ij g_ij I^ij` with the physical scale `s_ij = diag(B, B, B²)_i diag(1/B, 1/B, 1)_j`, modes×modes.
    fn modal<T>(&self, g: &DMatrix<T>) -> DMatrix<T>
    where
        T: nalgebra::ComplexField<RealField = f64>,
    {
        let (dofs, width_m) = (self.group.forces.dofs(), self.group.width_m);
        let modes = self.sums[0].nrows();
        let mut total = DMatrix::<T>::zeros(modes, modes);
        for (i, force) in dofs.iter().enumerate() {
            for (j, motion) in dofs.iter().enumerate() {
                let scale = force.force_scale(width_m) * motion.motion_scale(width_m);
                let factor = g[(i, j)].clone().scale(scale);
                for (t, s) in total.iter_mut().zip(&self.sums[i * dofs.len() + j]) {
                    *t += factor.clone().scale(*s);
                }
            }
        }
        total
    }

    /// Adds `factor` times the same to the real and the imaginary parts of a matrix, column by column: the forces of every
    /// step of a p-k iteration, which are asked for very often.
    fn add_modal(&self, g: &TransferMatrix, factor: f64, real: &mut [f64], imaginary: &mut [f64]) {
        let (dofs, width_m) = (self.group.forces.dofs(), self.group.width_m);
        for (i, force) in dofs.iter().enumerate() {
            for (j, motion) in dofs.iter().enumerate() {
                let scale = factor * force.force_scale(width_m) * motion.motion_scale(width_m);
                let value = g[(i, j)] * scale;
                let sums = self.sums[i * dofs.len() + j].as_slice();
                for (sum, s) in real.iter_mut().zip(sums) {
                    *sum += value.re * s;
                }
                for (sum, s) in imaginary.iter_mut().zip(sums) {
                    *sum += value.im * s;
                }
            }
        }
    }
}
