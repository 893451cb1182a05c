//! The mass matrix that still air shows, which of a body is symmetric.
//!
//! A centre of mass `x` downwind of the axis and `y` above it shows `-m x` in the moment of heave and in the lift of rotation, `m y` in
//! the moment of sway and in the drag of rotation. Cells or an axis that are not where the rig states them change the moments alone. A
//! motion besides the driven one adds its own inertia; a sensor that says one where there is none adds nothing.

use super::body::{CERTAIN, StillAirInertia};
use super::index;
use super::lag::{Ratio, Ratios, solve_together};
use super::prepare::PreparedRun;
use crate::section::Dof;
use crate::wind_tunnel::Rig;
use nalgebra::Complex;

/// Centres of mass are one up to this part of the width …
const SAME_CENTRE: f64 = 0.01;
/// … and up to this one on the axis, where nothing is stated: the moment of lift at it moves an onset by some 7 %.
const ON_THE_AXIS: f64 = 0.03;
/// A motion besides the driven one is asked for its inertia from this part on, both over the width …
const CONSIDERABLE: f64 = 0.05;
/// … and is none where this part of it is missing, less or more: what a centre of mass that is a little off adds is none of its size.
const MISSING: [f64; 2] = [0.6, 1.4];

/// Inertia of the motion of one run in the force of another.
struct InertialCoupling {
    /// Its place among the runs.
    run: usize,
    /// Without that of the other motion.
    found: StillAirInertia,
    /// That of the other motion, were it there.
    of_other: f64,
    /// Greatest part of the other motion in the driven one.
    part: f64,
}

