//! Gusts on strips whose motion is prescribed: their lags go on exactly from one point of time to the next.

use super::Airflow;
use crate::aerodynamics::GustForce;
use crate::section::Dof;
use crate::variables::Dual;

/// Gust forces on strips. The state of a strip is the gust at the newest point of time (`u`, `w`, m/s), then the gusts behind
/// each lag of `u` and of `w`.
#[derive(Debug, Clone)]
pub struct StripGusts {
    dofs: Vec<Dof>,
    coefficients: Vec<[f64; 2]>,
    /// Pole and weight of each lag.
    lags: &'static [[f64; 2]],
}

impl StripGusts {
    /// Strips in gusts that exert this force.
    pub fn new(force: &GustForce) -> Self {
        Self {
            dofs: force.dofs.clone(),
            coefficients: force.coefficients.clone(),
            lags: force.admittance.lags(),
        }
    }

    /// Numbers of the state of a strip.
    pub fn per_strip(&self) -> usize {
        2 + 2 * self.lags.len()
    }

    /// Goes to a new point of time, at which the gust is `gust`, after the mean wind has passed `widths` times the width; the first
    /// time (no `widths`) the flow has settled in it.
    pub fn take(&self, strip: &mut [f64], gust: [f64; 2], widths: Option<f64>) {
        let (before, lagging) = strip.split_at_mut(2);
        for (i, (g, j)) in lagging.iter_mut().zip(self.components()).enumerate() {
            *g = match widths {
                Some(widths) => {
                    let [pole, _] = self.lags[i % self.lags.len()];
                    behind_a_lag(*g, [before[j], gust[j]], pole * widths)
                }
                None => gust[j],
            };
        }
        before.copy_from_slice(&gust);
    }

    /// Adds the force of the gusts `ahead_s` seconds after the newest point, until then running on at `rate` (m/s²).
    pub fn add_ahead(
        &self,
        strip: &[f64],
        rate: [f64; 2],
        ahead_s: f64,
        air: Airflow,
        forces: &mut [Dual],
    ) {
        let convection_per_s = air.wind_m_s / air.width_m;
        let gust = [0, 1].map(|j| strip[j] + ahead_s * rate[j]);
        let (mut passed, mut passed_rate) = (gust, rate);
        if !self.lags.is_empty() {
            (passed, passed_rate) = ([0.0; 2], [0.0; 2]);
            for (i, (g, j)) in strip[2..].iter().zip(self.components()).enumerate() {
                let [pole, weight] = self.lags[i % self.lags.len()];
                let now = behind_a_lag(*g, [strip[j], gust[j]], pole * convection_per_s * ahead_s);
                passed[j] += weight * now;
                passed_rate[j] += weight * pole * convection_per_s * (gust[j] - now);
            }
        }
        for ((force, dof), row) in forces.iter_mut().zip(&self.dofs).zip(&self.coefficients) {
            let scale = 0.5 * air.density_kg_m3 * air.wind_m_s * dof.force_scale(air.width_m);
            force.value += scale * (row[0] * passed[0] + row[1] * passed[1]);
            force.slope += scale * (row[0] * passed_rate[0] + row[1] * passed_rate[1]);
        }
    }

    /// Rates of the gusts behind the lags, per second, where the mean wind passes so many widths in a second.
    pub fn rates(&self, strip: &[f64], convection_per_s: f64) -> impl Iterator<Item = f64> {
        let (now, lagging) = strip.split_at(2);
        lagging
            .iter()
            .zip(self.components())
            .enumerate()
            .map(move |(i, (g, j))| {
                let [pole, _] = self.lags[i % self.lags.len()];
                pole * convection_per_s * (now[j] - g)
            })
    }

    /// The component of each lag.
    fn components(&self) -> impl Iterator<Item = usize> + use<> {
        let count = self.lags.len();
        (0..2 * count).map(move |i| i / count)
    }
}

/// `ġ = p (u − g)` over `x = p t`, from `g`, while `u` goes on a straight line.
fn behind_a_lag(g: f64, [from, to]: [f64; 2], x: f64) -> f64 {
    let come = -libm::expm1(-x);
    let mean = if x == 0.0 { 1.0 } else { come / x };
    g + (from - g) * come + (to - from) * (1.0 - mean)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aerodynamics::RationalAdmittance;

    const AIR: Airflow = Airflow {
        wind_m_s: 30.0,
        width_m: 20.0,
        density_kg_m3: 1.25,
    };

    #[test]
    fn a_lag_follows_its_equation() {
        // closed form for u = t, p = 2, from 1: g = t − ½ + 1.5 e^(−2t)
        for t in [0.0, 1e-9, 0.3, 5.0] {
            let expected = t - 0.5 + 1.5 * f64::exp(-2.0 * t);
            let found = behind_a_lag(1.0, [0.0, t], 2.0 * t);
            assert!(
                (found - expected).abs() < 1e-15 * (1.0 + t),
                "{t}: {found} {expected}"
            );
        }
    }

    /// A steady gust along the wind is a wind a little faster; one point or two make no difference.
    #[test]
    fn a_steady_gust_passes_whole() {
        let force = |admittance| GustForce {
            dofs: Dof::TWO.to_vec(),
            coefficients: vec![[0.2, 5.0], [0.1, -1.0]],
            admittance,
            source: "test".into(),
        };
        for admittance in [RationalAdmittance::None, RationalAdmittance::Sears] {
            let gusts = StripGusts::new(&force(admittance));
            let mut strip = vec![0.0; gusts.per_strip()];
            gusts.take(&mut strip, [2.0, -1.0], None);
            gusts.take(&mut strip, [2.0, -1.0], Some(0.7));
            let mut forces = [Dual::default(); 2];
            gusts.add_ahead(&strip, [0.0; 2], 0.3, AIR, &mut forces);
            let lift = 0.5 * 1.25 * 30.0 * 20.0 * (0.2 * 2.0 - 5.0);
            assert!((forces[0].value - lift).abs() < 1e-12 * lift.abs());
            assert!(forces[0].slope.abs() < 1e-9);
        }
    }

    /// The rate is the difference of the force over a short time.
    #[test]
    fn rates_are_those_of_the_force() {
        let force = GustForce {
            dofs: Dof::TWO.to_vec(),
            coefficients: vec![[0.2, 5.0], [0.1, -1.0]],
            admittance: RationalAdmittance::Liepmann,
            source: "test".into(),
        };
        let gusts = StripGusts::new(&force);
        let mut strip = vec![0.0; gusts.per_strip()];
        gusts.take(&mut strip, [0.5, 0.0], None);
        gusts.take(&mut strip, [2.0, -1.0], Some(0.7));
        let at = |ahead| {
            let mut forces = [Dual::default(); 2];
            gusts.add_ahead(&strip, [0.3, -0.2], ahead, AIR, &mut forces);
            forces
        };
        let step = 1e-4;
        let (before, now, after) = (at(0.2 - step), at(0.2), at(0.2 + step));
        for i in 0..2 {
            let expected = (after[i].value - before[i].value) / (2.0 * step);
            assert!((now[i].slope - expected).abs() < 1e-6 * expected.abs());
        }
    }
}
