//! What machines do to what is in them, once they work.
//!
//! A machine that works for a moment is on first, and only then changes its contents: goals that ask for both the
//! machine on and the thing in it must be able to see that.

use cohabit_cdf::{ClassId, Color, Fluid, ObjectId, Property, StateFlag};
use serde::{Deserialize, Serialize};

use crate::{
    anchors::{Anchor, anchors, fitting_anchors, free_anchors},
    effect::Effect,
    facts::Facts,
    report::SoundKind,
};

/// Ticks from the start of a machine to its effect: a quarter of a second.
pub(crate) const EFFECT_TICKS: u64 = 15;
/// Ticks that a machine stays on for a moment: two seconds.
pub(crate) const MOMENT_TICKS: u64 = 120;
/// How much larger the embiggenator makes things.
const EMBIGGEN: f32 = 1.8;

/// What a machine does.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub(crate) enum Work {
    /// Nothing but being on.
    Nothing,
    /// What can be heated gets hot.
    Heat,
    /// As [`Self::Heat`], and what can be cooked is cooked.
    Toast,
    /// What can be chilled gets cold.
    Chill,
    /// What is in it becomes what it was yesterday.
    Yesterday,
    /// What is in it becomes a carrot.
    Carrot,
    /// A cartridge becomes its product, beside it.
    Print,
    /// What holds fluids gets hot coffee.
    Brew,
    /// Coffee becomes beans.
    Unbrew,
    /// What is in it takes a colour.
    Paint(Color),
    /// What is in it grows, or shrinks back.
    Embiggen,
    /// The object at this slot falls into the tray.
    Vend(u16),
}

/// A machine at work for a moment.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub(crate) struct Run {
    /// The tick in which it came on.
    pub since: u64,
    pub work: Work,
    /// Where the work is done: the machine itself, or what it is aimed at.
    pub site: ObjectId,
    /// What is on for as long.
    pub drives: Option<ObjectId>,
}

/// The class a cartridge prints, by its own class.
const PRINTS: &[(&str, &str)] = &[
    ("Printer_Cartridge", "CoffeeMug_Yellow"),
    ("Printer_Cartridge_Figure", "ActionFigure"),
    ("Printer_Cartridge_Hammer", "Hammer"),
    ("Printer_Cartridge_Lever", "FuseBox_01_Lever"),
    ("Printer_Cartridge_Mug", "CoffeeMug_Yellow"),
];

/// The first cartridge in a printer and the class it prints.
pub(crate) fn cartridge(facts: &Facts<'_>, printer: ObjectId) -> Option<(ObjectId, ClassId)> {
    facts.state.children(printer).find_map(|child| {
        let by_class = || {
            let (_, product) = PRINTS.iter().find(|(cartridge, _)| *cartridge == facts.class(child).id)?;
            facts.catalog.find(product)
        };
        let is_cartridge = PRINTS.iter().any(|(cartridge, _)| *cartridge == facts.class(child).id);
        is_cartridge.then(|| facts.object(child).prints.or_else(by_class)).flatten().map(|product| (child, product))
    })
}

/// The anchor of a printer where its product comes out: the last free one.
pub(crate) fn product_anchor(facts: &Facts<'_>, printer: ObjectId) -> Option<Anchor> {
    free_anchors(facts, printer).pop()
}

/// What is at a slot of a vending machine: the slots are the anchors of its last surface.
pub(crate) fn vended(facts: &Facts<'_>, machine: ObjectId, slot: u16) -> Option<ObjectId> {
    let surfaces = &facts.class(machine).receptacle.as_ref()?.surfaces;
    let [across, along] = surfaces.last()?.anchors;
    let total = anchors(facts, machine).len();
    let first = total.checked_sub((across * along) as usize)?;
    let wanted = u16::try_from(first).ok()?.checked_add(slot)?;
    facts.state.children(machine).find(|child| {
        matches!(facts.object(*child).support, crate::entity::Support::On { anchor: Some(anchor), .. } if anchor == wanted)
    })
}

