//! Reads the objects that a mission asks for.

use std::collections::BTreeMap;

use serde_json::Value;

use super::{
    DinoFood, Era, ObjectRequest, Portal,
    key::InitialKey,
    names::is_robot,
    problem::Pointer,
    raw::{Entry, Loose, RequiredObject, Scalar},
    reader::{Reader, shape},
    robot::is_blank,
};
use crate::{
    catalog::{ClassId, Property},
    flag_key::property_of,
    nearest::did_you_mean,
    state::{Color, Fluid, StateFlag},
};

impl Reader<'_> {
    /// Reads `required_objects`; those without a usable name are left out.
    pub fn objects(
        &mut self,
        at: &Pointer,
        list: &Loose<Vec<Loose<RequiredObject>>>,
        portals: &[Portal],
    ) -> Vec<ObjectRequest> {
        let objects = self.items(at, list, "an object with a name");
        self.unlisted_all = list.misfit().is_some();
        // All names first: a location may name an object that comes later.
        let named: Vec<_> = objects
            .into_iter()
            .filter_map(|(at, object)| Some((self.new_instance(&at.key("name"), &object.name)?, at, object)))
            .collect();
        let mut requests = Vec::with_capacity(named.len());
        for (index, (name, at, object)) in named.into_iter().enumerate() {
            let request = self.object(&at, name, object, portals);
            if let Some(condition) = object.condition.known().filter(|condition| !is_blank(condition)) {
                self.object_conditions.push((index, at.key("condition"), condition.clone()));
            }
            requests.push((at, request));
        }
        self.circles(&requests);
        let (places, requests) = requests.into_iter().unzip();
        self.places.objects = places;
        requests
    }

    fn object(&mut self, at: &Pointer, instance: String, object: &RequiredObject, portals: &[Portal]) -> ObjectRequest {
        self.extras(at, object);
        let class = self.catalog.class_of_instance(&instance);
        let inside = self.location(&at.key("location"), &object.location);
        let mut request = ObjectRequest {
            room: self.first_room(&at.key("roomLocation"), &object.room_location),
            inside,
            color: self.color_of(&at.key("colors"), &object.colors),
            yesterday: self.class_field(&at.key("yesterdayState"), &object.yesterday_state),
            prints: self.class_field(&at.key("printingObject"), &object.printing_object),
            past_portals: self.portal_names(
                &at.key("associatedPastPortals"),
                &object.associated_past_portals,
                portals,
                Some(Era::Past),
            ),
            future_portals: self.portal_names(
                &at.key("associatedFuturePortals"),
                &object.associated_future_portals,
                portals,
                Some(Era::Future),
            ),
            current_portal: self.current_portal(&at.key("currentPortal"), &object.current_portal, portals),
            dino_food: self.dino_food(&at.key("dinoFood"), &object.dino_food),
            instance,
            ..ObjectRequest::default()
        };
        for (at, entry) in self.items(&at.key("state"), &object.state, "a state such as {\"isOpen\": \"true\"}") {
            for (key, value) in entry {
                self.initial_state(&at.key(key), key, value, class, &mut request);
            }
        }
        request
    }

    fn location(&mut self, at: &Pointer, list: &Loose<Vec<Loose<Entry>>>) -> Option<String> {
        let entries = self.items(at, list, "a place such as {\"Desk_01_1\": \"on\"}");
        let mut places = entries.iter().flat_map(|(at, entry)| entry.iter().map(move |(name, way)| (at, name, way)));
        let (at, name, way) = places.next()?;
        if let Some((second, ..)) = places.next() {
            self.warn(second, "an object is in one place: only the first is used", None);
        }
        let at = at.key(name);
        if !way.as_str().is_some_and(|way| ["in", "on"].iter().any(|known| way.trim().eq_ignore_ascii_case(known))) {
            let found = way.as_str().map_or_else(|| shape(way).to_owned(), |way| format!("`{way}`"));
            self.error(&at, format!("expected `in` or `on`, found {found}"), None);
        }
        let class = self.reference_to_one(&at, name)?;
        let class = self.catalog.class(class);
        if !class.has(Property::Receptacle) && class.receptacle.is_none() {
            let message = format!("nothing can be in or on `{name}`: {} is no receptacle", class.name);
            self.error(&at, message, None);
        }
        Some(name.clone())
    }

    /// The class of an instance that must exist; a wildcard is a problem.
    fn reference_to_one(&mut self, at: &Pointer, name: &str) -> Option<ClassId> {
        if name.ends_with('*') {
            self.error(at, format!("`{name}` may be several objects; a place is one"), None);
            return None;
        }
        if is_robot(name) {
            self.error(at, format!("`{name}` is a robot: what it holds is said in `simbot_init`"), None);
            return None;
        }
        self.reference(at, name);
        self.catalog.class_of_instance(name)
    }

    /// Objects that are in themselves, or in each other.
    fn circles(&mut self, requests: &[(Pointer, ObjectRequest)]) {
        let inside: BTreeMap<&str, &str> = requests
            .iter()
            .filter_map(|(_, request)| Some((request.instance.as_str(), request.inside.as_deref()?)))
            .collect();
        for (at, request) in requests {
            let mut place = request.inside.as_deref();
            for _ in 0..requests.len() {
                let Some(name) = place else { break };
                if name == request.instance {
                    self.error(&at.key("location"), format!("`{name}` is inside itself"), None);
                    break;
                }
                place = inside.get(name).copied();
            }
        }
    }

    fn color_of(&mut self, at: &Pointer, list: &Loose<Vec<Scalar>>) -> Option<Color> {
        let (at, name) = self.first_text(at, list)?;
        self.color(&at, &name)
    }

    /// The colour of that name; none and a problem if there is none.
    pub fn color(&mut self, at: &Pointer, name: &str) -> Option<Color> {
        let color = Color::from_name(name);
        if color.is_none() {
            self.unknown(at, "colour", name, Color::ALL.iter().map(|color| color.name()));
        }
        color
    }

    /// The fluid of that name; none and a problem if there is none.
    pub fn fluid(&mut self, at: &Pointer, name: &str) -> Option<Fluid> {
        if name.eq_ignore_ascii_case("false") {
            return Some(Fluid::None);
        }
        let fluid = Fluid::from_name(name);
        if fluid.is_none() {
            self.unknown(at, "fluid", name, Fluid::ALL.iter().map(|fluid| fluid.name()));
        }
        fluid
    }

    fn class_field(&mut self, at: &Pointer, field: &Loose<Scalar>) -> Option<String> {
        let id = self.text(at, field)?;
        self.class_named(at, &id)
    }

    fn initial_state(
        &mut self,
        at: &Pointer,
        key: &str,
        value: &Value,
        class: Option<ClassId>,
        request: &mut ObjectRequest,
    ) {
        let Some(meaning) = InitialKey::of(key) else {
            let remedy = did_you_mean(key, InitialKey::names());
            return self.error(at, format!("unknown state `{key}`"), remedy);
        };
        let Some(scalar) = self.scalar_of(at, value) else { return };
        match meaning {
            InitialKey::Text => request.text = Some(scalar.text()),
            InitialKey::Filled => request.fluid = self.fluid(at, &scalar.text()),
            InitialKey::Circuit => request.circuit = self.circuit(at, &scalar),
            InitialKey::GeneratesCircuit => request.generates_circuit = self.circuit(at, &scalar),
            InitialKey::Flag(flag) => {
                if let Some(value) = self.truth_of(at, &scalar) {
                    self.initial_flag(at, flag, value, class, request);
                }
            }
            InitialKey::GeneratesPower => request.generates_power = self.truth_of(at, &scalar),
            InitialKey::Empty => request.empty = self.truth_of(at, &scalar).unwrap_or(false),
            InitialKey::RemoveContents => {
                request.remove_initial_contents = self.truth_of(at, &scalar).unwrap_or(false);
            }
            InitialKey::Blacklist => request.blacklisted = self.truth_of(at, &scalar).unwrap_or(false),
            InitialKey::Unique => request.unique = self.truth_of(at, &scalar).unwrap_or(false),
            InitialKey::Removed => request.removed = self.truth_of(at, &scalar).unwrap_or(false),
        }
    }

    fn initial_flag(
        &mut self,
        at: &Pointer,
        flag: StateFlag,
        value: bool,
        class: Option<ClassId>,
        request: &mut ObjectRequest,
    ) {
        if flag == StateFlag::PickedUp {
            if value {
                self.warn(at, "no object starts in a hand; ignored", None);
            }
            return;
        }
        if value {
            self.can_have(at, &request.instance, class, flag);
        }
        request.flags.push((flag, value));
    }

    /// Warns if objects of `class` never get `flag`.
    pub fn can_have(&mut self, at: &Pointer, instance: &str, class: Option<ClassId>, flag: StateFlag) {
        let (Some(class), Some(property)) = (class, property_of(flag)) else { return };
        let class = self.catalog.class(class);
        if !class.has(property) {
            let word = format!("{property:?}").to_lowercase();
            let message = format!("`{instance}` never gets into this state: {} is not {word}", class.name);
            self.warn(at, message, None);
        }
    }

    fn circuit(&mut self, at: &Pointer, scalar: &Scalar) -> Option<i32> {
        let number = self.integer_of(at, scalar)?;
        let circuit = i32::try_from(number).ok();
        if circuit.is_none() {
            self.error(at, format!("`{number}` is no circuit"), None);
        }
        circuit
    }

    fn current_portal(&mut self, at: &Pointer, field: &Loose<Scalar>, portals: &[Portal]) -> Option<String> {
        let name = self.text(at, field)?;
        self.portal_reference(at, &name, portals, None);
        Some(name)
    }

    /// What a dinosaur eats: an instance that the mission lists, or any object of a class.
    fn dino_food(&mut self, at: &Pointer, field: &Loose<Scalar>) -> Option<DinoFood> {
        let name = self.text(at, field)?;
        if self.listed.contains(&name) {
            return Some(DinoFood::Instance(name));
        }
        match self.catalog.class_of_instance(&name) {
            Some(class) if self.catalog.class(class).id != name => {
                self.reference(at, &name);
                Some(DinoFood::Instance(name))
            }
            _ => self.class_named(at, &name).map(DinoFood::Class),
        }
    }
}
