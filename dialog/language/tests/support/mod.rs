//! A small office: a catalogue of two dozen classes, and a robot in the break room that knows it all.
#![allow(dead_code, missing_docs, clippy::unwrap_used)]

pub mod cases;
mod plan;

use std::{
    fmt::Write as _,
    sync::{Arc, OnceLock},
};

use cohabit_cdf::{
    Action, Catalog, Color, Fluid, GoToTarget, ObjectId, RoomId, Status, catalog::Speech, state::StateFlag,
};
use cohabit_language::{Asking, Context, Known, KnownGoal, KnownObject, KnownRobot, Language, Step, Understanding};

/// `id | name | words | properties | colour | receptacle`: `-` none, `on`, `in` (enclosed), `key:CLASS`.
const CLASSES: &str = "
TableRound_02 | Table | round table, kitchen table | RECEPTACLE | brown | on
KitchenCounterTop_02 | Counter Top | counter | RECEPTACLE | gray | on
FridgeLower_02 | Fridge | refrigerator, icebox | OPENABLE RECEPTACLE POWERABLE | white | in
FridgeUpper_02 | Freezer | | OPENABLE RECEPTACLE POWERABLE | white | in
Microwave_01 | Microwave | oven, microwave oven | OPENABLE RECEPTACLE POWERABLE TOGGLEABLE | black | in
KitchenCounterSink_01 | Sink | kitchen sink, basin | TOGGLEABLE RECEPTACLE FILLABLE OPENABLE | gray | on
KitchenCabinet_02 | Cabinet | cupboard | OPENABLE RECEPTACLE | white | in
YesterdayMachine_01 | Time Machine | yesterday machine | OPENABLE TOGGLEABLE RECEPTACLE POWERABLE | blue | in
CoffeeMaker_01 | Coffee Maker | coffee machine | TOGGLEABLE RECEPTACLE POWERABLE FILLABLE | black | on
CoffeeUnMaker_01 | Coffee Unmaker | | TOGGLEABLE RECEPTACLE POWERABLE FILLABLE | red | on
Toaster_02 | Toaster | | TOGGLEABLE RECEPTACLE POWERABLE | gray | on
Bowl_01 | Bowl | dish | PICKUPABLE BREAKABLE HEATABLE CHILLABLE FILLABLE | white | -
CoffeeMug_Boss | Mug | cup, coffee mug | PICKUPABLE BREAKABLE FILLABLE HEATABLE | red | -
CoffeeMug_Yellow | Mug | cup, coffee mug | PICKUPABLE BREAKABLE FILLABLE HEATABLE | yellow | -
MilkCarton_01 | Milk | milk carton, carton of milk | PICKUPABLE OPENABLE FILLABLE | white | -
Cereal_Box_01 | Cereal Box | cereal, box of cereal | PICKUPABLE | orange | -
FoodPlate_01 | Plate | dish, dinner plate | PICKUPABLE BREAKABLE RECEPTACLE DIRTYABLE | white | on
Apple | Apple | fruit | PICKUPABLE EATABLE | green | -
Banana_01 | Banana | fruit | PICKUPABLE EATABLE | yellow | -
BreadSlice_01 | Bread Slice | bread, slice of bread | PICKUPABLE EATABLE COOKABLE | brown | -
Knife_01 | Knife | | PICKUPABLE | gray | -
Hammer | Hammer | mallet | PICKUPABLE | red | -
Trophy01 | Trophy | award | PICKUPABLE BREAKABLE | gold | -
Record_01 | Record | vinyl | PICKUPABLE BREAKABLE | black | -
Floppy_Virus | Floppy Disk | floppy, disk | PICKUPABLE HEATABLE BREAKABLE | black | -
Desk_01 | Table | desk, wooden table | RECEPTACLE | brown | on
AP_Prop_Desk_Green | Desk | green desk | RECEPTACLE | green | on
AP_Prop_Desk_Red | Desk | red desk | RECEPTACLE | red | on
AP_Prop_Desk_Blue | Desk | blue desk | RECEPTACLE | blue | on
Printer_3D | Printer | 3d printer, 3-d printer | RECEPTACLE POWERABLE TOGGLEABLE | gray | key:Printer_Cartridge_Hammer
Printer_Cartridge_Hammer | Hammer Print Cartridge | printer cartridge, cartridge | PICKUPABLE | black | -
Laser | Laser | laser cannon | RECEPTACLE POWERABLE USABLE TOGGLEABLE | red | key:Laser_Tip
Laser_Tip | Laser Tip | | PICKUPABLE | gray | -
AP_Prop_Shelf_Wall_Laser | Red wall shelf | red shelf, laser shelf | RECEPTACLE | red | on
AP_Prop_Shelf_Wall_04 | Shelf | blue shelf | RECEPTACLE | blue | on
FreezeRay | Freeze Ray | ice ray | TOGGLEABLE POWERABLE USABLE | blue | -
V_Monitor_Laser | Computer | red computer, laser computer | POWERABLE TOGGLEABLE RECEPTACLE INFECTABLE | red | key:Floppy_Virus
V_Monitor_FreezeRay | Computer | blue computer, freeze ray computer | TOGGLEABLE POWERABLE RECEPTACLE INFECTABLE | blue | key:Floppy_Virus
RoboticArm_01 | Robot Arm | robotic arm | TOGGLEABLE POWERABLE | orange | -
EAC_Machine | Everything's A Carrot Machine | carrot machine, carrot maker | TOGGLEABLE RECEPTACLE POWERABLE | orange | on
ColorChangerStation | Color Changer | color changing station | RECEPTACLE USABLE POWERABLE | white | on
ColorChanger_Button_Red | Red Button | | TOGGLEABLE | red | -
ColorChanger_Button_Green | Green Button | | TOGGLEABLE | green | -
ColorChanger_Button_Blue | Blue Button | | TOGGLEABLE | blue | -
GravityPad | Gravity Pad | gravity plate | TOGGLEABLE RECEPTACLE POWERABLE | gray | on
LightSwitch_01 | Light Switch | switch | TOGGLEABLE POWERABLE USABLE | white | -
StickyNote | Sticky Note | note | | yellow | -
FuseBox_01 | Fuse Box | | OPENABLE TOGGLEABLE RECEPTACLE POWERABLE | gray | key:FuseBox_01_Lever
FuseBox_01_Lever | Lever | fuse box lever | TOGGLEABLE PICKUPABLE | red | -
TrashCan_01 | Trash Can | bin, garbage can | RECEPTACLE | gray | on
Carrot_01 | Carrot | | PICKUPABLE EATABLE | orange | -
SM_Prop_Papers_01 | Papers | | DECOR | white | -
Door_01 | Door | | OPENABLE | brown | -
";

