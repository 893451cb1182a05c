//! The matrices of a section, and the way of the aerodynamic forces to its axis.

use super::Dof;
use nalgebra::DMatrix;

/// Matrices of the suspended section, per unit length: `M q̈ + R q̇ + K q = F`.
///
/// ```
/// # extern crate aerodeck_core as aerodeck;
/// use aerodeck::section::SectionModel;
/// use std::f64::consts::TAU;
///
/// let structure = SectionModel::iabse_1_1a().structure()?;
/// let heave_hz = structure.still_air_rad_s().next().expect("a motion") / TAU;
/// assert!((heave_hz - 0.1).abs() < 1e-12);
/// # Ok::<(), aerodeck::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Structure {
    /// Degrees of freedom, in the order of rows and columns.
    pub dofs: Vec<Dof>,
    /// Deck width `B`, m.
    pub width_m: f64,
    /// Air density `ρ`, kg/m³.
    pub air_density_kg_m3: f64,
    /// Distance of the axis from the reference point of the aerodynamic forces, m, positive downwind.
    pub axis_offset_m: f64,
    /// `M`, n×n: kg/m, kg·m²/m, and kg for the static unbalance.
    pub mass: DMatrix<f64>,
    /// `R`, n×n: N·s/m² and N·m·s/(rad·m).
    pub damping: DMatrix<f64>,
    /// `K`, n×n: N/m² and N·m/(rad·m).
    pub stiffness: DMatrix<f64>,
    /// Names of generalised coordinates, one per row; empty for a section, whose coordinates are its degrees of freedom.
    pub mode_names: Vec<String>,
}

impl Structure {
    /// A structure in generalised coordinates `η`: `M`, `R`, `K` for the whole structure instead of a metre.
    ///
    /// A generalised coordinate counts as a rotation does: it has no unit, and its force is made dimensionless with
    /// `½ρV²B²`, a work per unit coordinate.
    pub fn modal(
        width_m: f64,
        air_density_kg_m3: f64,
        [mass, damping, stiffness]: [DMatrix<f64>; 3],
        mode_names: Vec<String>,
    ) -> Self {
        Self {
            dofs: vec![Dof::Torsion; mode_names.len()],
            width_m,
            air_density_kg_m3,
            axis_offset_m: 0.0,
            mass,
            damping,
            stiffness,
            mode_names,
        }
    }

    /// Whether the coordinates are generalised ones.
    pub fn is_modal(&self) -> bool {
        !self.mode_names.is_empty()
    }

    /// `√(K_ii/M_ii)` of every coordinate, rad/s: its frequency in still air where nothing couples it to another.
    pub fn still_air_rad_s(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.dofs.len()).map(|i| (self.stiffness[(i, i)] / self.mass[(i, i)]).sqrt())
    }

    /// Name of the branch that starts as the mode of row `i`.
    pub fn branch_name(&self, i: usize) -> String {
        let name = self.mode_names.get(i).cloned();
        name.unwrap_or_else(|| self.dofs[i].name().to_owned())
    }

    /// Rows from the lowest to the highest still-air frequency.
    pub fn rows_by_frequency(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.dofs.len()).collect();
        let square = |i: &usize| self.stiffness[(*i, *i)] / self.mass[(*i, *i)];
        order.sort_by(|i, j| square(i).total_cmp(&square(j)));
        order
    }

    /// The same structure with only those of its degrees of freedom that are among `dofs`; the others are locked.
    #[must_use]
    pub fn only(&self, dofs: &[Dof]) -> Self {
        let kept: Vec<usize> = (0..self.dofs.len())
            .filter(|i| dofs.contains(&self.dofs[*i]))
            .collect();
        let part = |m: &DMatrix<f64>| m.select_rows(&kept).select_columns(&kept);
        let names = kept.iter().filter_map(|i| self.mode_names.get(*i));
        Self {
            dofs: kept.iter().map(|i| self.dofs[*i]).collect(),
            mass: part(&self.mass),
            damping: part(&self.damping),
            stiffness: part(&self.stiffness),
            mode_names: names.cloned().collect(),
            ..*self
        }
    }

    /// Rows of heave and rotation with `a/B`, where the axis is not the reference point.
    fn lever(&self) -> Option<(usize, usize, f64)> {
        let at = |dof: Dof| self.dofs.iter().position(|d| *d == dof);
        let (y, theta) = (at(Dof::Vertical)?, at(Dof::Torsion)?);
        (self.axis_offset_m != 0.0).then(|| (y, theta, self.axis_offset_m / self.width_m))
    }

    /// `Tᵀ X`: dimensionless forces (rows) about the reference point as forces about the axis, `m_axis = m + (a/B) f`.
    #[must_use]
    pub fn forces_at_axis<T: MatrixEntry>(&self, mut forces: DMatrix<T>) -> DMatrix<T> {
        if let Some((y, theta, lever)) = self.lever() {
            for mut column in forces.column_iter_mut() {
                let moment = column[y] * lever;
                column[theta] += moment;
            }
        }
        forces
    }

    /// `X T`: what follows from dimensionless motion of the reference point (columns) as what follows from motion of the
    /// axis, `y = y_axis + a θ`.
    #[must_use]
    pub fn motion_at_axis<T: MatrixEntry>(&self, mut effects: DMatrix<T>) -> DMatrix<T> {
        if let Some((y, theta, lever)) = self.lever() {
            for mut row in effects.row_iter_mut() {
                let by_rotation = row[y] * lever;
                row[theta] += by_rotation;
            }
        }
        effects
    }

    /// `Tᵀ G T`: a dimensionless aerodynamic matrix about the reference point as one about the axis.
    #[must_use]
    pub fn at_axis<T: MatrixEntry>(&self, g: DMatrix<T>) -> DMatrix<T> {
        self.forces_at_axis(self.motion_at_axis(g))
    }

    /// Takes a dimensionless aerodynamic matrix about the reference point to physical motion of the axis and force
    /// about it: `diag(B, B, B²) Tᵀ G T diag(1/B, 1/B, 1)`, still to be multiplied by `½ρV²`.
    pub fn to_physical<T: MatrixEntry>(&self, dimensionless: &DMatrix<T>) -> DMatrix<T> {
        self.scaled(&self.at_axis(dimensionless.clone()))
    }

    /// Scales a dimensionless aerodynamic matrix that is about the axis already:
    /// `diag(B, B, B²) G diag(1/B, 1/B, 1)`.
    pub fn scaled<T: MatrixEntry>(&self, dimensionless: &DMatrix<T>) -> DMatrix<T> {
        DMatrix::from_fn(dimensionless.nrows(), dimensionless.ncols(), |i, j| {
            dimensionless[(i, j)]
                * (self.dofs[i].force_scale(self.width_m) * self.dofs[j].motion_scale(self.width_m))
        })
    }
}

/// A real or complex entry of a matrix.
pub trait MatrixEntry:
    nalgebra::Scalar + std::ops::Mul<f64, Output = Self> + std::ops::AddAssign + Copy
{
}

impl<T> MatrixEntry for T where
    T: nalgebra::Scalar + std::ops::Mul<f64, Output = T> + std::ops::AddAssign + Copy
{
}
