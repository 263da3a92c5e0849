//! Names of things: from the catalogue's classes, their words, parts of those, and words for kinds.

use std::collections::{BTreeMap, BTreeSet};

use cohabit_cdf::{Catalog, ClassId, ObjectClass, Property};

use crate::words::{
    lexicon::{Lexicon, Naming},
    token,
};

/// How much one word of a name of several means its class.
const NAME_PART: f32 = 0.6;

/// The same of its other names.
const WORD_PART: f32 = 0.5;

/// How much the last word of a name means its class, where others are called just that.
const HEAD: f32 = 0.4;

/// How much what some furniture of a kind is called means other furniture of that kind, and how many must be called so.
const SHARED: f32 = 0.4;
const SHARING: usize = 2;

/// How much the word for a kind of things means a class of that kind.
const KIND: f32 = 0.3;

impl Lexicon {
    pub(crate) fn add_classes(&mut self, catalog: &Catalog, aliases: &BTreeMap<String, Vec<String>>) {
        for (index, class) in (0_u16..).zip(catalog.classes()) {
            let id = ClassId(index);
            if class.has(Property::Pickupable) {
                self.carried.insert(id);
            } else if class.receptacle.as_ref().is_some_and(|kind| !kind.enclosed) && !class.has(Property::Toggleable) {
                self.furniture.insert(id);
            }
            self.name_class(&class.name, id, 1.0);
            self.name_class(&class.id, id, 1.0);
            self.add_name_parts(&class.name, id);
            for (rank, word) in (0_u8..).zip(&class.words) {
                self.name_class(word, id, 0.9 - 0.05 * f32::from(rank.min(8)));
            }
        }
        for (alias, classes) in aliases {
            for class in classes.iter().filter_map(|id| catalog.find(id)) {
                self.name_class(alias, class, 0.9);
            }
        }
        self.add_heads(catalog);
        self.share_words(catalog);
    }

    /// `the blue rack`: what several shelves are called, all are called, though less surely.
    fn share_words(&mut self, catalog: &Catalog) {
        let kind = |class: &ObjectClass| {
            let is_furniture =
                class.receptacle.is_some() && !class.has(Property::Pickupable) && !class.has(Property::Toggleable);
            token::words(&class.name).pop().filter(|_| is_furniture)
        };
        let mut called: BTreeMap<(String, &str), usize> = BTreeMap::new();
        for (kind, class) in catalog.classes().iter().filter_map(|class| Some((kind(class)?, class))) {
            for word in class.words.iter().filter(|word| !word.contains(' ')) {
                *called.entry((kind.clone(), word)).or_default() += 1;
            }
        }
        for (id, class) in (0_u16..).map(ClassId).zip(catalog.classes()) {
            let own = kind(class);
            let shared = called.iter().filter(|((kind, _), count)| Some(kind) == own.as_ref() && **count >= SHARING);
            for ((_, word), _) in shared {
                self.name_class(word, id, SHARED);
            }
        }
    }

    /// `that box`: the cereal box too, though other things are called just that; `the cabinet`: one for medicine; `the rack`: for shoes.
    /// Only what can be carried is meant so, what things are kept in, and what they are put on.
    fn add_heads(&mut self, catalog: &Catalog) {
        let holds = |class: &ObjectClass| class.receptacle.is_some() && !class.has(Property::Toggleable);
        let is_meant = |class: &ClassId| self.carried.contains(class) || holds(catalog.class(*class));
        let meant: Vec<ClassId> = (0_u16..).map(ClassId).take(catalog.classes().len()).filter(is_meant).collect();
        for class in meant {
            let words = self.replaced(&token::words(&catalog.class(class).name));
            let [_, .., head] = words.as_slice() else { continue };
            let is_name = self.classes.exact(std::slice::from_ref(head)).is_some();
            let namings = is_name.then(|| self.classes.entry(head));
            if let Some(namings) = namings.filter(|known| known.iter().all(|one| one.class != class)) {
                namings.push(Naming { class, weight: HEAD });
            }
        }
    }

    fn add_name_parts(&mut self, name: &str, class: ClassId) {
        let words = self.replaced(&token::words(name));
        let is_room = |word: &String| self.rooms.words().any(|known| known == word);
        let parts: Vec<String> = words.iter().filter(|word| word.len() > 2 && !is_room(word)).cloned().collect();
        for word in parts.iter().filter(|_| words.len() > 1) {
            self.name_parts.entry(word).push(Naming { class, weight: NAME_PART });
        }
    }

    /// `garbage` for the garbage can: parts of other names than the first, where the word means nothing else.
    pub(crate) fn add_word_parts(&mut self, catalog: &Catalog) {
        for (index, class) in (0_u16..).zip(catalog.classes()).filter(|(_, class)| !class.has(Property::Decor)) {
            for name in class.words.iter().map(|name| token::words(name)).filter(|name| name.len() == 2) {
                let word = &name[..1];
                let is_free = word[0].len() > 3
                    && !self.is_small_word(&word[0])
                    && self.classes.exact(word).is_none()
                    && self.name_parts.exact(word).is_none_or(|known| known.iter().all(|one| one.weight < NAME_PART))
                    && [
                        self.colors.exact(word).is_some(),
                        self.fluids.exact(word).is_some(),
                        self.states.exact(word).is_some(),
                    ] == [false; 3]
                    && !self
                        .adjectives
                        .words()
                        .chain(self.rooms.words())
                        .chain(self.verbs.words())
                        .any(|known| *known == word[0]);
                let namings = is_free.then(|| self.name_parts.entry(&word[0]));
                if let Some(namings) = namings.filter(|known| known.iter().all(|one| one.class != ClassId(index))) {
                    namings.push(Naming { class: ClassId(index), weight: WORD_PART });
                }
            }
        }
    }

    /// `machine`, `food`: all classes that are such, where the word is no part of a name that was meant.
    pub(crate) fn add_kinds(&mut self, catalog: &Catalog, kinds: &BTreeMap<String, Property>) {
        for (word, property) in kinds {
            let namings = self.name_parts.entry(word);
            for (index, _) in (0_u16..).zip(catalog.classes()).filter(|(_, class)| class.has(*property)) {
                if namings.iter().all(|known| known.class != ClassId(index)) {
                    namings.push(Naming { class: ClassId(index), weight: KIND });
                }
            }
            self.kinds.insert(word.clone());
        }
    }

    fn name_class(&mut self, phrase: &str, class: ClassId, weight: f32) {
        // The same replacements as in utterances, so that `breakroom sign` is found again.
        let phrase = self.replaced(&token::words(phrase)).join(" ");
        if phrase.is_empty() {
            return;
        }
        let index = usize::from(class.0);
        if self.class_words.len() <= index {
            self.class_words.resize(index + 1, BTreeSet::new());
        }
        self.class_words[index].extend(token::words(&phrase));
        let namings = self.classes.entry(&phrase);
        match namings.iter_mut().find(|naming| naming.class == class) {
            Some(naming) => naming.weight = naming.weight.max(weight),
            None => namings.push(Naming { class, weight }),
        }
    }
}
