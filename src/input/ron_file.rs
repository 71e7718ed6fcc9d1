//! RON files: parsing with positions in errors, and fields of special shapes.

use super::error::InputError;
use ron::extensions::Extensions;
use serde::Deserialize;
use serde::de::{DeserializeOwned, Deserializer, Error, MapAccess, Visitor};
use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;
use std::path::Path;

/// Parses a RON file. `Some(...)` and the inner brackets of a newtype variant may be left out.
pub(crate) fn parse<T: DeserializeOwned>(file: &Path, bytes: &[u8]) -> Result<T, InputError> {
    let extensions = Extensions::IMPLICIT_SOME | Extensions::UNWRAP_VARIANT_NEWTYPES;
    let options = ron::Options::default().with_default_extension(extensions);
    let fault = |line, column, message| InputError::Syntax {
        file: file.to_owned(),
        line,
        column,
        message,
    };
    let text = str::from_utf8(bytes).map_err(|error| {
        let before = String::from_utf8_lossy(&bytes[..error.valid_up_to()]);
        let last = before.rsplit('\n').next().unwrap_or_default();
        let message = "not valid UTF-8; save the file as UTF-8".to_owned();
        fault(
            before.split('\n').count(),
            last.chars().count() + 1,
            message,
        )
    })?;
    options
        .from_str(text.trim_start_matches('\u{feff}'))
        .map_err(|error| {
            let start = error.span.start;
            fault(start.line, start.col, error.code.to_string())
        })
}

/// Deserialises a map in which no key may occur twice.
pub(crate) fn unique_keys<'de, D, T>(deserializer: D) -> Result<BTreeMap<String, T>, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
{
    struct Unique<T>(PhantomData<T>);

    impl<'de, T: Deserialize<'de>> Visitor<'de> for Unique<T> {
        type Value = BTreeMap<String, T>;

        fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
            f.write_str("a map from names")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut access: A) -> Result<Self::Value, A::Error> {
            let mut map = BTreeMap::new();
            while let Some((key, value)) = access.next_entry::<String, T>()? {
                if map.contains_key(&key) {
                    let message = format!("the name \"{key}\" is used twice; rename one of them");
                    return Err(A::Error::custom(message));
                }
                map.insert(key, value);
            }
            Ok(map)
        }
    }

    deserializer.deserialize_map(Unique(PhantomData))
}

/// Deserialises a list of exactly three.
pub(crate) fn three<'de, D, T>(deserializer: D) -> Result<[T; 3], D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
{
    <[T; 3]>::try_from(Vec::deserialize(deserializer)?).map_err(|list: Vec<T>| {
        D::Error::custom(format!(
            "a triangle's list has 3 entries, not {}",
            list.len()
        ))
    })
}

/// Deserialises a list of exactly three that may be left out.
pub(crate) fn maybe_three<'de, D, T>(deserializer: D) -> Result<Option<[T; 3]>, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
{
    three(deserializer).map(Some)
}
