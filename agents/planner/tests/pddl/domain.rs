//! Domain and problem files read and carried out by the book, with nothing of the planner's.

use std::collections::{BTreeSet, HashMap, HashSet};

use cohabit_planner::pddl::sexpr::Sexpr;

/// What holds; all else does not.
pub type State = BTreeSet<String>;

/// A domain and a problem.
pub struct Domain {
    /// The number of terms of each predicate.
    predicates: HashMap<String, usize>,
    constants: HashSet<String>,
    derived: Vec<(String, Sexpr)>,
    /// Preconditions and effects by name.
    actions: HashMap<String, (Sexpr, Sexpr)>,
    pub init: State,
    goal: Sexpr,
}

impl Domain {
    /// Reads both files, and checks that they are well-formed.
    pub fn read(domain: &str, problem: &str) -> Self {
        let mut read = Self {
            predicates: HashMap::new(),
            constants: HashSet::new(),
            derived: Vec::new(),
            actions: HashMap::new(),
            init: State::new(),
            goal: Sexpr::List(Vec::new(), 0),
        };
        let domain = definition(domain, "domain");
        for section in &domain[2..] {
            read.section(section);
        }
        let problem = definition(problem, "problem");
        assert_eq!(problem[2].head(), Some(":domain"));
        assert_eq!(problem[2].list()[1].word(), domain[1].list()[1].word(), "the problem is of another domain");
        for section in &problem[3..] {
            match section.head() {
                Some(":objects") => {}
                Some(":init") => read.init = section.list()[1..].iter().map(printed).collect(),
                Some(":goal") => read.goal = section.list()[1].clone(),
                other => panic!("{other:?} is no section of a problem"),
            }
        }
        read.check();
        read
    }

    fn section(&mut self, section: &Sexpr) {
        let parts = section.list();
        match section.head() {
            Some(":requirements" | ":types") => {}
            Some(":constants") => {
                let words: Vec<&str> = parts[1..].iter().map(|part| part.word().unwrap()).collect();
                for (index, word) in words.iter().enumerate() {
                    let is_type = *word == "-" || index > 0 && words[index - 1] == "-";
                    assert!(is_type || self.constants.insert((*word).to_owned()), "{word} is there twice");
                }
            }
            Some(":predicates") => {
                for predicate in &parts[1..] {
                    let terms = predicate.list()[1..].iter().filter(|term| term.word().unwrap().starts_with('?'));
                    let known = self.predicates.insert(predicate.head().unwrap().to_owned(), terms.count());
                    assert_eq!(known, None, "{predicate:?} is there twice");
                }
            }
            Some(":derived") => self.derived.push((printed(&parts[1]), parts[2].clone())),
            Some(":action") => {
                let keys: Vec<_> = [2, 4, 6].map(|at| parts[at].word()).into_iter().flatten().collect();
                assert_eq!(keys, [":parameters", ":precondition", ":effect"], "{section:?}");
                assert_eq!(parts.len(), 8, "{section:?}");
                assert!(parts[3].list().is_empty());
                let name = parts[1].word().unwrap().to_owned();
                let known = self.actions.insert(name.clone(), (parts[5].clone(), parts[7].clone()));
                assert!(known.is_none(), "{name} is there twice");
            }
            other => panic!("{other:?} is no section of a domain"),
        }
    }

    fn check(&self) {
        let derived: HashSet<&str> = self.derived.iter().map(|(atom, _)| atom.as_str()).collect();
        self.derived.iter().for_each(|(_, formula)| self.check_formula(formula));
        for (name, (needs, effects)) in &self.actions {
            self.check_formula(needs);
            for (when, atom, _) in changes(effects) {
                when.iter().for_each(|condition| self.check_formula(condition));
                self.check_atom(atom);
                assert!(!derived.contains(printed(atom).as_str()), "{name} changes what follows from other facts");
            }
        }
        self.check_formula(&self.goal);
        let init = self.init.iter().flat_map(|atom| Sexpr::read(atom).unwrap()).collect::<Vec<_>>();
        init.iter().for_each(|atom| self.check_atom(atom));
    }

