//! The section that the current parameters describe, and what follows from it alone: onset and divergence.

use crate::aerodynamics::Transfer;
use crate::aeroelastic::CoupledSection;
use crate::error::{Error, Result, ensure};
use crate::flutter::{
    FastMotion, FlutterSearch, LinearForces, OnsetSearch, OnsetSweep, SweepOutcome, SweptOnset,
    UnwantedGrowth, at_samples, damps_fast_motion, divergence_with_forces, left_tests,
    stands_at_samples, unwanted_growth,
};
use crate::onset_start::simulated_onset;
use crate::section::{Dof, SectionModel, Structure};
use crate::trained_model::{Model, TrainedModel};
use crate::units::{ReducedFrequency, ReducedFrequencyRange, ReducedVelocity};
use crate::variables::{OnsetNumbers, Role, SectionParameter, VariableTable};

/// The section of the model with the parameters in `values` (one number per variable of `table`).
///
/// A support whose three numbers are the start values stays as the model states it, so that an unchanged section is
/// the model's own to the last bit even where that states a stiffness.
pub(super) fn section_model(
    model: &TrainedModel,
    table: &VariableTable,
    values: &[f64],
) -> SectionModel {
    let mut section = model.section.clone();
    let value = |p: SectionParameter| {
        let start = p.value_in(&model.section);
        table.find(Role::Section(p)).map_or(start, |i| values[i])
    };
    section.width_m = value(SectionParameter::Width);
    section.air_density_kg_m3 = value(SectionParameter::AirDensity);
    // the variables are there where the model states them
    if section.axis_offset_m.is_some() {
        section.axis_offset_m = Some(value(SectionParameter::AxisOffset));
    }
    if section.mass_offset_m.is_some() {
        section.mass_offset_m = Some(value(SectionParameter::MassOffset));
    }
    for dof in model.section.dofs() {
        let parameters = [
            SectionParameter::Inertia(dof),
            SectionParameter::Frequency(dof),
            SectionParameter::DampingRatio(dof),
        ];
        let start = parameters.map(|p| p.value_in(&model.section));
        let now = parameters.map(value);
        if start.map(f64::to_bits) != now.map(f64::to_bits) {
            set_support(&mut section, dof, now);
        }
    }
    section
}

fn set_support(section: &mut SectionModel, dof: Dof, [inertia, frequency, damping]: [f64; 3]) {
    // no frequency is no spring: that cannot be said as a frequency
    let (frequency_hz, stiffness) = if frequency > 0.0 {
        (Some(frequency), None)
    } else {
        (None, Some(0.0))
    };
    let translation = match dof {
        Dof::Torsion => {
            let s = &mut section.torsion;
            (s.inertia_kg_m2_m, s.damping_ratio) = (inertia, damping);
            (s.frequency_hz, s.stiffness_n) = (frequency_hz, stiffness);
            return;
        }
        Dof::Vertical => Some(&mut section.vertical),
        Dof::Lateral => section.lateral.as_mut(),
    };
    if let Some(s) = translation {
        (s.mass_kg_m, s.damping_ratio) = (inertia, damping);
        (s.frequency_hz, s.stiffness_n_m2) = (frequency_hz, stiffness);
    }
}

/// The onset of `section`, coupled, up to `limit` m/s where it is plain: inside the tested range, with nothing that grows below it. A
/// sweep sees every crossing in some ten microseconds; whatever else it sees is for the search of all eigenvalues to judge.
pub(super) fn plain_onset(
    model: &TrainedModel,
    section: &SectionModel,
    coupled: &CoupledSection,
    limit: f64,
) -> Option<SweptOnset> {
    let onset = plain_without_samples(model, section, coupled, limit)?;
    if !matches!(model.model, Model::DiscreteLaguerre(_)) {
        return Some(onset);
    }
    let onset = at_samples(coupled, onset).ok()??;
    (onset.speed_m_s <= limit).then_some(onset)
}

/// A speed up to which nothing grows because the onset there is plain, and stands where the force is sampled.
pub(super) fn plainly_stable_to(
    model: &TrainedModel,
    section: &SectionModel,
    coupled: &CoupledSection,
    limit: f64,
) -> Option<f64> {
    let onset = plain_without_samples(model, section, coupled, limit)?;
    let stands = !matches!(model.model, Model::DiscreteLaguerre(_))
        || stands_at_samples(coupled, onset).ok()?;
    stands.then_some(onset.speed_m_s)
}

