//! Reads the conditions that a mission defines, and their expressions.

use serde_json::Value;

use super::{
    problem::Pointer,
    raw::{Condition, Entry, Loose, Scalar},
    reader::{Reader, shape},
};
use crate::{
    flag_key::{flag_keys, flag_of_key},
    goal::{Expression, InstancePattern, StateCondition},
    nearest::did_you_mean,
};

/// The kinds of expressions that are no flags.
pub(super) const KINDS: [&str; 12] = [
    "AND",
    "OR",
    "NOT",
    "Contains",
    "isFilledWith",
    "isFilled",
    "CanBeSeen",
    "IsInRange",
    "ColorMetaDataChange",
    "DinoFed",
    "IsReceptacle",
    "isFullOfItems",
];

/// Whether `key` names a kind of expression.
pub(super) fn is_kind(key: &str) -> bool {
    KINDS.into_iter().chain(flag_keys()).any(|known| known.eq_ignore_ascii_case(key))
}

impl Reader<'_> {
    /// Reads `stateconditions`; those without a name or a readable expression are left out.
    pub fn conditions(&mut self, at: &Pointer, list: &Loose<Vec<Loose<Condition>>>) -> Vec<StateCondition> {
        let mut conditions: Vec<StateCondition> = Vec::new();
        for (at, raw) in self.items(at, list, "a condition") {
            let Some(condition) = self.condition(&at, raw) else { continue };
            let same = |known: &StateCondition| known.name == condition.name && known.context == condition.context;
            if conditions.iter().any(same) {
                let message = format!("there is already a condition `{}` of `{}`", condition.name, condition.context);
                self.error(&at.key("stateName"), message, None);
            } else {
                conditions.push(condition);
                self.places.conditions.push(at);
            }
        }
        conditions
    }

    fn condition(&mut self, at: &Pointer, condition: &Condition) -> Option<StateCondition> {
        self.extras(at, condition);
        let name = self.text(&at.key("stateName"), &condition.state_name);
        if name.is_none() {
            self.error(&at.key("stateName"), "the condition has no name", None);
        }
        let context_at = at.key("context");
        let context = self.text(&context_at, &condition.context).unwrap_or_default();
        if !context.is_empty() {
            self.reference(&context_at, &context);
        }
        let expression_at = at.key("expression");
        let expression = match self.field(&expression_at, &condition.expression, "an expression") {
            Some(entry) => self.expression(&expression_at, entry),
            None => {
                if condition.expression.misfit().is_none() {
                    self.error(&expression_at, "the condition has no expression", None);
                }
                None
            }
        };
        let name = name?;
        let Some(expression) = expression else {
            self.unreadable.push(name);
            return None;
        };
        Some(StateCondition { name, context, expression })
    }

    /// Reads an object of one kind; several at once count as all of them.
    pub(super) fn expression(&mut self, at: &Pointer, entry: &Entry) -> Option<Expression> {
        let kinds: Vec<_> = entry.iter().filter(|(kind, _)| *kind != "message").collect();
        match kinds.as_slice() {
            [] => {
                self.error(at, "the expression is empty", None);
                None
            }
            [(kind, value)] => self.expression_of_kind(&at.key(kind), kind, value),
            several => {
                let remedy = Some("put them into one `AND`".to_owned());
                self.warn(at, format!("{} expressions in one are taken as all of them", several.len()), remedy);
                let all =
                    several.iter().filter_map(|(kind, value)| self.expression_of_kind(&at.key(kind), kind, value));
                Some(Expression::And(all.collect()))
            }
        }
    }

    fn expression_of_kind(&mut self, at: &Pointer, kind: &str, value: &Value) -> Option<Expression> {
        let known = KINDS.into_iter().chain(flag_keys()).find(|known| known.eq_ignore_ascii_case(kind));
        match known {
            Some("AND") => Some(Expression::And(self.expressions(at, value)?)),
            Some("OR") => Some(Expression::Or(self.expressions(at, value)?)),
            Some("NOT") => self.negation(at, value),
            Some(known) => {
                let Value::Object(fields) = value else {
                    self.error(at, format!("expected an object with a `target`, found {}", shape(value)), None);
                    return None;
                };
                self.test(at, known, fields)
            }
            None => {
                let remedy = did_you_mean(kind, KINDS.into_iter().chain(flag_keys()));
                self.error(at, format!("unknown kind of expression `{kind}`"), remedy);
                None
            }
        }
    }

    /// The expressions of an `AND`, `OR` or `NOT`: `{"expressions": [..]}`, `{"expression": {..}}`, `[..]` or `{..}`.
    fn expressions(&mut self, at: &Pointer, value: &Value) -> Option<Vec<Expression>> {
        let (at, value) = match value {
            Value::Object(fields) => ["expressions", "expression"]
                .into_iter()
                .find_map(|key| Some((at.key(key), fields.get(key)?)))
                .unwrap_or_else(|| (at.clone(), value)),
            _ => (at.clone(), value),
        };
        match value {
            Value::Array(items) => {
                let mut all = Vec::with_capacity(items.len());
                for (index, item) in items.iter().enumerate() {
                    all.extend(self.expression_value(&at.item(index), item));
                }
                if items.is_empty() {
                    self.error(&at, "there is nothing to combine", None);
                }
                (all.len() == items.len() && !items.is_empty()).then_some(all)
            }
            single => Some(vec![self.expression_value(&at, single)?]),
        }
    }

    fn expression_value(&mut self, at: &Pointer, value: &Value) -> Option<Expression> {
        if let Value::Object(entry) = value {
            return self.expression(at, entry);
        }
        self.error(at, format!("expected an expression, found {}", shape(value)), None);
        None
    }

    fn negation(&mut self, at: &Pointer, value: &Value) -> Option<Expression> {
        let mut inner = self.expressions(at, value)?;
        if inner.len() > 1 {
            self.warn(at, "`NOT` of several is taken as: not all of them", Some("put them into one `AND`".to_owned()));
            return Some(Expression::Not(Box::new(Expression::And(inner))));
        }
        inner.pop().map(|inner| Expression::Not(Box::new(inner)))
    }

    /// An expression that looks at a target.
    fn test(&mut self, at: &Pointer, kind: &str, fields: &Entry) -> Option<Expression> {
        let target = self.instance(at, fields, "target")?;
        Some(match kind {
            "Contains" => Expression::Contains { target, contains: self.instance(at, fields, "contains")? },
            "isFilledWith" => {
                let (at, fluid) = self.argument(at, fields, &["fluid", "value"])?;
                Expression::FilledWith { target, fluid: self.fluid(&at, &fluid.text())? }
            }
            "isFilled" => {
                let (at, value) = self.argument(at, fields, &["value", "fluid"])?;
                self.filled(&at, target, &value)?
            }
            "CanBeSeen" => {
                Expression::CanBeSeen { target, distance_m: self.distance(at, fields, &["distance", "value"])? }
            }
            "IsInRange" => {
                Expression::InRange { target, distance_m: self.distance(at, fields, &["value", "distance"])? }
            }
            "ColorMetaDataChange" => {
                let (at, color) = self.argument(at, fields, &["colorvalue", "value", "color"])?;
                Expression::HasColor { target, color: self.color(&at, &color.text())? }
            }
            "DinoFed" => Expression::DinoFed { target, value: self.value(at, fields, &["isFed", "value"])? },
            "IsReceptacle" => Expression::IsReceptacle { target, value: self.value(at, fields, &["value"])? },
            "isFullOfItems" => Expression::IsFull { target, value: self.value(at, fields, &["value"])? },
            _ => {
                let flag = flag_of_key(kind)?;
                Expression::Flag { target, flag, value: self.value(at, fields, &["value"])? }
            }
        })
    }

    /// `isFilled` takes a fluid, or true for any.
    fn filled(&mut self, at: &Pointer, target: InstancePattern, value: &Scalar) -> Option<Expression> {
        if value.truth() == Some(true) {
            return Some(Expression::FilledWithAny { target });
        }
        Some(Expression::FilledWith { target, fluid: self.fluid(at, &value.text())? })
    }

    fn instance(&mut self, at: &Pointer, fields: &Entry, key: &str) -> Option<InstancePattern> {
        let (at, name) = self.argument(at, fields, &[key])?;
        let name = name.text();
        self.reference(&at, &name);
        Some(InstancePattern(name))
    }

    /// The first of `keys` that is there.
    fn argument(&mut self, at: &Pointer, fields: &Entry, keys: &[&str]) -> Option<(Pointer, Scalar)> {
        let found = keys.iter().find_map(|key| Some((at.key(key), fields.get(*key)?)));
        let Some((at, value)) = found else {
            let expected = keys.first().copied().unwrap_or_default();
            self.error(at, format!("`{expected}` is missing"), None);
            return None;
        };
        let scalar = self.scalar_of(&at, value)?;
        Some((at, scalar))
    }

    /// The truth asked for: true, if nothing is said.
    fn value(&mut self, at: &Pointer, fields: &Entry, keys: &[&str]) -> Option<bool> {
        if keys.iter().all(|key| fields.get(*key).is_none_or(Value::is_null)) {
            return Some(true);
        }
        let (at, value) = self.argument(at, fields, keys)?;
        self.truth_of(&at, &value)
    }

    fn distance(&mut self, at: &Pointer, fields: &Entry, keys: &[&str]) -> Option<f32> {
        let (at, value) = self.argument(at, fields, keys)?;
        let number = value.number().filter(|number| (0.0..=1000.0).contains(number));
        if number.is_none() {
            self.error(&at, format!("expected a distance in metres, found `{}`", value.text()), None);
        }
        #[allow(clippy::cast_possible_truncation, reason = "at most 1000")]
        number.map(|number| number as f32)
    }
}