/// Enters where still air shows the centre of mass, and doubts what no body shows.
pub(super) fn judge(rig: &Rig, runs: &mut [PreparedRun<'_>]) {
    for dof in [Dof::Vertical, Dof::Lateral] {
        let translation = couplings(rig, runs, dof, Dof::Torsion);
        let rotation = couplings(rig, runs, Dof::Torsion, dof);
        let sides = [(&translation, &rotation), (&rotation, &translation)];
        let mut unseen = Vec::new();
        for (own, across) in sides {
            let reference = surest(across);
            let doubt = |c: &InertialCoupling| Some((c.run, c.unseen(runs, reference?)?));
            unseen.extend(own.iter().filter_map(doubt));
        }
        let seen = |c: &&InertialCoupling| unseen.iter().all(|(run, _)| *run != c.run);
        let mut off_axis = None;
        for c in translation.iter().filter(seen) {
            let of_rotation = surest(&rotation).filter(seen);
            off_axis = off_axis.or(c.enter_centre(rig, runs, of_rotation));
        }
        for (run, doubt) in unseen.into_iter().chain(off_axis) {
            runs[run].report.doubts.push(doubt);
        }
    }
}

/// In tenths, without a sign of zero.
fn millimetres(metres: f64) -> f64 {
    (1e4 * metres).round() / 10.0 + 0.0
}

/// The one in which the other motion weighs least.
fn surest(all: &[InertialCoupling]) -> Option<&InertialCoupling> {
    all.iter().min_by(|a, b| a.part.total_cmp(&b.part))
}

/// Inertia of the runs of `dof` in the force of `other`.
fn couplings(rig: &Rig, runs: &[PreparedRun<'_>], dof: Dof, other: Dof) -> Vec<InertialCoupling> {
    let told = |p: &PreparedRun<'_>, moves: Dof| {
        let still_air = p.report.still_air.as_ref();
        p.report.dof == moves && still_air.is_some_and(|s| !s.hides_weight())
    };
    let body = runs.iter().find(|p| told(p, other));
    let body = body.and_then(|p| p.report.still_air.as_ref());
    let of_dof = runs.iter().enumerate().filter(|(_, p)| told(p, dof));
    // a force that nobody measures is zero
    let measured = |r: &&Ratios| r.total[index(other)].iter().any(|r| r.value.norm() > 0.0);
    let (at, ratios): (Vec<usize>, Vec<&Ratios>) = of_dof
        .filter_map(|(at, p)| Some((at, p.ratios.as_ref().filter(measured)?)))
        .unzip();
    let forces = || ratios.iter().map(|r| &r.total[index(other)][..]);
    let left: Vec<Vec<Ratio>> = ratios.iter().map(|r| without(r, other, body)).collect();
    let all = solve_together(other, &forces().collect::<Vec<_>>());
    let left = solve_together(other, &left.iter().map(Vec::as_slice).collect::<Vec<_>>());
    let width = rig.model_width_m;
    let scale = other.motion_scale(width) / dof.motion_scale(width);
    let mut couplings = Vec::new();
    for (((run, ratios), all), found) in at.into_iter().zip(ratios).zip(all).zip(left) {
        let (Some(all), Some(found)) = (all, found) else {
            continue;
        };
        let moves = ratios.motion[index(other)].iter();
        let part = moves.map(|r| scale * r.value.norm()).fold(0.0, f64::max);
        // of motions that are driven at once none is told from the other
        if body.is_some() || part <= CONSIDERABLE {
            couplings.push(InertialCoupling {
                run,
                of_other: all.inertia - found.inertia,
                found,
                part,
            });
        }
    }
    couplings
}

/// The force of `other` over the driven motion without that of the `body` that moves so.
fn without(run: &Ratios, other: Dof, body: Option<&StillAirInertia>) -> Vec<Ratio> {
    let force = &run.total[index(other)];
    let moves = &run.motion[index(other)];
    let Some(body) = body.filter(|_| moves.len() == force.len()) else {
        return force.clone();
    };
    let left = force.iter().zip(moves).map(|(force, moves)| {
        let of_body = Complex::new(
            body.inertia * force.omega.powi(2) - body.stiffness.unwrap_or(0.0),
            -body.damping.unwrap_or(0.0) * force.omega,
        );
        let of_body = of_body * Complex::from_polar(1.0, -force.omega * body.lag_s);
        Ratio {
            omega: force.omega,
            value: force.value - of_body * moves.value,
            variance: force.variance + of_body.norm_sqr() * moves.variance,
        }
    });
    left.collect()
}

impl InertialCoupling {
    /// The doubt that another motion of which its channel tells is none, against the `across` of the other runs.
    fn unseen(&self, runs: &[PreparedRun<'_>], across: &Self) -> Option<String> {
        let off = self.found.inertia - across.found.inertia;
        let error = self.error(across) / self.of_other.abs();
        // what is not there was taken off
        let missing = -off / self.of_other;
        let [least, most] = MISSING;
        let is_missing = (least + error..=most).contains(&missing);
        (self.part > CONSIDERABLE && is_missing).then(|| {
            let (own, other) = (runs[self.run].report.dof.name(), self.found.dof.name());
            format!(
                "the {other} channel tells of {:.0} % of the {own} motion, both over the width, whose inertia in the {other} force, \
                 {:.4} kg·m, still air does not show ({:.4} ± {:.4} kg·m): a sensor that feels the {own} motion?",
                100.0 * self.part,
                self.of_other,
                off + self.of_other,
                self.found.inertia_standard_error
            )
        })
    }

    /// Certain difference of two, kg·m.
    fn error(&self, other: &Self) -> f64 {
        let error = |c: &Self| c.found.inertia_standard_error;
        CERTAIN * error(self).hypot(error(other))
    }

    /// Enters the place of the centre of mass in the run and returns the doubt of it.
    fn enter_centre(
        &self,
        rig: &Rig,
        runs: &mut [PreparedRun<'_>],
        rotation: Option<&Self>,
    ) -> Option<(usize, String)> {
        let body = runs[self.run].report.still_air.as_mut();
        let body = body.filter(|b| b.is_certain())?;
        let (axis, sign, place) = match body.dof {
            Dof::Vertical => (0, -1.0, "downwind of"),
            _ => (1, 1.0, "above"),
        };
        let metres = |c: &Self| sign * c.found.inertia / body.inertia;
        let (found, width) = (metres(self), rig.model_width_m);
        let turning = rotation.map(metres);
        body.centre_of_mass_m = Some(found);
        let off = |from: f64, part: f64, c: &Self| {
            (found - from).abs() > part * width + self.error(c) / body.inertia.abs()
        };
        let why = if let (Some(turning), Some(c)) = (turning, rotation)
            && off(turning, SAME_CENTRE, c)
        {
            let turning = millimetres(turning);
            format!(
                "rotation shows it {turning:.1} mm {place} it: `position_m` of the cells is not that from the axis"
            )
        } else {
            match rig.centre_of_mass_m.map(|p| p[axis]) {
                Some(stated) if off(stated, SAME_CENTRE, self) => {
                    let stated = millimetres(stated);
                    format!("`rig.centre_of_mass_m` states {stated:.1} mm")
                }
                // cells that are elsewhere change the moments alone: where rotation shows the same, they are not
                None if turning.is_none() && off(0.0, ON_THE_AXIS, self) => {
                    "`rig.centre_of_mass_m` does not state it: is `position_m` of the cells that from the axis?".to_owned()
                }
                _ => return None,
            }
        };
        let (mm, part, name) = (millimetres(found), 100.0 * found / width, body.dof.name());
        let doubt = format!(
            "still air shows the centre of mass {mm:.1} mm ({part:.1} % of the width) {place} the axis in {name} motion, {why}"
        );
        Some((self.run, doubt))
    }
}
