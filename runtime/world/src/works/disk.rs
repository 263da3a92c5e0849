//! What floppy disks do to the computers that they are in.

use cohabit_cdf::{ObjectId, Property, StateFlag};

use crate::{effect::Effect, facts::Facts, power::lacks_power};

const VIRUS: &str = "Floppy_Virus";
const ANTIVIRUS: &str = "Floppy_AntiVirus";

/// Whether a whole disk in that computer does something: a virus to a clean one, an antivirus to an infected one.
pub(crate) fn is_effective(facts: &Facts<'_>, disk: ObjectId, terminal: ObjectId) -> bool {
    let infected = facts.is(terminal, StateFlag::Infected);
    let whole = !facts.is(disk, StateFlag::Broken);
    let kind = facts.class(disk).id.as_str();
    facts.has(terminal, Property::Infectable)
        && whole
        && ((kind == VIRUS && !infected) || (kind == ANTIVIRUS && infected))
}

/// What a disk changes in a computer that has power.
pub(crate) fn read(facts: &Facts<'_>, disk: ObjectId, terminal: ObjectId) -> Option<Effect> {
    let infects = facts.class(disk).id == VIRUS;
    let works = is_effective(facts, disk, terminal) && !lacks_power(facts, terminal);
    works.then_some(Effect::Set(terminal, StateFlag::Infected, infects))
}

/// What the disks in a computer change as its power comes: an antivirus has the last word.
pub(crate) fn read_all(facts: &Facts<'_>, terminal: ObjectId) -> Option<Effect> {
    if !facts.has(terminal, Property::Infectable) || lacks_power(facts, terminal) {
        return None;
    }
    let disks = facts.state.children(terminal).filter(|disk| !facts.is(*disk, StateFlag::Broken));
    let kinds: Vec<&str> = disks.map(|disk| facts.class(disk).id.as_str()).collect();
    let infected = facts.is(terminal, StateFlag::Infected);
    let after = (infected || kinds.contains(&VIRUS)) && !kinds.contains(&ANTIVIRUS);
    (after != infected).then_some(Effect::Set(terminal, StateFlag::Infected, after))
}
