//! Objects: put down, dropped elsewhere, turned, gone.

use cohabit_cdf::{
    Layout, RoomId,
    catalog::{ObjectClass, Stands},
    layout::Placement,
};
use toml::{Table, Value};

use super::{Work, geometry};
use crate::entries::{List, number, numbers, string};

/// The first number of new instances: lower ones are those that missions give.
const FIRST: u32 = 10_000;
/// How high what hangs on walls is put, m.
const ON_WALL_M: f32 = 1.2;

fn entry(thing: &Placement) -> Table {
    let mut pairs = vec![("instance", string(&thing.instance)), ("room", string(thing.room.id()))];
    if let Some(on) = &thing.on {
        pairs.push(("on", string(on)));
    }
    if thing.anchor {
        pairs.push(("anchor", Value::Boolean(true)));
    } else {
        pairs.push(("at_m", numbers(&thing.at_m)));
    }
    if thing.yaw_deg != 0.0 {
        pairs.push(("yaw_deg", number(thing.yaw_deg)));
    }
    if thing.scale != [1.0; 3] {
        pairs.push(("scale", numbers(&thing.scale)));
    }
    if let Some(works) = &thing.works {
        pairs.push(("works", string(works)));
    }
    pairs.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}

fn is_of(instance: &str) -> impl Fn(&Table) -> bool {
    let instance = instance.to_owned();
    move |entry| entry.get("instance").and_then(Value::as_str) == Some(instance.as_str())
}

/// All that stands on a thing, and on that, holders first.
fn held<'a>(layout: &'a Layout, instance: &str) -> Vec<&'a Placement> {
    let mut held: Vec<&Placement> = Vec::new();
    // Plans have holders before what they hold.
    for thing in &layout.placements {
        let stands_on = |holder: &str| thing.on.as_deref() == Some(holder);
        if stands_on(instance) || held.iter().any(|holder| stands_on(&holder.instance)) {
            held.push(thing);
        }
    }
    held
}

impl<'a> Work<'a> {
    pub(super) fn add_thing(&mut self, class: &str, at_m: [f32; 2]) -> Result<(), String> {
        let (catalog, layout) = (self.catalog, self.layout);
        let id = catalog.find(class).ok_or_else(|| match catalog.near(class) {
            Some(near) => format!("there is no class `{class}`: did you mean `{near}`?"),
            None => format!("there is no class `{class}`: choose one of the catalogue"),
        })?;
        let class = catalog.class(id);
        let room = layout.room_at(at_m[0], at_m[1]).ok_or("there is no room here: choose a place in a room")?;
        let is_free = |name: &String| layout.placement(name).is_none() && catalog.class_of_instance(name) == Some(id);
        let instance = (FIRST..).map(|number| format!("{}_{number}", class.id)).take(10_000).find(is_free);
        let instance = instance.ok_or("there are too many of these already")?;
        let yaw_deg = geometry::facing_deg(layout, room, at_m);
        let thing = Placement {
            instance,
            room,
            at_m: [at_m[0], at_m[1], if class.stands == Stands::OnWall { ON_WALL_M } else { 0.0 }],
            yaw_deg,
            on: None,
            anchor: false,
            works: None,
            scale: [1.0; 3],
        };
        let thing = self.dropped(thing, class, at_m, room, &[]);
        self.put(&thing)
    }

    pub(super) fn drop_thing(&mut self, instance: &str, at_m: [f32; 2]) -> Result<(), String> {
        let old = self.thing(instance)?;
        let room = self.layout.room_at(at_m[0], at_m[1]).ok_or("there is no room here: drop it in a room")?;
        let class =
            self.catalog.class_of_instance(instance).ok_or("nothing is known of its class: mend its name first")?;
        let class = self.catalog.class(class);
        let held = held(self.layout, instance);
        let except: Vec<&str> = held.iter().map(|thing| thing.instance.as_str()).chain([instance]).collect();
        let new = self.dropped(old.clone(), class, at_m, room, &except);
        self.put(&new)?;
        self.follow(&new, &held, new.yaw_deg - old.yaw_deg)
    }

