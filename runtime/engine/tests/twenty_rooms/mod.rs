//! A world pack with a floor plan of twenty rooms of its own: nineteen along a corridor.

use std::fmt::Write as _;

use cohabit_cdf::{PackFile, WorldData, WorldPack};

/// Rooms beside the corridor; the first ten lie south of it, the others north.
const ROOMS: usize = 19;
const SOUTHERN: usize = 10;
/// The last room's colour on maps.
pub const LOUNGE_COLOR: [u8; 3] = [0xC0, 0xFF, 0xEE];

const HEAD: &str = "name = \"twenty\"\nversion = \"1\"\nlicence = \"CC0-1.0\"\ndescription = \"Twenty rooms\"\n";
const MISSION: &str = r#"{"scene": {"scene_id": "Tour", "layoutOverride": "Twenty", "roomLocation": ["sun lounge"],
    "required_objects": [], "sticky_notes": []}, "task_goals": [], "stateconditions": []}"#;

/// The id and the name of a room, from 1.
fn named(number: usize) -> (String, String) {
    match number {
        1 => ("MusicRoom".to_owned(), "music room".to_owned()),
        ROOMS => ("SunLounge".to_owned(), "sun lounge".to_owned()),
        _ => (format!("Studio-{number}"), format!("studio {number}")),
    }
}

/// The pack alone, on top of what is built in.
pub fn world() -> WorldData {
    let mut head = format!("{HEAD}[[room]]\nid = \"Arcade\"\nname = \"arcade\"\ncorridor = true\n");
    let (mut rooms, mut openings) = (room("Arcade", [0.0, 4.0, 40.0, 6.4]), String::new());
    let mut viewpoints = viewpoint("Arcade", [20.0, 5.2], 0.0);
    let switch = |number: usize, room: &str, at: [f32; 2], yaw: f32| {
        let [x, y] = at;
        format!(
            "[[placement]]\ninstance = \"LightSwitch_01_{number}\"\nroom = \"{room}\"\nat_m = [{x:.3}, {y:.3}, 1.15]\n\
             yaw_deg = {yaw:.1}\n"
        )
    };
    let mut switches = switch(ROOMS + 1, "Arcade", [0.085, 5.2], 0.0);
    for number in 1..=ROOMS {
        let (id, name) = named(number);
        let _ = write!(head, "[[room]]\nid = \"{id}\"\nname = \"{name}\"\n");
        let is_southern = number <= SOUTHERN;
        let west = 4.0 * ((number - 1) % SOUTHERN) as f32;
        let [south, wall, yaw] = if is_southern { [0.0, 4.0, 90.0] } else { [6.4, 6.4, -90.0] };
        rooms += &room(&id, [west, south, west + 4.0, south + 4.0]);
        viewpoints += &viewpoint(&id, [west + 2.0, south + 2.0], yaw);
        let between = if is_southern { [id.as_str(), "Arcade"] } else { ["Arcade", id.as_str()] };
        let _ = write!(
            openings,
            "[[opening]]\nkind = \"passage\"\nbetween = {between:?}\nat_m = [{:.1}, {wall:.1}]\nwidth_m = 1.0\nwall_runs = \"x\"\n",
            west + 2.0,
        );
        let beside = if is_southern { wall - 0.085 } else { wall + 0.085 };
        switches += &switch(number, &id, [west + 0.8, beside], -yaw);
    }
    head += "words = [\"winter garden\"]\ncolor = \"#c0ffee\"\n";
    let plan = [rooms, openings, switches, viewpoints].concat();
    let files = [("world.toml", head), ("layouts/Twenty.toml", plan), ("missions/tour.json", MISSION.to_owned())];
    let files = files.map(|(path, text)| PackFile { path: path.to_owned(), bytes: text.into_bytes() });
    WorldData::layered(vec![WorldPack::parse("twenty", files.into()).unwrap()]).unwrap()
}

fn room(id: &str, [west, south, east, north]: [f32; 4]) -> String {
    format!(
        "[[room]]\nid = \"{id}\"\nrects_m = [[{west:.1}, {south:.1}, {east:.1}, {north:.1}]]\ncircuit = 1\n\
         floor = {{ material = \"wood\", color = \"#9a8468\" }}\nwall = {{ material = \"plain\", color = \"#e6e2d8\" }}\n"
    )
}

fn viewpoint(room: &str, [x, y]: [f32; 2], yaw_deg: f32) -> String {
    format!("[[viewpoint]]\nroom = \"{room}\"\nnumber = 1\nat_m = [{x:.1}, {y:.1}]\nyaw_deg = {yaw_deg:.1}\n")
}
