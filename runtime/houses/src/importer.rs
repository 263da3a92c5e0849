//! A house becomes a floor plan, which is checked as every floor plan is.

use cohabit_cdf::{Catalog, Layout, RoomEntry, RoomId, WorldData, WorldPack, layout::OpeningKind};
use cohabit_floorplans::parts::{
    CIRCUIT, Chance, Draft, Entry, Gap, Room, Site, Wall, add_entry, add_fuse_box, add_switch, kept_free, text,
};

use crate::{
    error::HouseError,
    furnish::{Contents, Furnished, Sorter},
    house::House,
    names::{NamedRoom, RoomTable},
    report::{Report, Tally},
    shell::{Shell, too_small},
    types::TypeTable,
};

/// The world pack whose classes and rooms houses have.
const HOMES: &str = "homes";
/// The class of doors to the outside.
const ENTRANCE: &str = "SM_Bld_Door_02";

/// A house as a floor plan.
#[derive(Clone, Debug)]
pub struct ImportedPlan {
    /// Its id.
    pub id: String,
    /// The text of its file.
    pub text: String,
    /// The room where one begins.
    pub start: RoomId,
    /// The rooms that a world pack has to declare beside those of the pack `homes`.
    pub rooms: Vec<RoomEntry>,
    /// What became of the house.
    pub report: Report,
}

/// Turns houses into floor plans.
#[derive(Clone, Debug)]
pub struct Importer {
    world: WorldData,
    rooms: RoomTable,
    types: TypeTable,
}

/// The world of the pack `homes`.
pub fn homes() -> WorldData {
    let pack = WorldPack::builtin(HOMES).expect("invariant: the pack is built in");
    WorldData::layered(vec![pack]).expect("invariant: the built-in pack is sound")
}

impl Default for Importer {
    fn default() -> Self {
        Self { world: homes(), rooms: RoomTable::builtin(), types: TypeTable::builtin() }
    }
}

impl Importer {
    /// The world whose classes and rooms floor plans have, without those that they declare themselves.
    #[must_use]
    pub const fn world(&self) -> &WorldData {
        &self.world
    }

    /// The floor plan of a house, from the text of its JSON.
    ///
    /// # Errors
    /// [`HouseError`] says what is wrong with it, and where.
    pub fn plan(&self, id: &str, text: &str) -> Result<ImportedPlan, HouseError> {
        let mut house = House::parse(text)?;
        let shell = Shell::of(&mut house, &self.rooms)?;
        let builder = Builder { house: &house, shell: &shell, catalog: self.world.catalog(), types: &self.types };
        let (draft, report) = builder.draft()?;
        let plan = ImportedPlan {
            id: id.to_owned(),
            text: self::text(&draft, "Made by `cohabit import-house` from a house of ProcTHOR.", self.world.catalog()),
            start: builder.start(),
            rooms: shell.rooms.iter().filter_map(|room| room.entry.clone()).collect(),
            report,
        };
        self.check(&plan)?;
        Ok(plan)
    }

    /// Nothing is wrong with a plan, nor with its mirror image.
    fn check(&self, plan: &ImportedPlan) -> Result<(), HouseError> {
        let file = format!("{}.toml", plan.id);
        let mut faults = Vec::new();
        for id in [plan.id.clone(), format!("{}_mirror", plan.id)] {
            match Layout::parse(&id, &[(&file, &plan.text)]) {
                Ok(layout) => faults.extend(layout.faults(self.world.catalog()).iter().map(ToString::to_string)),
                Err(error) => faults.push(error.to_string()),
            }
        }
        if faults.is_empty() { Ok(()) } else { Err(HouseError::Faults { faults }) }
    }
}

/// A house on its way to a floor plan.
struct Builder<'a> {
    house: &'a House,
    shell: &'a Shell,
    catalog: &'a Catalog,
    types: &'a TypeTable,
}

