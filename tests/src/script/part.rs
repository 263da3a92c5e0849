//! Whether what a page shows of a file stands in that file.

/// Checks that a file has all lines of a part, in their order. Comments and empty lines do not count.
pub fn check(part: &str, whole: &str) -> Result<(), String> {
    let mut rest = lines(whole);
    for line in lines(part) {
        if !rest.any(|own| own == line) {
            return Err(format!("the file has no line `{line}` behind those before it"));
        }
    }
    Ok(())
}

fn lines(text: &str) -> impl Iterator<Item = &str> {
    let lines = text.lines().map(|line| line.split(" #").next().unwrap_or_default().trim());
    lines.filter(|line| !line.is_empty() && !line.starts_with('#'))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn a_part_has_lines_of_its_file_in_their_order() {
        let whole = "# A file\n[a]\nb = 1\n\nc = \"#fff\"  # a colour\n[d]\nb = 1\n";
        for part in ["[a]\nb = 1\nc = \"#fff\"", "b = 1   # one\n\n[d]", "[a]\n[d]\nb = 1\n"] {
            assert_eq!(check(part, whole), Ok(()), "{part}");
        }
        for part in ["[d]\n[a]", "b = 2", "c = \"#fff\"\nc = \"#fff\""] {
            assert!(check(part, whole).unwrap_err().contains("has no line"), "{part}");
        }
    }
}
