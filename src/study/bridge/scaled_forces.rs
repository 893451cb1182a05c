//! Forces whose entries are multiplied by a factor each.

use crate::aerodynamics::{
    ContinuousRealization, Realizable, Realization, Transfer, TransferMatrix,
};
use crate::error::{Error, Result};
use crate::section::Dof;
use crate::units::ReducedFrequency;
use nalgebra::DMatrix;

/// Forces of a model, each entry multiplied by a factor.
pub(super) struct Scaled {
    dofs: Vec<Dof>,
    realization: Realization,
}

impl Scaled {
    pub(super) fn new(forces: &dyn Transfer, factors: &DMatrix<f64>) -> Result<Self> {
        let unfit = || {
            Error::input(
                "scatter of the derivatives",
                "forces with filters of single motions",
                "others",
            )
        };
        let Some(Realization::Continuous(r)) = forces.realizable().map(Realizable::realize) else {
            return Err(unfit());
        };
        let mut c = r.c.clone();
        for (l, mut column) in c.column_iter_mut().enumerate() {
            let motion = driver(&r, l).ok_or_else(unfit)?;
            column.component_mul_assign(&factors.column(motion));
        }
        Ok(Self {
            dofs: forces.dofs().to_vec(),
            realization: Realization::Continuous(ContinuousRealization {
                c,
                e0: r.e0.component_mul(factors),
                e1: r.e1.component_mul(factors),
                e2: r.e2.component_mul(factors),
                ..r
            }),
        })
    }
}

/// The one motion that drives a filter.
fn driver(r: &ContinuousRealization, filter: usize) -> Option<usize> {
    let mut motions = (0..r.b.ncols()).filter(|j| r.b[(filter, *j)] != 0.0);
    motions.next().filter(|_| motions.next().is_none())
}

impl Transfer for Scaled {
    fn dofs(&self) -> &[Dof] {
        &self.dofs
    }

    fn transfer(&self, k: ReducedFrequency) -> Result<TransferMatrix> {
        self.realization.transfer(k)
    }

    fn realizable(&self) -> Option<&dyn Realizable> {
        Some(self)
    }
}

impl Realizable for Scaled {
    fn realize(&self) -> Realization {
        self.realization.clone()
    }
}
