//! Which thing a client means: by number, by instance id, by class, or by a description, which the robot's language reads.

use std::sync::Arc;

use cohabit_cdf::{Catalog, GoToTarget, ObjectId, RoomId, suggestion};
use cohabit_language::{Context, Known, KnownObject, Language};

use crate::limits::MOST_FITTING;

/// Articles, which a description may begin with.
const ARTICLES: [&str; 3] = ["the ", "a ", "an "];

/// The words for things.
pub(crate) struct Things {
    language: Language,
}

impl Things {
    /// The words for things of these classes.
    pub fn new(catalog: &Arc<Catalog>) -> Self {
        Self { language: Language::new(Arc::clone(catalog)) }
    }

    /// What people would call a thing: `the red mug on the desk`.
    pub fn name(&self, object: ObjectId, scene: &Known) -> String {
        self.language.name(object, scene)
    }

    /// Where to walk: to a room, or to the one thing that is meant.
    ///
    /// # Errors
    /// Why it is not clear which, or that there is none.
    pub fn place(&self, text: &str, scene: &Known) -> Result<GoToTarget, String> {
        match self.room(text) {
            Some(room) => Ok(GoToTarget::Room(room)),
            None => self.object(text, scene).map(GoToTarget::Object),
        }
    }

    /// The one thing that is meant.
    ///
    /// # Errors
    /// Why it is not clear which, or that there is none.
    pub fn object(&self, text: &str, scene: &Known) -> Result<ObjectId, String> {
        if let Ok(number) = text.parse() {
            let object = scene.object(ObjectId(number)).map(|object| object.id);
            return object.ok_or_else(|| format!("there is no thing of number {number}: `look` lists those in sight"));
        }
        match self.fitting(text, scene).as_slice() {
            [] => Err(self.nothing(text, scene)),
            [one] => Ok(*one),
            several => Err(self.several(text, several, scene)),
        }
    }

    /// The room that is called so. What is the name of one is no other word for another, as where the robot understands people: the
    /// kitchen of a home is not the break room of an office.
    fn room(&self, text: &str) -> Option<RoomId> {
        let text = bare(text);
        let rooms = self.language.catalog().rooms();
        let is_said_for = |word: &String| word.eq_ignore_ascii_case(&text);
        let by_word = || rooms.all().iter().find(|room| room.words.iter().any(is_said_for)).map(|room| room.id);
        rooms.find(&text).or_else(by_word)
    }

    /// All things that are meant, the likeliest first.
    fn fitting(&self, text: &str, scene: &Known) -> Vec<ObjectId> {
        let of_instance = all(scene, |object| object.instance.eq_ignore_ascii_case(text));
        if !of_instance.is_empty() {
            return of_instance;
        }
        match self.language.catalog().find(text) {
            Some(class) => all(scene, |object| object.class == class),
            None => self.described(text, scene),
        }
    }

    /// Those that are as they are described.
    fn described(&self, text: &str, scene: &Known) -> Vec<ObjectId> {
        let request = format!("go to the {}", bare(text));
        let referents = self.language.referents(&request, scene, &Context::default());
        referents.map(|referents| referents.fitting()).unwrap_or_default()
    }

    fn nothing(&self, text: &str, scene: &Known) -> String {
        let catalog = self.language.catalog();
        let is_there = |name: &String| {
            let class = catalog.class_of_instance(name);
            class.is_some_and(|class| scene.objects.iter().any(|object| object.class == class))
        };
        let near = catalog.near(text).filter(is_there);
        let meant = near.map_or_else(String::new, |near| format!("{} ", suggestion(&near)));
        let advice = "use a plainer word, or the number of a thing that `look` lists";
        format!("nothing here is `{text}`, in any room: {meant}{advice}")
    }

    fn several(&self, text: &str, objects: &[ObjectId], scene: &Known) -> String {
        let objects = objects.iter().filter_map(|id| scene.object(*id));
        let mut fitting: Vec<(f32, &KnownObject)> = objects.map(|object| (scene.distance_m(object), object)).collect();
        fitting.sort_by(|(one, _), (other, _)| one.total_cmp(other));
        let rest = fitting.len().saturating_sub(MOST_FITTING);
        let nearest = fitting.into_iter().take(MOST_FITTING);
        let mut lines: Vec<String> = nearest.map(|(away_m, object)| self.candidate(away_m, object, scene)).collect();
        if rest > 0 {
            lines.push(format!("and {rest} more, farther away"));
        }
        format!("several things fit `{text}`: name one by its number or its instance id\n{}", lines.join("\n"))
    }

    /// A thing that may be meant, with its distance, m.
    fn candidate(&self, away_m: f32, object: &KnownObject, scene: &Known) -> String {
        let (name, room) = (self.name(object.id, scene), object.room.name_in(self.language.catalog()));
        format!("{}: {name} [{}]; in the {room}, {away_m:.1} m away", object.id.0, object.instance)
    }
}

