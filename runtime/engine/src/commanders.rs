//! Who commands which body: one at a time, and whom it goes back to.

use cohabit_bus::{Text, is_alive};

/// Somebody who commands, or did before another took over.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Commander {
    /// The run of its publisher of commands.
    pub run: u64,
    /// What kind of peer it is.
    pub peer: Text<30>,
}

/// The commanders of all bodies: of each, who commands it now stands last, behind those it was taken from.
#[derive(Default)]
pub(crate) struct Commanders {
    bodies: Vec<Vec<Commander>>,
}

impl Commanders {
    /// Who commands a body.
    pub fn of(&self, body: u32) -> Option<&Commander> {
        self.bodies.get(body as usize)?.last()
    }

    /// Makes somebody the commander of a body; says how, or why not.
    pub fn claim(&mut self, body: u32, claimant: Commander, take_over: bool) -> Result<String, String> {
        self.bury(body);
        let peer = claimant.peer.as_str().to_owned();
        let stack = self.stack(body);
        let from = match stack.last() {
            Some(now) if now.run == claimant.run => return Ok(format!("the {peer} commands body {body} already")),
            Some(now) if !take_over => {
                return Err(format!("the {} commands body {body}: it has to be taken over", now.peer.as_str()));
            }
            now => now.map(|now| now.peer.as_str().to_owned()),
        };
        // Who comes back stands in one place alone.
        stack.retain(|earlier| earlier.run != claimant.run);
        stack.push(claimant);
        Ok(match from {
            Some(from) => format!("the {peer} took body {body} over from the {from}"),
            None => format!("the {peer} commands body {body}"),
        })
    }

    /// Somebody lets go of a body; says what came of it, if it was its commander.
    pub fn release(&mut self, body: u32, run: u64) -> Option<String> {
        let stack = self.stack(body);
        let was = stack.last().filter(|now| now.run == run).cloned();
        stack.retain(|commander| commander.run != run);
        self.bury(body);
        let peer = was?.peer;
        let peer = peer.as_str();
        Some(match self.of(body) {
            Some(back) => format!("the {peer} handed body {body} back to the {}", back.peer.as_str()),
            None => format!("the {peer} let go of body {body}"),
        })
    }

    /// Whether a body obeys somebody; else why not.
    pub fn obeys(&self, body: u32, run: u64) -> Result<(), String> {
        match self.of(body) {
            Some(now) if now.run == run => Ok(()),
            Some(now) => Err(format!("the {} commands body {body}: it has to be taken over", now.peer.as_str())),
            None => Err(format!("nobody commands body {body}: it has to be claimed first")),
        }
    }

    /// Forgets those whose processes are gone. Gives the bodies whose commander was among them, and a sentence.
    pub fn bury_all(&mut self) -> Vec<(u32, String)> {
        let all = 0..u32::try_from(self.bodies.len()).unwrap_or(0);
        all.filter_map(|body| {
            let was = self.of(body)?.clone();
            self.bury(body);
            if self.of(body) == Some(&was) {
                return None;
            }
            let gone = was.peer.as_str();
            Some(match self.of(body) {
                Some(back) => {
                    (body, format!("the {gone} is gone; body {body} goes back to the {}", back.peer.as_str()))
                }
                None => (body, format!("the {gone} is gone; nobody commands body {body}")),
            })
        })
        .collect()
    }

    fn bury(&mut self, body: u32) {
        self.stack(body).retain(|commander| is_alive(commander.run));
    }

    /// There are few bodies: who asks has checked that this is one of them.
    fn stack(&mut self, body: u32) -> &mut Vec<Commander> {
        let index = body as usize;
        if self.bodies.len() <= index {
            self.bodies.resize_with(index + 1, Vec::new);
        }
        &mut self.bodies[index]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The run of somebody in this process.
    fn run(number: u64) -> u64 {
        (u64::from(std::process::id()) << 40) + number
    }

    fn somebody(number: u64, peer: &str) -> Commander {
        Commander { run: run(number), peer: Text::new(peer) }
    }

    #[test]
    fn a_body_has_one_commander() {
        let mut all = Commanders::default();
        assert!(all.obeys(0, run(1)).unwrap_err().contains("nobody"));
        all.claim(0, somebody(1, "agent"), false).unwrap();
        assert_eq!(all.obeys(0, run(1)), Ok(()));
        let refused = all.claim(0, somebody(2, "page"), false).unwrap_err();
        assert!(refused.contains("agent"), "{refused}");
        assert!(all.obeys(0, run(2)).is_err());
        all.claim(1, somebody(2, "page"), false).unwrap();
        assert_eq!(all.obeys(1, run(2)), Ok(()));
    }

    #[test]
    fn what_was_taken_over_goes_back() {
        let mut all = Commanders::default();
        all.claim(0, somebody(1, "agent"), false).unwrap();
        all.claim(0, somebody(2, "page"), true).unwrap();
        all.claim(0, somebody(3, "study"), true).unwrap();
        assert!(all.obeys(0, run(1)).is_err());
        // Who is not in command lets go without anybody noticing.
        assert_eq!(all.release(0, run(2)), None);
        let told = all.release(0, run(3)).unwrap();
        assert!(told.contains("back to the agent"), "{told}");
        assert_eq!(all.obeys(0, run(1)), Ok(()));
        assert!(all.release(0, run(1)).unwrap().contains("let go"));
        assert_eq!(all.of(0), None);
    }

    #[test]
    fn the_dead_command_nothing() {
        let mut all = Commanders::default();
        all.claim(0, somebody(1, "agent"), false).unwrap();
        // No process has the highest number of all.
        let dead = Commander { run: 0xff_ffff << 40, peer: Text::new("page") };
        all.claim(0, dead, true).unwrap();
        let told = all.bury_all();
        assert!(told.len() == 1 && told[0].1.contains("back to the agent"), "{told:?}");
        assert_eq!(all.obeys(0, run(1)), Ok(()));
        assert!(all.bury_all().is_empty());
    }
}
