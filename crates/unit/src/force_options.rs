//! What makes an exported unit one of forces alone: its strips, and where their forces act.

use crate::aerodynamics::{GustForce, Realizable};
use crate::error::{Error, Result, counted, ensure, non_negative, positive};
use crate::trained_model::TrainedModel;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// The file of the options in `resources/`; an archive without it holds a coupled section.
pub const FORCE_FILE: &str = "force.json";
/// Strips at most: a bridge of ten kilometres in strips of a metre.
pub const MAX_STRIPS: usize = 10_000;
/// Communication steps from the motion that the unit was given last to the middle of the step over which an explicit
/// (Jacobi) importer holds the force: one until the force is read, half of the step for which it is held.
pub(crate) const EXPLICIT_PREDICTION: f64 = 1.5;
/// Largest prediction, in communication steps.
pub(crate) const MAX_PREDICTION: f64 = 3.0;

/// A strip of deck.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StripOptions {
    /// Width `B`, m.
    pub width_m: f64,
    /// Length of span, m.
    pub length_m: f64,
    /// Wind speed at the strip over the input `wind_speed`.
    pub wind_factor: f64,
    /// Whose forces act on it: 0 for those of the model of the archive, 1 for the first of [`ForceOptions::further`], and so on.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub model: usize,
}

#[allow(clippy::trivially_copy_pass_by_ref)] // as serde asks
fn is_zero(model: &usize) -> bool {
    *model == 0
}

/// A further force model of a unit whose strips do not all have the same: that of another section of a bridge.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FurtherModel {
    /// The model.
    pub model: TrainedModel,
    /// Forces of gusts on its strips, where the unit takes gusts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gusts: Option<GustForce>,
}

/// Strips that lie side by side under the forces of one model.
#[derive(Debug, Clone)]
pub struct StripsOfModel<'a> {
    /// The model.
    pub model: &'a TrainedModel,
    /// Forces of gusts on them.
    pub gusts: Option<&'a GustForce>,
    /// Among all strips.
    pub strips: Range<usize>,
    /// Filters of each strip.
    pub filters: usize,
    /// Lagging gusts of each strip.
    pub lags: usize,
}

impl StripsOfModel<'_> {
    /// Filters and lagging gusts of each strip.
    pub fn inner(&self) -> usize {
        self.filters + self.lags
    }
}

/// The options of a unit of forces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceOptions {
    /// The strips, one at least; those of one model after those of another.
    pub strips: Vec<StripOptions>,
    /// Models of strips whose forces are not those of the model of the archive.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub further: Vec<FurtherModel>,
    /// Whether variables are named by strip (`strip[1].heave`); a single strip may go without (`heave`).
    pub named_strips: bool,
    /// Numbers of the nodes of a bridge in whose places the strips are: their variables are named by them
    /// (`node[1076].heave`). None where strips are counted.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub nodes: Vec<u32>,
    /// Start value of `prediction`, communication steps.
    pub prediction_steps: f64,
}

impl ForceOptions {
    /// One strip of a metre for an explicit importer.
    pub fn single(width_m: f64) -> Self {
        Self {
            strips: vec![StripOptions {
                width_m,
                length_m: 1.0,
                wind_factor: 1.0,
                model: 0,
            }],
            further: Vec::new(),
            named_strips: false,
            nodes: Vec::new(),
            prediction_steps: EXPLICIT_PREDICTION,
        }
    }