/// `instance | room | x y z | parent | marks`; the robot stands at 0 0 and looks along x.
const OBJECTS: &str = "
TableRound_02_1 | BreakRoom | 3 0 0 | - |
KitchenCounterTop_02_1 | BreakRoom | 2 3 0 | - |
FridgeLower_02_1 | BreakRoom | 4 3 0 | - |
FridgeUpper_02_1 | BreakRoom | 4 3 1 | - |
Microwave_01_1 | BreakRoom | 1 3 1 | KitchenCounterTop_02_1 |
KitchenCounterSink_01_1 | BreakRoom | 0 3 1 | - |
KitchenCabinet_02_1 | BreakRoom | -2 3 1 | - |
YesterdayMachine_01_1 | BreakRoom | -3 0 0 | - |
CoffeeMaker_01_1 | BreakRoom | 1 -3 1 | - |
CoffeeUnMaker_01_1 | BreakRoom | 2 -3 1 | - |
Toaster_02_1 | BreakRoom | 3 -3 1 | - |
LightSwitch_01_1 | BreakRoom | -4 1 1 | - |
StickyNote_1 | BreakRoom | -4 2 1 | - | text
TrashCan_01_1 | BreakRoom | -4 -2 0 | - |
Door_01_1 | BreakRoom | 6 -2 0 | - |
CoffeeMug_Boss_1 | BreakRoom | 3 0.4 0.8 | TableRound_02_1 |
CoffeeMug_Yellow_1 | BreakRoom | 3 -0.4 0.8 | TableRound_02_1 |
Bowl_01_1 | BreakRoom | 3 0 0.8 | TableRound_02_1 | broken
MilkCarton_01_1 | BreakRoom | 4 3 0.5 | FridgeLower_02_1 | milk
Banana_01_1 | BreakRoom | 2.8 0 0.8 | TableRound_02_1 |
Cereal_Box_01_1 | BreakRoom | 2 3 1 | KitchenCounterTop_02_1 |
BreadSlice_01_1 | BreakRoom | -2 3 1 | KitchenCabinet_02_1 |
FoodPlate_01_1 | BreakRoom | 3 0.2 0.8 | TableRound_02_1 | dirty
Apple_1 | BreakRoom | 2.7 0.2 0.8 | TableRound_02_1 | red
Apple_2 | BreakRoom | 2.7 -0.2 0.8 | TableRound_02_1 |
AP_Prop_Desk_Green_1 | MainOffice | 10 0 0 | - |
AP_Prop_Desk_Red_1 | MainOffice | 12 0 0 | - |
AP_Prop_Desk_Blue_1 | MainOffice | 14 0 0 | - |
Trophy01_1 | MainOffice | 10 0 0.8 | AP_Prop_Desk_Green_1 |
Record_01_1 | MainOffice | 12 0 0.8 | AP_Prop_Desk_Red_1 |
Hammer_1 | MainOffice | 14 0 0.8 | AP_Prop_Desk_Blue_1 |
Desk_01_1 | Lab1 | 10 10 0 | - |
Printer_3D_1 | Lab1 | 12 12 0 | - |
Printer_Cartridge_Hammer_1 | Lab1 | 10 10 0.8 | Desk_01_1 |
Laser_1 | Lab1 | 8 12 0 | - |
Laser_Tip_1 | Lab1 | 10.3 10 0.8 | Desk_01_1 |
AP_Prop_Shelf_Wall_Laser_1 | Lab1 | 8 14 1 | - |
AP_Prop_Shelf_Wall_04_1 | Lab1 | 6 14 1 | - |
FreezeRay_1 | Lab1 | 6 12 0 | - |
V_Monitor_Laser_1 | Lab1 | 9.6 10 0.8 | Desk_01_1 | works=Laser_1
V_Monitor_FreezeRay_1 | Lab1 | 6 11 0.8 | - | works=FreezeRay_1
RoboticArm_01_1 | Lab1 | 5 10 0 | - |
FuseBox_01_1 | Lab1 | 4 14 1 | - |
FuseBox_01_Lever_1 | Lab1 | 4 14 1 | FuseBox_01_1 |
EAC_Machine_1 | Lab2 | 20 10 0 | - |
ColorChangerStation_1 | Lab2 | 22 10 0 | - |
ColorChanger_Button_Red_1 | Lab2 | 22 10.2 0.8 | - | works=ColorChangerStation_1
ColorChanger_Button_Green_1 | Lab2 | 22 10 0.8 | - | works=ColorChangerStation_1
ColorChanger_Button_Blue_1 | Lab2 | 22 9.8 0.8 | - | works=ColorChangerStation_1
GravityPad_1 | Lab2 | 24 10 0 | - |
Floppy_Virus_1 | Lab2 | 24 12 0 | - |
LightSwitch_01_2 | Lab2 | 20 14 1 | - |
Knife_01_1 | BreakRoom | 2.2 3 1 | KitchenCounterTop_02_1 |
";

