//! The number of strips, which importers may choose in the configuration mode, and which number depends on which.
// the contract of all functions is that of the parent module
#![allow(non_snake_case, clippy::missing_safety_doc)]

use crate::fmi2::guard::{Component, array, array_mut, exported, target};
use crate::fmi2::types::fmi2ValueReference;
use crate::lifecycle::{Call, State};
use crate::refusal::{CallResult, Refusal};
use crate::variables::DependencyKind;

/// A kind of dependency in the words of the interface.
fn fmi3_kind(kind: DependencyKind) -> i32 {
    match kind {
        DependencyKind::Constant => 1,
        DependencyKind::Tunable => 3,
        DependencyKind::Dependent => 5,
    }
}

exported! {
    /// Begins the choice of the number of strips.
    fmi3EnterConfigurationMode() Call::SetupExperiment => |c| {
        let Some(strips) = c.groups.strips() else {
            return Err(Refusal::call("there are no structural parameters"));
        };
        c.configuration = Some(strips);
        Ok(())
    };
    /// Ends it: the unit has as many strips from now on, each of those beyond the exported ones like the last of these. What has been set
    /// before stays where there still is such a variable.
    fmi3ExitConfigurationMode() Call::SetupExperiment => |c| {
        let Some(strips) = c.configuration.take() else {
            return Err(Refusal::call("the configuration mode was not entered"));
        };
        if c.groups.strips() != Some(strips) {
            let resized = c.instance.resized(Some(strips))?;
            c.replace(resized);
        }
        Ok(())
    };
}

/// Refuses references that are not the number of strips.
fn check_strips(c: &Component, references: &[fmi2ValueReference]) -> CallResult<usize> {
    let own = c.groups.strips().zip(c.groups.strips_reference());
    let wrong = |r: &&fmi2ValueReference| own.is_none_or(|(_, own)| own != **r);
    match (references.iter().find(wrong), own) {
        (None, own) => Ok(own.map_or(0, |(strips, _)| strips)),
        (Some(wrong), _) => Err(Refusal::error(format!(
            "value reference {wrong}: there is no such variable of this type"
        ))),
    }
}

exported! {
    /// Reads the number of strips.
    fmi3GetUInt64(
        vr: *const fmi2ValueReference, nvr: usize, values: *mut u64, nValues: usize
    ) Call::GetInteger => |c| {
        let present = check_strips(c, array(vr, nvr, "valueReferences")?)?;
        super::life::check_count("values", nvr, nValues)?;
        let strips = c.configuration.unwrap_or(present) as u64;
        array_mut(values, nValues, "values")?.fill(strips);
        Ok(())
    };
    /// Sets the number of strips, in the configuration mode.
    fmi3SetUInt64(
        vr: *const fmi2ValueReference, nvr: usize, values: *const u64, nValues: usize
    ) Call::SetInteger => |c| {
        check_strips(c, array(vr, nvr, "valueReferences")?)?;
        super::life::check_count("values", nvr, nValues)?;
        for value in array(values, nValues, "values")? {
            if c.configuration.is_none() {
                let message = "strips: may be set in the configuration mode only";
                return Err(Refusal::error(message));
            }
            let most = crate::force_options::MAX_STRIPS;
            let strips = usize::try_from(*value).ok();
            let Some(strips) = strips.filter(|n| (1..=most).contains(n)) else {
                let message = format!("strips: expected 1 to {most}, found {value}");
                return Err(Refusal::discard(message));
            };
            c.configuration = Some(strips);
        }
        Ok(())
    };
}

/// What the numbers of a variable depend on, each by its element, the value reference of the other and its element: while initialising on
/// what has been set for it, later on inputs and states at once.
fn dependencies(
    c: &mut Component,
    reference: u32,
) -> CallResult<Vec<(usize, u32, usize, DependencyKind)>> {
    let Some(indices) = c.groups.all().get(reference as usize) else {
        return match c.groups.is_known(reference) {
            true => Ok(Vec::new()),
            false => Err(Refusal::call(format!(
                "value reference {reference}: there is no such variable"
            ))),
        };
    };
    let initial = matches!(
        c.instance.state(),
        State::Instantiated | State::Initialization
    );
    let table = c.instance.described_table()?;
    let mut all = Vec::new();
    for (i, own) in indices.iter().enumerate() {
        let v = &table.variables()[*own as usize];
        let on = match initial {
            true => &v.initial_dependencies,
            false => &v.direct_inputs,
        };
        all.extend(on.iter().filter_map(|dependency| {
            let (reference, element) = c.groups.element_of(dependency.on)?;
            Some((i + 1, reference, element + 1, dependency.kind))
        }));
    }
    Ok(all)
}

exported! {
    /// How many there are, of all its numbers.
    fmi3GetNumberOfVariableDependencies(
        vr: fmi2ValueReference, nDependencies: *mut usize
    ) Call::SetDebugLogging => |c| {
        *target(nDependencies, "nDependencies")? = dependencies(c, vr)?.len();
        Ok(())
    };
    /// Which they are: indices of elements count from one.
    fmi3GetVariableDependencies(
        dependent: fmi2ValueReference, elementIndicesOfDependent: *mut usize,
        independents: *mut fmi2ValueReference, elementIndicesOfIndependents: *mut usize,
        dependencyKinds: *mut i32, nDependencies: usize
    ) Call::SetDebugLogging => |c| {
        let all = dependencies(c, dependent)?;
        super::life::check_count("nDependencies", all.len(), nDependencies)?;
        let n = nDependencies;
        let own = array_mut(elementIndicesOfDependent, n, "elementIndicesOfDependent")?;
        let on = array_mut(independents, n, "independents")?;
        let of = elementIndicesOfIndependents;
        let elements = array_mut(of, n, "elementIndicesOfIndependents")?;
        let kinds = array_mut(dependencyKinds, n, "dependencyKinds")?;
        for (i, (dependent, reference, element, kind)) in all.into_iter().enumerate() {
            (own[i], on[i]) = (dependent, reference);
            (elements[i], kinds[i]) = (element, fmi3_kind(kind));
        }
        Ok(())
    };
}
