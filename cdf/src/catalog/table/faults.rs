//! What is wrong in a table: names that nothing declares, changes where they may not stand.

use std::collections::BTreeSet;

use super::{ActionTable, Change, Condition, Effect, Need, TableError};

impl ActionTable {
    /// All classes that the table names.
    fn classes(&self) -> Vec<String> {
        let conditions = |needs: &[Need], effects: &[Effect], when: &[Condition]| {
            let needs = needs.iter().flat_map(|need| need.any.clone());
            let effects = effects.iter().flat_map(|effect| effect.when.clone());
            needs.chain(effects).chain(when.iter().cloned()).flat_map(classes_of).collect::<Vec<_>>()
        };
        let changes = |effects: &[Effect]| {
            let changes = effects.iter().flat_map(|effect| effect.changes.clone());
            changes
                .filter_map(|change| match change {
                    Change::Spawn(_, class) | Change::Become(_, class) => Some(class),
                    _ => None,
                })
                .collect::<Vec<_>>()
        };
        let mut all = Vec::new();
        for rule in &self.rules {
            all.extend(conditions(&rule.needs, &rule.effects, &rule.when));
            all.extend(changes(&rule.effects));
        }
        for device in &self.devices {
            all.extend(conditions(&device.needs, &device.press, &[]));
            all.extend(changes(&device.press));
            all.extend(
                [&device.classes, &device.works, &device.aims, &device.worked_by].into_iter().flatten().cloned(),
            );
        }
        for work in &self.works {
            for effects in [&work.effects, &work.then] {
                all.extend(conditions(&[], effects, &[]));
                all.extend(changes(effects));
            }
        }
        for recipe in [&self.slice, &self.prints, &self.yesterday] {
            all.extend(recipe.iter().flat_map(|(from, to)| [from.clone(), to.clone()]));
        }
        all.extend(self.kinds.values().flatten().cloned());
        all
    }

    /// What is wrong in what one file says; `works` are the names of those of all files.
    pub(super) fn faults(
        &self,
        file: &str,
        is_class: &dyn Fn(&str) -> bool,
        works: &BTreeSet<&str>,
    ) -> Vec<TableError> {
        let mut faults = Vec::new();
        for work in &self.works {
            if let Some(change) = work.changes().find(|change| !change.is_of_a_work()) {
                let (file, work, change) = (file.to_owned(), work.name.clone(), change.clone());
                faults.push(TableError::NotOfAWork { file, work, change });
            }
        }
        let unknown: BTreeSet<String> = self.classes().into_iter().filter(|class| !is_class(class)).collect();
        faults.extend(unknown.into_iter().map(|class| TableError::NoClass {
            file: file.to_owned(),
            class,
            near: None,
        }));
        let no_work = |device: &str, work: &str| {
            let [file, device, work] = [file, device, work].map(str::to_owned);
            TableError::NoWork { file, device, work }
        };
        for device in &self.devices {
            let name = device.classes.first().map_or("", String::as_str);
            let mut changes = device.press.iter().flat_map(|effect| &effect.changes);
            if let Some(change) = changes.find(|change| !change.is_of_a_press()) {
                let (file, device, change) = (file.to_owned(), name.to_owned(), change.clone());
                faults.push(TableError::NoPress { file, device, change });
            }
            let named = [&device.work, &device.shut_work].into_iter().flatten().map(String::as_str);
            faults.extend(named.filter(|work| !works.contains(work)).map(|work| no_work(name, work)));
            if let Some(work) = device.work.as_ref().filter(|_| !device.runs_for_a_moment()) {
                let (file, device, work) = (file.to_owned(), name.to_owned(), work.clone());
                faults.push(TableError::NotBegun { file, device, work });
            }
        }
        let power_work = self.power_work.as_deref().filter(|work| !works.contains(work));
        faults.extend(power_work.map(|work| no_work("power_work", work)));
        faults
    }
}

/// The classes that a condition names.
fn classes_of(condition: Condition) -> Vec<String> {
    condition.test.pattern().map(|classes| classes.0.clone()).unwrap_or_default()
}