    /// The strips of each model, in the order of the strips: of the archive's, with its forces of gusts, then of the further ones.
    pub fn parts<'a>(
        &'a self,
        model: &'a TrainedModel,
        gusts: Option<&'a GustForce>,
    ) -> Vec<StripsOfModel<'a>> {
        let further = self.further.iter().map(|f| (&f.model, f.gusts.as_ref()));
        let all = std::iter::once((model, gusts)).chain(further).enumerate();
        let from = |k: usize| self.strips.partition_point(|s| s.model < k);
        all.map(|(k, (model, gusts))| StripsOfModel {
            strips: from(k)..from(k + 1),
            filters: model.model.realize().states(),
            lags: gusts.map_or(0, GustForce::states),
            model,
            gusts,
        })
        .collect()
    }

    /// Strips of several models are those of nodes of a bridge, one model after another, and each model has some.
    fn check_models(&self) -> Result<()> {
        let models: Vec<usize> = self.strips.iter().map(|s| s.model).collect();
        let mut used = models.clone();
        used.dedup();
        ensure(
            used.iter().copied().eq(0..=self.further.len()),
            "strips: model",
            format_args!(
                "strips of {}, those of one after those of another",
                counted(self.further.len() + 1, "model")
            ),
            format_args!("{used:?}"),
        )?;
        let named = self.further.is_empty() || !self.nodes.is_empty();
        let expected = "the nodes of a bridge for strips of several models";
        ensure(named, "nodes", expected, "none")?;
        self.further.iter().try_for_each(|f| f.model.validate())
    }

    /// Checks the options.
    ///
    /// # Errors
    /// [`Error::Input`] for no strip or too many, several without names, a width or length that is not positive, a
    /// negative wind factor, a prediction outside 0 to 3; for models without strips, or whose strips lie between those of another.
    pub fn validate(&self) -> Result<()> {
        let count = self.strips.len();
        let in_range = (1..=MAX_STRIPS).contains(&count);
        ensure(in_range, "strips", format_args!("1 to {MAX_STRIPS}"), count)?;
        let found = format_args!("{count} without");
        let named = count == 1 || self.named_strips;
        ensure(named, "strips", "names for more than one", found)?;
        self.check_models()?;
        let mut nodes = self.nodes.clone();
        nodes.sort_unstable();
        nodes.dedup();
        let each = self.nodes.is_empty() || (nodes.len() == count && self.named_strips);
        let found = format_args!("{} of {}", nodes.len(), counted(count, "strip"));
        ensure(each, "nodes", "a node of its own for each strip", found)?;
        for (i, strip) in self.strips.iter().enumerate() {
            let place = |key: &str| format!("strip {}: {key}", i + 1);
            positive(place("width"), strip.width_m)?;
            positive(place("length"), strip.length_m)?;
            non_negative(place("wind factor"), strip.wind_factor)?;
        }
        let prediction = self.prediction_steps;
        ensure(
            (0.0..=MAX_PREDICTION).contains(&prediction),
            "prediction",
            format_args!("0 to {MAX_PREDICTION} communication steps"),
            prediction,
        )
    }

    /// Reads and checks the options.
    ///
    /// # Errors
    /// [`Error::Input`] for text that is not such a file, and for strips or a prediction that cannot be.
    pub fn from_json(text: &str) -> Result<Self> {
        let options: Self = serde_json::from_str(text)
            .map_err(|e| Error::json("options of a unit of forces", &e))?;
        options.validate()?;
        Ok(options)
    }

    /// The options as JSON.
    ///
    /// # Errors
    /// [`Error::Input`] for strips or a prediction that cannot be.
    pub fn to_json(&self) -> Result<String> {
        self.validate()?;
        serde_json::to_string_pretty(self).map_err(|e| Error::Numerical(e.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_options_are_named() {
        let with = |change: fn(&mut ForceOptions)| {
            let mut options = ForceOptions::single(31.0);
            change(&mut options);
            options.validate().map_err(|e| e.to_string())
        };
        assert_eq!(with(|_| ()), Ok(()));
        type Change = fn(&mut ForceOptions);
        let refused: [(Change, &str); 6] = [
            (|o| o.strips.clear(), "strips: expected 1 to 10000, found 0"),
            (
                |o| o.strips.push(o.strips[0].clone()),
                "strips: expected names for more than one",
            ),
            (|o| o.strips[0].width_m = 0.0, "strip 1: width: expected"),
            (|o| o.strips[0].length_m = -1.0, "strip 1: length: expected"),
            (
                |o| o.strips[0].wind_factor = f64::NAN,
                "strip 1: wind factor",
            ),
            (
                |o| o.prediction_steps = 3.1,
                "prediction: expected 0 to 3 communication steps, found 3.1",
            ),
        ];
        for (change, message) in refused {
            let found = with(change).unwrap_err();
            assert!(found.starts_with(message), "{found}");
        }
    }

    #[test]
    fn options_survive_their_file() {
        let options = ForceOptions::single(0.5);
        let text = options.to_json().unwrap();
        assert_eq!(ForceOptions::from_json(&text).unwrap(), options);
        let message = ForceOptions::from_json("{\"strips\": 3}").unwrap_err();
        assert!(message.to_string().starts_with("line 1, column"));
    }
}
