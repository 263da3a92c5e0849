//! Floor plans by their number: each follows from the seed and its number alone, and is checked before it is handed out.

use cohabit_cdf::{Layout, RoomEntry, RoomId};

use crate::{
    chance::Chance,
    draft::{Draft, Tables},
    furniture::FurnitureTable,
    kind::Kind,
    text::text,
    things::ThingTable,
};

/// Drafts of one plan that are tried before it is given up.
const MOST_DRAFTS: usize = 200;

/// Why floor plans cannot be made.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// No plan has so few or so many rooms.
    #[error("floor plans of {rooms} rooms cannot be made: the rooms of {} are from 1 to {most}, without the hallway", article(*.kind))]
    Rooms {
        /// What was asked for.
        rooms: usize,
        /// The kind of building.
        kind: Kind,
        /// The most rooms that it may have.
        most: usize,
    },
    /// No draft went together.
    #[error("floor plan {number} was given up after {MOST_DRAFTS} drafts: take another seed, or fewer rooms")]
    GivenUp {
        /// Its number.
        number: u64,
    },
    /// A pack has no such name.
    #[error("`{name}` is no name of a world pack: {}", cohabit_cdf::world_pack::NAME_RULE)]
    Name {
        /// What was asked for.
        name: String,
    },
    /// A pack that comes with the program has this name.
    #[error("`{name}` is the name of a world pack that comes with the program: take another one")]
    Taken {
        /// What was asked for.
        name: String,
    },
    /// A pack has no such number of plans.
    #[error("a world pack of {count} floor plans cannot be made: from 1 to {most}")]
    Count {
        /// What was asked for.
        count: usize,
        /// The most that a pack may have.
        most: usize,
    },
}

/// `an office`.
fn article(kind: Kind) -> String {
    format!("{} {kind}", if kind == Kind::Office { "an" } else { "a" })
}

/// A floor plan of a kind, made at random.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct FloorPlan {
    /// Its id: kind, rooms, seed and number.
    pub id: String,
    /// Its file's text, in the format of floor plans of world packs.
    pub text: String,
    /// Its rooms, the hallway first if there is one.
    pub rooms: Vec<RoomId>,
    /// The drafts that were discarded before it.
    pub discarded: usize,
}

/// Floor plans of one kind, of so many rooms, from one seed.
#[derive(Clone, Debug)]
pub struct FloorPlans {
    kind: Kind,
    rooms: usize,
    seed: u64,
    tables: Tables,
}

impl FloorPlans {
    /// Plans of `rooms` rooms each, without the hallway that those of four rooms or more have.
    ///
    /// # Errors
    /// [`PlanError::Rooms`], if no plan has so many.
    pub fn new(kind: Kind, rooms: usize, seed: u64) -> Result<Self, PlanError> {
        let table = kind.rooms();
        let most = table.rooms.len();
        if !(1..=most).contains(&rooms) {
            return Err(PlanError::Rooms { rooms, kind, most });
        }
        let tables = Tables {
            catalog: kind.catalog(),
            rooms: table,
            furniture: FurnitureTable::of(kind),
            things: ThingTable::of(kind),
        };
        Ok(Self { kind, rooms, seed, tables })
    }

    /// The kind of building.
    #[must_use]
    pub const fn kind(&self) -> Kind {
        self.kind
    }

    /// The seed.
    #[must_use]
    pub const fn seed(&self) -> u64 {
        self.seed
    }

    /// The rooms of each plan, without a hallway.
    #[must_use]
    pub const fn rooms(&self) -> usize {
        self.rooms
    }

    /// What a world says of the rooms that plans of this kind may have, beside those that are built in or of [`Kind::pack`].
    pub fn room_entries(&self) -> impl Iterator<Item = RoomEntry> + '_ {
        self.tables.rooms.rooms.iter().filter_map(|room| room.entry())
    }

    /// The plan with this number, which depends on no other plan.
    ///
    /// # Errors
    /// [`PlanError::GivenUp`], if what was drawn never went together.
    pub fn plan(&self, number: u64) -> Result<FloorPlan, PlanError> {
        let mut chance = Chance::new(self.seed, number);
        let kind = if self.kind == Kind::Office { "Office" } else { "Home" };
        let id = format!("{kind}{}_{}_{number:03}", self.rooms, self.seed);
        let about = format!(
            "Made by `cohabit generate-world --kind {} --rooms {} --seed {}`.",
            self.kind, self.rooms, self.seed
        );
        let made = (0..MOST_DRAFTS).find_map(|discarded| {
            let draft = Draft::draw(&self.tables, self.rooms, &mut chance)?;
            let text = text(&draft, &about, &self.tables.catalog);
            let rooms = draft.rooms.iter().map(|room| room.id).collect();
            self.is_sound(&id, &text).then(|| FloorPlan { id: id.clone(), text, rooms, discarded })
        });
        made.ok_or(PlanError::GivenUp { number })
    }

    /// Whether nothing is wrong with a plan, and with its mirror image.
    fn is_sound(&self, id: &str, text: &str) -> bool {
        let file = format!("{id}.toml");
        [id.to_owned(), format!("{id}_mirror")].iter().all(|id| {
            let layout = Layout::parse(id, &[(file.as_str(), text)]);
            layout.is_ok_and(|layout| layout.faults(&self.tables.catalog).is_empty())
        })
    }
}
