//! JSON files, with errors that name line and column.

use crate::input::InputError;
use serde::de::DeserializeOwned;
use std::path::Path;

/// Parses a JSON file.
pub(super) fn parse<T: DeserializeOwned>(file: &Path, text: &[u8]) -> Result<T, InputError> {
    serde_json::from_slice(text).map_err(|error| InputError::Syntax {
        file: file.to_owned(),
        line: error.line(),
        column: error.column(),
        message: error.to_string(),
    })
}
