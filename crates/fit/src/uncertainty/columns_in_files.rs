//! Columns and matrices that may be missing, for `#[serde(with = "…")]`.

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

/// A matrix, or none, as a list of at most one.
pub(super) mod perhaps_rows {
    use crate::state_space::rows::list;
    use nalgebra::DMatrix;
    use serde::{Deserializer, Serializer};

    pub(in crate::uncertainty) fn serialize<S: Serializer>(
        m: &Option<DMatrix<f64>>,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        let all: Vec<DMatrix<f64>> = m.iter().cloned().collect();
        list::serialize(&all, to)
    }

    pub(in crate::uncertainty) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Option<DMatrix<f64>>, D::Error> {
        list::deserialize(from).map(|mut all| all.pop())
    }
}
