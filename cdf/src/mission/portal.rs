//! Portals to the past and to the future: what a mission declares of them, and how it is read.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::{
    problem::Pointer,
    raw::{Cdf, Loose, PortalEntry, Scalar},
    reader::{Reader, shape},
};
use crate::nearest::did_you_mean;

/// Where a portal leads.
#[derive(Clone, Copy, Debug, Deserialize, Eq, Hash, PartialEq, Serialize)]
pub enum Era {
    /// To the past.
    Past,
    /// To the future.
    Future,
}

/// One of `pastPortals` or `futurePortals`.
#[derive(Clone, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct Portal {
    /// The name by which objects refer to it.
    pub name: String,
    /// Where it leads.
    pub era: Era,
    /// Whether it is open from the start.
    pub open: bool,
}

/// Words for an open portal, beside what is true anyway.
const OPEN: [&str; 5] = ["open", "opened", "on", "active", "enabled"];

/// Words for a closed one.
const CLOSED: [&str; 5] = ["closed", "close", "off", "inactive", "disabled"];

impl Reader<'_> {
    /// Reads the portals of both eras; those without a name are left out.
    pub fn portals(&mut self, root: &Pointer, raw: &Cdf) -> Vec<Portal> {
        let mut portals = Vec::new();
        for (key, list, era) in
            [("pastPortals", &raw.past_portals, Era::Past), ("futurePortals", &raw.future_portals, Era::Future)]
        {
            for (at, entry) in self.items(&root.key(key), list, "a portal") {
                self.extras(&at, entry);
                let name_at = at.key("PortalName");
                let Some(name) = self.text(&name_at, &entry.name) else {
                    if entry.name.misfit().is_none() {
                        self.error(&name_at, "the portal has no name", None);
                    }
                    continue;
                };
                let open = self.portal_status(&at.key("PortalStatus"), entry);
                if portals.iter().any(|known: &Portal| known.name == name && known.era == era) {
                    self.error(&name_at, format!("there is already a portal `{name}`"), None);
                    continue;
                }
                portals.push(Portal { name, era, open });
            }
        }
        portals
    }

    fn portal_status(&mut self, at: &Pointer, entry: &PortalEntry) -> bool {
        let Some(status) = self.field(at, &entry.status, "true or false") else { return false };
        let text = status.text().to_ascii_lowercase();
        if OPEN.contains(&text.as_str()) {
            return true;
        }
        if text.is_empty() || CLOSED.contains(&text.as_str()) {
            return false;
        }
        self.truth_of(at, status).unwrap_or(false)
    }

    /// The names of portals that lead to an object; undeclared ones are warned of, and kept.
    pub fn portal_names(
        &mut self,
        at: &Pointer,
        list: &Loose<Vec<Value>>,
        portals: &[Portal],
        era: Option<Era>,
    ) -> Vec<String> {
        let items = self.field(at, list, "a list of portals").map_or(&[][..], Vec::as_slice);
        let mut names = Vec::new();
        for (index, item) in items.iter().enumerate() {
            let at = at.item(index);
            let name = match item {
                Value::Object(fields) => fields.get("PortalName").and_then(Scalar::of),
                other => Scalar::of(other),
            };
            let Some(name) = name.map(|name| name.text()).filter(|name| !name.is_empty()) else {
                self.error(&at, format!("expected the name of a portal, found {}", shape(item)), None);
                continue;
            };
            self.portal_reference(&at, &name, portals, era);
            names.push(name);
        }
        names
    }

    /// Warns of a portal that the mission does not declare.
    pub fn portal_reference(&mut self, at: &Pointer, name: &str, portals: &[Portal], era: Option<Era>) {
        let known = || portals.iter().filter(|portal| era.is_none_or(|era| portal.era == era));
        if known().any(|portal| portal.name == name) {
            return;
        }
        let remedy = did_you_mean(name, known().map(|portal| portal.name.as_str())).unwrap_or_else(|| {
            let list = if era == Some(Era::Future) { "futurePortals" } else { "pastPortals" };
            format!("declare it in `{list}`")
        });
        self.warn(at, format!("there is no portal `{name}`: it never opens"), Some(remedy));
    }
}
