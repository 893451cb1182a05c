//! Buffeting of the IABSE benchmark: vertical gusts only, von Kármán, Davenport's function on the amplitude.

use super::flat_plate::{IABSE, WITHOUT_ROTARY};
use super::{Case, Figure};
use crate::buffeting::{
    Admittance, BuffetingProblem, Gust, GustComponent, GustForces, GustSpectrum, SpectrumShape,
    Turbulence, buffeting_response,
};
use crate::error::Result;
use crate::section::SectionModel;

/// Figures about buffeting.
pub const CASES: &[Case] = &[
    Case {
        name: "iabse-1.1a-turbulence",
        what: "IABSE 1.1a: von Kármán's spectrum of the vertical gusts at 45 m/s",
        figures: &[Figure::new("S_w at 0.278 Hz", 5.26, 2, "m²/s").published(IABSE)],
        compute: || {
            Ok(vec![W.spectrum.density(
                GustComponent::Vertical,
                0.278,
                45.0,
            )])
        },
    },
    Case {
        name: "iabse-1.1a-buffeting",
        what: "Flat plate (Theodorsen), IABSE 1.1a: RMS response to vertical gusts, without the rotary inertia",
        figures: &[
            rms("heave at 15 m/s: RMS y", 0.2508),
            rms("heave at 30 m/s: RMS y", 0.7807),
            rms("heave at 45 m/s: RMS y", 1.3626).headline(),
            rms("heave at 60 m/s: RMS y", 2.1398),
            rms("heave at 75 m/s: RMS y", 4.6157),
            rms("torsion at 15 m/s: RMS θ·B/2", 0.0344),
            rms("torsion at 30 m/s: RMS θ·B/2", 0.1824),
            rms("torsion at 45 m/s: RMS θ·B/2", 0.4449).headline(),
            rms("torsion at 60 m/s: RMS θ·B/2", 0.8810),
            rms("torsion at 75 m/s: RMS θ·B/2", 2.7995),
        ],
        compute: iabse_rms,
    },
    Case {
        name: "iabse-1.1a-buffeting-adaptive",
        what: "Flat plate (Theodorsen), IABSE 1.1a: the same RMS response, by adaptive quadrature from 1e-7 to 50 Hz",
        figures: &[
            adaptive("heave at 15 m/s: RMS y", 0.25095),
            adaptive("heave at 30 m/s: RMS y", 0.78109),
            adaptive("heave at 45 m/s: RMS y", 1.36365),
            adaptive("heave at 60 m/s: RMS y", 2.14260),
            adaptive("heave at 75 m/s: RMS y", 4.62388),
            adaptive("torsion at 15 m/s: RMS θ·B/2", 0.03444),
            adaptive("torsion at 30 m/s: RMS θ·B/2", 0.18245),
            adaptive("torsion at 45 m/s: RMS θ·B/2", 0.44493),
            adaptive("torsion at 60 m/s: RMS θ·B/2", 0.88111),
            adaptive("torsion at 75 m/s: RMS θ·B/2", 2.79976),
        ],
        compute: iabse_rms,
    },
    Case {
        name: "iabse-1.1a-buffeting-published",
        what: "Flat plate (Theodorsen), IABSE 1.1a: the printed RMS response to vertical gusts",
        figures: &[
            printed("heave at 15 m/s: RMS y", 0.2603),
            printed("heave at 30 m/s: RMS y", 0.7780),
            printed("heave at 45 m/s: RMS y", 1.3404).headline(),
            printed("heave at 60 m/s: RMS y", 2.1601),
            printed("heave at 75 m/s: RMS y", 4.4848),
            printed("torsion at 15 m/s: RMS θ·B/2", 0.0419),
            printed("torsion at 30 m/s: RMS θ·B/2", 0.2027),
            printed("torsion at 45 m/s: RMS θ·B/2", 0.4792).headline(),
            printed("torsion at 60 m/s: RMS θ·B/2", 0.9306),
            printed("torsion at 75 m/s: RMS θ·B/2", 2.8414),
        ],
        compute: iabse_rms,
    },
];

const SPEEDS_M_S: [f64; 5] = [15.0, 30.0, 45.0, 60.0, 75.0];

const W: Gust = Gust {
    spectrum: GustSpectrum {
        shape: SpectrumShape::VonKarman,
        length_m: 20.0,
        intensity: 0.05,
    },
    admittance: Admittance::Davenport { decay: 7.0 },
};

const fn rms(quantity: &'static str, expected: f64) -> Figure {
    Figure::new(quantity, expected, 4, "m").within(
        0.02 * expected,
        "2 %: the reference depends on its grid of frequencies",
    )
}

const fn adaptive(quantity: &'static str, expected: f64) -> Figure {
    Figure::new(quantity, expected, 5, "m").computed("SciPy, adaptive quadrature")
}

const fn printed(quantity: &'static str, expected: f64) -> Figure {
    Figure::new(quantity, expected, 4, "m")
        .published(IABSE)
        .within(
            0.25 * expected,
            "participants of the benchmark scatter by 5 to 25 %",
        )
}

/// RMS of `y` and of `θ·B/2` (m) at the five speeds.
fn iabse_rms() -> Result<Vec<f64>> {
    let structure = SectionModel::iabse_1_1a().structure()?;
    let problem = BuffetingProblem {
        structure: &structure,
        model: &WITHOUT_ROTARY,
        forces: &GustForces::flat_plate(),
        turbulence: &Turbulence {
            along: None,
            vertical: Some(W),
        },
    };
    let responses = SPEEDS_M_S
        .iter()
        .map(|speed| buffeting_response(&problem, *speed, None))
        .collect::<Result<Vec<_>>>()?;
    let heave = responses.iter().map(|r| r.rms[0]);
    let edge = responses.iter().map(|r| r.rms[1] * 0.5 * structure.width_m);
    Ok(heave.chain(edge).collect())
}