fn fields(line: &str) -> Vec<&str> {
    line.split('|').map(str::trim).collect()
}

pub fn catalog() -> Arc<Catalog> {
    let builtin = Catalog::builtin();
    let mut text = String::new();
    for line in CLASSES.lines().filter(|line| !line.is_empty()) {
        let field = fields(line);
        let quoted = |list: &str, by: char| {
            let items = list.split(by).map(str::trim).filter(|item| !item.is_empty());
            items.map(|item| format!("{item:?}")).collect::<Vec<_>>().join(", ")
        };
        let (words, properties) = (quoted(field[2], ','), quoted(field[3], ' '));
        write!(
            text,
            "[[object]]\nid = {:?}\nname = {:?}\nwords = [{words}]\nproperties = [{properties}]\nsize_m = [0.5, 0.5, 0.5]\n\
             mass_kg = 1.0\ncolor = {:?}\nmodel = \"box\"\n",
            field[0], field[1], field[4]
        )
        .unwrap();
        let class = builtin.find(field[0]).map(|class| builtin.class(class));
        let built: Vec<String> =
            class.iter().flat_map(|class| &class.as_built).map(|flag| format!("{flag:?}")).collect();
        writeln!(text, "as_built = {built:?}").unwrap();
        if field[5] != "-" {
            let keys = field[5].strip_prefix("key:").map(|key| format!("keys = [{key:?}]\n")).unwrap_or_default();
            write!(
                text,
                "[object.receptacle]\nenclosed = {}\n{keys}[[object.receptacle.surface]]\ncenter_m = [0.0, 0.0, 0.5]\n\
                 size_m = [0.5, 0.5]\nanchors = [4, 4]\nclearance_m = 0.5\n",
                field[5] == "in"
            )
            .unwrap();
        }
    }
    let model = "[[model]]\nid = \"box\"\n[[model.part]]\nshape = \"box\"\nsize = [0.5, 0.5, 0.5]\n";
    let catalog = Catalog::parse(&[("objects.toml", &text)], &[("models.toml", model)]).unwrap();
    Arc::new(catalog.with_table_of(&builtin))
}