/// The free place in the tray of a vending machine: an anchor of its first surface.
pub(crate) fn tray_anchor(facts: &Facts<'_>, machine: ObjectId) -> Option<Anchor> {
    let [across, along] = facts.class(machine).receptacle.as_ref()?.surfaces.first()?.anchors;
    free_anchors(facts, machine).into_iter().find(|anchor| u32::from(anchor.index) < across * along)
}

/// What `work` changes at `site`, done by `machine`.
pub(crate) fn effects(facts: &Facts<'_>, machine: ObjectId, work: Work, site: ObjectId) -> Vec<Effect> {
    let contents = facts.contents(site);
    let direct = facts.held_in(site);
    match work {
        Work::Nothing => Vec::new(),
        Work::Heat => contents.into_iter().flat_map(|id| heat(facts, id)).collect(),
        Work::Toast => contents
            .into_iter()
            .flat_map(|id| {
                let cooked = facts.has(id, Property::Cookable).then_some(Effect::Set(id, StateFlag::Cooked, true));
                heat(facts, id).into_iter().chain(cooked)
            })
            .collect(),
        Work::Chill => contents.into_iter().flat_map(|id| chill(facts, id)).collect(),
        Work::Yesterday => direct.into_iter().flat_map(|id| yesterday(facts, site, id)).collect(),
        Work::Carrot => direct.into_iter().flat_map(|id| carrot(facts, site, id)).collect(),
        Work::Print => print(facts, site),
        Work::Brew => brew(facts, site),
        Work::Unbrew => unbrew(facts, site),
        Work::Paint(color) => direct.into_iter().map(|id| Effect::Paint(id, color)).collect(),
        Work::Embiggen => direct.into_iter().flat_map(|id| embiggen(facts, id)).collect(),
        Work::Vend(slot) => vend(facts, machine, site, slot),
    }
}

/// What gets hot is no longer cold; a floppy disk breaks.
fn heat(facts: &Facts<'_>, id: ObjectId) -> Vec<Effect> {
    if !facts.has(id, Property::Heatable) {
        return Vec::new();
    }
    let mut effects = vec![Effect::Set(id, StateFlag::Hot, true), Effect::Set(id, StateFlag::Cold, false)];
    if facts.class(id).id.starts_with("Floppy_") && !facts.is(id, StateFlag::Broken) {
        effects.extend([Effect::Set(id, StateFlag::Broken, true), Effect::sound(SoundKind::Break, id)]);
    }
    effects
}

/// What gets cold is no longer hot.
pub(crate) fn chill(facts: &Facts<'_>, id: ObjectId) -> Vec<Effect> {
    if !facts.has(id, Property::Chillable) {
        return Vec::new();
    }
    vec![Effect::Set(id, StateFlag::Cold, true), Effect::Set(id, StateFlag::Hot, false)]
}

/// Broken, eaten, cooked and cut things are whole again; a carrot is what it was.
fn yesterday(facts: &Facts<'_>, machine: ObjectId, id: ObjectId) -> Vec<Effect> {
    if let Some(was) = facts.object(id).yesterday {
        return replace(facts, machine, id, was, free_instance(facts, &facts.catalog.class(was).id), None, None);
    }
    [StateFlag::Broken, StateFlag::Eaten, StateFlag::Cooked, StateFlag::Cut]
        .into_iter()
        .filter(|flag| facts.is(id, *flag))
        .map(|flag| Effect::Set(id, flag, false))
        .collect()
}

fn carrot(facts: &Facts<'_>, machine: ObjectId, id: ObjectId) -> Vec<Effect> {
    let Some(class) = facts.catalog.find("Carrot_01") else { return Vec::new() };
    let object = facts.object(id);
    if object.class == class {
        return Vec::new();
    }
    let instance = product_instance(facts, machine, class);
    replace(facts, machine, id, class, instance, Some(object.class), Some(machine))
}

/// One object goes, another comes to its anchor.
fn replace(
    facts: &Facts<'_>,
    parent: ObjectId,
    old: ObjectId,
    class: ClassId,
    instance: String,
    yesterday: Option<ClassId>,
    by: Option<ObjectId>,
) -> Vec<Effect> {
    let at = match facts.object(old).support {
        crate::entity::Support::On { anchor: Some(anchor), .. } => anchor,
        _ => 0,
    };
    vec![Effect::Remove(old), Effect::Spawn { class, instance, parent, anchor: at, yesterday, by }]
}

