//! Matrices in files as lists of rows, `[[a, b], [c, d]]`, for `#[serde(with = "…")]`.

use nalgebra::DMatrix;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error as _};

fn to_rows(m: &DMatrix<f64>) -> Vec<Vec<f64>> {
    m.row_iter().map(|r| r.iter().copied().collect()).collect()
}

fn from_rows(rows: &[Vec<f64>]) -> Result<DMatrix<f64>, String> {
    let columns = rows.first().map_or(0, Vec::len);
    if let Some(row) = rows.iter().find(|r| r.len() != columns) {
        return Err(format!(
            "matrix rows of one length: expected {columns} numbers, found {}",
            row.len()
        ));
    }
    Ok(DMatrix::from_fn(rows.len(), columns, |i, j| rows[i][j]))
}

/// Writes a matrix as rows.
pub fn serialize<S: Serializer>(m: &DMatrix<f64>, s: S) -> Result<S::Ok, S::Error> {
    to_rows(m).serialize(s)
}

/// Reads a matrix from rows of one length.
pub fn deserialize<'de, D: Deserializer<'de>>(d: D) -> Result<DMatrix<f64>, D::Error> {
    from_rows(&Vec::<Vec<f64>>::deserialize(d)?).map_err(D::Error::custom)
}

/// The same for a list of matrices.
pub mod list {
    use super::{DMatrix, Deserialize, Deserializer, Serialize, Serializer, from_rows, to_rows};
    use serde::de::Error as _;

    /// Writes a list of matrices.
    pub fn serialize<S: Serializer>(list: &[DMatrix<f64>], s: S) -> Result<S::Ok, S::Error> {
        list.iter().map(to_rows).collect::<Vec<_>>().serialize(s)
    }

    /// Reads a list of matrices.
    pub fn deserialize<'de, D: Deserializer<'de>>(d: D) -> Result<Vec<DMatrix<f64>>, D::Error> {
        Vec::<Vec<Vec<f64>>>::deserialize(d)?
            .iter()
            .map(|rows| from_rows(rows).map_err(D::Error::custom))
            .collect()
    }
}