/// The office, changed by `marks` such as `FridgeLower_02_1 open`, `held Bowl_01_1`, `at Lab1 10 8`.
pub fn scene(catalog: &Catalog, marks: &[&str]) -> Known {
    let lines: Vec<Vec<&str>> = OBJECTS.lines().filter(|line| !line.is_empty()).map(fields).collect();
    let id = |instance: &str| {
        let at = lines.iter().position(|line| line[0] == instance).unwrap_or_else(|| panic!("no {instance}"));
        ObjectId(at as u32)
    };
    let robot = KnownRobot { position_m: [0.0; 3], yaw_rad: 0.0, room: RoomId::BREAK_ROOM, held: None };
    let goals = vec![
        KnownGoal { text: "Repair the bowl".to_owned(), met: true },
        KnownGoal { text: "Pour milk into the bowl".to_owned(), met: false },
    ];
    let mut known = Known { goals, ..Known::new(robot, Vec::new()) };
    for line in &lines {
        let mut position = line[2].split(' ').map(|number| number.parse().unwrap());
        let class = catalog.class_of_instance(line[0]).unwrap();
        let position_m = [(); 3].map(|()| position.next().unwrap());
        let object =
            KnownObject::new(id(line[0]), line[0].to_owned(), class, RoomId::new(line[1]).unwrap(), position_m);
        let mut object =
            KnownObject { parent: (line[3] != "-").then(|| id(line[3])), visible: line[1] == "BreakRoom", ..object };
        for mark in line[4].split(' ') {
            match mark.strip_prefix("works=") {
                Some(device) => object.works = Some(id(device)),
                None => set(&mut object, mark),
            }
        }
        known.objects.push(object);
    }
    for mark in marks {
        change(&mut known, &id, mark);
    }
    known
}

