//! Sections that are stepped, and an integration that knows nothing of how.

use aerodeck::aerodynamics::{DiscreteLaguerre, RationalModel, Realizable};
use aerodeck::aeroelastic::CoupledSection;
use aerodeck::response::{Inputs, SectionState, Stepper};
use aerodeck::section::{Dof, SectionModel};
use nalgebra::{DMatrix, DVector};

pub fn jones() -> Stepper {
    let structure = SectionModel::table_4_1().structure().unwrap();
    let aero = RationalModel::jones_flat_plate().realize();
    Stepper::new(CoupledSection::new(structure, aero).unwrap())
}

pub fn discrete() -> Stepper {
    let structure = SectionModel::table_4_1().structure().unwrap();
    let model = DiscreteLaguerre::shared(
        Dof::TWO.to_vec(),
        0.6,
        0.08,
        vec![
            DMatrix::from_row_slice(2, 3, &[-2.0, 0.5, 0.8, -0.4, 0.1, 0.1]),
            DMatrix::from_row_slice(2, 3, &[4.0, 0.6, -0.3, 1.0, 0.2, -0.1]),
        ],
        vec![0.0; 2],
    );
    Stepper::new(CoupledSection::new(structure, model.realize()).unwrap())
}

pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    let scale = a.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    a.iter()
        .zip(b)
        .map(|(x, y)| (x - y).abs() / scale)
        .fold(0.0, f64::max)
}

pub fn blown(speed: f64) -> Inputs {
    Inputs {
        force: vec![3.0, -0.2],
        force_rate: vec![-5.0, 0.7],
        ..Inputs::steady(speed, 2)
    }
}

/// Classical Runge–Kutta of fourth order on `Stepper::state_derivative`, small steps.
pub fn runge_kutta(
    stepper: &Stepper,
    start: &SectionState,
    inputs: &Inputs,
    h: f64,
    steps: usize,
) -> Vec<f64> {
    let tau = h / steps as f64;
    let mut stepper = stepper.clone();
    let mut derivative = |z: &DVector<f64>, t: f64| {
        let mut now = inputs.clone();
        now.wind_speed_m_s += inputs.wind_speed_rate_m_s2 * t;
        for (w, rate) in now.force.iter_mut().zip(&inputs.force_rate) {
            *w += rate * t;
        }
        let state = SectionState {
            values: z.as_slice().to_vec(),
            ..SectionState::default()
        };
        DVector::from_vec(stepper.state_derivative(&state, &now).unwrap())
    };
    let mut z = DVector::from_column_slice(&start.values);
    for i in 0..steps {
        let t = i as f64 * tau;
        let k1 = derivative(&z, t);
        let k2 = derivative(&(&z + &k1 * (tau / 2.0)), t + tau / 2.0);
        let k3 = derivative(&(&z + &k2 * (tau / 2.0)), t + tau / 2.0);
        let k4 = derivative(&(&z + &k3 * tau), t + tau);
        z += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (tau / 6.0);
    }
    z.as_slice().to_vec()
}
