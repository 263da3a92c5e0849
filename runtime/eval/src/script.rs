//! Scripts as people write them: one line of text each.

use serde_json::Value;

use crate::task::Line;

/// Reads a script: a line that begins with `{` is a command in JSON, one that begins with `#` a remark, all others are
/// said to the robot. Lines before one of `---` prepare the mission.
///
/// # Errors
/// The number of the line (from 1) and what is wrong with it.
pub fn read(text: &str) -> Result<(Vec<Line>, Vec<Line>), (usize, String)> {
    let (mut preparation, mut script) = (Vec::new(), Vec::new());
    for (index, line) in text.lines().map(str::trim).enumerate() {
        if line == "---" {
            preparation.append(&mut script);
        } else if line.starts_with('{') {
            let action: Value = serde_json::from_str(line).map_err(|error| (index + 1, error.to_string()))?;
            script.push(Line::Action(action));
        } else if !line.is_empty() && !line.starts_with('#') {
            script.push(Line::utterance(line));
        }
    }
    Ok((preparation, script))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_script_has_words_commands_and_remarks() {
        let text = "# first\nopen the fridge\n---\n\n {\"type\": \"Look\"} \nthank you\n";
        let (preparation, script) = read(text).unwrap();
        assert_eq!(preparation, [Line::utterance("open the fridge")]);
        let action = Line::Action(serde_json::json!({ "type": "Look" }));
        assert_eq!(script, [action, Line::utterance("thank you")]);
        assert_eq!(read("hello\n{oops").unwrap_err().0, 2);
    }
}
