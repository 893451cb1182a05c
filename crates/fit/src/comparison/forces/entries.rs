//! Models against test points in the frequency domain: transfer functions with their tolerance bands, and derivatives.

use crate::aerodynamics::Transfer;
use crate::aerodynamics::derivatives::{Derivative, DerivativePoint, DerivativeTable, Part};
use crate::error::Result;
use crate::identification::samples::part_of;
use crate::section::Dof;
use crate::units::ReducedFrequency;
use nalgebra::Complex;
use serde::Serialize;
use std::f64::consts::TAU;

/// Half width of the thesis's band around a measured magnitude, percent.
pub(crate) const MAGNITUDE_BAND_PERCENT: f64 = 15.0;
/// Half width of its band around a measured phase, degrees.
pub(crate) const PHASE_BAND_DEG: f64 = 5.0;
/// Points of the curves of a model.
const CURVE_POINTS: usize = 80;

/// One measured value of a transfer function.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TestPoint {
    /// Frequency of the motion at the mean speed, Hz.
    pub frequency_hz: f64,
    /// Reduced frequency `K = ωB/V`.
    pub k: f64,
    /// `|G|`.
    pub magnitude: f64,
    /// Phase of `G`, degrees, without jumps from point to point.
    pub phase_deg: f64,
}

/// What belongs to one model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PerModel<P> {
    /// Model.
    pub model: String,
    /// One entry per point.
    pub points: Vec<P>,
}

impl<P> PerModel<P> {
    fn new(model: &str, points: Vec<P>) -> Self {
        let model = model.to_owned();
        Self { model, points }
    }
}

/// One transfer function.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EntryComparison {
    /// Force (row of `G`).
    pub force: Dof,
    /// Motion (column of `G`).
    pub motion: Dof,
    /// What was measured.
    pub points: Vec<TestPoint>,
    /// The models there: `100 (|G_model|/|G| − 1)` percent and the phase of `G_model/G` in degrees.
    pub models: Vec<PerModel<(f64, f64)>>,
    /// The models in between: frequency (Hz), magnitude, phase (degrees).
    pub curves: Vec<PerModel<(f64, f64, f64)>>,
}

/// One derivative over `V̂`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DerivativeComparison {
    /// Name, e.g. `H1`.
    pub name: &'static str,
    /// `V̂` and measured value.
    pub measured: Vec<(f64, f64)>,
    /// Model, and its `V̂` and value.
    pub models: Vec<(String, Vec<(f64, f64)>)>,
}

/// Whether a deviation of magnitude, percent, is inside the band.
pub fn in_magnitude_band(percent: f64) -> bool {
    percent.abs() <= MAGNITUDE_BAND_PERCENT
}

/// Whether a deviation of phase, degrees, is inside the band.
pub fn in_phase_band(degrees: f64) -> bool {
    degrees.abs() <= PHASE_BAND_DEG
}

impl EntryComparison {
    /// How many points a model has inside the bands, and its largest deviations, in words.
    pub fn describe(&self, model: usize) -> String {
        let points = &self.models[model].points;
        let count = |f: fn(&(f64, f64)) -> bool| points.iter().filter(|p| f(p)).count();
        let larger = |w: f64, x: f64| if x.abs() > w.abs() { x } else { w };
        let worst = |f: fn(&(f64, f64)) -> f64| points.iter().map(f).fold(0.0, larger);
        format!(
            "magnitude within ±15 % at {} of {} (worst {:+.0} %), phase within ±5° at {} (worst {:+.1}°)",
            count(|p| in_magnitude_band(p.0)),
            points.len(),
            worst(|p| p.0),
            count(|p| in_phase_band(p.1)),
            worst(|p| p.1),
        )
    }
}

