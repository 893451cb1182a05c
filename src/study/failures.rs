//! Stages that fail without taking the others with them.

use crate::error::{Error, Result};
use crate::verdict::StageFailure;

/// Whether an error is one of a file, to be mended before anything else is of use: it cannot be read or written, or what
/// stands in it is wrong.
pub(crate) fn is_of_a_file(error: &Error) -> bool {
    match error {
        Error::Io { .. } => true,
        Error::Input(input) => input.file.is_some(),
        Error::Several(errors) => errors.iter().any(is_of_a_file),
        Error::Numerical(_) | Error::NotDistinct(_) | Error::Unstable(_) => false,
    }
}

/// The value of a stage; a failure is noted in `failed`.
pub(crate) fn attempt<T>(
    failed: &mut Vec<StageFailure>,
    stage: impl Into<String>,
    result: Result<T>,
) -> Result<Option<T>> {
    match result {
        Ok(value) => Ok(Some(value)),
        Err(e) if is_of_a_file(&e) => Err(e),
        Err(e) => {
            failed.push(StageFailure::new(stage, e));
            Ok(None)
        }
    }
}
