//! The pages that are open by one link. Where a second one is opened, the first says so and is over: two would play one mission.

use crate::registry::Registry;

/// So many pages of one participant are told apart; the oldest are forgotten, which have long said that they are over.
const MOST_KNOWN: usize = 50;

impl Registry {
    /// Whether somebody's link was opened once more since this page was: pages are told apart by what each calls itself.
    pub(crate) fn is_elsewhere(&mut self, place: u32, page: &str) -> bool {
        let Some(participant) = self.participants.get_mut(&place) else { return false };
        let pages = &mut participant.pages;
        if !pages.iter().any(|known| known == page) {
            if pages.len() >= MOST_KNOWN {
                pages.remove(0);
            }
            pages.push(page.to_owned());
        }
        pages.last().is_some_and(|newest| newest != page)
    }
}
