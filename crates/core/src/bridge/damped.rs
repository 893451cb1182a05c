//! Modes with tuned mass dampers and viscous links.
//!
//! A mass `m` on a spring and a dashpot is a coordinate of its own, `u`, beside those of the modes. With `v` the motion of its point
//! by unit mass-normalised modes, `ω` and `ζ` of the mass while the girder is held, and `η = √m u`, mass-normalised as the modes are,
//! spring and dashpot work on the stroke alone, so that each is a matrix of rank one:
//!
//! ```text
//! g = (√m v, −1)        K += ω² g gᵀ        R += 2ζω g gᵀ
//! ```
//!
//! A viscous link between two points, or a point and the ground, is `R += c g gᵀ` with `g = (v₁ − v₂, 0)`. Modes and dampers are
//! coupled by nothing else: the wind does not blow at a damper.

use super::{Bridge, DampedPoint, Dampers};
use crate::error::{Result, counted, ensure, finite, non_negative, positive};
use crate::section::Dof;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

impl Bridge {
    /// The same bridge with these dampers.
    ///
    /// # Errors
    /// [`Error::Input`](crate::error::Error::Input) for nodes that are none, masses that follow a rotation, and masses, frequencies, damping ratios and
    /// coefficients that are not positive (damping ratios and coefficients may be zero).
    pub fn with_dampers(mut self, dampers: Dampers) -> Result<Self> {
        for damper in &dampers.masses {
            let key = |of: &str| format!("{}: {of}", damper.name);
            self.check_point(&damper.name, &damper.at)?;
            let moves = damper.at.motion != Dof::Torsion;
            ensure(moves, key("motion"), "vertical or lateral", "torsion")?;
            positive(key("mass_kg"), damper.mass_kg)?;
            positive(key("frequency_hz"), damper.frequency_hz)?;
            non_negative(key("damping_ratio"), damper.damping_ratio)?;
        }
        for link in &dampers.links {
            for end in std::iter::once(&link.at).chain(&link.to) {
                self.check_point(&link.name, end)?;
            }
            non_negative(format!("{}: coefficient", link.name), link.coefficient)?;
        }
        self.dampers = dampers;
        Ok(self)
    }

    fn check_point(&self, name: &str, point: &DampedPoint) -> Result<()> {
        finite(format!("{name}: offset_m"), point.offset_m)?;
        ensure(
            point.node < self.nodes.len(),
            name,
            format_args!("one of {}", counted(self.nodes.len(), "node")),
            format_args!("node {}", point.node),
        )
    }

    /// Number of coordinates: the modes, then the masses of the dampers.
    pub fn coordinates(&self) -> usize {
        self.modes.len() + self.dampers.masses.len()
    }

    /// What may be tuned, in one order: air density, frequency and damping ratio of every mode, mass, frequency and damping ratio of every
    /// damper, coefficient of every link.
    pub fn tunable(&mut self) -> impl Iterator<Item = &mut f64> {
        let modes = self.modes.iter_mut();
        let modes = modes.flat_map(|m| [&mut m.frequency_hz, &mut m.damping_ratio]);
        let masses = self.dampers.masses.iter_mut();
        let masses =
            masses.flat_map(|d| [&mut d.mass_kg, &mut d.frequency_hz, &mut d.damping_ratio]);
        let links = self.dampers.links.iter_mut().map(|l| &mut l.coefficient);
        std::iter::once(&mut self.air_density_kg_m3)
            .chain(modes)
            .chain(masses)
            .chain(links)
    }

    /// The motion of a point by unit mass-normalised coordinates; zero for those of dampers.
    pub fn motion_of(&self, point: &DampedPoint) -> DVector<f64> {
        let (row, offset) = (point.motion as usize, point.offset_m);
        // nose-up lifts what is upwind of the axis
        let turned = |shape: &[f64; 3]| match point.motion {
            Dof::Vertical => offset * shape[2],
            _ => 0.0,
        };
        let modes = self.modes.iter().map(|m| {
            let shape = &m.shape[point.node];
            (shape[row] - turned(shape)) / m.generalised_mass.sqrt()
        });
        let masses = self.dampers.masses.iter().map(|_| 0.0);
        DVector::from_iterator(self.coordinates(), modes.chain(masses))
    }

    /// The stroke of each mass, its displacement less that of its point, by unit coordinates: a row for each.
    pub fn strokes(&self) -> DMatrix<f64> {
        let mut all = DMatrix::zeros(self.dampers.masses.len(), self.coordinates());
        for (d, damper) in self.dampers.masses.iter().enumerate() {
            all.row_mut(d).tr_copy_from(&-self.motion_of(&damper.at));
            all[(d, self.modes.len() + d)] = damper.mass_kg.sqrt().recip();
        }
        all
    }

    /// Adds what the dampers do to damping and stiffness of the coordinates.
    pub(super) fn damp(&self, damping: &mut DMatrix<f64>, stiffness: &mut DMatrix<f64>) {
        let strokes = self.strokes();
        for (d, damper) in self.dampers.masses.iter().enumerate() {
            let omega = TAU * damper.frequency_hz;
            let stroke = strokes.row(d).transpose();
            let square = &stroke * stroke.transpose() * damper.mass_kg;
            *stiffness += &square * (omega * omega);
            *damping += square * (2.0 * damper.damping_ratio * omega);
        }
        for link in &self.dampers.links {
            let mut stretch = self.motion_of(&link.at);
            if let Some(to) = &link.to {
                stretch -= self.motion_of(to);
            }
            *damping += &stretch * stretch.transpose() * link.coefficient;
        }
    }
}
