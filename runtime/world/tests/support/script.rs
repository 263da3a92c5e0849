//! Scripts of commands made from plain numbers, so that chance, a fuzzer and a shrinker can all write them.
//!
//! A line says what kind of thing to do; which object it is done to is found in the world as the line comes up, so that
//! most lines make sense: what is picked up is in reach, what is poured goes into something.

use cohabit_cdf::{ObjectClass, Property, RoomId, StateFlag};
use cohabit_world::{Action, BodyId, GoToTarget, Input, ObjectId, ObjectView, Vec2, Verb, World};

/// How far off an object may be for a hand to try it, m: a little more than a hand reaches.
const TRY_M: f32 = 1.7;
/// The same for what is done from afar.
const LOOK_M: f32 = 3.2;
const THROW_M: f32 = 5.0;
/// A short walk, m.
const ROOM_M: f32 = 2.5;
/// Most lines wait no longer for their end than this, ticks: enough for a hand, and for a walk across a room.
const SHORT_TICKS: u32 = 100;
/// No line waits longer than this: enough for a walk through two doors.
const LONGEST_TICKS: u32 = 600;

/// What a line asks for.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Kind {
    GoNear,
    GoAnywhere,
    GoToRoom,
    GoToViewpoint,
    GoToPoint,
    PickUp,
    Place,
    Open,
    Close,
    Toggle,
    Pour,
    Fill,
    Clean,
    Break,
    Throw,
    Scan,
    Examine,
    Highlight,
    Move,
    Rotate,
    Look,
    LookAround,
    Stop,
    Drive,
    /// Ids and numbers that nobody should send.
    Nonsense,
}

/// Every kind as often as it is to come up among scripts made by chance.
pub const KINDS: &[Kind] = &[
    Kind::GoNear,
    Kind::GoNear,
    Kind::GoNear,
    Kind::GoAnywhere,
    Kind::GoToRoom,
    Kind::GoToViewpoint,
    Kind::GoToPoint,
    Kind::PickUp,
    Kind::PickUp,
    Kind::PickUp,
    Kind::PickUp,
    Kind::PickUp,
    Kind::Place,
    Kind::Place,
    Kind::Place,
    Kind::Place,
    Kind::Open,
    Kind::Open,
    Kind::Close,
    Kind::Close,
    Kind::Toggle,
    Kind::Toggle,
    Kind::Toggle,
    Kind::Toggle,
    Kind::Pour,
    Kind::Pour,
    Kind::Fill,
    Kind::Fill,
    Kind::Clean,
    Kind::Clean,
    Kind::Break,
    Kind::Break,
    Kind::Throw,
    Kind::Throw,
    Kind::Scan,
    Kind::Examine,
    Kind::Highlight,
    Kind::Move,
    Kind::Move,
    Kind::Rotate,
    Kind::Look,
    Kind::LookAround,
    Kind::Stop,
    Kind::Drive,
    Kind::Drive,
    Kind::Nonsense,
];

/// One command of a script, before it is known what it is done to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    pub kind: Kind,
    /// Which body, or one too many.
    pub body: u8,
    /// Which of the objects that come into question.
    pub pick: u16,
    /// How far, how much, or which nonsense.
    pub amount: u8,
    /// How long before the next line: at once, some ticks, or until it is done.
    pub pace: u8,
}

impl Line {
    /// Bytes of one line in a fuzzer's input.
    pub const BYTES: usize = 6;

    /// A line from any bytes.
    pub fn from_bytes([kind, body, low, high, amount, pace]: [u8; Self::BYTES]) -> Self {
        let kind = KINDS[usize::from(kind) % KINDS.len()];
        Self { kind, body, pick: u16::from_le_bytes([low, high]), amount, pace }
    }

    /// A script from any bytes; what is left over at their end is ignored.
    pub fn script(bytes: &[u8]) -> Vec<Self> {
        bytes.as_chunks().0.iter().copied().map(Self::from_bytes).collect()
    }

