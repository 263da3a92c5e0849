//! Reads floor plans from TOML: whole plans, and variants that say what differs from a base.

use std::collections::BTreeSet;

use serde::Deserialize;

use super::{
    Finish, Layout, LayoutError, NotePlace, Opening, OpeningKind, Placement, Room, RoomId, Viewpoint, mirror,
    unit_scale,
};
use crate::model::Axis;
use crate::nearest::nearest;

/// One file: every list is added to the base's, and replaces what has the same name there.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LayoutFile {
    #[serde(default)]
    base: Option<String>,
    /// Instances of the base to leave out, with all that stands on them.
    #[serde(default)]
    remove: Vec<String>,
    #[serde(default)]
    wall_height_m: Option<f32>,
    #[serde(default)]
    room: Vec<Room>,
    #[serde(default)]
    finish: Vec<RoomFinish>,
    #[serde(default)]
    opening: Vec<Opening>,
    #[serde(default)]
    placement: Vec<Placement>,
    #[serde(default)]
    viewpoint: Vec<Viewpoint>,
    #[serde(default)]
    note_place: Vec<NotePlace>,
}

/// Other surfaces for a room of the base.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RoomFinish {
    room: RoomId,
    #[serde(default)]
    floor: Option<Finish>,
    #[serde(default)]
    wall: Option<Finish>,
    #[serde(default)]
    wainscot: Option<Finish>,
}

/// Height of rooms where no file says another, m.
const WALL_HEIGHT_M: f32 = 2.8;

/// The ids of all plans in these files, then of their mirror images.
pub(super) fn ids(files: &[(&str, &str)]) -> Vec<String> {
    let plain = files.iter().map(|(file, _)| stem(file).to_owned());
    let mirrored = files.iter().map(|(file, _)| format!("{}{}", stem(file), mirror::SUFFIX));
    plain.chain(mirrored).collect()
}

/// The id of a plan file, which may be named with its folder.
fn stem(file: &str) -> &str {
    let name = file.rsplit('/').next().unwrap_or(file);
    name.strip_suffix(".toml").unwrap_or(name)
}

impl Layout {
    /// The plan `id` out of `(file name, text)` of plan files.
    ///
    /// # Errors
    /// [`LayoutError`] names the file and what is wrong in it.
    pub fn parse(id: &str, files: &[(&str, &str)]) -> Result<Self, LayoutError> {
        if let Some(original) = id.strip_suffix(mirror::SUFFIX) {
            return Ok(mirror::mirrored(&Self::parse(original, files)?));
        }
        let mut plan = Self {
            id: id.to_owned(),
            wall_height_m: WALL_HEIGHT_M,
            rooms: Vec::new(),
            openings: Vec::new(),
            placements: Vec::new(),
            viewpoints: Vec::new(),
            note_places: Vec::new(),
        };
        for (name, file) in chain(id, files)? {
            plan.apply(name, file)?;
        }
        plan.order_parents_first(id)?;
        plan.place_doors();
        Ok(plan)
    }

    fn apply(&mut self, name: &str, file: LayoutFile) -> Result<(), LayoutError> {
        check_once(name, &file)?;
        self.wall_height_m = file.wall_height_m.unwrap_or(self.wall_height_m);
        replace_or_add(&mut self.rooms, file.room, |a, b| a.id == b.id);
        for finish in file.finish {
            self.refinish(finish);
        }
        replace_or_add(&mut self.openings, file.opening, |a, b| a.door.is_some() && a.door == b.door);
        for instance in file.remove {
            self.remove(name, &instance)?;
        }
        self.place(name, file.placement)?;
        replace_or_add(&mut self.viewpoints, file.viewpoint, |a, b| (a.room, a.number) == (b.room, b.number));
        self.note_places.retain(|note| file.note_place.iter().all(|new| new.room != note.room));
        self.note_places.extend(file.note_place);
        Ok(())
    }

    fn refinish(&mut self, finish: RoomFinish) {
        for room in self.rooms.iter_mut().filter(|room| room.id == finish.room) {
            if let Some(floor) = &finish.floor {
                room.floor = floor.clone();
            }
            if let Some(wall) = &finish.wall {
                room.wall = wall.clone();
            }
            if finish.wainscot.is_some() {
                room.wainscot.clone_from(&finish.wainscot);
            }
        }
    }

    fn remove(&mut self, file: &str, instance: &str) -> Result<(), LayoutError> {
        if self.placement(instance).is_none() {
            return Err(self.no_instance(file, instance));
        }
        let mut gone = vec![instance.to_owned()];
        self.placements.retain(|placement| {
            let goes = placement.instance == instance || placement.on.as_ref().is_some_and(|on| gone.contains(on));
            if goes {
                gone.push(placement.instance.clone());
            }
            !goes
        });
        Ok(())
    }

