//! Reading and setting variables, by value reference; what is computed is computed when first asked for.

use super::Instance;
use super::layout::{DataType, Source};
use super::section::{self, OnsetCard};
use crate::error::Result;
use crate::flutter::{OnsetSearch, UnwantedGrowth, unwanted_growth};
use crate::fmu::refusal::{Answer, Refusal};
use crate::fmu::resources::Resources;
use crate::fmu::variables::Role;
use crate::response::Outputs;

impl Instance {
    /// Values of real variables.
    ///
    /// # Errors
    /// A reference that is none, of another type, or not readable now; a value that cannot be computed.
    pub fn reals(&mut self, references: &[u32], values: &mut [f64]) -> Answer<()> {
        for (reference, value) in references.iter().zip(values) {
            *value = self.number(*reference, DataType::Real)?;
        }
        Ok(())
    }

    /// Value of an integer variable.
    ///
    /// # Errors
    /// As [`Instance::reals`].
    pub fn integer(&mut self, reference: u32) -> Answer<i32> {
        Ok(self.number(reference, DataType::Integer)? as i32)
    }

    /// Value of a truth variable.
    ///
    /// # Errors
    /// As [`Instance::reals`].
    pub fn boolean(&mut self, reference: u32) -> Answer<bool> {
        Ok(self.number(reference, DataType::Boolean)? != 0.0)
    }

    /// Place in the table of a text that may be read now.
    ///
    /// # Errors
    /// As [`Instance::reals`].
    pub fn text_place(&self, reference: u32) -> Answer<usize> {
        Ok(self.readable(reference, DataType::String)?.0)
    }

    pub(super) fn number(&mut self, reference: u32, wanted: DataType) -> Answer<f64> {
        let (place, access) = self.readable(reference, wanted)?;
        match access.source {
            Source::Response if !self.outputs_current => {
                self.prepare()?;
                // what is part of the state needs no output equation
                if let Some(entry) = self.layout.state_entry[place] {
                    return Ok(self.memory.section.values[entry]);
                }
                self.refresh_outputs()?;
            }
            Source::Calculated if !self.onset_current => self.refresh_onset(),
            _ => {}
        }
        Ok(self.memory.values[place])
    }

    /// Sets real variables: all of them or, when one is refused, none.
    ///
    /// # Errors
    /// An error for a reference that is none, of another type or not settable now, and for a value that is not finite;
    /// a discard for a value outside the limits of its variable.
    pub fn set_reals(&mut self, references: &[u32], values: &[f64]) -> Answer<()> {
        for (reference, value) in references.iter().zip(values) {
            let (place, access) = self.writable(*reference, DataType::Real)?;
            self.check_value(place, access, self.layout.settled(place, *value))?;
        }
        for (reference, value) in references.iter().zip(values) {
            let place = *reference as usize;
            self.store(place, self.layout.settled(place, *value));
        }
        Ok(())
    }

    /// Refuses to set variables of a type that has none to set.
    ///
    /// # Errors
    /// For every reference.
    pub fn refuse_to_set(&self, references: &[u32], of_type: DataType) -> Answer<()> {
        for reference in references {
            self.writable(*reference, of_type)?;
        }
        Ok(())
    }

    pub(super) fn store(&mut self, place: usize, value: f64) {
        if self.memory.values[place].to_bits() == value.to_bits() {
            return;
        }
        self.memory.values[place] = value;
        self.outputs_current = false;
        match self.layout.source(place) {
            Source::Section => {
                self.stepper = None;
                self.onset_current = false;
                self.growth_known = false;
                self.release_pending = true;
            }
            Source::Release => self.release_pending = true,
            Source::Limit => {
                self.onset_current = false;
                self.growth_known = false;
            }
            _ => {}
        }
    }

