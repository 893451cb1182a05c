//! A crossing of the imaginary axis, refined by Newton's method in speed and frequency with exact derivatives.

use super::{Crossing, Sweep};
use crate::flutter::dynamic_stiffness::{Determinant, ZERO, oscillator};
use crate::state_space::Complex64;

/// Relative size of the last Newton step.
const TOLERANCE: f64 = 1e-13;
/// From a start interpolated on the grid five steps do.
const STEPS: usize = 20;

impl<const N: usize> Sweep<'_, N> {
    /// The crossing next to a speed (m/s) and circular frequency (rad/s); `None` when Newton's method does not settle.
    pub(super) fn refine(&self, mut speed: f64, mut omega: f64) -> Option<Crossing> {
        for _ in 0..STEPS {
            let [value, by_lambda, by_speed] = self.singularity(speed, omega);
            // i d_λ is the derivative along ω
            let by_omega = Complex64::new(-by_lambda.im, by_lambda.re);
            let jacobian = by_omega.re * by_speed.im - by_omega.im * by_speed.re;
            let omega_step = (value.re * by_speed.im - value.im * by_speed.re) / jacobian;
            let speed_step = (by_omega.re * value.im - by_omega.im * value.re) / jacobian;
            if !(omega_step.is_finite() && speed_step.is_finite()) {
                return None;
            }
            omega -= omega_step;
            speed -= speed_step;
            if speed_step.abs() <= TOLERANCE * speed && omega_step.abs() <= TOLERANCE * omega {
                let rate = -by_speed / by_lambda;
                return (speed > 0.0 && omega > 0.0).then_some(Crossing {
                    speed,
                    omega,
                    destabilises: rate.re > 0.0,
                });
            }
        }
        None
    }

    /// The determinant of `D(λ, V)` of [`dynamic_stiffness`](crate::flutter::dynamic_stiffness) at `λ = iω`, and its derivatives
    /// by `λ` and by `V`.
    fn singularity(&self, speed: f64, omega: f64) -> [Complex64; 3] {
        let (s, forces) = (&self.supports, &self.sweep.forces);
        let width = s.width;
        let p = Complex64::new(0.0, omega * width / speed);
        let (g, slope) = forces.transfer::<N>(p, self.coefficients);
        let (g, slope) = (s.at_axis(g), s.at_axis(slope));
        let lambda = Complex64::new(0.0, omega);
        let air = 0.5 * s.density * width * width;
        let (pressure, lag) = (air * speed * speed, air * width);
        let [mut d, mut by_lambda, mut by_speed] = [[[ZERO; N]; N]; 3];
        for i in 0..N {
            for j in 0..N {
                let (value, rate) = oscillator(lambda, s.entry(i, j));
                d[i][j] = value - g[i][j] * pressure;
                by_lambda[i][j] = rate - slope[i][j] * (lag * speed);
                by_speed[i][j] = g[i][j] * (-2.0 * air * speed) + slope[i][j] * lambda * lag;
            }
        }
        let determinant = Determinant::new(&d, N);
        let [by_lambda, by_speed] = [by_lambda, by_speed].map(|d| determinant.along(&d));
        [determinant.value, by_lambda, by_speed]
    }
}
