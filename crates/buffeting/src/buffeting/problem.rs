//! What a buffeting computation needs: a structure, self-excited forces, gust forces at nodes, turbulence.
//!
//! With `P_ca(i) = w_i Σ_d φ_a,d(i) ½ρV_i diag(B, B, B²) A_dc χ(ωB/V_i) √S_c(f, V_i)` for component `c`, coordinate `a` and node `i`, and
//! Davenport's coherence `C_ij = exp(−C_c f |x_i − x_j|/V)`, the spectra of the forces on the coordinates are `S_Q = Σ_c P_cᴴ C P_c`, a
//! full matrix. A section is one node of a metre whose coordinates are its own motions, `Φ = I`.

use super::admittance::Admittance;
use super::coherence::Coherence;
use super::spectrum::GustSpectrum;
use super::stability::highest_natural_hz;
use crate::aerodynamics::GustComponent;
use crate::aerodynamics::quasi_steady::LinearQuasiSteady;
use crate::aerodynamics::{Realization, Transfer};
use crate::aeroelastic::CoupledSection;
use crate::bridge::{Bridge, ModalForces, Node, StripGroup};
use crate::error::{Error, Result, counted, ensure, positive};
use crate::section::{Dof, Structure};
use crate::units::ReducedFrequency;
use nalgebra::{Complex, DMatrix};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Gauss's three points on (−1, 1).
const GAUSS: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 9.0),
    (0.0, 8.0 / 9.0),
    (0.774_596_669_241_483_4, 5.0 / 9.0),
];
/// The middle alone, for fields of many nodes.
const MIDDLE: [(f64, f64); 1] = [(0.0, 2.0)];

/// One component of the turbulence and how the deck takes it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Gust {
    /// Spectrum and scales.
    pub spectrum: GustSpectrum,
    /// Factor on the amplitude of the force.
    #[serde(default)]
    pub admittance: Admittance,
}

/// Turbulence with independent components; one that is left out is zero.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Turbulence {
    /// `u`, along the mean wind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub along: Option<Gust>,
    /// `w`, upwards.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vertical: Option<Gust>,
}

impl Turbulence {
    /// One component, if it is there.
    pub fn component(&self, component: GustComponent) -> Option<&Gust> {
        match component {
            GustComponent::Along => self.along.as_ref(),
            GustComponent::Vertical => self.vertical.as_ref(),
        }
    }

    /// Checks every value.
    ///
    /// # Errors
    /// [`Error::Input`] naming the key below `place`; for no component at all.
    pub fn validate(&self, place: &str) -> Result<()> {
        let parts = [("along", &self.along), ("vertical", &self.vertical)];
        ensure(
            parts.iter().any(|(_, gust)| gust.is_some()),
            place,
            "`along`, `vertical` or both",
            "neither",
        )?;
        for (key, gust) in parts {
            if let Some(gust) = gust {
                gust.spectrum.validate(&format!("{place}.{key}.spectrum"))?;
                gust.admittance
                    .validate(&format!("{place}.{key}.admittance"))?;
            }
        }
        Ok(())
    }
}

/// A structure in turbulence.
pub struct BuffetingProblem<'a> {
    pub(super) structure: Structure,
    forces: SelfExcited<'a>,
    /// Along the line.
    pub(super) nodes: Vec<Node>,
    /// Motions of the nodes by the coordinates, one after the other: three of each node of a bridge, those of a section.
    pub(super) shapes: DMatrix<f64>,
    /// Nodes that the wind blows at.
    pub(super) strips: Vec<BlownStrips>,
    /// Force on the coordinates by a gust of 1 m/s of each component at each node in a wind of 1 m/s, nodes×coordinates.
    pub(super) gust_forces: [DMatrix<f64>; 2],
    /// Spectra and admittances.
    pub(super) turbulence: Turbulence,
    /// Coherence from node to node.
    pub(super) coherence: Coherence,
    /// Highest natural frequency, Hz.
    pub(super) highest_hz: f64,
    /// Points and weights on (−1, 1) by which the variance in a line of a record's spectrum is taken.
    pub(super) line_rule: &'static [(f64, f64)],
}

/// Strips with the force per unit length on the motions of a node by a gust of 1 m/s of each component in a mean wind of 1 m/s.
type BlownStrips = StripGroup<DMatrix<f64>>;

/// Self-excited forces on the coordinates.
enum SelfExcited<'a> {
    Section(&'a dyn Transfer),
    Modal(ModalForces),
}