    /// Sets first rates of inputs, per second: all of them or none.
    ///
    /// # Errors
    /// A reference that is no input, another order than one, a rate that is not finite.
    pub fn set_input_rates(
        &mut self,
        references: &[u32],
        orders: &[i32],
        rates: &[f64],
    ) -> Answer<()> {
        for ((reference, order), rate) in references.iter().zip(orders).zip(rates) {
            self.input_index(*reference)?;
            check_order(*order)?;
            if !rate.is_finite() {
                return Err(Refusal::error(format!(
                    "rate of value reference {reference}: expected a finite number, found {rate}"
                )));
            }
        }
        for (reference, rate) in references.iter().zip(rates) {
            let index = self.input_index(*reference)?;
            self.memory.input_rates[index] = *rate;
        }
        Ok(())
    }

    /// Place among the inputs: wind speed, then the external forces.
    pub(super) fn input_index(&self, reference: u32) -> Answer<usize> {
        let (place, _) = self.typed(reference, DataType::Real)?;
        let forces = self.layout.force.iter().copied();
        std::iter::once(self.layout.wind_speed)
            .chain(forces)
            .position(|input| input == place)
            .ok_or_else(|| {
                let name = self.table().variables()[place].name;
                Refusal::error(format!("`{name}` is no input"))
            })
    }

    pub(super) fn refresh_outputs(&mut self) -> Answer<()> {
        self.prepare()?;
        self.load_inputs();
        if let Some(stepper) = &mut self.stepper {
            stepper.outputs(&self.memory.section, &self.inputs, &mut self.outputs)?;
        }
        check_finite(&self.outputs)?;
        for (i, places) in self.layout.responses.iter().enumerate() {
            for (place, list) in places.iter().zip(self.outputs.lists()) {
                self.memory.values[*place] = list[i];
            }
        }
        self.outputs_current = true;
        Ok(())
    }

    /// Searches onset and divergence for the current parameters. A search that fails is no reason to end a run.
    pub(super) fn refresh_onset(&mut self) {
        let card = self.onset_card(&self.memory.values);
        for (place, variable) in self.resources.table.variables().iter().enumerate() {
            if let Role::Calculated(which) = variable.role {
                self.memory.values[place] = card.value(which);
            }
        }
        self.notices.extend(card.warnings);
        self.onset_current = true;
    }

    /// Growth below the onset for the parameters in `values`.
    pub(super) fn growth(&self, values: &[f64]) -> Result<UnwantedGrowth> {
        let Resources { model, table, .. } = &self.resources;
        let speed_max_m_s = values[self.layout.search_limit];
        let section = section::coupled_section(model, table, &self.aerodynamics, values)?;
        if let Some(onset) = section::plain_onset(model, table, values, speed_max_m_s) {
            return Ok(UnwantedGrowth {
                scanned_to_m_s: onset.speed_m_s,
                bands: Vec::new(),
            });
        }
        section::check_searchable(&section)?;
        let search = OnsetSearch {
            speed_max_m_s,
            ..OnsetSearch::default()
        };
        unwanted_growth(&section, &search, Some(model.tested_range))
    }

    pub(super) fn onset_card(&self, values: &[f64]) -> OnsetCard {
        let Resources { model, table, .. } = &self.resources;
        let limit = values[self.layout.search_limit];
        match section::coupled_section(model, table, &self.aerodynamics, values) {
            Ok(section) => {
                let plain = section::plain_onset(model, table, values, limit);
                OnsetCard::search(model, &section, limit, plain)
            }
            Err(why) => OnsetCard::unknown(limit, &why),
        }
    }
}

/// Refuses outputs that no number holds any more.
pub(super) fn check_finite(outputs: &Outputs) -> Answer<()> {
    if outputs.lists().into_iter().flatten().all(|x| x.is_finite()) {
        return Ok(());
    }
    Err(Refusal::discard(
        "outputs: the motion has grown beyond the range of numbers",
    ))
}

/// Rates are known to the first order.
pub(super) fn check_order(order: i32) -> Answer<()> {
    if order == 1 {
        Ok(())
    } else {
        Err(Refusal::call(format!(
            "order of the derivative: expected 1, found {order}"
        )))
    }
}
