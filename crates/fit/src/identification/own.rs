//! Transfer functions with filters of their own, and the static term: options that every fit has.
//!
//! "A different set of parameters for the identification of each transfer function" (thesis, chapter 5): the number of
//! filters and their poles or decay factor may differ from one transfer function to the other.

use super::basis::index_of;
use super::form::{Form, PoleSearch};
use crate::error::{Error, Result, counted, ensure};
use crate::section::Dof;
use serde::{Deserialize, Serialize};

/// What a fit to records does about the part of a force that does not follow the motion (`h₀` of 2.23).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StaticTerm {
    /// Nothing: the forces have no mean.
    #[default]
    None,
    /// One dimensionless constant per force is estimated along with the coefficients, common to all records: a steady wind
    /// load grows with `V²` like the other forces.
    Estimated,
    /// The mean of each force over each record is subtracted first (thesis, section 3.3): whatever offset a record has, but
    /// also the mean of what the motion causes.
    Removed,
}

/// Continuous filters of one transfer function in place of those that the others share.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OwnFilters {
    /// Force (row of `G`).
    pub force: Dof,
    /// Motion (column of `G`).
    pub motion: Dof,
    /// Number of filters; left out, that of the form.
    pub filters: Option<usize>,
    /// Poles as in [`PoleSearch::fixed`]; left out, they are searched for this transfer function alone.
    pub poles: Option<Vec<f64>>,
}

/// Discrete filters of one transfer function in place of those that the others share.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OwnDecay {
    /// Force (row of `G`).
    pub force: Dof,
    /// Motion (column of `G`).
    pub motion: Dof,
    /// Number of filters; left out, that of the fit.
    pub filters: Option<usize>,
    /// Decay factor, `0 < α < 1`; left out, that of the fit.
    pub alpha: Option<f64>,
}

/// The form and poles of one transfer function.
#[derive(Debug, Clone)]
pub(crate) struct EntryForm {
    pub form: Form,
    /// Free poles that are not searched.
    pub fixed: Option<Vec<f64>>,
    /// Whether its poles are searched for it alone.
    pub alone: bool,
}

/// How many transfer functions have filters of their own, in words.
pub(crate) fn describe_own(count: usize) -> String {
    match count {
        0 => String::new(),
        n => format!(
            ", filters of their own for {}",
            counted(n, "transfer function")
        ),
    }
}

/// Refuses the same transfer function twice.
pub(crate) fn each_once(named: impl Iterator<Item = (Dof, Dof)>) -> Result<()> {
    let mut seen = Vec::new();
    for (force, motion) in named {
        let (row, column) = (force.name(), motion.name());
        ensure(
            !seen.contains(&(force, motion)),
            "own",
            "every transfer function at most once",
            format_args!("{row} force due to {column} motion twice"),
        )?;
        seen.push((force, motion));
    }
    Ok(())
}

/// Place of a named transfer function among `dofs`, row by row.
pub(crate) fn place_of(dofs: &[Dof], force: Dof, motion: Dof) -> Result<usize> {
    let i = index_of(dofs, force, "own.force")?;
    Ok(i * dofs.len() + index_of(dofs, motion, "own.motion")?)
}

/// Checks what can be checked without the data.
pub(crate) fn validate_own(form: &Form, own: &[OwnFilters]) -> Result<()> {
    each_once(own.iter().map(|o| (o.force, o.motion)))?;
    for one in own {
        let (form, fixed) = (one.form(form)?, one.poles.clone());
        let search = PoleSearch {
            fixed,
            ..PoleSearch::default()
        };
        form.validate()?;
        search.validate(&form)?;
    }
    Ok(())
}

impl OwnFilters {
    fn form(&self, shared: &Form) -> Result<Form> {
        let count = self.filters.unwrap_or(shared.filters());
        shared.with_filters(count).ok_or_else(|| {
            Error::input(
                "own",
                "filters (`laguerre` or `takenaka_malmquist`)",
                "rational functions, whose lags are common to all transfer functions",
            )
        })
    }
}

