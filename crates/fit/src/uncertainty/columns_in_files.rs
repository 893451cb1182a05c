//! Columns in files, for `#[serde(with = "…")]`.

/// A column of numbers as a list.
pub(super) mod numbers {
    use nalgebra::DVector;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(in crate::uncertainty) fn serialize<S: Serializer>(
        v: &DVector<f64>,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        v.as_slice().serialize(to)
    }

    pub(in crate::uncertainty) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<DVector<f64>, D::Error> {
        Vec::deserialize(from).map(DVector::from_vec)
    }
}
