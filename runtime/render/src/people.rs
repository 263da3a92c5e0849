//! Outfits: one person's shape, dressed and coloured so that several people are told apart.

use cohabit_cdf::model::Model;

/// How one person looks: what is put on the bare figure, and what its colours become.
struct Outfit {
    /// Models of `bodies.toml` whose parts are added.
    wears: &'static [&'static str],
    /// Shirt, trousers, shoes, hair, skin and the skin's shade.
    colors: [&'static str; 6],
}

/// The colours of the bare figure, in the same order.
const BASE: [&str; 6] = ["tint", "#3f4a5c", "#4a3a30", "#4a2f22", "#d69c78", "#c98f6d"];

const OUTFITS: [Outfit; 6] = [
    Outfit {
        wears: &["hair_short", "badge", "sleeves_long"],
        colors: ["#a4472f", "#3f4a5c", "#4a3a30", "#4a2f22", "#d69c78", "#c98f6d"],
    },
    Outfit {
        wears: &["hair_long", "badge", "sleeves_short", "skirt"],
        colors: ["#3d7a86", "#2f3440", "#6e2f3a", "#2a211d", "#b07a58", "#a06c4c"],
    },
    Outfit {
        wears: &["hair_short", "glasses", "lab_coat", "sleeves_long"],
        colors: ["#eceae4", "#5b5f66", "#2c2b2b", "#8d8a86", "#e3b596", "#d6a383"],
    },
    Outfit {
        wears: &["hair_bun", "glasses", "sleeves_long", "scarf"],
        colors: ["#c9a24a", "#4a4658", "#3a2f2a", "#7a3f22", "#e6b795", "#d8a583"],
    },
    Outfit {
        wears: &["hair_short", "beard", "sleeves_short", "badge"],
        colors: ["#5c7f52", "#6a5a48", "#d9d5cc", "#1f1a18", "#7f5238", "#714730"],
    },
    Outfit {
        wears: &["hair_curly", "sleeves_short", "badge"],
        colors: ["#7a5f9c", "#3a5276", "#e0ddd6", "#2b1c14", "#94633f", "#855736"],
    },
];

/// The models of all people, dressed, from the parts in `own`.
pub(crate) fn dressed(own: &[Model]) -> Vec<Model> {
    let named = |id: &str| own.iter().find(|model| model.id == id).expect("invariant: bodies.toml has every outfit");
    let person = named("person");
    let dress = |outfit: &Outfit| {
        let mut model = person.clone();
        for id in outfit.wears {
            model.parts.extend_from_slice(&named(id).parts);
        }
        for part in &mut model.parts {
            if let Some(index) = BASE.iter().position(|base| *base == part.color) {
                part.color = outfit.colors[index].to_owned();
            }
        }
        model
    };
    OUTFITS.iter().map(dress).collect()
}
