//! Model exchange: the importer integrates, `ż = f(t, z, inputs)`. Nothing happens at events but what the importer sets
//! there.

use super::Instance;
use crate::lifecycle::{Interface, State};
use crate::refusal::{CallResult, Refusal};
use crate::variables::Role;

impl Instance {
    /// Makes an instance whose importer integrates.
    ///
    /// # Errors
    /// A unit without continuous states: sampled models, and bridges with more than anybody integrates.
    pub fn for_model_exchange(mut self) -> CallResult<Self> {
        if !self.offers_model_exchange() {
            return Err(Refusal::error(
                "type of the unit: expected co-simulation (1), because sampled models have no continuous states and bridges of \
                 many hundred do not offer them, found model exchange (0)",
            ));
        }
        self.unit.will_be_integrated();
        self.interface = Interface::ModelExchange;
        Ok(self)
    }

    /// Whether an importer may integrate it.
    pub(super) fn offers_model_exchange(&self) -> bool {
        !self.layout.state_rates.is_empty()
    }

    /// Number of continuous states.
    pub(crate) fn state_count(&self) -> usize {
        self.layout.state_rates.len()
    }

    /// Moves between events and integration.
    pub fn enter(&mut self, mode: State) {
        self.now.memory.state = mode;
    }

    /// Whether states have been set at an event since this was asked last: those of a parameter that counts them in other units.
    pub(crate) fn has_set_states(&mut self) -> bool {
        self.unit.has_set_states()
    }

    /// Sets the time, s.
    ///
    /// # Errors
    /// A time that is not finite.
    pub fn set_time(&mut self, time: f64) -> CallResult<()> {
        if !time.is_finite() {
            return Err(Refusal::error(format!(
                "time: expected a finite number, found {time}"
            )));
        }
        self.now.memory.time = time;
        // turbulence that is in the archive goes on
        self.outputs_current = false;
        Ok(())
    }

    /// Sets the continuous states.
    ///
    /// # Errors
    /// Another number of them; a discard where one is not finite, with everything as it was.
    pub fn set_continuous_states(&mut self, states: &[f64]) -> CallResult<()> {
        self.check_states("states", states.len())?;
        if !states.iter().all(|x| x.is_finite()) {
            return Err(Refusal::discard("states: expected finite numbers"));
        }
        for (entry, state) in self.layout.state_entries.iter().zip(states) {
            self.now.memory.system.set_number(*entry, *state);
        }
        self.outputs_current = false;
        Ok(())
    }

    /// The continuous states.
    ///
    /// # Errors
    /// Room for another number of them; parameters that give nothing that can be simulated.
    pub(crate) fn continuous_states(&mut self, states: &mut [f64]) -> CallResult<()> {
        self.check_states("states", states.len())?;
        self.unit
            .prepared(&self.now.resources, &mut self.now.memory)?;
        for (state, entry) in states.iter_mut().zip(&self.layout.state_entries) {
            *state = self.now.memory.system.number(*entry);
        }
        Ok(())
    }

    /// Their rates, per second.
    ///
    /// # Errors
    /// Room for another number of them; rates that cannot be computed.
    pub(crate) fn state_rates(&mut self, rates: &mut [f64]) -> CallResult<()> {
        self.check_states("derivatives", rates.len())?;
        let now = &mut self.now;
        let unit = self.unit.prepared(&now.resources, &mut now.memory)?;
        unit.state_rates(&now.memory, rates)
    }

    /// Their usual sizes.
    ///
    /// # Errors
    /// Room for another number of them.
    pub(crate) fn state_nominals(&self, nominals: &mut [f64]) -> CallResult<()> {
        self.check_states("nominals", nominals.len())?;
        let variables = self.table().variables();
        for (nominal, rate) in nominals.iter_mut().zip(&self.layout.state_rates) {
            let state = variables[*rate].derivative_of;
            *nominal = state.and_then(|s| variables[s].nominal).unwrap_or(1.0);
        }
        Ok(())
    }

    /// The importer has taken a step: says what must be known of it.
    ///
    /// # Errors
    /// A step that the inputs do not allow.
    pub(crate) fn step_taken(&mut self) -> CallResult<()> {
        self.unit.watch(&mut self.now);
        self.unit.step_taken(&mut self.now)
    }

    /// Rate of the state to which the variable at `index` belongs.
    pub(super) fn rate_at(&mut self, index: usize) -> CallResult<f64> {
        let role = self.table().variables()[index].role;
        let unit = self
            .unit
            .prepared(&self.now.resources, &mut self.now.memory)?;
        if let Role::FilterRate(i) = role
            && let Some(rate) = unit.filter_rate(&self.now.memory, i)
            && rate.is_finite()
        {
            return Ok(rate);
        }
        let mut rates = std::mem::take(&mut self.rates);
        rates.resize(self.layout.state_rates.len(), 0.0);
        let found = self.state_rates(&mut rates);
        let entry = self.layout.state_rates.iter().position(|p| *p == index);
        let rate = entry.map_or(0.0, |entry| rates[entry]);
        self.rates = rates;
        found.map(|()| rate)
    }

    fn check_states(&self, what: &str, found: usize) -> CallResult<()> {
        let expected = self.layout.state_rates.len();
        if found == expected {
            return Ok(());
        }
        Err(Refusal::error(format!(
            "{what}: expected {expected} numbers, found {found}"
        )))
    }
}
