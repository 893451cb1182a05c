//! Columns of numbers in files as lists, for `#[serde(with = "…")]`.

use nalgebra::DVector;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

pub(super) fn serialize<S: Serializer>(v: &DVector<f64>, to: S) -> Result<S::Ok, S::Error> {
    v.as_slice().serialize(to)
}

pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<DVector<f64>, D::Error> {
    Vec::deserialize(from).map(DVector::from_vec)
}