    /// How many ticks pass before the next line, and whether the end of the command ends the wait.
    pub fn wait(&self) -> (u32, bool) {
        match self.pace {
            0..24 => (0, false),
            24..64 => (u32::from(self.pace) - 20, false),
            64..252 => (SHORT_TICKS, true),
            _ => (LONGEST_TICKS, true),
        }
    }

    /// The command as things stand in `world`.
    pub fn input(&self, world: &World, command: u64) -> Input {
        let bodies = world.bodies().len() as u32;
        // Now and then somebody who is not there is told.
        let body = if self.body > 250 { bodies + 3 } else { u32::from(self.body) % bodies };
        Input { command, body: BodyId(body), action: self.action(world, BodyId(body)) }
    }

    fn action(&self, world: &World, id: BodyId) -> Action {
        let part = f32::from(self.amount) / 255.0;
        let Some(body) = world.body(id) else { return Action::Stop };
        let here = body.position_m.truncate();
        let find = |choose: &dyn Fn(&Candidate<'_>) -> bool, within: f32| self.choose(world, here, within, choose);
        // Where nothing will do, just anything is tried.
        let anything = ObjectId(u32::from(self.pick) % (world.objects().len() as u32 + 2));
        let object = |choose: &dyn Fn(&Candidate<'_>) -> bool, within| find(choose, within).unwrap_or(anything);
        let interact = |verb, object| Action::Interact { verb, object };
        let goto = |target| Action::GoTo { target };
        let held = body.held.and_then(|held| world.object(held)).map(|view| world.catalog().class(view.class));
        let kind = if self.amount.is_multiple_of(11) { self.kind } else { self.sensible(held) };
        match kind {
            Kind::GoNear => goto(GoToTarget::Object(object(&|thing| thing.is_operable(), ROOM_M))),
            Kind::GoAnywhere => goto(GoToTarget::Object(object(&|_| true, f32::INFINITY))),
            Kind::GoToRoom => goto(GoToTarget::Room(room(self.pick))),
            Kind::GoToViewpoint => {
                let room = if self.amount.is_multiple_of(4) { room(self.pick) } else { body.room };
                goto(GoToTarget::Viewpoint(room, self.amount % 9))
            }
            Kind::GoToPoint => {
                let aside = Vec2::new(part - 0.5, f32::from(self.pick % 256) / 255.0 - 0.5) * 3.0;
                goto(GoToTarget::Point((here + aside).into()))
            }
            Kind::PickUp => {
                let wanted = |thing: &Candidate<'_>| thing.has(Property::Pickupable) && !thing.view.hidden;
                let near = find(&wanted, TRY_M).map(|object| Action::PickUp { object });
                // Looking is cheaper than walking, and there are many lines that find nothing in reach.
                near.unwrap_or_else(|| match self.pick % 4 {
                    0 => goto(GoToTarget::Object(object(&wanted, ROOM_M))),
                    1 => interact(Verb::Scan, object(&|thing| !thing.view.hidden, LOOK_M)),
                    2 => interact(Verb::Toggle, object(&|thing| thing.has(Property::Toggleable), TRY_M)),
                    _ => interact(Verb::Examine, object(&|thing| !thing.view.hidden, LOOK_M)),
                })
            }
            Kind::Place => Action::Place { receptacle: object(&|thing| thing.takes(held), TRY_M) },
            Kind::Open => interact(Verb::Open, object(&|thing| thing.opens(false), TRY_M)),
            Kind::Close => interact(Verb::Close, object(&|thing| thing.opens(true), TRY_M)),
            Kind::Toggle => interact(Verb::Toggle, object(&|thing| thing.has(Property::Toggleable), TRY_M)),
            Kind::Pour => interact(Verb::Pour, object(&|thing| thing.has(Property::Fillable), TRY_M)),
            Kind::Fill | Kind::Clean => {
                let verb = if kind == Kind::Fill { Verb::Fill } else { Verb::Clean };
                interact(verb, object(&|thing| thing.class.id == "KitchenCounterSink_01", TRY_M))
            }
            Kind::Break => {
                let wanted = |thing: &Candidate<'_>| thing.has(Property::Breakable) || thing.has(Property::Cuttable);
                interact(Verb::Break, object(&wanted, TRY_M))
            }
            Kind::Throw => interact(Verb::Throw, object(&|_| true, THROW_M)),
            Kind::Scan => interact(Verb::Scan, object(&|thing| !thing.view.hidden, LOOK_M)),
            Kind::Examine => interact(Verb::Examine, object(&|thing| !thing.view.hidden, LOOK_M)),
            Kind::Highlight => Action::Highlight { object: object(&|_| true, f32::INFINITY) },
            Kind::Move => Action::Move { distance_m: part * 3.0 - 1.0 },
            Kind::Rotate => Action::Rotate { yaw_rad: part * 6.0 - 3.0 },
            Kind::Look => Action::Look { pitch_rad: part * 3.0 - 1.5 },
            Kind::LookAround => Action::LookAround,
            Kind::Stop => Action::Stop,
            Kind::Drive => {
                let turn_rad_s = f32::from(self.pick % 256) / 40.0 - 3.2;
                Action::Drive { forward_m_s: part * 4.0 - 2.0, turn_rad_s, pitch_rad_s: part - 0.5 }
            }
            Kind::Nonsense => self.nonsense(world),
        }
    }

    /// What somebody who holds this would rather do: an empty hand takes something before it places or pours.
    fn sensible(&self, held: Option<&ObjectClass>) -> Kind {
        let hand = [Kind::Place, Kind::Pour, Kind::Fill, Kind::Clean, Kind::Throw, Kind::Break];
        let Some(held) = held else {
            return if hand.contains(&self.kind) { Kind::PickUp } else { self.kind };
        };
        let tool = matches!(held.id.as_str(), "Hammer" | "Knife_01");
        let wet = [Property::Fillable, Property::Dirtyable].into_iter().any(|property| held.has(property));
        match self.kind {
            Kind::PickUp | Kind::Pour | Kind::Fill | Kind::Clean if tool => Kind::Break,
            Kind::PickUp if wet => [Kind::Pour, Kind::Fill, Kind::Clean, Kind::Place][usize::from(self.amount) % 4],
            Kind::PickUp => Kind::Place,
            kind => kind,
        }
    }

    /// One of the objects that come into question; now and then just any.
    fn choose(
        &self,
        world: &World,
        here: Vec2,
        within: f32,
        wanted: &dyn Fn(&Candidate<'_>) -> bool,
    ) -> Option<ObjectId> {
        if self.amount.is_multiple_of(32) {
            return None;
        }
        let near = |view: &ObjectView<'_>| view.position_m.truncate().distance(here) < within;
        let candidates = world.objects().filter(|view| near(view) && world.exists(view.id) && view.held_by.is_none());
        let candidates = candidates.map(|view| Candidate { view, class: world.catalog().class(view.class) });
        let found: Vec<ObjectId> = candidates.filter(|thing| wanted(thing)).map(|thing| thing.view.id).collect();
        found.get(usize::from(self.pick) % found.len().max(1)).copied()
    }

    fn nonsense(&self, world: &World) -> Action {
        let number = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30, f32::MIN_POSITIVE, -0.0, 99.9];
        let number = number[usize::from(self.amount) % number.len()];
        let nobody = ObjectId([u32::MAX, world.objects().len() as u32, 1 << 31][usize::from(self.pick) % 3]);
        match self.pick % 10 {
            0 => Action::Move { distance_m: number },
            1 => Action::Rotate { yaw_rad: number },
            2 => Action::Look { pitch_rad: number },
            3 => Action::GoTo { target: GoToTarget::Point([number, -number]) },
            4 => Action::GoTo { target: GoToTarget::Object(nobody) },
            5 => Action::PickUp { object: nobody },
            6 => Action::Place { receptacle: nobody },
            7 => Action::Drive { forward_m_s: 1.0, turn_rad_s: number, pitch_rad_s: -number },
            8 => Action::Interact { verb: Verb::ALL[usize::from(self.amount) % Verb::ALL.len()], object: nobody },
            _ => Action::GoTo { target: GoToTarget::Viewpoint(room(self.pick), self.amount | 128) },
        }
    }
}

/// An object that may be meant.
struct Candidate<'a> {
    view: ObjectView<'a>,
    class: &'a ObjectClass,
}

impl Candidate<'_> {
    fn has(&self, property: Property) -> bool {
        self.class.has(property)
    }