/// A description without its article, in small letters.
fn bare(text: &str) -> String {
    let text = text.trim().to_lowercase();
    let bare = ARTICLES.iter().find_map(|article| text.strip_prefix(article)).map(str::to_owned);
    bare.unwrap_or(text)
}

fn all(scene: &Known, is: impl Fn(&KnownObject) -> bool) -> Vec<ObjectId> {
    scene.objects.iter().filter(|object| is(object)).map(|object| object.id).collect()
}

#[cfg(test)]
mod tests {
    use cohabit_cdf::{WorldData, WorldPack};

    use super::*;
    use crate::scene::scene;

    #[test]
    fn a_thing_is_found_by_number_by_id_and_by_description() {
        let catalog = Arc::new(Catalog::builtin());
        let (things, scene) = (Things::new(&catalog), scene(&catalog));
        for (text, expected) in [
            ("1", 1),
            ("CoffeeMug_Yellow_1", 1),
            ("coffeemug_boss_1", 0),
            ("Bowl_01", 2),
            ("bowl", 2),
            ("The bowl", 2),
            ("the yellow mug", 1),
            ("a yellow cup", 1),
        ] {
            assert_eq!(things.object(text, &scene), Ok(ObjectId(expected)), "{text}");
        }
    }

    #[test]
    fn where_several_things_fit_they_are_named_and_where_none_does_that_is_said() {
        let catalog = Arc::new(Catalog::builtin());
        let (things, scene) = (Things::new(&catalog), scene(&catalog));
        let several = things.object("mug", &scene).unwrap_err();
        let lines: Vec<&str> = several.lines().collect();
        assert_eq!(lines.len(), 3, "{several}");
        assert!(lines[0].starts_with("several things fit `mug`: name one by its number"), "{several}");
        for (line, [begin, end]) in lines[1..].iter().zip([
            ["0: the ", " [CoffeeMug_Boss_1]; in the break room, 1.0 m away"],
            ["1: the ", " [CoffeeMug_Yellow_1]; in the break room, 2.8 m away"],
        ]) {
            assert!(line.starts_with(begin) && line.ends_with(end), "{several}");
        }
        for (text, part) in [
            ("9", "no thing of number 9"),
            ("the green mug", "nothing here is `the green mug`"),
            ("hammer", "nothing here is `hammer`, in any room: use a plainer word"),
            ("xylophone", "nothing here is `xylophone`, in any room: use a plainer word"),
        ] {
            let refused = things.object(text, &scene).unwrap_err();
            assert!(refused.contains(part), "{text}: {refused}");
        }
        let near = things.nothing("Bowl_02", &scene);
        assert!(near.contains("did you mean `Bowl_01`?"), "{near}");
    }

    #[test]
    fn of_many_things_that_fit_the_nearest_are_named() {
        let catalog = Arc::new(Catalog::builtin());
        let (things, mut scene) = (Things::new(&catalog), scene(&catalog));
        let mug = scene.objects[0].clone();
        let far = (10..).zip([9.0; MOST_FITTING]);
        let copy = |(id, x_m)| KnownObject { id: ObjectId(id), position_m: [x_m, 0.0, 0.8], ..mug.clone() };
        scene.objects.extend(far.map(copy));
        let several = things.object("CoffeeMug_Boss", &scene).unwrap_err();
        let lines: Vec<&str> = several.lines().collect();
        assert_eq!(lines.len(), 2 + MOST_FITTING, "{several}");
        assert!(lines[1].starts_with("0: ") && lines[1].ends_with(", 1.0 m away"), "{several}");
        assert_eq!(lines.last(), Some(&"and 1 more, farther away"));
    }

    #[test]
    fn rooms_are_places_to_walk_to() {
        let catalog = Arc::new(Catalog::builtin());
        let (things, scene) = (Things::new(&catalog), scene(&catalog));
        for text in ["BreakRoom", "the break room", "Kitchen"] {
            assert_eq!(things.place(text, &scene), Ok(GoToTarget::Room(RoomId::BREAK_ROOM)), "{text}");
        }
        assert_eq!(things.place("bowl", &scene), Ok(GoToTarget::Object(ObjectId(2))));
    }

    #[test]
    fn the_name_of_a_room_is_no_other_word_for_another() {
        let pack = WorldPack::builtin("homes").unwrap();
        let catalog = Arc::clone(WorldData::layered(vec![pack]).unwrap().catalog());
        let (things, scene) = (Things::new(&catalog), scene(&catalog));
        for (text, id) in [
            ("Kitchen", "Kitchen"),
            ("the kitchen", "Kitchen"),
            ("dining room", "DiningRoom"),
            ("sitting room", "LivingRoom"),
            ("cafeteria", "BreakRoom"),
        ] {
            assert_eq!(things.place(text, &scene), Ok(GoToTarget::Room(RoomId::new(id).unwrap())), "{text}");
        }
    }
}