impl<'a> Builder<'a> {
    fn draft(&self) -> Result<(Draft, Report), HouseError> {
        let sorter = Sorter { types: self.types, catalog: self.catalog, lattice: &self.shell.lattice };
        let mut tally = Tally::default();
        let start = self.ways_begin();
        let mut contents: Vec<Contents<'_>> =
            (0..self.shell.rooms.len()).map(|room| Contents::of(room == start)).collect();
        for object in &self.house.objects {
            match self.shell.room_at(sorter.point_m(object)) {
                Some(room) => sorter.add(object, &mut contents[room]),
                None => sorter.leave_out(object, &mut tally),
            }
        }
        let mut notes = self.shell.openings.notes.clone();
        // Where there is a choice, the same house always makes the same plan.
        let mut chance = Chance::new(0, 0);
        let sites = self.sites(&mut notes, &mut chance)?;
        let mut rooms = Vec::new();
        for (room, (contents, (bare, has_switch))) in contents.into_iter().zip(&sites).enumerate() {
            let door = self.gaps().iter().find(|gap| gap.is_way() && gap.between.contains(&room));
            let small = || too_small(&self.house.rooms[room], bare);
            let mut furnished = contents.furnish(bare, door, room).ok_or_else(small)?;
            // Where none of the walls beside doors has room for a light switch, it is where furniture leaves some.
            if !has_switch && !add_switch(&mut furnished.site, room, &[], None, &mut chance) {
                let id = self.shell.rooms[room].id;
                notes.push(format!("{id} has no light switch: no wall has room for it"));
            }
            tally.add(furnished.tally.clone());
            rooms.push(self.room(room, furnished));
        }
        Ok((Draft { rooms, gaps: self.gaps().to_vec() }, self.report(&tally, notes)))
    }

    fn gaps(&self) -> &'a [Gap] {
        &self.shell.openings.gaps
    }

    fn room(&self, room: usize, furnished: Furnished<'_>) -> Room {
        let named = &self.shell.rooms[room];
        let Furnished { site, things, views, notes, tally: _ } = furnished;
        Room {
            id: named.id,
            rects: site.rects,
            floor: named.floor.clone(),
            wall: named.wall.clone(),
            circuit: circuit(room),
            furniture: site.placed,
            things,
            views,
            notes,
        }
    }

    /// The rooms with what each has before furniture: doors, light switches (and whether it has one), a fuse box for each circuit.
    fn sites(&self, notes: &mut Vec<String>, chance: &mut Chance) -> Result<Vec<(Site<'a>, bool)>, HouseError> {
        let mut sites = Vec::new();
        for room in 0..self.shell.rooms.len() {
            sites.push(self.site(room, notes, chance)?);
        }
        for (index, circuit) in sites.chunks_mut(CIRCUIT).enumerate() {
            if !circuit.iter_mut().any(|(site, _)| add_fuse_box(site, chance)) {
                notes.push(format!("circuit {} has no fuse box: no wall has room for it", index + 1));
            }
        }
        Ok(sites)
    }

    fn site(&self, room: usize, notes: &mut Vec<String>, chance: &mut Chance) -> Result<(Site<'a>, bool), HouseError> {
        let own = self.gaps().iter().filter(|gap| gap.kind != OpeningKind::Window && gap.between.contains(&room));
        let doors: Vec<(Wall, i32)> = own.map(|gap| (gap.wall_of(room), gap.middle)).collect();
        let entry: Option<Entry> = self.shell.openings.entries.iter().copied().find(|entry| entry.room == room);
        let free = kept_free(room, self.gaps(), entry);
        let mut site = Site::new(self.catalog, &self.shell.floors[room].rects, &doors, free);
        if !site.is_walkable() {
            return Err(too_small(&self.house.rooms[room], &site));
        }
        let id = self.shell.rooms[room].id;
        if entry.is_some_and(|entry| !add_entry(&mut site, ENTRANCE, entry, chance)) {
            notes.push(format!("{id} is without its door to the outside: there is no room for it"));
        }
        let has_switch = add_switch(&mut site, room, self.gaps(), entry, chance);
        Ok((site, has_switch))
    }

    /// The room where the check of floor plans begins its ways: the first corridor, or the first room.
    fn ways_begin(&self) -> usize {
        let is_corridor = |room: &NamedRoom| {
            let declared = room.entry.as_ref().is_some_and(|entry| entry.corridor);
            declared || self.catalog.rooms().is_corridor(room.id)
        };
        self.shell.rooms.iter().position(is_corridor).unwrap_or(0)
    }

    /// The room where one begins: that of the agent.
    fn start(&self) -> RoomId {
        let of_agent = self.house.agent_m.and_then(|at_m| self.shell.room_at(self.shell.lattice.point_m(at_m)));
        let room = self.shell.rooms.get(of_agent.unwrap_or(0));
        room.map_or(RoomId::HALLWAY, |room| room.id)
    }

    fn report(&self, tally: &Tally, notes: Vec<String>) -> Report {
        let count = |is_way: bool| self.gaps().iter().filter(|gap| gap.is_way() == is_way).count();
        Report {
            rooms: self.shell.rooms.len(),
            doors: count(true) + self.shell.openings.entries.len(),
            windows: count(false),
            placed: tally.placed,
            moved: tally.moved,
            left_out: tally.left_out(),
            notes,
        }
    }
}

/// The circuit of a room.
fn circuit(room: usize) -> u8 {
    u8::try_from(room / CIRCUIT + 1).unwrap_or(u8::MAX)
}
