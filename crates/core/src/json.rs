//! JSON that says what it is: its first key, `format`, is `aerodeck/KIND VERSION`.

use crate::error::{Error, Result};
use serde::de::value::MapAccessDeserializer;
use serde::de::{DeserializeSeed, Error as _, IntoDeserializer, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;
use std::marker::PhantomData;

/// The key that says what a file or an answer is.
pub const KEY: &str = "format";

/// What that key says of a `kind` in its first layout; the files of models number theirs by `schema_version`.
///
/// ```
/// assert_eq!(aerodeck_core::json::format("model"), "aerodeck/model 1");
/// ```
pub fn format(kind: &str) -> String {
    format!("aerodeck/{kind} 1")
}

/// Indented JSON of an object, beginning with what it is.
///
/// ```
/// use aerodeck_core::json;
/// let text = json::write("pair", &std::collections::BTreeMap::from([("a", 1)]))?;
/// assert_eq!(text, "{\n  \"format\": \"aerodeck/pair 1\",\n  \"a\": 1\n}\n");
/// # aerodeck_core::Result::Ok(())
/// ```
///
/// # Errors
/// [`Error::Numerical`] for a value that is no object or cannot be written as JSON.
pub fn write(kind: &str, value: &impl Serialize) -> Result<String> {
    let text = serde_json::to_string_pretty(value).map_err(|e| Error::Numerical(e.to_string()))?;
    let rest = text.strip_prefix('{');
    let rest = rest.ok_or_else(|| Error::Numerical(format!("{kind}: no object of JSON")))?;
    let comma = if rest == "}" { "\n" } else { "," };
    Ok(format!(
        "{{\n  \"{KEY}\": \"{}\"{comma}{rest}\n",
        format(kind)
    ))
}

/// Reads an object of a kind, also after a byte-order mark; one that does not say what it is is taken for it.
///
/// ```
/// use std::collections::BTreeMap;
/// let read = |text| aerodeck_core::json::read::<BTreeMap<String, f64>>("pair", text);
/// assert_eq!(read("{ \"format\": \"aerodeck/pair 1\", \"a\": 2.5 }").unwrap(), read("{ \"a\": 2.5 }").unwrap());
/// let refused = read("{ \"format\": \"aerodeck/model 1\" }").unwrap_err().to_string();
/// assert_eq!(refused, "JSON of the format `aerodeck/model 1`, not `aerodeck/pair 1` at line 1 column 32");
/// assert!(read("{ \"format\": \"aerodeck/pair 2\", \"a\": 2.5 }").is_err());
/// assert!(read("\u{feff}{ \"a\": 2.5 }").is_ok());
/// ```
///
/// # Errors
/// Those of [`serde_json::from_str`], and one for another kind or version.
pub fn read<T: for<'de> Deserialize<'de>>(
    kind: &str,
    text: &str,
) -> std::result::Result<T, serde_json::Error> {
    // editors may leave a byte-order mark
    let text = text.trim_start_matches('\u{feff}');
    let mut source = serde_json::Deserializer::from_str(text);
    let read = source.deserialize_map(OfKind(kind, PhantomData))?;
    source.end().map(|()| read)
}

struct OfKind<'a, T>(&'a str, PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for OfKind<'_, T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, keys: A) -> std::result::Result<T, A::Error> {
        let kind = self.0;
        T::deserialize(MapAccessDeserializer::new(OtherKeys { kind, keys }))
    }
}

/// The keys of an object without the one that says what it is.
struct OtherKeys<'a, A> {
    kind: &'a str,
    keys: A,
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for OtherKeys<'_, A> {
    type Error = A::Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> std::result::Result<Option<K::Value>, A::Error> {
        while let Some(key) = self.keys.next_key::<String>()? {
            if key != KEY {
                return seed.deserialize(key.into_deserializer()).map(Some);
            }
            let found: String = self.keys.next_value()?;
            let own = format(self.kind);
            if found != own {
                let what = format!("JSON of the format `{found}`, not `{own}`");
                return Err(A::Error::custom(what));
            }
        }
        Ok(None)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(
        &mut self,
        seed: V,
    ) -> std::result::Result<V::Value, A::Error> {
        self.keys.next_value_seed(seed)
    }
}
