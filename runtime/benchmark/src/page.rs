//! Tables as a page: one file without scripts, which needs nothing from anywhere.

use std::fmt::Write as _;

use crate::table::Grid;

const HEAD: &str = r#"<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<title>Cohabit benchmark</title>
<style>
body { font: 16px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 75rem; padding: 0 1rem; color: #1d1d1f; background: #fff; }
.grid { overflow-x: auto; }
table { border-collapse: collapse; margin: .5rem 0; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: .3rem .8rem .3rem 0; border-bottom: 1px solid #ddd; vertical-align: top; }
th { font-weight: 600; }
p { max-width: 60rem; color: #555; }
@media (prefers-color-scheme: dark) { body { color: #eee; background: #1b1b1d; } th, td { border-color: #444; } p { color: #aaa; } }
</style>
</head>
<body>
<main>
<h1>Cohabit benchmark</h1>
"#;

/// The page of these tables (HTML).
#[must_use]
pub fn page(grids: &[Grid]) -> String {
    let mut page = HEAD.to_owned();
    for grid in grids {
        let _ = writeln!(page, "<h2>{}</h2>\n<div class=\"grid\" tabindex=\"0\"><table>", escaped(&grid.title));
        let _ = writeln!(page, "<thead>{}</thead>\n<tbody>", row("<th scope=\"col\">", "</th>", &grid.head));
        for cells in &grid.rows {
            let _ = writeln!(page, "{}", row("<td>", "</td>", cells));
        }
        page.push_str("</tbody></table></div>\n");
        if !grid.note.is_empty() {
            let _ = writeln!(page, "<p>{}</p>", escaped(&grid.note));
        }
    }
    page.push_str("</main>\n</body>\n</html>\n");
    page
}

fn row(before: &str, behind: &str, cells: &[String]) -> String {
    let cells: String = cells.iter().map(|cell| format!("{before}{}{behind}", escaped(cell))).collect();
    format!("<tr>{cells}</tr>")
}

/// Text as HTML shows it.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            other => escaped.push(other),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_in_a_table_becomes_markup() {
        let cell = "<script>alert(\"x\") & more</script>".to_owned();
        let grid = Grid { title: cell.clone(), head: vec![cell.clone()], rows: vec![vec![cell.clone()]], note: cell };
        let page = page(&[grid]);
        assert!(!page.contains("<script"), "{page}");
        assert_eq!(page.matches("&lt;script&gt;alert(&quot;x&quot;) &amp; more").count(), 4, "{page}");
        assert!(page.starts_with("<!doctype html>") && page.ends_with("</html>\n"));
        assert!(
            page.contains("<body>\n<main>\n") && page.contains("</main>\n</body>"),
            "all of it is the main part: {page}"
        );
    }
}