    /// An instance that a file names is not there.
    fn no_instance(&self, file: &str, instance: &str) -> LayoutError {
        let placed = self.placements.iter().map(|placement| placement.instance.as_str());
        let near = nearest(instance, placed).map(str::to_owned);
        LayoutError::NoInstance { file: file.to_owned(), instance: instance.to_owned(), near }
    }

    fn place(&mut self, file: &str, placements: Vec<Placement>) -> Result<(), LayoutError> {
        for (index, placement) in placements.iter().enumerate() {
            if placements[..index].iter().any(|earlier| earlier.instance == placement.instance) {
                return Err(LayoutError::Duplicate { file: file.to_owned(), instance: placement.instance.clone() });
            }
        }
        for placement in placements {
            let missing = placement.on.as_deref().filter(|on| self.placement(on).is_none());
            if let Some(on) = missing {
                return Err(self.no_instance(file, on));
            }
            replace_or_add(&mut self.placements, vec![placement], |a, b| a.instance == b.instance);
        }
        Ok(())
    }

    /// A variant may put an object of its base on one that only it has.
    fn order_parents_first(&mut self, file: &str) -> Result<(), LayoutError> {
        let mut waiting = std::mem::take(&mut self.placements);
        while !waiting.is_empty() {
            let placed = &self.placements;
            let stands = |on: &String| placed.iter().any(|earlier| earlier.instance == *on);
            let ready: Vec<_> = waiting.extract_if(.., |placement| placement.on.as_ref().is_none_or(stands)).collect();
            if ready.is_empty() {
                return Err(LayoutError::OnItself { file: file.to_owned(), instance: waiting.swap_remove(0).instance });
            }
            self.placements.extend(ready);
        }
        Ok(())
    }

    /// Every door is an object too: it stands in its opening, and its front faces the second of the two rooms.
    fn place_doors(&mut self) {
        for opening in self.openings.iter().filter(|opening| opening.kind == OpeningKind::Door) {
            let Some(instance) = &opening.door else { continue };
            self.placements.push(Placement {
                instance: instance.clone(),
                room: opening.between[0],
                at_m: [opening.at_m[0], opening.at_m[1], 0.0],
                yaw_deg: if opening.wall_runs == Axis::X { 90.0 } else { 0.0 },
                on: None,
                anchor: false,
                works: None,
                scale: unit_scale(),
            });
        }
    }
}

/// The files that make up `id`, the one without a base first.
fn chain<'a>(id: &str, files: &[(&'a str, &str)]) -> Result<Vec<(&'a str, LayoutFile)>, LayoutError> {
    let mut chain: Vec<(&str, LayoutFile)> = Vec::new();
    let mut wanted = Some(id.to_owned());
    while let Some(id) = wanted.take() {
        let Some((name, text)) = files.iter().find(|(name, _)| stem(name) == id) else {
            let known = ids(files);
            let near = nearest(&id, known.iter().map(String::as_str)).map(str::to_owned);
            return Err(LayoutError::Unknown { id, near, known: known.join(", ") });
        };
        if chain.iter().any(|(earlier, _)| earlier == name) {
            return Err(LayoutError::Circle { file: (*name).to_owned() });
        }
        let file: LayoutFile = toml::from_str(text)
            .map_err(|source| LayoutError::Syntax { file: (*name).to_owned(), source: Box::new(source) })?;
        wanted.clone_from(&file.base);
        chain.push((name, file));
    }
    chain.reverse();
    Ok(chain)
}

/// What a file has takes the place of what its base has; of what it has twice, the first would be lost without a word.
fn check_once(name: &str, file: &LayoutFile) -> Result<(), LayoutError> {
    let rooms = file.room.iter();
    let rooms = rooms.map(|room| (format!("room `{}`", room.id), "write all its rectangles into one `rects_m`"));
    let doors = file.opening.iter().filter_map(|opening| opening.door.as_ref());
    let doors = doors.map(|door| (format!("door `{door}`"), "give each door a number of its own"));
    let views = file.viewpoint.iter();
    let views = views.map(|view| (format!("viewpoint {} of {}", view.number, view.room), "give one another number"));
    let mut seen = BTreeSet::new();
    for (what, remedy) in rooms.chain(doors).chain(views) {
        if !seen.insert(what.clone()) {
            return Err(LayoutError::Twice { file: name.to_owned(), what, remedy });
        }
    }
    Ok(())
}

