//! Contact sheets: every class in each of its states, and those who act, so that a person sees what can be told apart.
//!
//! What a sheet shows follows from the catalogue: the properties of a class say which states it can have.

use std::sync::Arc;

use cohabit_cdf::layout::{Finish, Layout, Room};
use cohabit_cdf::model::{Material, When};
use cohabit_cdf::{Catalog, ClassId, Color, Fluid, Property, RoomId, StateFlag, StateFlags};
use glam::Vec3;

use crate::instance::{Instance, Look};
use crate::kit;
use crate::library::MeshLibrary;
use crate::mesh::Aabb;
use crate::signs::SIGNS;
use crate::{Camera, Planes, Renderer, Scene};

#[cfg(test)]
mod tests;

/// Classes on a sheet of one group.
const CLASSES_PER_SHEET: usize = 14;
/// Pictures in a row.
const COLUMNS: usize = 8;
/// Height of the label under a picture, pixels.
const LABEL_PX: usize = 22;
/// The moment at which what moves is shown.
const NANOS: u64 = 1_370_000_000;

/// What signs are shown on, where the catalogue has it: large, small, and round.
const SIGNED: [&str; 3] = ["Desk_01", "PackingBox", "CandyJar_01"];
/// What bodies carry, where the catalogue has it.
const CARRIED: &str = "CoffeeMug_Yellow";

/// One picture of a sheet.
#[derive(Clone, Debug)]
pub struct Cell {
    /// What it shows.
    pub label: String,
    /// What stands in an empty room for it.
    pub instances: Vec<Instance>,
    /// The box that fills the picture: the least and the greatest coordinates, m.
    pub around: [[f32; 3]; 2],
}

/// Pictures that belong together.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// What they have in common; fit for a file's name.
    pub name: String,
    /// The pictures, row by row.
    pub cells: Vec<Cell>,
}

/// A picture, RGBA, row by row.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Four bytes a pixel.
    pub rgba: Vec<u8>,
}

/// A class in one of its states.
#[derive(Clone, Debug)]
pub struct State {
    /// What people call the state.
    pub label: String,
    /// The class in that state, at the origin.
    pub instance: Instance,
}

/// What a class can be, its usual state first; the rest follows from its properties.
#[must_use]
pub fn states(catalog: &Catalog, class: ClassId) -> Vec<State> {
    let has = |property| catalog.class(class).has(property);
    let shows = |when| catalog.model(class).parts.iter().any(|part| part.when == Some(when));
    let plain = plain(Look::Object(class));
    let mut all = vec![State { label: catalog.class(class).id.clone(), instance: plain.clone() }];
    let mut add = |label: &str, instance: Instance| all.push(State { label: label.to_owned(), instance });
    let with = |flag| Instance { flags: plain.flags.with(flag), ..plain.clone() };
    let without = |flag| {
        let mut flags = plain.flags;
        flags.set(flag, false);
        Instance { flags, ..plain.clone() }
    };
    let on = || Instance { running: 1.0, ..with(StateFlag::Toggled) };
    if has(Property::Openable) {
        add("open", Instance { opened: 1.0, ..with(StateFlag::Opened) });
    }
    if has(Property::Openable) {
        add("locked", with(StateFlag::Locked));
    }
    // What is no switch itself may be switched by another: a portal by its computer.
    if has(Property::Toggleable) || shows(When::On) {
        add("on", on());
    }
    if shows(When::Future) {
        add("to the future", Instance { look: Look::Gate { class, future: true }, ..on() });
    }
    let flags = [
        (Property::Powerable, "overloaded", StateFlag::Overloaded),
        (Property::Powerable, "sparking", StateFlag::Sparking),
        (Property::Breakable, "broken", StateFlag::Broken),
        (Property::Dirtyable, "dirty", StateFlag::Dirty),
        (Property::Heatable, "hot", StateFlag::Hot),
        (Property::Chillable, "cold", StateFlag::Cold),
        (Property::Cookable, "cooked", StateFlag::Cooked),
        (Property::Cuttable, "cut", StateFlag::Cut),
        (Property::Eatable, "eaten", StateFlag::Eaten),
        (Property::Infectable, "infected", StateFlag::Infected),
    ];
    if has(Property::Powerable) {
        add("no power", without(StateFlag::Powered));
    }
    for (_, label, flag) in flags.into_iter().filter(|(property, ..)| has(*property)) {
        add(label, with(flag));
    }
    if has(Property::Fillable) {
        for fluid in Fluid::ALL.into_iter().filter(|fluid| *fluid != Fluid::None) {
            // Into some one looks only while they are open.
            let filled = if has(Property::Openable) && !has(Property::Toggleable) {
                Instance { fluid, opened: 1.0, ..with(StateFlag::Opened) }
            } else {
                Instance { fluid, ..plain.clone() }
            };
            add(&fluid.name().to_lowercase(), filled);
        }
        if shows(When::Cereal) {
            add("cereal", Instance { fluid: Fluid::Milk, ..with(StateFlag::Cereal) });
        }
    }
    if has(Property::Pickupable) {
        for color in Color::ALL.into_iter().filter(|color| *color != Color::Original) {
            add(&color.name().to_lowercase(), Instance { color, ..plain.clone() });
        }
        add("embiggened", Instance { scale: [2.0; 3], ..with(StateFlag::Embiggenated) });
    }
    all
}