    fn is_operable(&self) -> bool {
        let operable = [Property::Pickupable, Property::Openable, Property::Toggleable, Property::Receptacle];
        operable.into_iter().any(|property| self.has(property))
    }

    fn opens(&self, opened: bool) -> bool {
        self.has(Property::Openable) && self.view.flags.has(StateFlag::Opened) == opened
    }

    /// Whether it would take what is held, as far as can be seen.
    fn takes(&self, held: Option<&ObjectClass>) -> bool {
        let Some(kind) = &self.class.receptacle else { return false };
        let shut = self.has(Property::Openable) && !self.view.flags.has(StateFlag::Opened);
        !shut && (kind.keys.is_empty() || held.is_some_and(|held| kind.keys.contains(&held.id)))
    }
}

fn room(pick: u16) -> RoomId {
    RoomId::BUILTIN[usize::from(pick) % RoomId::BUILTIN.len()]
}

/// What a command is called where commands are counted.
pub fn verb(action: &Action) -> String {
    match action {
        Action::Interact { verb, .. } => format!("{verb:?}"),
        Action::GoTo { target: GoToTarget::Object(_) } => "GoTo Object".to_owned(),
        Action::GoTo { target: GoToTarget::Room(_) } => "GoTo Room".to_owned(),
        Action::GoTo { target: GoToTarget::Viewpoint(..) } => "GoTo Viewpoint".to_owned(),
        Action::GoTo { target: GoToTarget::Point(_) } => "GoTo Point".to_owned(),
        other => format!("{other:?}").split([' ', '{']).next().unwrap_or_default().to_owned(),
    }
}