/// Puts each new one in the place of the first that is the `same`, or at the end.
fn replace_or_add<T>(list: &mut Vec<T>, new: Vec<T>, same: impl Fn(&T, &T) -> bool) {
    for item in new {
        match list.iter().position(|old| same(old, &item)) {
            Some(index) => list[index] = item,
            None => list.push(item),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const HALL: &str = r##"
room = [{ id = "Hallway", rects_m = [[0.0, 0.0, 4.0, 2.0]], floor = { material = "tile", color = "#ffffff" },
          wall = { material = "plain", color = "#eeeeee" }, circuit = 1 }]
opening = [{ kind = "door", door = "Door_01_1", between = ["Hallway", "Hallway"], at_m = [1.0, 2.0], width_m = 1.0,
             wall_runs = "x" }]
placement = [
    { instance = "Desk_01_1", room = "Hallway", at_m = [1.0, 1.0, 0.0], yaw_deg = 90.0 },
    { instance = "Bowl_01_1", room = "Hallway", on = "Desk_01_1", at_m = [0.1, 0.5, 0.75] },
    { instance = "Apple_1", room = "Hallway", on = "Bowl_01_1", anchor = true },
]
viewpoint = [{ room = "Hallway", number = 1, at_m = [3.0, 1.0], yaw_deg = -90.0 }]
"##;

    fn parse(id: &str, variant: &str) -> Result<Layout, LayoutError> {
        Layout::parse(id, &[("Hall.toml", HALL), ("Other.toml", variant)])
    }

    fn instances(plan: &Layout) -> Vec<&str> {
        plan.placements.iter().map(|placement| placement.instance.as_str()).collect()
    }

    #[test]
    fn a_door_is_an_object() {
        let plan = parse("Hall", "").unwrap();
        assert_eq!(instances(&plan), ["Desk_01_1", "Bowl_01_1", "Apple_1", "Door_01_1"]);
        assert_eq!(plan.placements[3].yaw_deg, 90.0);
    }

    #[test]
    fn a_variant_replaces_and_removes_with_what_stands_there() {
        let plan = parse("Other", "base = \"Hall\"\nremove = [\"Bowl_01_1\"]\nplacement = [{ instance = \"Desk_01_1\", room = \"Hallway\", at_m = [2.0, 1.0, 0.0] }]\nfinish = [{ room = \"Hallway\", wall = { material = \"brick\", color = \"#884433\" } }]").unwrap();
        assert_eq!(instances(&plan), ["Desk_01_1", "Door_01_1"]);
        assert_eq!(plan.placements[0].at_m, [2.0, 1.0, 0.0]);
        assert_eq!(plan.rooms[0].wall.color, "#884433");
        assert_eq!(plan.rooms[0].floor.color, "#ffffff");
    }

    #[test]
    fn a_mirrored_plan_mirrors_what_stands_on_things() {
        let plan = parse("Hall", "").unwrap();
        let mirrored = parse("Hall_mirror", "").unwrap();
        let [x, y, z] = plan.origin_in_world_m(&plan.placements[1]);
        let seen = mirrored.origin_in_world_m(&mirrored.placements[1]);
        for (seen, expected) in seen.into_iter().zip([4.0 - x, y, z]) {
            assert!((seen - expected).abs() < 1e-5, "{seen} is not {expected}");
        }
        assert_eq!(mirrored.viewpoints[0].yaw_deg, -90.0);
        let twice = mirror::mirrored(&mirrored);
        assert_eq!(twice.placements, plan.placements);
    }

    #[test]
    fn faults_name_the_file() {
        let cases = [
            ("remove = [\"Cake_1\"]", "Other.toml: there is no `Cake_1`"),
            ("placement = [{ instance = \"A\", room = \"Hallway\", on = \"B\" }]", "Other.toml: there is no `B`"),
            (
                "placement = [{ instance = \"A\", room = \"Hallway\" }, { instance = \"A\", room = \"Hallway\" }]",
                "`A` is placed twice",
            ),
            (
                "placement = [{ instance = \"Desk_01_1\", room = \"Hallway\", on = \"Apple_1\" }]",
                "`Desk_01_1` stands on itself",
            ),
            ("base = \"Other\"", "lead back"),
            (
                "opening = [{ kind = \"door\", door = \"Door_01_2\", between = [\"Hallway\", \"Hallway\"], at_m = [1.0, 0.0], width_m = 1.0, wall_runs = \"x\" }, { kind = \"door\", door = \"Door_01_2\", between = [\"Hallway\", \"Hallway\"], at_m = [3.0, 0.0], width_m = 1.0, wall_runs = \"x\" }]",
                "Other.toml: the door `Door_01_2` is there twice: give each door a number",
            ),
            (
                "room = [{ id = \"Lab1\", rects_m = [[4.0, 0.0, 6.0, 2.0]], floor = { material = \"tile\", color = \"#ffffff\" }, wall = { material = \"plain\", color = \"#eeeeee\" }, circuit = 1 }, { id = \"Lab1\", rects_m = [[6.0, 0.0, 8.0, 4.0]], floor = { material = \"tile\", color = \"#ffffff\" }, wall = { material = \"plain\", color = \"#eeeeee\" }, circuit = 1 }]",
                "Other.toml: the room `Lab1` is there twice: write all its rectangles into one `rects_m`",
            ),
            ("bass = 1", "Other.toml"),
            ("base = \"Nowhere\"", "there are Hall, Other, Hall_mirror, Other_mirror"),
        ];
        for (text, expected) in cases {
            let text = if text.starts_with("bas") { text.to_owned() } else { format!("base = \"Hall\"\n{text}") };
            let error = parse("Other", &text).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }
}