impl<'a> BuffetingProblem<'a> {
    /// A section; its gust forces are those of quasi-steady theory (1.12d), or of the thin plate: lift `2π w/V`, moment about mid-chord
    /// `(π/2) w/V`.
    ///
    /// # Errors
    /// [`Error::Input`] for parts of other degrees of freedom and turbulence that cannot be.
    pub fn of_section(
        structure: &Structure,
        model: &'a dyn Transfer,
        theory: Option<&LinearQuasiSteady>,
        turbulence: &Turbulence,
    ) -> Result<Self> {
        let plate = || DMatrix::from_row_slice(2, 2, &[0.0, 2.0 * PI, 0.0, PI / 2.0]);
        let (of_gusts, gusts) = match theory {
            Some(theory) => (theory.dofs(), theory.buffeting.clone()),
            None => (&Dof::TWO[..], plate()),
        };
        let dofs = structure.dofs.as_slice();
        let has_lateral = dofs.contains(&Dof::Lateral);
        let expected = "`[coefficients]` with drag: gust forces of the thin plate, taken without, have no lateral part";
        let stated = theory.is_some() || !has_lateral;
        ensure(stated, "coefficients", expected, "none")?;
        for (of, found) in [("model", model.dofs()), ("gust forces", of_gusts)] {
            let expected = format!("the section's degrees of freedom {}", Dof::names(dofs));
            let place = format!("buffeting: {of}");
            ensure(found == dofs, place, expected, Dof::names(found))?;
        }
        turbulence.validate("turbulence")?;
        let (n, width_m) = (dofs.len(), structure.width_m);
        let gusts = structure.forces_at_axis(gusts);
        let half_rho = 0.5 * structure.air_density_kg_m3;
        let force = |i: usize, c| half_rho * dofs[i].force_scale(width_m) * gusts[(i, c)];
        let name = "section".to_owned();
        let nodes = vec![Node {
            name: name.clone(),
            along_m: 0.0,
            length_m: 1.0,
        }];
        let strips = vec![StripGroup {
            name,
            width_m,
            wind_factor: 1.0,
            nodes: vec![0],
            forces: DMatrix::from_fn(n, 2, force),
        }];
        let shapes = DMatrix::identity(n, n);
        Ok(Self {
            structure: structure.clone(),
            forces: SelfExcited::Section(model),
            gust_forces: gust_forces(&nodes, &shapes, &strips),
            nodes,
            shapes,
            strips,
            turbulence: *turbulence,
            coherence: Coherence::default(),
            highest_hz: highest_natural_hz(structure),
            line_rule: &GAUSS,
        })
    }

    /// A bridge. The gust forces of each group are over `½ρV²` and its width (squared for the moment): rows vertical, lateral, rotation;
    /// columns `u/V`, `w/V`.
    ///
    /// # Errors
    /// [`Error::Input`] for gust forces of other groups and turbulence that cannot be.
    pub fn of_bridge(
        bridge: &Bridge,
        gust_matrices: &[[[f64; 2]; 3]],
        turbulence: Turbulence,
        coherence: Coherence,
    ) -> Result<Self> {
        coherence.validate("coherence")?;
        turbulence.validate("turbulence")?;
        ensure(
            gust_matrices.len() == bridge.groups.len(),
            "buffeting",
            format_args!("gust forces of {}", counted(bridge.groups.len(), "group")),
            gust_matrices.len(),
        )?;
        let strips = bridge.groups.iter().zip(gust_matrices).map(|(g, matrix)| {
            let half_rho = 0.5 * bridge.air_density_kg_m3 * g.wind_factor;
            let scale = |i: usize| half_rho * Dof::THREE[i].force_scale(g.width_m);
            g.with_forces(DMatrix::from_fn(3, 2, |i, c| scale(i) * matrix[i][c]))
        });
        let strips: Vec<_> = strips.filter(|s| s.wind_factor != 0.0).collect();
        let shapes = bridge.shapes_at(&(0..bridge.nodes.len()).collect::<Vec<_>>());
        let highest = bridge.modes.iter().map(|m| m.frequency_hz);
        Ok(Self {
            structure: bridge.structure(),
            forces: SelfExcited::Modal(bridge.forces()),
            nodes: bridge.nodes.clone(),
            gust_forces: gust_forces(&bridge.nodes, &shapes, &strips),
            shapes,
            strips,
            turbulence,
            coherence,
            highest_hz: highest.fold(0.0, f64::max),
            line_rule: &MIDDLE,
        })
    }

