//! [`Value`]: the value of a key, of any type.

use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};

use crate::shown::shown;

/// A value as it is written. It is checked where its key is known.
#[derive(Debug)]
pub(super) enum Value {
    Whole(i64),
    Number(f64),
    Truth(bool),
    Text(String),
    /// Its numbers, and a description of the first other element, if any.
    List(Vec<f64>, Option<String>),
    Table,
    /// A date, a time, or both; no key accepts them.
    Date,
}

/// The only key of the table as which serde represents a date.
pub(super) const DATE: &str = "$__toml_private_datetime";

impl Value {
    /// A description of the value, as the end of "width is …".
    pub(super) fn said(&self) -> String {
        match self {
            Self::Whole(whole) => whole.to_string(),
            Self::Number(number) => said(*number),
            Self::Truth(truth) => truth.to_string(),
            Self::Text(text) => format!("the text \"{}\"", shown(text)),
            Self::List(..) => "a list".into(),
            Self::Table => "a table".into(),
            Self::Date => "a date or time".into(),
        }
    }

    pub(super) fn number(&self) -> Option<f64> {
        match self {
            Self::Whole(whole) => Some(*whole as f64),
            Self::Number(number) => Some(*number),
            _ => None,
        }
    }
}

/// A number as people write it.
pub(super) fn said(number: f64) -> String {
    if number == 0.0 || !number.is_finite() || (1e-5..1e15).contains(&number.abs()) {
        number.to_string()
    } else {
        format!("{number:e}")
    }
}

impl<'de> Deserialize<'de> for Value {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(AnyValue)
    }
}

struct AnyValue;

impl<'de> Visitor<'de> for AnyValue {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value")
    }

    fn visit_bool<E>(self, truth: bool) -> Result<Value, E> {
        Ok(Value::Truth(truth))
    }

    fn visit_i64<E>(self, whole: i64) -> Result<Value, E> {
        Ok(Value::Whole(whole))
    }

    fn visit_i128<E>(self, whole: i128) -> Result<Value, E> {
        Ok(Value::Number(whole as f64))
    }

    fn visit_u64<E>(self, whole: u64) -> Result<Value, E> {
        Ok(Value::Number(whole as f64))
    }

    fn visit_u128<E>(self, whole: u128) -> Result<Value, E> {
        Ok(Value::Number(whole as f64))
    }

    fn visit_f64<E>(self, number: f64) -> Result<Value, E> {
        Ok(Value::Number(number))
    }

    fn visit_str<E>(self, text: &str) -> Result<Value, E> {
        Ok(Value::Text(text.into()))
    }

    fn visit_string<E>(self, text: String) -> Result<Value, E> {
        Ok(Value::Text(text))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Value, A::Error> {
        let (mut numbers, mut other) = (Vec::new(), None);
        while let Some(value) = list.next_element::<Value>()? {
            match value.number() {
                Some(number) => numbers.push(number),
                None => other = other.or(Some(value.said())),
            }
        }
        Ok(Value::List(numbers, other))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut table: A) -> Result<Value, A::Error> {
        let mut value = Value::Table;
        while let Some((key, IgnoredAny)) = table.next_entry::<String, IgnoredAny>()? {
            if key == DATE {
                value = Value::Date;
            }
        }
        Ok(value)
    }
}