    pub(super) fn set_thing(&mut self, instance: &str, at_m: [f32; 3], yaw_deg: f32) -> Result<(), String> {
        let old = self.thing(instance)?;
        let mut new = old.clone();
        new.yaw_deg = geometry::heading_deg(yaw_deg);
        if new.on.is_none() {
            new.at_m = at_m;
            new.room = self.layout.room_at(at_m[0], at_m[1]).unwrap_or(old.room);
        } else if !new.anchor {
            new.at_m = at_m;
        }
        let held = held(self.layout, instance);
        self.put(&new)?;
        self.follow(&new, &held, new.yaw_deg - old.yaw_deg)
    }

    pub(super) fn remove_thing(&mut self, instance: &str) -> Result<(), String> {
        let thing = self.thing(instance)?;
        let base = self.text.base()?.map(|base| Layout::find(&base, self.catalog)).transpose();
        let base = base.map_err(|error| error.to_string())?;
        for gone in held(self.layout, instance).into_iter().rev() {
            self.text.remove_all(List::Placement, is_of(&gone.instance))?;
        }
        self.text.remove_all(List::Placement, is_of(&thing.instance))?;
        if base.is_some_and(|base| base.placement(instance).is_some()) {
            self.text.add(List::Remove, &string(instance))?;
        }
        Ok(())
    }

    /// A thing that can be moved by itself.
    fn thing(&self, instance: &str) -> Result<&'a Placement, String> {
        let layout = self.layout;
        let found = layout.placement(instance).ok_or_else(|| format!("there is no `{instance}` in the plan"))?;
        if layout.is_door(found) {
            return Err("a door is where its opening is: move that".to_owned());
        }
        Ok(found)
    }

    /// A thing as it stands once it was dropped.
    fn dropped(
        &self,
        thing: Placement,
        class: &ObjectClass,
        at_m: [f32; 2],
        room: RoomId,
        except: &[&str],
    ) -> Placement {
        let (layout, catalog) = (self.layout, self.catalog);
        let is_small = class.stands == Stands::OnSurface;
        let holder = is_small.then(|| geometry::holder_at(layout, catalog, class, at_m, except)).flatten();
        let Some(holder) = holder.filter(|holder| holder.room == room) else {
            let height_m = if thing.on.is_some() { 0.0 } else { thing.at_m[2] };
            let at = (at_m, thing.yaw_deg);
            let ([x, y], yaw_deg) = geometry::standing_at(layout, room, class, thing.scale, at);
            return Placement { room, at_m: [x, y, height_m], yaw_deg, on: None, anchor: false, ..thing };
        };
        if thing.on.as_ref() == Some(&holder.instance) && !thing.anchor {
            let [x, y, _] = layout.origin_in_world_m(holder);
            let [ahead, left] = geometry::local_m([x, y], holder.yaw_deg, at_m);
            return Placement { at_m: [ahead, left, thing.at_m[2]], ..thing };
        }
        Placement { room, at_m: [0.0; 3], on: Some(holder.instance.clone()), anchor: true, ..thing }
    }

    /// What stands on a thing stays on it, in the room where that is now, and turns with it.
    fn follow(&mut self, holder: &Placement, held: &[&Placement], turned_deg: f32) -> Result<(), String> {
        for thing in held {
            let yaw_deg = geometry::heading_deg(thing.yaw_deg + turned_deg);
            let new = Placement { room: holder.room, yaw_deg, ..(*thing).clone() };
            if new != **thing || self.is_before_holder(&new)? {
                self.put(&new)?;
            }
        }
        Ok(())
    }

    /// Writes a thing where it stands in the file, or at the end, behind what it stands on.
    pub(super) fn put(&mut self, thing: &Placement) -> Result<(), String> {
        let is_before_holder = self.is_before_holder(thing)?;
        match self.text.find(List::Placement, is_of(&thing.instance))? {
            Some(index) if !is_before_holder => self.text.set(List::Placement, index, entry(thing)),
            Some(index) => {
                self.text.remove(List::Placement, index)?;
                self.text.add(List::Placement, &Value::Table(entry(thing)))
            }
            None => self.text.add(List::Placement, &Value::Table(entry(thing))),
        }
    }

    /// Whether a thing's entry stands before that of what it stands on, where files cannot name that.
    fn is_before_holder(&self, thing: &Placement) -> Result<bool, String> {
        let Some(on) = &thing.on else { return Ok(false) };
        let own = self.text.find(List::Placement, is_of(&thing.instance))?;
        let holder = self.text.find(List::Placement, is_of(on))?;
        Ok(own.zip(holder).is_some_and(|(own, holder)| own < holder))
    }
}
