//! What ties binary, description and model together: one digest over all three.

use super::variables::{Variable, VariableTable};
use uuid::Uuid;

/// Version of the interface between archive and runtime: raised when an old archive must not meet a new binary.
pub const INTERFACE_VERSION: u32 = 1;

/// `modelIdentifier`: the name of the shared library and of the functions' owner.
pub const MODEL_IDENTIFIER: &str = "aerodeck_section";

/// Namespace of the digests of this program.
const NAMESPACE: Uuid = Uuid::from_u128(0x6f1d_9c52_77a4_5b0e_9f3a_2d84_c1e6_40b7);

/// The identity of an exported section: UUID version 5 of interface version, variable table and the bytes of the
/// files in `resources/`.
///
/// The runtime computes it anew from what it finds in the archive, so that a description, a binary and a model of
/// different exports are never mixed.
pub fn guid(table: &VariableTable, files: &[&[u8]]) -> Uuid {
    let mut text = format!("interface {INTERFACE_VERSION}\n");
    for (reference, variable) in table.variables().iter().enumerate() {
        text.push_str(&line(reference, variable));
    }
    let mut bytes = text.into_bytes();
    for file in files {
        bytes.extend_from_slice(file);
    }
    Uuid::new_v5(&NAMESPACE, &bytes)
}

/// Everything of a variable that the importer relies on; numbers by their bits.
fn line(reference: usize, v: &Variable) -> String {
    let bits = |x: Option<f64>| x.map(f64::to_bits);
    let value = match &v.value {
        super::variables::Value::Real(start) => format!("Real {:?}", bits(*start)),
        other => format!("{other:?}"),
    };
    format!(
        "{reference} {} {:?} {:?} {:?} {value} {:?} {:?} {:?} {:?} {:?}\n",
        v.name,
        v.causality,
        v.variability,
        v.initial,
        v.unit.map(|u| u.name),
        bits(v.min),
        bits(v.max),
        v.direct_inputs,
        v.initial_dependencies,
    )
}