/// All sheets: those who act, signs of states, then every class that can be more than one thing, then the rest.
pub fn sheets<'a>(meshes: &'a MeshLibrary, catalog: &'a Catalog) -> impl Iterator<Item = Sheet> + 'a {
    let sheets = sheets_of(meshes, catalog, catalog.class_ids());
    [bodies(meshes, catalog), signs(meshes, catalog)].into_iter().chain(sheets)
}

/// Sheets of these classes alone.
pub fn sheets_of<'a>(
    meshes: &'a MeshLibrary,
    catalog: &'a Catalog,
    classes: impl Iterator<Item = ClassId>,
) -> impl Iterator<Item = Sheet> + 'a {
    let (still, changing): (Vec<_>, Vec<_>) = classes.partition(|class| states(catalog, *class).len() == 1);
    let changing: Vec<Vec<ClassId>> = changing.chunks(CLASSES_PER_SHEET).map(<[_]>::to_vec).collect();
    let still: Vec<Vec<ClassId>> = still.chunks(CLASSES_PER_SHEET * 4).map(<[_]>::to_vec).collect();
    let named = |name: &'static str, groups: Vec<Vec<ClassId>>| {
        groups.into_iter().enumerate().map(move |(index, group)| Sheet {
            name: format!("{name}-{}", index + 1),
            cells: group.into_iter().flat_map(|class| cells(meshes, catalog, class)).collect(),
        })
    };
    named("states", changing).chain(named("decor", still))
}

/// A class in all its states.
#[must_use]
pub fn cells(meshes: &MeshLibrary, catalog: &Catalog, class: ClassId) -> Vec<Cell> {
    let bounds = meshes.bounds(class);
    let cell = |state: State| {
        let scale = state.instance.scale[0];
        let mut around = Aabb { min: bounds.min * scale, max: bounds.max * scale };
        let grown = if state.instance.opened > 0.0 { 0.3 } else { 0.06 };
        around.max += (around.max - around.min) * grown;
        around.min -= ((around.max - around.min) * grown).with_z(0.0);
        let signed = [StateFlag::Hot, StateFlag::Overloaded, StateFlag::Infected];
        if signed.into_iter().any(|flag| state.instance.flags.has(flag)) {
            around.max.z += (around.max.x - around.min.x).clamp(0.06, 0.3);
        }
        Cell { label: state.label, instances: vec![state.instance], around: [around.min.into(), around.max.into()] }
    };
    states(catalog, class).into_iter().map(cell).collect()
}

fn plain(look: Look) -> Instance {
    Instance {
        id: 1,
        look,
        position_m: [0.0; 3],
        rotation: [0.0, 0.0, 0.0, 1.0],
        scale: [1.0; 3],
        flags: StateFlags::default().with(StateFlag::Powered),
        fluid: Fluid::None,
        color: Color::Original,
        opened: 0.0,
        running: 0.0,
        room: RoomId::LAB1,
        visible: true,
    }
}