    /// Rows of the shapes of some nodes.
    pub(super) fn shapes_at(&self, nodes: &[usize]) -> DMatrix<f64> {
        let each = self.shapes.nrows() / self.nodes.len();
        let rows = nodes.iter().flat_map(|n| each * n..each * (n + 1));
        self.shapes.select_rows(&rows.collect::<Vec<_>>())
    }

    /// Names of some nodes.
    pub fn names_of(&self, nodes: &[usize]) -> Vec<String> {
        nodes.iter().map(|n| self.nodes[*n].name.clone()).collect()
    }

    /// What `of` says of strips, at every node; zero where no wind blows.
    pub(super) fn at_nodes<T: Copy + Default>(&self, of: impl Fn(&BlownStrips) -> T) -> Vec<T> {
        let mut all = vec![T::default(); self.nodes.len()];
        for strips in &self.strips {
            let value = of(strips);
            strips.nodes.iter().for_each(|n| all[*n] = value);
        }
        all
    }

    /// Mean wind at every node; that of the bridge where none blows at strips.
    pub(super) fn winds_m_s(&self, speed_m_s: f64) -> Vec<f64> {
        let factors = self.at_nodes(|strips| Some(strips.wind_factor));
        let winds = factors.into_iter().map(|f| f.unwrap_or(1.0) * speed_m_s);
        winds.collect()
    }

    /// Part of the force of long gusts that gusts of a frequency exert on strips, times the mean wind.
    pub(super) fn admittance(
        &self,
        gust: &Gust,
        strips: &BlownStrips,
        frequency_hz: f64,
        speed_m_s: f64,
    ) -> Complex<f64> {
        let local = strips.wind_factor * speed_m_s;
        let k = ReducedFrequency::from_hertz(frequency_hz, strips.width_m, local);
        gust.admittance.amplitude(k) * speed_m_s
    }

    /// The self-excited forces.
    pub fn model(&self) -> &dyn Transfer {
        match &self.forces {
            SelfExcited::Section(model) => *model,
            SelfExcited::Modal(forces) => forces,
        }
    }

    /// The coupled system, which must be stable, and the decay rate of its slowest motion, 1/s.
    pub(super) fn coupled(&self, speed_m_s: f64) -> Result<(CoupledSection, f64)> {
        positive("wind speed", speed_m_s)?;
        let coupled = CoupledSection::new(self.structure.clone(), self.forces.realize()?)?;
        let roots = coupled.at(speed_m_s)?.eigenvalues()?;
        let slowest = roots.iter().map(|z| -z.re).fold(f64::INFINITY, f64::min);
        match roots.iter().filter(|z| z.re > 0.0).count() {
            0 => Ok((coupled, slowest)),
            growing => Err(self.unstable(growing, "", speed_m_s)),
        }
    }

    /// Only what is stable has a stationary response; `at` says where motions grow.
    pub(super) fn unstable(&self, growing: usize, at: &str, speed_m_s: f64) -> Error {
        let what = match self.forces {
            SelfExcited::Section(_) => "section",
            SelfExcited::Modal(_) => "bridge",
        };
        Error::Unstable(format!(
            "buffeting at {speed_m_s} m/s: the {what} is unstable there ({}{at}), no response is stationary",
            counted(growing, "growing root")
        ))
    }
}

impl SelfExcited<'_> {
    fn realize(&self) -> Result<Realization> {
        match self {
            Self::Modal(forces) => forces.realize(),
            Self::Section(model) => model.realizable().map(|m| m.realize()).ok_or_else(|| {
                Error::input(
                    "buffeting in the time domain",
                    "a model with a realisation",
                    "one that is known only as a transfer matrix",
                )
            }),
        }
    }
}

/// Force on the coordinates by a gust of 1 m/s of each component at each node in a wind of 1 m/s (nodes×coordinates).
fn gust_forces(nodes: &[Node], shapes: &DMatrix<f64>, strips: &[BlownStrips]) -> [DMatrix<f64>; 2] {
    let each = shapes.nrows() / nodes.len();
    [0, 1].map(|component| {
        let mut forces = DMatrix::zeros(nodes.len(), shapes.ncols());
        for strips in strips {
            for &n in &strips.nodes {
                let force = strips.forces.column(component) * nodes[n].length_m;
                forces.set_row(n, &force.tr_mul(&shapes.rows(each * n, each)));
            }
        }
        forces
    })
}