fn print(facts: &Facts<'_>, printer: ObjectId) -> Vec<Effect> {
    let (Some((_, class)), Some(anchor)) = (cartridge(facts, printer), product_anchor(facts, printer)) else {
        return Vec::new();
    };
    let instance = product_instance(facts, printer, class);
    vec![Effect::Spawn { class, instance, parent: printer, anchor: anchor.index, yesterday: None, by: Some(printer) }]
}

/// Coffee comes hot into everything under the spout that takes it; water and beans are used up.
fn brew(facts: &Facts<'_>, maker: ObjectId) -> Vec<Effect> {
    let mut effects = Vec::new();
    for id in facts.contents(maker) {
        if facts.class(id).id == "CoffeeBeans_01" {
            effects.push(Effect::Remove(id));
        } else if facts.has(id, Property::Fillable) {
            effects.push(Effect::Fill(id, Fluid::Coffee));
            effects.extend(heat(facts, id));
        }
    }
    effects.push(Effect::Fill(maker, Fluid::None));
    effects
}

/// Coffee in the unmaker, or in what stands in it, comes out as beans.
fn unbrew(facts: &Facts<'_>, unmaker: ObjectId) -> Vec<Effect> {
    let filled: Vec<ObjectId> = std::iter::once(unmaker)
        .chain(facts.contents(unmaker))
        .filter(|id| facts.object(*id).fluid == Fluid::Coffee)
        .collect();
    let mut effects: Vec<Effect> = filled.iter().map(|id| Effect::Fill(*id, Fluid::None)).collect();
    let beans = facts.catalog.find("CoffeeBeans_01");
    if let (false, Some(class), Some(anchor)) = (filled.is_empty(), beans, free_anchors(facts, unmaker).first()) {
        let instance = product_instance(facts, unmaker, class);
        let spawn = Effect::Spawn {
            class,
            instance,
            parent: unmaker,
            anchor: anchor.index,
            yesterday: None,
            by: Some(unmaker),
        };
        effects.push(spawn);
    }
    effects
}

fn embiggen(facts: &Facts<'_>, id: ObjectId) -> [Effect; 2] {
    let large = facts.is(id, StateFlag::Embiggenated);
    [Effect::Set(id, StateFlag::Embiggenated, !large), Effect::Scale(id, if large { 1.0 / EMBIGGEN } else { EMBIGGEN })]
}

fn vend(facts: &Facts<'_>, button: ObjectId, machine: ObjectId, slot: u16) -> Vec<Effect> {
    let (Some(object), Some(tray)) = (vended(facts, machine, slot), tray_anchor(facts, machine)) else {
        return Vec::new();
    };
    vec![
        Effect::PutOn { object, parent: machine, anchor: tray.index },
        Effect::Set(machine, StateFlag::Used, true),
        Effect::sound(SoundKind::Machine, button),
    ]
}

/// The first free instance id of a class.
pub(crate) fn free_instance(facts: &Facts<'_>, class: &str) -> String {
    numbered(facts, class)
}

/// The id of the next thing of a class that a machine makes.
fn product_instance(facts: &Facts<'_>, machine: ObjectId, class: ClassId) -> String {
    numbered(facts, &format!("{}_Spawned_{}", facts.object(machine).instance, facts.catalog.class(class).id))
}

/// `stem_1`, or the next number that nothing ever had.
fn numbered(facts: &Facts<'_>, stem: &str) -> String {
    (1_u32..)
        .map(|number| format!("{stem}_{number}"))
        .find(|instance| !facts.state.objects.iter().any(|object| object.is_called(instance)))
        .expect("invariant: fewer objects than numbers")
}

/// The anchor that a slice falls to: a fitting one beside what it was cut from.
pub(crate) fn slice_place(facts: &Facts<'_>, cut: ObjectId, class: ClassId) -> Option<(ObjectId, u16)> {
    let parent = facts.object(cut).parent()?;
    let size = facts.catalog.class(class).size_m.into();
    fitting_anchors(facts, parent, size).first().map(|anchor| (parent, anchor.index))
}