/// The plain onset under forces that are not sampled.
fn plain_without_samples(
    model: &TrainedModel,
    section: &SectionModel,
    coupled: &CoupledSection,
    limit: f64,
) -> Option<SweptOnset> {
    let tested = Some(model.tested_range);
    let forces = match &model.model {
        Model::Laguerre(m) => LinearForces::of_laguerre(m, tested),
        Model::Rational(m) => LinearForces::of_rational(m, tested),
        Model::MinimumState(m) => LinearForces::of_rational(&m.to_roger(), tested),
        Model::DiscreteLaguerre(m) => LinearForces::of_discrete_laguerre(m, tested),
    };
    let sweep = OnsetSweep::new(forces, coupled.structure(), limit).ok()?;
    match sweep.onset(section, sweep.forces().coefficients()) {
        Ok(SweepOutcome::Onset(o)) if o.in_tested_range && o.spurious == 0 => Some(o),
        _ => None,
    }
}

/// Winds at which motions are looked at on the way to an onset: as it rises `K` falls, but where modes veer.
const ON_THE_WAY: usize = 4;

/// States at most whose eigenvalues are searched, for about a second: the time grows with their third power.
const SEARCHED_STATES: usize = 100;

/// The search of all eigenvalues up to `limit` m/s; one that would seem to hang is refused.
fn search_up_to(section: &CoupledSection, limit: f64) -> Result<OnsetSearch> {
    let states = section.states();
    ensure(
        states <= SEARCHED_STATES,
        "search of all eigenvalues",
        format_args!("at most {SEARCHED_STATES} states"),
        states,
    )?;
    Ok(OnsetSearch::up_to(limit))
}

/// Why damping is not known in wind slower than every test of a model; no parameter of the section changes it.
pub(super) fn slow_wind(model: &TrainedModel) -> Option<&'static str> {
    let (forces, dofs) = (&model.model, model.section.dofs());
    let k = model.tested_range.max;
    // what cannot be said is not said to be damped
    let damps = damps_fast_motion(&dofs, k, |k| forces.transfer(k)).unwrap_or(false);
    FastMotion::new(damps.then_some(FastMotion::Damped), [model.tested_range]).why_open()
}

/// Onset and divergence of a section.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct OnsetCard {
    pub numbers: OnsetNumbers,
    /// What a reader must know before using the numbers.
    pub warnings: Vec<String>,
}

impl OnsetCard {
    /// Searches up to `limit` m/s. What is not found is the limit itself, with frequency and reduced velocity zero. What cannot be
    /// searched for is zero, with a warning: parameters that are legal must not make a getter fail, and no speed that is not
    /// known may read as a safe one, in a log or without.
    pub(super) fn search(
        model: &TrainedModel,
        section: &CoupledSection,
        limit: f64,
        plain: Option<SweptOnset>,
        slow_wind: Option<&str>,
    ) -> Self {
        let mut card = match Self::with_divergence(section.structure(), &model.model, limit) {
            Ok(card) => card,
            Err(unknown) => return unknown,
        };
        card.search_onset(model, section, limit, plain);
        card.judge(slow_wind);
        card.look_beside_tests(section, Some(model.tested_range));
        card
    }

    /// With divergence up to `limit`, m/s, and nothing else. Where that cannot be searched for, as without stiffness, no onset can.
    pub(super) fn with_divergence(
        structure: &Structure,
        forces: &dyn Transfer,
        limit: f64,
    ) -> std::result::Result<Self, Self> {
        let speed = divergence_with_forces(structure, forces).map_err(|why| Self::unknown(&why))?;
        let mut card = Self::nothing_found(limit);
        if let Some(speed) = speed.filter(|v| *v <= limit) {
            card.numbers.divergence_m_s = speed.into();
            card.numbers.divergence_found = true;
        }
        Ok(card)
    }

    fn search_onset(
        &mut self,
        model: &TrainedModel,
        section: &CoupledSection,
        limit: f64,
        plain: Option<SweptOnset>,
    ) {
        if let Some(onset) = plain {
            let width = section.structure().width_m;
            let velocity = ReducedVelocity::from(ReducedFrequency::from_circular(
                std::f64::consts::TAU * onset.frequency_hz,
                width,
                onset.speed_m_s,
            ));
            self.set_onset(onset.speed_m_s, onset.frequency_hz, velocity, true);
            self.numbers.stable_below = true;
            return;
        }
        // what cannot be judged is not called stable
        self.numbers.stable_below =
            growth_of(model, section, limit).is_ok_and(|growth| growth.is_none());
        let (name, tested) = (model.model.kind(), Some(model.tested_range));
        let found = search_up_to(section, limit)
            .and_then(|search| simulated_onset(name, section, &search, tested));
        match found {
            Ok(found) => self.take(found, limit),
            Err(why) => self.onset_unknown(&why),
        }
    }