/// All that [`verb`] may say.
pub fn verbs() -> Vec<String> {
    let object = ObjectId(0);
    let mut all = vec![
        Action::Move { distance_m: 0.0 },
        Action::Rotate { yaw_rad: 0.0 },
        Action::Look { pitch_rad: 0.0 },
        Action::LookAround,
        Action::PickUp { object },
        Action::Place { receptacle: object },
        Action::Highlight { object },
        Action::Stop,
        Action::Drive { forward_m_s: 0.0, turn_rad_s: 0.0, pitch_rad_s: 0.0 },
        Action::GoTo { target: GoToTarget::Object(object) },
        Action::GoTo { target: GoToTarget::Room(RoomId::LAB1) },
        Action::GoTo { target: GoToTarget::Viewpoint(RoomId::LAB1, 1) },
        Action::GoTo { target: GoToTarget::Point([0.0; 2]) },
    ];
    all.extend(Verb::ALL.map(|verb| Action::Interact { verb, object }));
    all.iter().map(verb).collect()
}

/// An action as a person would write it, instance ids for numbers.
pub fn write(world: &World, input: &Input) -> String {
    let name = |id: ObjectId| world.object(id).map_or_else(|| format!("{id:?}"), |view| view.instance.to_owned());
    let action = match input.action {
        Action::GoTo { target: GoToTarget::Object(object) } => format!("GoTo {}", name(object)),
        Action::PickUp { object } => format!("PickUp {}", name(object)),
        Action::Place { receptacle } => format!("Place {}", name(receptacle)),
        Action::Interact { verb, object } => format!("{verb:?} {}", name(object)),
        Action::Highlight { object } => format!("Highlight {}", name(object)),
        other => format!("{other:?}"),
    };
    format!("tick {:5}, body {}: {action}", world.tick(), input.body.0)
}
