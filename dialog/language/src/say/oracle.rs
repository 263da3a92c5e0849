//! Answers to the robot's questions from all that is true: for simulated users, and for data.
//!
//! The templates are those of Alexa Arena's oracle (Gao et al. 2023, "Oracle Answers").

use cohabit_cdf::{
    Catalog, Layout, ObjectId,
    layout::Viewpoint,
    model::{Material, Shape},
};

use crate::known::{Known, KnownObject, describe, within_half_turn};

/// How near a thing must be to be a landmark, m.
const LANDMARK_M: f32 = 1.5;
/// A bearing of less is in front, of more than a half turn less so much is behind, rad.
const AHEAD_RAD: f32 = std::f32::consts::FRAC_PI_4;
/// Who goes less far need not have moved, m.
const STEP_M: f32 = 0.3;

/// Somebody who knows all.
#[derive(Clone, Copy, Debug)]
pub struct Oracle<'a> {
    catalog: &'a Catalog,
    truth: &'a Known,
}

impl<'a> Oracle<'a> {
    /// The oracle of a world: `truth` is all that is in it, and where the robot stands.
    #[must_use]
    pub const fn new(catalog: &'a Catalog, truth: &'a Known) -> Self {
        Self { catalog, truth }
    }

    /// Where is it? `The mug is to your left on the desk next to the lamp in the main office. It is closest to
    /// viewpoint 3.`, of those of its room in the floor plan.
    #[must_use]
    pub fn location(&self, id: ObjectId, layout: &Layout) -> String {
        let Some(object) = self.truth.object(id) else { return "It is not there any more.".to_owned() };
        let mut parts = vec![format!("The {} is", describe::bare(self.catalog, self.truth, id))];
        if object.room == self.truth.robot.room {
            parts.push(direction(self.truth.bearing_rad(object)).to_owned());
        }
        if let Some(parent) = object.parent.and_then(|parent| self.truth.object(parent)) {
            let preposition = describe::inside(self.catalog, parent.class);
            parts.push(format!("{preposition} {}", describe::short(self.catalog, self.truth, parent.id)));
        }
        if let Some(landmark) = self.landmark(object) {
            parts.push(format!("next to {}", describe::short(self.catalog, self.truth, landmark)));
        }
        parts.push(format!("in the {}.", object.room.name_in(self.catalog)));
        let [x, y, _] = object.position_m;
        let away = |view: &Viewpoint| (view.at_m[0] - x).hypot(view.at_m[1] - y);
        let here = layout.viewpoints.iter().filter(|view| view.room == object.room);
        if let Some(nearest) = here.min_by(|one, other| away(one).total_cmp(&away(other))) {
            parts.push(format!("It is closest to viewpoint {}.", nearest.number));
        }
        parts.join(" ")
    }

    /// What does it look like? `The mug is round and red. It is made of ceramic.`
    #[must_use]
    pub fn appearance(&self, id: ObjectId) -> String {
        let Some(object) = self.truth.object(id) else { return "It is not there any more.".to_owned() };
        let name = describe::name(self.catalog, object.class);
        let color = describe::color(self.catalog, object);
        let parts = &self.catalog.model(object.class).parts;
        let largest = parts.iter().max_by(|one, other| bulk_m3(&one.shape).total_cmp(&bulk_m3(&other.shape)));
        let Some(part) = largest else { return format!("The {name} is {color}.") };
        let made = substance(part.material).map(|of| format!(" It is made of {of}.")).unwrap_or_default();
        let form = form(&part.shape).map(|form| format!("{form} and ")).unwrap_or_default();
        format!("The {name} is {form}{color}.{made}")
    }

    /// Which direction? `You should turn left.`
    #[must_use]
    pub fn direction(&self, id: ObjectId) -> String {
        let object = self.truth.object(id);
        turn(object.map_or(0.0, |object| self.truth.bearing_rad(object))).unwrap_or_else(|| STAY.to_owned())
    }

    /// Which direction, to get to `to_m` (x, y in the world, m)? As the paper has it: where the robot stands is compared with
    /// where it is in the end. `You should turn left.`, `You should go straight ahead.`, `You don't need to move.`
    #[must_use]
    pub fn way(&self, to_m: [f32; 2]) -> String {
        let [x, y, _] = self.truth.robot.position_m;
        let [dx, dy] = [to_m[0] - x, to_m[1] - y];
        if dx.hypot(dy) < STEP_M {
            return STAY.to_owned();
        }
        let bearing_rad = within_half_turn(dy.atan2(dx) - self.truth.robot.yaw_rad);
        turn(bearing_rad).unwrap_or_else(|| "You should go straight ahead.".to_owned())
    }