fn change(known: &mut Known, id: &dyn Fn(&str) -> ObjectId, mark: &str) {
    let words: Vec<&str> = mark.split(' ').collect();
    match words.as_slice() {
        ["held", instance] => {
            let held = id(instance);
            known.robot.held = Some(held);
            let robot = known.robot.clone();
            let object = &mut known.objects[held.0 as usize];
            (object.parent, object.room, object.position_m) = (None, robot.room, robot.position_m);
        }
        ["at", room, x, y] => {
            known.robot.room = RoomId::new(room).unwrap();
            known.robot.position_m = [x.parse().unwrap(), y.parse().unwrap(), 0.0];
            let room = known.robot.room;
            known.objects.iter_mut().for_each(|object| object.visible = object.room == room);
        }
        ["without", instance] => {
            let gone = id(instance);
            known.objects.retain(|object| object.id != gone);
        }
        [instance, "in", parent] => {
            let (child, parent) = (id(instance), id(parent));
            let (position, room) = {
                let parent = &known.objects[parent.0 as usize];
                (parent.position_m, parent.room)
            };
            let object = &mut known.objects[child.0 as usize];
            (object.parent, object.position_m, object.room) = (Some(parent), position, room);
        }
        [instance, marks @ ..] => {
            let object = &mut known.objects[id(instance).0 as usize];
            marks.iter().for_each(|mark| set(object, mark));
        }
        [] => {}
    }
}

pub(crate) fn set(object: &mut KnownObject, mark: &str) {
    let flag = match mark {
        "" => return,
        "red" => return object.color = Color::Red,
        "green" => return object.color = Color::Green,
        "blue" => return object.color = Color::Blue,
        "milk" => return object.fluid = Fluid::Milk,
        "coffee" => return object.fluid = Fluid::Coffee,
        "water" => return object.fluid = Fluid::Water,
        "text" => return object.text = "The bowl must be mended first.".to_owned(),
        "open" => StateFlag::Opened,
        "broken" => StateFlag::Broken,
        "cereal" => StateFlag::Cereal,
        "dirty" => StateFlag::Dirty,
        "on" => StateFlag::Toggled,
        "locked" => StateFlag::Locked,
        "wet" => StateFlag::Wet,
        "creased" => StateFlag::Creased,
        "folded" => StateFlag::Folded,
        _ => panic!("unknown mark {mark}"),
    };
    object.flags.set(flag, true);
}

/// A step as one short text: `open FridgeLower_02_1`.
pub fn step_text(step: &Step, scene: &Known) -> String {
    let name = |id: ObjectId| scene.object(id).map_or_else(|| format!("{id:?}"), |object| object.instance.clone());
    match step.action {
        Action::Move { distance_m } => format!("move {distance_m:.2}"),
        Action::Rotate { yaw_rad } => format!("turn {:.0}", yaw_rad.to_degrees()),
        Action::Look { pitch_rad } => format!("look {:.0}", pitch_rad.to_degrees()),
        Action::LookAround => "look around".to_owned(),
        Action::GoTo { target: GoToTarget::Object(object) } => format!("go {}", name(object)),
        Action::GoTo { target: GoToTarget::Room(room) } => format!("go {}", room.id()),
        Action::GoTo { target: GoToTarget::Viewpoint(room, number) } => format!("go {}_{number}", room.id()),
        Action::GoTo { target: GoToTarget::Point(point) } => format!("go {point:?}"),
        Action::PickUp { object } => format!("take {}", name(object)),
        Action::Place { receptacle } | Action::PlaceBeside { receptacle, .. } => format!("put {}", name(receptacle)),
        Action::Interact { verb, object } => format!("{} {}", format!("{verb:?}").to_lowercase(), name(object)),
        Action::Highlight { object } => format!("show {}", name(object)),
        Action::Stop => "stop".to_owned(),
        Action::Drive { .. } => "drive".to_owned(),
    }
}