    fn check_formula(&self, formula: &Sexpr) {
        match formula.head() {
            Some("and" | "or" | "not") => formula.list()[1..].iter().for_each(|part| self.check_formula(part)),
            _ => self.check_atom(formula),
        }
    }

    fn check_atom(&self, atom: &Sexpr) {
        let terms = &atom.list()[1..];
        assert_eq!(self.predicates.get(atom.head().unwrap()), Some(&terms.len()), "{atom:?}");
        for term in terms {
            assert!(self.constants.contains(term.word().unwrap()), "{term:?} of {atom:?} is no constant");
        }
    }

    /// What holds, with what follows from it.
    fn derive(&self, state: &State) -> State {
        let mut whole = state.clone();
        loop {
            let before = whole.len();
            for (atom, formula) in &self.derived {
                if holds(formula, &whole) {
                    whole.insert(atom.clone());
                }
            }
            if whole.len() == before {
                return whole;
            }
        }
    }

    /// Does an action, if it can be done.
    pub fn act(&self, name: &str, state: &mut State) -> bool {
        let Some((needs, effects)) = self.actions.get(name) else { panic!("there is no action {name}") };
        let whole = self.derive(state);
        if !holds(needs, &whole) {
            return false;
        }
        let is_due = |when: &[&Sexpr]| when.iter().all(|condition| holds(condition, &whole));
        let due: Vec<_> = changes(effects).into_iter().filter(|(when, ..)| is_due(when)).collect();
        for (_, atom, _) in due.iter().filter(|(.., is_added)| !is_added) {
            state.remove(&printed(atom));
        }
        for (_, atom, _) in due.iter().filter(|(.., is_added)| *is_added) {
            state.insert(printed(atom));
        }
        true
    }

    /// Does what nobody does: meets goals, and has the machine that is on work and go off.
    pub fn settle(&self, state: &mut State) {
        let (meets, machines) = (self.names("meet-"), [self.names("work-"), self.names("rest-")].concat());
        loop {
            while meets.iter().any(|name| self.act(name, state)) {}
            if !machines.iter().any(|name| self.act(name, state)) {
                return;
            }
        }
    }

    fn names(&self, kind: &str) -> Vec<&String> {
        let mut names: Vec<&String> = self.actions.keys().filter(|name| name.starts_with(kind)).collect();
        names.sort();
        names
    }

    /// Whether the goal is reached.
    pub fn is_done(&self, state: &State) -> bool {
        holds(&self.goal, &self.derive(state))
    }

    /// How many actions there are.
    pub fn actions(&self) -> usize {
        self.actions.len()
    }
}

/// The parts of the one definition in a file.
fn definition(text: &str, kind: &str) -> Vec<Sexpr> {
    let all = Sexpr::read(text).unwrap();
    assert_eq!(all.len(), 1, "one definition a file");
    let parts = all[0].list().to_vec();
    assert_eq!((parts[0].word(), parts[1].head()), (Some("define"), Some(kind)));
    parts
}

fn printed(expression: &Sexpr) -> String {
    match expression {
        Sexpr::Word(word, _) => word.clone(),
        Sexpr::List(parts, _) => format!("({})", parts.iter().map(printed).collect::<Vec<_>>().join(" ")),
    }
}

fn holds(formula: &Sexpr, state: &State) -> bool {
    let parts = formula.list();
    match formula.head() {
        Some("and") => parts[1..].iter().all(|part| holds(part, state)),
        Some("or") => parts[1..].iter().any(|part| holds(part, state)),
        Some("not") => !holds(&parts[1], state),
        _ => state.contains(&printed(formula)),
    }
}

/// The changes of an effect: under which conditions, what, and whether it is added.
fn changes(effect: &Sexpr) -> Vec<(Vec<&Sexpr>, &Sexpr, bool)> {
    let parts = effect.list();
    match effect.head() {
        Some("and") => parts[1..].iter().flat_map(changes).collect(),
        Some("not") => vec![(Vec::new(), &parts[1], false)],
        Some("when") => {
            let under = |(mut when, atom, is_added): (Vec<_>, _, _)| {
                when.push(&parts[1]);
                (when, atom, is_added)
            };
            changes(&parts[2]).into_iter().map(under).collect()
        }
        _ => vec![(Vec::new(), effect, true)],
    }
}
