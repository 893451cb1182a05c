//! Forces and rates of the filters at one instant, for importers that integrate the filters themselves.

use super::course::MotionCubic;
use super::filters::add_product;
use super::{Airflow, PrescribedForces};
use crate::aerodynamics::Realization;
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::variables::Dual;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

impl PrescribedForces {
    /// Entries of the state that are the filters of strip `s`.
    pub fn filters(&self, s: usize) -> Range<usize> {
        let first = self.strip(s).start + 1;
        first..first + self.realization.states()
    }

    /// Whether rates, and whether accelerations of coordinate `dof` of a strip enter the forces.
    pub fn feels(&self, dof: usize) -> [bool; 2] {
        match &self.realization {
            Realization::Continuous(c) => {
                [&c.e1, &c.e2].map(|e| e.column(dof).iter().any(|x| *x != 0.0))
            }
            Realization::Discrete(_) => [false; 2],
        }
    }

    /// What the filters hold behind a deck held still, per dimensionless displacement of each coordinate.
    ///
    /// # Errors
    /// [`crate::Error::Numerical`] for a filter that does not settle.
    pub fn steady_flow(&self) -> Result<DMatrix<f64>> {
        let (matrix, drive) = match &self.realization {
            Realization::Continuous(c) => (-&c.a, &c.b),
            Realization::Discrete(d) => (DMatrix::identity(d.a.nrows(), d.a.nrows()) - &d.a, &d.b),
        };
        if matrix.is_empty() {
            return Ok(drive.clone());
        }
        let settled = matrix.lu().solve(drive);
        let why = "prescribed motion: a filter does not settle";
        settled.ok_or_else(|| Error::Numerical(why.into()))
    }

    /// Enters the filters of a strip of this width (m) held at a displacement (m or rad) until the flow has settled.
    pub fn enter_steady_flow(
        &self,
        steady_flow: &DMatrix<f64>,
        displacement: &[f64],
        width: f64,
        filters: &mut [f64],
    ) {
        let motion = self.dimensionless(displacement, width);
        let filters_at_rest = steady_flow * DVector::from_iterator(self.dofs.len(), motion);
        filters.copy_from_slice(filters_at_rest.as_slice());
    }

    /// Forces on a strip now, with their rates, from its filters and the displacement, rate and acceleration of each coordinate.
    pub fn at_instant(
        &self,
        filters: &[f64],
        motion: &[[f64; 3]],
        air: Airflow,
        forces: &mut [Dual],
    ) {
        let mut courses = [MotionCubic::default(); Dof::THREE.len()];
        for ((course, dof), now) in courses.iter_mut().zip(&self.dofs).zip(motion) {
            *course = MotionCubic::now(*now).times(dof.motion_scale(air.width_m));
        }
        self.forces(filters, &courses, air, forces);
    }

    /// `ż = (V/B)(A z + B r)` of a strip, 1/s; sampled filters have no rate.
    pub fn filter_rates(
        &self,
        filters: &[f64],
        displacement: &[f64],
        wind_m_s: f64,
        width_m: f64,
        rates: &mut [f64],
    ) {
        rates.fill(0.0);
        let Realization::Continuous(c) = &self.realization else {
            return;
        };
        add_product(&c.a, filters, rates);
        let motion = self.dimensionless(displacement, width_m);
        for (column, r) in c.b.column_iter().zip(motion) {
            for (rate, b) in rates.iter_mut().zip(&column) {
                *rate += b * r;
            }
        }
        let speed = wind_m_s / width_m;
        rates.iter_mut().for_each(|rate| *rate *= speed);
    }

    fn dimensionless(&self, displacement: &[f64], width: f64) -> impl Iterator<Item = f64> {
        let scaled = self.dofs.iter().zip(displacement);
        scaled.map(move |(dof, x)| x * dof.motion_scale(width))
    }
}