/// Form and poles of every transfer function, row by row.
///
/// # Errors
/// [`Error::Input`] for degrees of freedom that the data do not have.
pub(crate) fn entry_forms(
    dofs: &[Dof],
    form: &Form,
    poles: &PoleSearch,
    own: &[OwnFilters],
) -> Result<Vec<EntryForm>> {
    let shared = EntryForm {
        form: form.clone(),
        fixed: poles.fixed.clone(),
        alone: form.pole_per_transfer_function(),
    };
    let mut all = vec![shared; dofs.len() * dofs.len()];
    for one in own {
        all[place_of(dofs, one.force, one.motion)?] = EntryForm {
            form: one.form(form)?,
            fixed: one.poles.clone(),
            alone: true,
        };
    }
    Ok(all)
}

/// Transfer functions whose poles are searched together: those that share theirs, and each of the others alone.
pub(crate) fn searched_together(entries: &[EntryForm]) -> Vec<Vec<usize>> {
    let searched = (0..entries.len()).filter(|e| entries[*e].fixed.is_none());
    let (alone, together): (Vec<usize>, Vec<usize>) = searched.partition(|e| entries[*e].alone);
    let mut groups = vec![together];
    groups.extend(alone.into_iter().map(|e| vec![e]));
    groups.retain(|g| !g.is_empty());
    groups
}

/// Options of a search for a form of another number of poles: a start for the shared ones says nothing about them.
pub(crate) fn search_for(poles: &PoleSearch, form: &Form) -> PoleSearch {
    let start = poles.start.clone();
    PoleSearch {
        start: start.filter(|s| s.len() == form.free_poles()),
        ..poles.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn own(force: Dof, motion: Dof, filters: Option<usize>, poles: Option<Vec<f64>>) -> OwnFilters {
        OwnFilters {
            force,
            motion,
            filters,
            poles,
        }
    }

    #[test]
    fn entries_share_unless_they_are_named() {
        let (y, t) = (Dof::Vertical, Dof::Torsion);
        let named = [own(y, y, Some(5), None), own(t, y, None, Some(vec![0.4]))];
        let forms =
            entry_forms(&Dof::TWO, &Form::default(), &PoleSearch::default(), &named).unwrap();
        let filters: Vec<usize> = forms.iter().map(|f| f.form.filters()).collect();
        assert_eq!(filters, [5, 3, 3, 3]);
        assert_eq!(forms[2].fixed, Some(vec![0.4]));
        assert_eq!(searched_together(&forms), [vec![1, 3], vec![0]]);
        let missing = [own(Dof::Lateral, y, None, None)];
        let error = entry_forms(
            &Dof::TWO,
            &Form::default(),
            &PoleSearch::default(),
            &missing,
        );
        assert!(error.unwrap_err().to_string().contains("own.force"));
    }

    #[test]
    fn impossible_filters_are_refused() {
        let (y, t) = (Dof::Vertical, Dof::Torsion);
        let message =
            |form: &Form, named: &[OwnFilters]| validate_own(form, named).unwrap_err().to_string();
        let laguerre = Form::default();
        let twice = [own(y, t, None, None), own(y, t, Some(2), None)];
        assert!(message(&laguerre, &twice).contains("at most once"));
        assert!(message(&laguerre, &[own(y, t, Some(0), None)]).contains("at least 1"));
        for many in [101, 100_000, usize::MAX] {
            assert!(message(&laguerre, &[own(y, t, Some(many), None)]).contains("at most 100"));
        }
        let two = [own(y, t, None, Some(vec![0.2, 0.4]))];
        assert!(message(&laguerre, &two).contains("1 number for"));
        let rational = Form::Rational {
            lags: 1,
            added_mass: true,
        };
        assert!(message(&rational, &[own(y, t, None, None)]).contains("rational functions"));
    }
}
