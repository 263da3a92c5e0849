//! JSON values that know where they are, so that what is wrong is said with its pointer.

use serde_json::Value;

use crate::error::HouseError;

/// The longest text that is looked at, bytes.
const LONGEST_TEXT: usize = 256;
/// The largest coordinate, m, and angle, degrees.
const LARGEST: f64 = 10_000.0;

/// A value and its JSON pointer.
#[derive(Clone, Debug)]
pub struct Node<'a> {
    value: &'a Value,
    pub at: String,
}

impl<'a> Node<'a> {
    /// The whole document.
    pub const fn root(value: &'a Value) -> Self {
        Self { value, at: String::new() }
    }

    fn wrong(&self, is: &str, remedy: &str) -> HouseError {
        HouseError::at(&self.at, is, remedy)
    }

    /// A member of an object, if it is there and not `null`.
    pub fn member(&self, name: &str) -> Result<Option<Self>, HouseError> {
        let object = self.value.as_object().ok_or_else(|| self.wrong("it is no object", "write { … }"))?;
        let value = object.get(name).filter(|value| !value.is_null());
        Ok(value.map(|value| Self { value, at: format!("{}/{name}", self.at) }))
    }

    /// A member that must be there.
    pub fn needed(&self, name: &str) -> Result<Self, HouseError> {
        let lacks = || self.wrong(&format!("it has no `{name}`"), "add that");
        self.member(name)?.ok_or_else(lacks)
    }

    /// The items of a list, at most so many.
    pub fn items(&self, most: usize) -> Result<Vec<Self>, HouseError> {
        let list = self.value.as_array().ok_or_else(|| self.wrong("it is no list", "write [ … ]"))?;
        if list.len() > most {
            return Err(self.wrong(&format!("{} items", list.len()), &format!("at most {most}")));
        }
        let item = |(index, value): (usize, &'a Value)| Self { value, at: format!("{}/{index}", self.at) };
        Ok(list.iter().enumerate().map(item).collect())
    }

    /// The items of a list that may be absent.
    pub fn items_of(&self, name: &str, most: usize) -> Result<Vec<Self>, HouseError> {
        self.member(name)?.map_or_else(|| Ok(Vec::new()), |list| list.items(most))
    }

    /// A text.
    pub fn text(&self) -> Result<&'a str, HouseError> {
        let text = self.value.as_str().ok_or_else(|| self.wrong("it is no text", "write \"…\""))?;
        if text.len() > LONGEST_TEXT {
            let reason = format!("a text of {} bytes", text.len());
            return Err(self.wrong(&reason, &format!("at most {LONGEST_TEXT}")));
        }
        Ok(text)
    }

    /// A number that is one, and not beyond all houses.
    pub fn number(&self) -> Result<f64, HouseError> {
        let number = self.value.as_f64().ok_or_else(|| self.wrong("it is no number", "write metres or degrees"))?;
        if !number.is_finite() || number.abs() > LARGEST {
            let remedy = format!("write a number from -{LARGEST} to {LARGEST}");
            return Err(self.wrong(&format!("{number} is out of range"), &remedy));
        }
        Ok(number)
    }

    /// A number that may be absent, 0 then.
    pub fn number_of(&self, name: &str) -> Result<f64, HouseError> {
        self.member(name)?.map_or(Ok(0.0), |number| number.number())
    }

    /// Whether a member is `true`, `false` or absent.
    pub fn flag_of(&self, name: &str) -> Result<Option<bool>, HouseError> {
        let Some(flag) = self.member(name)? else { return Ok(None) };
        flag.value.as_bool().map(Some).ok_or_else(|| flag.wrong("it is neither true nor false", "write one of them"))
    }

    /// Whether it is a text.
    pub fn is_text(&self) -> bool {
        self.value.is_string()
    }
}
