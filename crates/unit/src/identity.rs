//! What ties binary, description and model together: one digest over all three.

use super::variables::{StartValue, Variable, VariableTable};
use uuid::Uuid;

/// Version of the interface between archive and runtime: raised when an old archive must not meet a new binary.
pub(crate) const INTERFACE_VERSION: u32 = 1;

/// `modelIdentifier`: the name of the shared library and of the functions' owner.
pub const MODEL_IDENTIFIER: &str = "aerodeck_section";

/// Namespace of the digests of this program.
const NAMESPACE: Uuid = Uuid::from_u128(0x6f1d_9c52_77a4_5b0e_9f3a_2d84_c1e6_40b7);

/// The identity of an exported section: UUID version 5 of interface version, variable table and the bytes of the
/// files in `resources/`.
///
/// The runtime computes it anew from what it finds in the archive, so that a description, a binary and a model of
/// different exports are never mixed. It does so for every instance: the digest is taken of bytes, not of text.
pub fn guid(table: &VariableTable, files: &[&[u8]]) -> Uuid {
    let of_files: usize = files.iter().map(|file| file.len()).sum();
    let mut bytes = Vec::with_capacity(of_files + 128 * table.variables().len());
    bytes.extend_from_slice(&INTERFACE_VERSION.to_le_bytes());
    for variable in table.variables() {
        put_variable(&mut bytes, variable);
    }
    for file in files {
        bytes.extend_from_slice(file);
    }
    Uuid::new_v5(&NAMESPACE, &bytes)
}

/// Everything of a variable that the importer relies on, with dependencies where its row states them; numbers by their bits, lists and texts behind their length.
fn put_variable(bytes: &mut Vec<u8>, v: &Variable) {
    put_text(bytes, &v.name);
    let initial = v.initial.map_or(0, |initial| 1 + initial as u8);
    bytes.extend_from_slice(&[v.causality as u8, v.variability as u8, initial]);
    match &v.value {
        StartValue::Real(start) => {
            bytes.push(0);
            put_number(bytes, *start);
        }
        StartValue::Integer(start) => {
            bytes.push(1);
            put_number(bytes, start.map(f64::from));
        }
        StartValue::Boolean(start) => bytes.extend_from_slice(&[2, start.map_or(2, u8::from)]),
        StartValue::String(start) => {
            bytes.push(3);
            put_text(bytes, start);
        }
    }
    put_text(bytes, v.unit.map_or("", |unit| unit.name));
    put_number(bytes, v.min);
    put_number(bytes, v.max);
    for list in [&v.direct_inputs, &v.initial_dependencies] {
        put_count(bytes, list.len());
        for dependency in list {
            put_count(bytes, 3 * dependency.on + dependency.kind as usize);
        }
    }
}

fn put_text(bytes: &mut Vec<u8>, text: &str) {
    put_count(bytes, text.len());
    bytes.extend_from_slice(text.as_bytes());
}

fn put_number(bytes: &mut Vec<u8>, number: Option<f64>) {
    bytes.push(u8::from(number.is_some()));
    if let Some(number) = number {
        bytes.extend_from_slice(&number.to_le_bytes());
    }
}

/// Seven bits a byte, the lowest first; the last byte is below 128.
fn put_count(bytes: &mut Vec<u8>, mut count: usize) {
    while count >= 0x80 {
        bytes.push(count as u8 | 0x80);
        count >>= 7;
    }
    bytes.push(count as u8);
}

#[cfg(test)]
mod tests {
    use super::super::standard::{Causality, Initial, Variability};
    use super::super::variables::{Dependency, Role};
    use super::*;

    fn variable() -> Variable {
        Variable {
            name: "a".into(),
            description: String::new(),
            role: Role::WindSpeed,
            is_listed: true,
            causality: Causality::Input,
            variability: Variability::Continuous,
            initial: None,
            value: StartValue::Real(Some(1.0)),
            unit: None,
            display_unit: None,
            quantity: None,
            min: None,
            max: None,
            nominal: None,
            derivative_of: None,
            direct_inputs: vec![Dependency::plain(3)],
            initial_dependencies: Vec::new(),
        }
    }

    /// Whatever an importer relies on makes another identity, and what stands in one place is not taken for another.
    #[test]
    fn every_part_of_a_variable_counts() {
        let changes: [fn(&mut Variable); 17] = [
            |_| (),
            |v| v.name = "ab".into(),
            |v| v.causality = Causality::Output,
            |v| v.variability = Variability::Discrete,
            |v| v.initial = Some(Initial::Exact),
            |v| v.initial = Some(Initial::Calculated),
            |v| v.value = StartValue::Real(None),
            |v| v.value = StartValue::Real(Some(-1.0)),
            |v| v.value = StartValue::Integer(Some(1)),
            |v| v.value = StartValue::Boolean(Some(true)),
            |v| v.value = StartValue::String("1".into()),
            |v| v.unit = Some(&crate::si::METRE),
            |v| v.min = Some(0.0),
            |v| v.max = Some(0.0),
            |v| v.direct_inputs = [3, 200].map(Dependency::plain).to_vec(),
            |v| v.direct_inputs = vec![Dependency::plain(300)],
            |v| v.direct_inputs = vec![Dependency::constant(3)],
        ];
        let mut variables: Vec<Variable> = changes
            .iter()
            .map(|change| {
                let mut changed = variable();
                change(&mut changed);
                changed
            })
            .collect();
        let all = [
            Dependency::plain(3),
            Dependency::constant(3),
            Dependency::plain(1000),
        ];
        for dependency in all {
            variables.push(Variable {
                initial_dependencies: vec![dependency],
                ..variable()
            });
        }
        let bytes = |v: &Variable| {
            let mut bytes = Vec::new();
            put_variable(&mut bytes, v);
            bytes
        };
        let mut found: Vec<Vec<u8>> = variables.iter().map(bytes).collect();
        found.sort();
        found.dedup();
        assert_eq!(found.len(), variables.len());
    }
}