/// Every transfer function among `dofs` of a table of one speed against the models.
pub(super) fn compare_entries(
    group: &DerivativeTable,
    speed_m_s: f64,
    dofs: &[Dof],
    models: &[(String, &dyn Transfer)],
) -> Result<Vec<EntryComparison>> {
    let mut all = Vec::with_capacity(dofs.len() * dofs.len());
    for (i, &force) in dofs.iter().enumerate() {
        for (j, &motion) in dofs.iter().enumerate() {
            let measured = measured(group, force, motion);
            let hz = |k: ReducedFrequency| k.circular(group.width_m, speed_m_s) / TAU;
            let mut phase_deg = 0.0;
            let point = |(k, g): &(ReducedFrequency, Complex<f64>)| {
                phase_deg = unwrapped(g.arg().to_degrees(), phase_deg);
                TestPoint {
                    frequency_hz: hz(*k),
                    k: k.full_width(),
                    magnitude: g.norm(),
                    phase_deg,
                }
            };
            let points: Vec<TestPoint> = measured.iter().map(point).collect();
            let (mut of_models, mut curves) = (Vec::new(), Vec::new());
            for (name, model) in models {
                let at = |k| Ok::<_, crate::Error>(model.transfer(k)?[(i, j)]);
                let deviation = |(k, g): &(ReducedFrequency, Complex<f64>)| {
                    let ratio = at(*k)? / g;
                    Ok((100.0 * (ratio.norm() - 1.0), ratio.arg().to_degrees()))
                };
                let deviations = measured.iter().map(deviation).collect::<Result<_>>()?;
                of_models.push(PerModel::new(name, deviations));
                curves.push(PerModel::new(name, curve(&points, &hz, &at)?));
            }
            all.push(EntryComparison {
                force,
                motion,
                points,
                models: of_models,
                curves,
            });
        }
    }
    Ok(all)
}

/// Both parts of an entry at its test points, in the order of rising `K`.
fn measured(
    group: &DerivativeTable,
    force: Dof,
    motion: Dof,
) -> Vec<(ReducedFrequency, Complex<f64>)> {
    let part = |p| group.points(Derivative::from_entry(force, motion, p));
    let value = |p: &DerivativePoint| p.value * p.k().full_width().powi(2);
    let both = part(Part::Real).iter().zip(part(Part::Imaginary));
    let entry = |(re, im): (&DerivativePoint, &DerivativePoint)| {
        let k = 0.5 * (re.k().full_width() + im.k().full_width());
        let k = ReducedFrequency::from_full_width(k);
        (k, Complex::new(value(re), value(im)))
    };
    let mut all: Vec<_> = both.map(entry).collect();
    all.sort_by(|a, b| a.0.full_width().total_cmp(&b.0.full_width()));
    all
}

/// A model from the first to the last test point, its phase next to that of the first.
fn curve(
    points: &[TestPoint],
    hz: &dyn Fn(ReducedFrequency) -> f64,
    at: &dyn Fn(ReducedFrequency) -> Result<Complex<f64>>,
) -> Result<Vec<(f64, f64, f64)>> {
    let (Some(first), Some(last)) = (points.first(), points.last()) else {
        return Ok(Vec::new());
    };
    let mut phase_deg = first.phase_deg;
    let point = |i| {
        let part = i as f64 / (CURVE_POINTS as f64 - 1.0);
        let k = ReducedFrequency::from_full_width(first.k + part * (last.k - first.k));
        let g = at(k)?;
        phase_deg = unwrapped(g.arg().to_degrees(), phase_deg);
        Ok((hz(k), g.norm(), phase_deg))
    };
    (0..CURVE_POINTS).map(point).collect()
}

/// A phase in degrees without a jump from the last one.
fn unwrapped(degrees: f64, last: f64) -> f64 {
    degrees + 360.0 * ((last - degrees) / 360.0).round()
}

/// The derivatives that couple `dofs`, measured at one speed and according to the models.
pub(super) fn compare_derivatives(
    group: &DerivativeTable,
    dofs: &[Dof],
    models: &[(String, &dyn Transfer)],
) -> Result<Vec<DerivativeComparison>> {
    let mut all = Vec::new();
    for derivative in Derivative::ALL {
        let place = |dof| dofs.iter().position(|d| *d == dof);
        let (Some(i), Some(j)) = (place(derivative.force()), place(derivative.motion())) else {
            continue;
        };
        let points = group.points(derivative).iter();
        let mut measured: Vec<(f64, f64)> = points.map(|p| (p.v_hat, p.value)).collect();
        measured.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (Some(first), Some(last)) = (measured.first(), measured.last()) else {
            continue;
        };
        let mut of_models = Vec::with_capacity(models.len());
        for (name, model) in models {
            let at = |i_point: usize| {
                let part = i_point as f64 / (CURVE_POINTS as f64 - 1.0);
                let v_hat = first.0 + part * (last.0 - first.0);
                let k = ReducedFrequency::from_v_hat(v_hat);
                let g = model.transfer(k)?[(i, j)] / k.full_width().powi(2);
                Ok((v_hat, part_of(g, derivative.part())))
            };
            let points = (0..CURVE_POINTS).map(at).collect::<Result<Vec<_>>>()?;
            of_models.push((name.clone(), points));
        }
        all.push(DerivativeComparison {
            name: derivative.name(),
            measured,
            models: of_models,
        });
    }
    Ok(all)
}