/// The robot, people in all outfits, what they do and which faces they show, a note, and what is poured.
fn bodies(meshes: &MeshLibrary, catalog: &Catalog) -> Sheet {
    let robot = |head_pitch_rad, arm, holds, rolled_m| Look::Robot { head_pitch_rad, arm, holds, rolled_m };
    let person =
        |outfit, arm, holds, walked_m, pace| Look::Person { outfit, head_pitch_rad: 0.0, arm, holds, walked_m, pace };
    let cell =
        |label: &str, instance: Instance, around| Cell { label: label.to_owned(), instances: vec![instance], around };
    let whole = [[-0.25, -0.3, 0.0], [0.3, 0.3, 1.76]];
    let head = [[-0.12, -0.14, 1.42], [0.14, 0.14, 1.76]];
    let small = [[-0.25, -0.28, 0.0], [0.3, 0.28, 1.36]];
    let face = [[-0.16, -0.19, 1.02], [0.18, 0.19, 1.34]];
    let mut cells = Vec::new();
    for (label, look) in [
        ("robot", robot(0.0, 0.0, false, 0.0)),
        ("reaches", robot(0.0, 1.0, false, 0.03)),
        ("looks up", robot(0.5, 0.0, false, 0.0)),
        ("holds", robot(-0.3, 0.0, true, 0.06)),
    ] {
        cells.push(cell(label, plain(look), small));
    }
    for outfit in 0..meshes.bodies().people.len() as u32 {
        cells.push(cell(&format!("person {outfit}"), plain(person(outfit, 0.0, false, 0.0, 0.0)), whole));
    }
    for (label, look) in [
        ("walks", person(0, 0.0, false, 0.25, 1.0)),
        ("walks on", person(1, 0.0, false, 0.6, 1.0)),
        ("walks so", person(2, 0.0, false, 0.95, 1.0)),
        ("reaches", person(3, 1.0, false, 0.0, 0.0)),
        ("holds", person(4, 0.0, true, 0.0, 0.0)),
        ("walks, holds", person(5, 0.0, true, 0.3, 1.0)),
    ] {
        cells.push(cell(label, plain(look), whole));
    }
    // Where the world's bodies carry things, seen from their middle on the floor, m.
    for (label, look, at) in [
        ("carries", robot(-0.3, 0.0, true, 0.0), [0.42, -0.16, 0.82]),
        ("hands over", robot(-0.2, 1.0, true, 0.0), [0.72, -0.16, 0.82]),
        ("carries", person(1, 0.0, true, 0.0, 0.0), [0.4, -0.2, 1.0]),
        ("hands over", person(2, 1.0, true, 0.0, 0.0), [0.7, -0.2, 1.0]),
    ] {
        let mut carrying = cell(label, plain(look), [[-0.25, -0.3, 0.3], [0.6, 0.3, 1.5]]);
        if let Some(class) = catalog.find(CARRIED) {
            carrying.instances.push(Instance { id: 2, position_m: at, ..plain(Look::Object(class)) });
        }
        cells.push(carrying);
    }
    for mood in StateFlag::MOODS {
        let label = format!("{mood:?}").to_lowercase();
        let flags = StateFlags::default().with(mood);
        // Turned towards who looks.
        let (sin, cos) = libm::sincosf(-0.25);
        let of = |look| Instance { flags, rotation: [0.0, 0.0, sin, cos], ..plain(look) };
        cells.push(cell(&label, of(robot(0.0, 0.0, false, 0.0)), face));
        cells.push(cell(&label, of(person(u32::from(flags.has(StateFlag::Sad)), 0.0, false, 0.0, 0.0)), head));
    }
    cells.push(cell("note", plain(Look::Note {}), [[0.0, -0.05, 0.0], [0.01, 0.05, 0.1]]));
    for fluid in [Fluid::Water, Fluid::Milk, Fluid::Coffee] {
        let stream = Instance { position_m: [0.0, 0.0, 0.25], fluid, ..plain(Look::Stream { height_m: 0.25 }) };
        cells.push(cell(&format!("{} flows", fluid.name()), stream, [[-0.06, -0.06, 0.0], [0.06, 0.06, 0.26]]));
    }
    Sheet { name: "bodies".to_owned(), cells }
}

/// Every sign, on things whose own models show no states.
fn signs(meshes: &MeshLibrary, catalog: &Catalog) -> Sheet {
    let mut cells = Vec::new();
    for class in SIGNED.iter().filter_map(|id| catalog.find(id)) {
        let bounds = meshes.bounds(class);
        let grown = bounds.size() * 0.2 + Vec3::splat(0.06);
        let around = [(bounds.min - grown.with_z(0.0)).into(), (bounds.max + grown).into()];
        for sign in &SIGNS {
            let instance = plain(Look::Object(class));
            let instances = vec![Instance { flags: instance.flags.with(sign.flag), ..instance }];
            cells.push(Cell { label: format!("{:?}", sign.flag).to_lowercase(), instances, around });
        }
    }
    Sheet { name: "signs".to_owned(), cells }
}

