//! Classes and models as the files of a world pack have them.

use std::fmt::{self, Write as _};

use cohabit_cdf::{
    ObjectClass,
    catalog::{Receptacle, Stands},
    model::{Material, Model, Part, Shape},
};

/// How many points or triangles stand on a line.
const ON_A_LINE: usize = 8;

/// A text in quotes.
struct Quoted<'a>(&'a str);

impl fmt::Display for Quoted<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", toml::Value::String(self.0.to_owned()))
    }
}

/// A number with at most four decimals.
struct Short(f32);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = format!("{:.4}", self.0);
        let text = text.trim_end_matches('0').trim_end_matches('.');
        f.write_str(if text == "-0" { "0" } else { text })
    }
}

/// Values in brackets.
fn list<T: fmt::Display>(values: impl IntoIterator<Item = T>) -> String {
    let values: Vec<String> = values.into_iter().map(|value| value.to_string()).collect();
    format!("[{}]", values.join(", "))
}

/// Values in brackets, a few of them on each line.
fn lines(values: &[String]) -> String {
    let lines: Vec<String> = values.chunks(ON_A_LINE).map(|some| format!("  {},\n", some.join(", "))).collect();
    format!("[\n{}]", lines.concat())
}

/// The `[[object]]` of a class.
#[must_use]
pub fn object(class: &ObjectClass) -> String {
    let mut text = format!("[[object]]\nid = {}\nname = {}\n", Quoted(&class.id), Quoted(&class.name));
    let mut add = |key: &str, value: String| {
        // Writing to a text does not fail.
        let _ = writeln!(text, "{key} = {value}");
    };
    if !class.words.is_empty() {
        add("words", list(class.words.iter().map(|word| Quoted(word))));
    }
    let properties = class.properties.iter().map(|property| format!("\"{}\"", format!("{property:?}").to_uppercase()));
    add("properties", list(properties));
    add("size_m", list(class.size_m.map(Short)));
    add("mass_kg", Short(class.mass_kg).to_string());
    add("color", Quoted(&class.color).to_string());
    if let Some(tint) = &class.tint {
        add("tint", Quoted(tint).to_string());
    }
    let stands = match class.stands {
        Stands::OnSurface => "on_surface",
        Stands::OnFloor => "on_floor",
        Stands::OnWall => "on_wall",
    };
    add("stands", Quoted(stands).to_string());
    if let Some(receptacle) = &class.receptacle {
        add("receptacle", receptacle_text(receptacle));
    }
    text
}

fn receptacle_text(receptacle: &Receptacle) -> String {
    let surfaces = receptacle.surfaces.iter().map(|surface| {
        format!(
            "{{ center_m = {}, size_m = {}, anchors = {}, clearance_m = {} }}",
            list(surface.center_m.map(Short)),
            list(surface.size_m.map(Short)),
            list(surface.anchors),
            Short(surface.clearance_m)
        )
    });
    format!("{{ surface = {} }}", list(surfaces))
}

/// The `[[model]]` of imported parts: meshes that stand where they are written.
#[must_use]
pub fn model(model: &Model) -> String {
    let parts: Vec<String> = model.parts.iter().map(part).collect();
    format!("[[model]]\nid = {}\n{}", Quoted(&model.id), parts.concat())
}

fn part(part: &Part) -> String {
    let Shape::Mesh { points, triangles, smooth_deg } = &part.shape else { return String::new() };
    let mut text = format!("\n[[model.part]]\nshape = \"mesh\"\ncolor = {}\n", Quoted(&part.color));
    let mut add = |key: &str, value: String| {
        let _ = writeln!(text, "{key} = {value}");
    };
    if part.material != Material::Plain {
        add("material", format!("\"{}\"", format!("{:?}", part.material).to_lowercase()));
    }
    if let Some(opacity) = part.opacity {
        add("opacity", Short(opacity).to_string());
    }
    if let Some(angle) = smooth_deg {
        add("smooth_deg", Short(*angle).to_string());
    }
    let points: Vec<String> = points.iter().map(|point| list(point.map(Short))).collect();
    let triangles: Vec<String> = triangles.iter().map(list).collect();
    add("points", lines(&points));
    add("triangles", lines(&triangles));
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_as_short_as_they_can_be() {
        let shown = [0.0, -0.0, 1.0, -0.00001, 0.1234, -12.5, 0.00006, 10.0].map(|value| Short(value).to_string());
        assert_eq!(shown, ["0", "0", "1", "0", "0.1234", "-12.5", "0.0001", "10"]);
    }

    #[test]
    fn texts_are_quoted() {
        assert_eq!(Quoted("mug").to_string(), "\"mug\"");
        let sly = "a\"\nid = 'b'\\";
        let read: toml::Table = toml::from_str(&format!("name = {}", Quoted(sly))).unwrap();
        assert_eq!(read["name"].as_str(), Some(sly));
    }
}
