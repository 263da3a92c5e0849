//! Parameters of links, such as a site that recruits people passes them: by some conditions are assigned, and others lead participants back to
//! where they came from. `{survey_code}` in the address of return stands for the parameter of that name. Nothing else of a link is kept; what
//! leads back may tell who somebody is, so it lies with the links, apart from data, and goes with whoever withdraws.

use std::{collections::BTreeMap, fmt::Write as _};

use crate::{
    design::{Completion, CovariateSource, Study},
    folder::FolderError,
    registry::{Registry, StudyFault},
};

/// The longest value that is kept, in characters: identifiers are shorter.
const LONGEST_VALUE: usize = 200;

/// The parameters that an address of return has places for.
///
/// # Errors
/// What is wrong with them.
pub(crate) fn places(address: &str) -> Result<Vec<&str>, &'static str> {
    let mut parts = address.split('{');
    let before = parts.next().unwrap_or_default();
    let mut names = Vec::new();
    for part in parts {
        let is_name = |name: &str| name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
        match part.split_once('}') {
            Some((name, rest)) if !name.is_empty() && is_name(name) && !rest.contains('}') => names.push(name),
            _ => return Err("a place for a parameter is its name in braces: letters, digits, _ and -"),
        }
    }
    if before.contains('}') {
        return Err("there is a } without its {");
    }
    // Else whoever makes a link says to which site it leads.
    if !names.is_empty() && !before.contains('?') {
        return Err("parameters can stand behind a ? alone");
    }
    Ok(names)
}

/// An address of return with the values that somebody's link had; where it had none, the place is empty.
pub(crate) fn filled(address: &str, told: &BTreeMap<String, String>) -> String {
    let mut parts = address.split('{');
    let mut filled = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (name, rest) = part.split_once('}').unwrap_or((part, ""));
        filled += &encoded(told.get(name).map_or("", String::as_str));
        filled += rest;
    }
    filled
}

/// A value as it stands in an address.
fn encoded(value: &str) -> String {
    let mut text = String::new();
    for byte in value.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~".contains(&byte) {
            text.push(char::from(byte));
        } else {
            let _ = write!(text, "%{byte:02X}");
        }
    }
    text
}

impl Study {
    /// The parameters that lead participants back.
    fn leading_back(&self) -> Vec<&str> {
        match &self.completion {
            Some(Completion::Return(address)) => places(address).unwrap_or_default(),
            Some(Completion::Code(_)) | None => Vec::new(),
        }
    }

    /// Whether conditions are assigned by a parameter of that name.
    fn assigns_by(&self, name: &str) -> bool {
        let is_it =
            |from: &CovariateSource| matches!(from, CovariateSource::Link { parameter, .. } if parameter == name);
        self.minimisation.iter().flat_map(|all| &all.covariates).any(|covariate| is_it(&covariate.from))
    }
}

impl Registry {
    /// Keeps of what a newcomer's link tells what the study asks for, until they agree.
    pub(crate) fn tell(&mut self, index: usize, parameters: &BTreeMap<String, String>) {
        let back = self.study.leading_back();
        let is_asked = |name: &str| back.contains(&name) || self.study.assigns_by(name);
        let asked = parameters.iter().filter(|(name, value)| is_asked(name) && value.chars().count() <= LONGEST_VALUE);
        if let Some(newcomer) = self.newcomers.get_mut(index) {
            newcomer.parameters.extend(asked.map(|(name, value)| (name.clone(), value.clone())));
        }
    }

    /// Keeps what leads somebody back who has agreed.
    pub(crate) fn keep_way_back(
        &mut self,
        place: u32,
        parameters: &BTreeMap<String, String>,
    ) -> Result<(), StudyFault> {
        let back = self.study.leading_back();
        let kept = parameters.iter().filter(|(name, _)| back.contains(&name.as_str()));
        let kept: BTreeMap<String, String> = kept.map(|(name, value)| (name.clone(), value.clone())).collect();
        if kept.is_empty() {
            return Ok(());
        }
        let mut links = self.links.clone();
        links.back.insert(place, kept);
        let path = self.folder.links_path();
        links.save(&path).map_err(|source| FolderError::File { path, source })?;
        self.links = links;
        Ok(())
    }

    /// What shows that the participant at a place took part, if anything does.
    pub(crate) fn completion(&self, place: u32) -> Option<Completion> {
        let none = BTreeMap::new();
        self.study.completion.as_ref().map(|completion| match completion {
            Completion::Return(address) => {
                Completion::Return(filled(address, self.links.back.get(&place).unwrap_or(&none)))
            }
            Completion::Code(code) => Completion::Code(code.clone()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_has_places_for_parameters_of_links() {
        let address = "https://x.org/back?id=5&code={survey_code}&from={SONA-1}";
        assert_eq!(places(address), Ok(vec!["survey_code", "SONA-1"]));
        let told = BTreeMap::from([("survey_code".to_owned(), "a b&c=ü/1".to_owned())]);
        assert_eq!(filled(address, &told), "https://x.org/back?id=5&code=a%20b%26c%3D%C3%BC%2F1&from=");
        assert_eq!(
            (places("https://x.org/"), filled("https://x.org/", &told)),
            (Ok(Vec::new()), "https://x.org/".to_owned())
        );
        for wrong in [
            "https://{host}/?a={b}",
            "https://x.org/?a={b",
            "https://x.org/?a=b}",
            "https://x.org/?a={}",
            "https://x.org/?a={b c}",
        ] {
            assert!(places(wrong).is_err(), "{wrong}");
        }
    }
}
