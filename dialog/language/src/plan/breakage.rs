//! Breaking and cutting.

use cohabit_cdf::{ClassId, ObjectId, Property, Verb};

use crate::{
    ground::want::{Miss, Want},
    plan::{Fault, Planner, settle::Settled},
    words::{intent::Intent, lexicon::Pronoun},
};

impl Planner<'_> {
    pub(crate) fn add_break(&mut self, settled: &Settled) -> Result<(), Fault> {
        let objects = self.objects_to_break(settled)?;
        let (tools, lacks, says) = match settled.intent {
            Intent::Cut => (&self.devices.knives, "I need a knife for that.", "cutting"),
            _ => (&self.devices.hammers, "I need the hammer for that.", "breaking"),
        };
        let tool = match &settled.tool {
            Some((phrase, role)) if phrase.pronoun != Some(Pronoun::Place) => {
                Some(self.find_one(phrase, &Want::place(Intent::Use, &[], None), Some(*role))?)
            }
            _ if self.may_find(tools) => return Err(self.need(tools, lacks)),
            _ => self.tool(tools),
        };
        for object in objects {
            if settled.intent == Intent::Cut && !self.has(object, Property::Cuttable) {
                return Err(Fault::Cannot(format!("I cannot cut {}.", self.the(object))));
            }
            if let Some(tool) = tool.filter(|tool| *tool != object) {
                self.hold(tool)?;
            }
            self.open_around(object, false);
            self.interact(Verb::Break, object, says);
        }
        Ok(())
    }

    /// What is to be broken or cut. Who names a tool means to do it: the only thing that it may be is not asked about again.
    fn objects_to_break(&mut self, settled: &Settled) -> Result<Vec<ObjectId>, Fault> {
        let names_tool = settled.tool.as_ref().is_some_and(|(phrase, _)| !phrase.is_empty());
        match self.find_objects(settled, &Want::object(settled.intent)) {
            Err(Fault::Miss { miss: Miss::Several(ids), .. }) if names_tool && ids.len() == 1 => Ok(ids),
            found => found,
        }
    }

    /// One of these: that in the hand, or the nearest.
    fn tool(&self, classes: &[ClassId]) -> Option<ObjectId> {
        let held = self.scene.robot.held.and_then(|held| self.scene.object(held));
        let held = held.filter(|held| classes.contains(&held.class)).map(|held| held.id);
        held.or_else(|| self.nearest(classes))
    }
}