impl Sheet {
    /// Draws all pictures of a sheet, each `cell_px` wide and high, with its label below.
    pub fn paint(&self, renderer: &mut dyn Renderer, meshes: &Arc<MeshLibrary>, cell_px: u32) -> Picture {
        let side = cell_px as usize;
        let columns = self.cells.len().clamp(1, COLUMNS);
        let rows = self.cells.len().div_ceil(columns);
        let (width, height) = (columns * side, rows * (side + LABEL_PX));
        let mut rgba = vec![255_u8; width * height * 4];
        let mut stage = stage(meshes);
        for (index, cell) in self.cells.iter().enumerate() {
            let portrait = cell.paint(renderer, &mut stage, cell_px);
            let (left, top) = (index % columns * side, index / columns * (side + LABEL_PX));
            for (row, line) in portrait.chunks(side * 4).enumerate() {
                let start = ((top + row) * width + left) * 4;
                rgba[start..start + line.len()].copy_from_slice(line);
            }
            write(&mut rgba, width, [left + 4, top + side + LABEL_PX - 6], &cell.label, side);
        }
        Picture { width: width as u32, height: height as u32, rgba }
    }
}

impl Cell {
    /// Puts its instances, and nothing else, on a stage.
    pub fn enter(&self, stage: &mut Scene) {
        stage.set_instances(&self.instances);
    }

    /// A camera that looks at its box from the front, a little from above and from the side.
    #[must_use]
    pub fn camera(&self, side_px: u32) -> Camera {
        let [min, max] = self.around.map(Vec3::from_array);
        let (middle, radius) = ((min + max) * 0.5, ((max - min).length() * 0.5).max(0.01));
        let fov_y_rad = 0.6_f32;
        let distance = radius / libm::sinf(fov_y_rad * 0.5);
        let (yaw, pitch) = (0.62_f32, 0.42_f32);
        let back =
            Vec3::new(libm::cosf(pitch) * libm::cosf(yaw), -libm::cosf(pitch) * libm::sinf(yaw), libm::sinf(pitch));
        Camera {
            position_m: (middle + back * distance).into(),
            yaw_rad: core::f32::consts::PI - yaw,
            pitch_rad: -pitch,
            fov_y_rad,
            width: side_px,
            height: side_px,
            hide: None,
            for_people: true,
            ceiling: false,
        }
    }

    fn paint(&self, renderer: &mut dyn Renderer, stage: &mut Scene, side_px: u32) -> Vec<u8> {
        self.enter(stage);
        let camera = self.camera(side_px);
        let mut color = vec![0; camera.pixels() * 4];
        renderer.render(stage, &camera, &mut Planes { color: Some(&mut color), ..Planes::default() });
        color
    }
}

/// A large empty room, at a moment at which what moves can be seen to.
#[must_use]
pub fn stage(meshes: &Arc<MeshLibrary>) -> Scene {
    let mut scene = Scene::new(Arc::clone(meshes), &studio());
    scene.set_time(NANOS);
    scene
}

fn studio() -> Layout {
    let finish = |color: &str| Finish { material: Material::Plain, color: color.to_owned() };
    let room = Room {
        id: RoomId::LAB1,
        rects_m: vec![[-20.0, -20.0, 20.0, 20.0]],
        floor: finish("#b9b6ae"),
        wall: finish("#c8c6be"),
        wainscot: None,
        circuit: 1,
    };
    Layout {
        id: "studio".to_owned(),
        wall_height_m: 6.0,
        rooms: vec![room],
        openings: Vec::new(),
        placements: Vec::new(),
        viewpoints: Vec::new(),
        note_places: Vec::new(),
    }
}

/// Writes a line of text whose baseline begins at `at`, no wider than `most_px`.
fn write(rgba: &mut [u8], width: usize, at: [usize; 2], text: &str, most_px: usize) {
    let strokes = kit::line_of_text(text);
    let wide = strokes.iter().flatten().fold(1.0_f32, |most, point| most.max(point[0]));
    // Pixels a unit of the font, whose capitals are one unit high.
    let unit = ((most_px as f32 - 10.0) / wide).min(11.0);
    for [from, to] in strokes {
        let steps = ((to[0] - from[0]).hypot(to[1] - from[1]) * unit * 2.0) as usize + 1;
        for step in 0..=steps {
            let share = step as f32 / steps as f32;
            let point = |axis: usize| (from[axis] + (to[axis] - from[axis]) * share) * unit;
            let (x, y) = (at[0] as f32 + point(0), at[1] as f32 - point(1));
            dot(rgba, width, x, y);
        }
    }
}

/// A soft dark point.
fn dot(rgba: &mut [u8], width: usize, x: f32, y: f32) {
    for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
        let (px, py) = (x.floor() + dx, y.floor() + dy);
        let share = (1.0 - (px - x).abs()) * (1.0 - (py - y).abs());
        let start = (py.max(0.0) as usize * width + px.max(0.0) as usize) * 4;
        if let Some(pixel) = rgba.get_mut(start..start + 3) {
            for byte in pixel {
                *byte = (*byte).min((255.0 - 225.0 * share) as u8);
            }
        }
    }
}