    /// Which one do you mean? `The red mug on the desk in the main office.`
    #[must_use]
    pub fn reference(&self, id: ObjectId) -> String {
        let Some(object) = self.truth.object(id) else { return "It is not there any more.".to_owned() };
        let name = describe::bare(self.catalog, self.truth, id);
        let color = describe::color(self.catalog, object);
        let colored = if color.is_empty() || name.contains(&color) { name } else { format!("{color} {name}") };
        let held = object.parent.and_then(|parent| self.truth.object(parent)).map(|parent| {
            let preposition = describe::inside(self.catalog, parent.class);
            format!(" {preposition} {}", describe::short(self.catalog, self.truth, parent.id))
        });
        format!("The {colored}{} in the {}.", held.unwrap_or_default(), object.room.name_in(self.catalog))
    }

    /// Something else that is kept by what keeps it, the nearest; nothing, if that is like it.
    fn landmark(&self, object: &KnownObject) -> Option<ObjectId> {
        let parent = object.parent?;
        let away = |other: &KnownObject| {
            let [dx, dy] = [0, 1].map(|axis| other.position_m[axis] - object.position_m[axis]);
            dx.hypot(dy)
        };
        let others = self.truth.objects.iter().filter(|other| other.id != object.id && other.parent == Some(parent));
        let near = others.filter(|other| other.class != object.class && away(other) < LANDMARK_M);
        near.min_by(|one, other| away(one).total_cmp(&away(other)).then(one.id.cmp(&other.id))).map(|other| other.id)
    }
}

/// What is answered where nothing is to be done.
const STAY: &str = "You don't need to move.";

/// Which way to turn towards what is seen at a bearing; nothing, where it is ahead.
fn turn(bearing_rad: f32) -> Option<String> {
    let way = match direction(bearing_rad) {
        "to your left" => "left",
        "to your right" => "right",
        "behind you" => "around",
        _ => return None,
    };
    Some(format!("You should turn {way}."))
}

/// Where something is that is seen at a bearing, positive to the left.
fn direction(bearing_rad: f32) -> &'static str {
    match bearing_rad {
        bearing if bearing.abs() <= AHEAD_RAD => "in front of you",
        bearing if bearing.abs() >= std::f32::consts::PI - AHEAD_RAD => "behind you",
        bearing if bearing > 0.0 => "to your left",
        _ => "to your right",
    }
}

/// About how much room it takes.
fn bulk_m3(shape: &Shape) -> f32 {
    let span = |values: &mut dyn Iterator<Item = f32>| {
        let (low, high) =
            values.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), value| (value.min(low), value.max(high)));
        (high - low).max(0.0)
    };
    match shape {
        Shape::Box { size, .. } => size.iter().product(),
        Shape::Cylinder { radius, height, .. } => 3.0 * radius * radius * height,
        Shape::Sphere { radii } => 4.0 * radii.iter().product::<f32>(),
        Shape::Lathe { profile } => {
            let radius = profile.iter().map(|[radius, _]| *radius).fold(0.0, f32::max);
            3.0 * radius * radius * span(&mut profile.iter().map(|[_, z]| *z))
        }
        Shape::Extrude { outline, height, .. } => {
            let side = |axis: usize| span(&mut outline.iter().map(|point| point[axis]));
            side(0) * side(1) * height
        }
        Shape::Mesh { points, .. } => {
            let side = |axis: usize| span(&mut points.iter().map(|point| point[axis]));
            side(0) * side(1) * side(2)
        }
        Shape::Tube { .. } | Shape::Text { .. } | Shape::Line { .. } => 0.0,
    }
}

/// The word for its form; none for a mesh, which may have any.
fn form(shape: &Shape) -> Option<&'static str> {
    match shape {
        Shape::Box { .. } => Some("rectangular"),
        Shape::Mesh { .. } => None,
        _ => Some("round"),
    }
}

/// What it is made of, where that is a word people use.
const fn substance(material: Material) -> Option<&'static str> {
    match material {
        Material::Plastic => Some("plastic"),
        Material::Metal => Some("metal"),
        Material::Wood => Some("wood"),
        Material::Glass => Some("glass"),
        Material::Ceramic => Some("ceramic"),
        Material::Fabric => Some("fabric"),
        Material::Paper => Some("paper"),
        _ => None,
    }
}