/// What the things of a plan are put beside.
pub fn neighbours(understanding: &Understanding, scene: &Known) -> Vec<String> {
    let Understanding::Plan { steps, .. } = understanding else { return Vec::new() };
    let beside = steps.iter().filter_map(|step| scene.object(step.action.beside()?));
    beside.map(|object| object.instance.clone()).collect()
}

/// What was understood, as one text: steps by `, `, or the kind and the words.
pub fn text(understanding: &Understanding, scene: &Known) -> String {
    match understanding {
        Understanding::Plan { steps, .. } => {
            steps.iter().map(|step| step_text(step, scene)).collect::<Vec<_>>().join(", ")
        }
        Understanding::Question { text, .. } => format!("? {text}"),
        Understanding::Answer { text, .. } => format!("= {text}"),
        Understanding::Refusal { text, .. } => format!("! {text}"),
        Understanding::Stop { then: None, .. } => "stop!".to_owned(),
        Understanding::Stop { then: Some(then), .. } => text(then, scene),
    }
}

/// The language with the rewriter; with `UNDERSTANDING=grammar` in the environment the grammar alone, to compare.
pub fn language(catalog: Arc<Catalog>) -> Language {
    let rewriter = match catalog.speech() {
        Speech::Office => cohabit_rewriter::rewrite,
        Speech::Household => cohabit_rewriter::rewrite_at_home,
    };
    let language = Language::new(catalog);
    match std::env::var("UNDERSTANDING").as_deref() {
        Ok("grammar") => language,
        _ => language.with_rewriter(rewriter),
    }
}

/// A conversation in the office.
pub struct Talk {
    pub language: &'static Language,
    pub scene: Known,
    pub context: Context,
}

impl Talk {
    pub fn new(marks: &[&str]) -> Self {
        if let Some((language, scene)) = plan::talk(marks) {
            return Self { language, scene, context: Context::default() };
        }
        static OFFICE: OnceLock<(Arc<Catalog>, Language)> = OnceLock::new();
        let (catalog, language) = OFFICE.get_or_init(|| {
            let catalog = catalog();
            (catalog.clone(), language(catalog))
        });
        let scene = scene(catalog, marks);
        Self { language, scene, context: Context::default() }
    }

    /// The same, with a robot that asks at other times.
    pub fn asking(marks: &[&str], asking: Asking) -> Self {
        let language = Box::leak(Box::new(language(catalog()).asking(asking)));
        Self { language, ..Self::new(marks) }
    }

    /// Somebody points at an object.
    pub fn choose(&mut self, instance: &str) -> String {
        let object = self.scene.objects.iter().find(|object| object.instance == instance).unwrap().id;
        text(&self.language.choose(object, &self.scene, &mut self.context), &self.scene)
    }

    /// These steps are done, as far as the language can tell.
    pub fn carry_out(&mut self, steps: &[Step]) {
        for step in steps {
            self.context.note_outcome(step, Status::ActionSuccessful);
        }
        self.scene = self.language.expected(&self.scene, steps);
    }

    /// Says something, and has done what is to be done at once.
    pub fn say_and_do(&mut self, utterance: &str) -> String {
        let understanding = self.language.understand(utterance, &self.scene, &mut self.context);
        let text = text(&understanding, &self.scene);
        if let Understanding::Plan { steps, .. } = &understanding {
            self.carry_out(steps);
        }
        text
    }

    pub fn say(&mut self, utterance: &str) -> String {
        let understanding = self.language.understand(utterance, &self.scene, &mut self.context);
        // What was written down and read again is the same conversation.
        self.context = serde_json::from_str(&serde_json::to_string(&self.context).unwrap()).unwrap();
        text(&understanding, &self.scene)
    }
}

/// Finds that the last of several utterances comes to `wanted`, once all before it were done.
#[track_caller]
pub fn means(marks: &[&str], said: &[&str], wanted: &str) {
    let mut talk = Talk::new(marks);
    let found = said.iter().map(|said| talk.say_and_do(said)).last().unwrap();
    assert_eq!(found, wanted, "{said:?}");
}