    /// What slow wind does where no test tells is not stable; nor is what diverges below the onset, whatever oscillates there.
    /// `slow_wind`: why damping there is not known.
    pub(super) fn judge(&mut self, slow_wind: Option<&str>) {
        if let Some(why) = slow_wind.filter(|_| self.numbers.stable_below) {
            self.numbers.stable_below = false;
            let warning = format!("in slow wind motions are faster than every test: {why}");
            self.warnings.push(warning);
        }
        let numbers = &self.numbers;
        let (divergence, onset) = (numbers.divergence_m_s.value, numbers.speed_m_s.value);
        if !(numbers.divergence_found && divergence < onset) {
            return;
        }
        let flutter = match numbers.found {
            true => format!("before the flutter onset at {onset:.3} m/s"),
            false => "where no oscillation grows".to_owned(),
        };
        self.warnings.push(format!(
            "static divergence at {divergence:.3} m/s, {flutter}: the margin to flutter does not count it"
        ));
        self.numbers.stable_below = false;
    }

    /// Nor is what data say nothing of: below the onset a motion comes to lie below every test, or in a gap between them, or
    /// does not oscillate any more.
    pub(super) fn look_beside_tests(
        &mut self,
        section: &CoupledSection,
        tested: Option<ReducedFrequencyRange>,
    ) {
        let Some(tested) = tested.filter(|_| self.numbers.stable_below) else {
            return;
        };
        let search = OnsetSearch::new(self.numbers.speed_m_s.value, ON_THE_WAY);
        let left = left_tests(section, &search, tested)
            .unwrap_or_else(|why| Some(format!("modes cannot be followed: {why}")));
        self.numbers.stable_below = left.is_none();
        self.warnings.extend(left);
    }

    /// The card of parameters that give no section at all.
    pub(super) fn unknown(why: &Error) -> Self {
        let why = format!("flutter onset and divergence are not known for these parameters: {why}");
        Self {
            numbers: OnsetNumbers::default(),
            warnings: vec![why],
        }
    }

    pub(super) fn nothing_found(limit: f64) -> Self {
        let numbers = OnsetNumbers {
            speed_m_s: limit.into(),
            divergence_m_s: limit.into(),
            ..OnsetNumbers::default()
        };
        Self {
            numbers,
            warnings: Vec::new(),
        }
    }

    /// Enters the answer of a search up to `limit` m/s. Growth from the lowest speed on is an onset at that speed or lower; what
    /// was judged up to a lower speed is stable up to there.
    pub(super) fn take(&mut self, found: FlutterSearch, limit: f64) {
        let (at, tested, warnings) = match found {
            FlutterSearch::Onset(o) => (o.at, o.in_tested_range, o.warnings),
            FlutterSearch::UnstableAtOrBelow(start) => {
                let (speed, why) = (start.at.speed_m_s, start.explain());
                self.warnings
                    .push(format!("the onset lies at {speed:.3} m/s or lower: {why}"));
                (start.at, start.in_tested_range, start.warnings)
            }
            FlutterSearch::StableUpTo(range) => {
                let judged = range.from_m_s <= range.to_m_s;
                let to = if judged { range.to_m_s.min(limit) } else { 0.0 };
                self.numbers.speed_m_s = to.into();
                if to < limit {
                    self.warnings.push(format!(
                        "the onset is not known beyond {to:.3} m/s: {}",
                        range.explain()
                    ));
                } else if range.from_m_s > 0.0 {
                    self.warnings.push(range.explain());
                }
                // what slow wind does there is not known
                self.numbers.stable_below &= range.from_m_s <= 0.0;
                return;
            }
        };
        let (speed, velocity) = (at.speed_m_s, at.reduced_velocity);
        self.set_onset(speed, at.frequency_hz, velocity, tested == Some(true));
        self.warnings.extend(warnings);
    }

    pub(super) fn set_onset(
        &mut self,
        speed: f64,
        frequency: f64,
        velocity: ReducedVelocity,
        tested: bool,
    ) {
        self.numbers = OnsetNumbers {
            speed_m_s: speed.into(),
            frequency_hz: frequency.into(),
            reduced_velocity: velocity.v_star().into(),
            found: true,
            in_tested_range: tested,
            ..self.numbers
        };
    }

    /// An onset that could not be searched for is zero, and nothing is stable below it.
    pub(super) fn onset_unknown(&mut self, why: &Error) {
        self.numbers.speed_m_s = 0.0.into();
        self.numbers.stable_below = false;
        let warning = format!("flutter onset is not known for these parameters: {why}");
        self.warnings.push(warning);
    }
}

/// Growth below the onset, up to `limit` m/s.
pub(super) fn growth_of(
    model: &TrainedModel,
    section: &CoupledSection,
    limit: f64,
) -> Result<UnwantedGrowth> {
    let search = search_up_to(section, limit)?;
    unwanted_growth(section, &search, Some(model.tested_range))
}
