//! Tables as they ship and as labs write them, and the pages that use them.

use super::*;

const ENGLISH_TABLE: &str = include_str!("../../../web/texts/en.toml");
const GERMAN_TABLE: &str = include_str!("../../../web/texts/de.toml");

/// The pages and scripts of a part, as they stand in the sources.
fn sources(part: PagePart) -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let (folder, staff, more): (_, &[&str], &[&str]) = match part {
        PagePart::Session => ("dialog/web", &["wizard.html"], &[]),
        // Its server tells participants some things itself, such as what they are to try in a tutorial.
        PagePart::Study => (
            "runtime/study/web",
            &["wizard.html", "experimenter.html"],
            &[
                "runtime/study/src/registry.rs",
                "runtime/study/src/tutorial.rs",
                "runtime/study/src/web.rs",
                "runtime/study/src/web/refusals.rs",
            ],
        ),
    };
    let files = fs::read_dir(root.join(folder)).unwrap().map(|entry| entry.unwrap().path());
    files
        .chain(more.iter().map(|file| root.join(file)))
        .map(|path| (path.file_name().unwrap().to_string_lossy().into_owned(), path))
        .filter(|(name, _)| !staff.contains(&name.as_str()))
        .filter(|(name, _)| [".html", ".js", ".rs"].iter().any(|end| name.ends_with(end)))
        .map(|(name, path)| (name, fs::read_to_string(path).unwrap()))
        .collect()
}

/// The keys that a page or a script takes texts by.
fn keys(name: &str, source: &str) -> BTreeSet<String> {
    let between = |begin: &str, end: char| -> Vec<String> {
        // `getContext("2d")` takes none.
        let is_call = |at: usize| !source[..at].ends_with(char::is_alphanumeric);
        let calls = source.match_indices(begin).filter(|(at, _)| begin == "{" || is_call(*at));
        let keys = calls.filter_map(|(at, _)| source[at + begin.len()..].split_once(end));
        keys.map(|(key, _)| key.to_owned()).collect()
    };
    // Where something else is called `text`, scripts import it as `words`.
    let found = if name.ends_with(".html") {
        between("{", '}')
    } else {
        [between("text(\"", '"'), between("words(\"", '"')].concat()
    };
    found.into_iter().filter(|key| ![LANGUAGE, TABLE].contains(&key.as_str())).collect()
}

#[test]
fn each_language_has_each_text_that_the_pages_use_and_no_other() {
    for part in PagePart::ALL {
        let sources = sources(part);
        assert!(!sources.is_empty());
        let used: BTreeSet<String> = sources.iter().flat_map(|(name, source)| keys(name, source)).collect();
        for language in languages() {
            let texts = PageTexts::of(language).unwrap();
            assert_eq!(texts.language(), language);
            let has: BTreeSet<String> = texts.part(part).keys().cloned().collect();
            assert_eq!(used.difference(&has).collect::<Vec<_>>(), [] as [&String; 0], "{language} lacks them");
            assert_eq!(has.difference(&used).collect::<Vec<_>>(), [] as [&String; 0], "nobody uses them ({language})");
            assert!(![LANGUAGE, TABLE].iter().any(|name| has.contains(*name)), "these stand for something else");
        }
    }
}

#[test]
fn pages_say_in_each_other_language_that_the_robot_speaks_english() {
    let html = "<html lang=\"{language}\"><p>{robot_language}</p>";
    for (language, shown) in [("en", "<p></p>"), ("de", "Englisch"), ("es", "inglés")] {
        for part in PagePart::ALL {
            let page = PageTexts::of(language).unwrap().page(part, html);
            assert!(page.contains(shown) && page.contains(&format!("lang=\"{language}\"")), "{page}");
        }
    }
}

#[test]
fn texts_of_a_session_are_true_in_a_home_too() {
    for language in languages() {
        let texts = PageTexts::of(language).unwrap();
        for (key, text) in texts.part(PagePart::Session) {
            let words = ["office", "büro", "oficina"];
            assert!(!words.iter().any(|word| text.to_lowercase().contains(word)), "{language}, {key}: {text}");
        }
    }
}

#[test]
fn texts_stand_in_pages_as_texts() {
    let marked = ENGLISH_TABLE.replacen("\"Goals\"", "'<b title=\"x\">&</b></script>'", 1);
    let texts = PageTexts::parse("own.toml", &marked).unwrap();
    let page = texts.page(PagePart::Session, "<p title=\"{goals}\">{of_no_text} {goals}</p>{");
    let shown = "&lt;b title=&quot;x&quot;&gt;&amp;&lt;/b&gt;&lt;/script&gt;";
    assert_eq!(page, format!("<p title=\"{shown}\">{{of_no_text}} {shown}</p>{{"));
    let table = texts.page(PagePart::Session, "{texts}");
    assert!(!table.contains('<'), "{table}");
    let table: serde_json::Value = serde_json::from_str(&table).unwrap();
    assert_eq!(table["goals"], "<b title=\"x\">&</b></script>");
    assert_eq!(table["goals_met"], "{met} of {all} goals");
}

#[test]
fn what_is_wrong_in_a_table_is_told_with_its_place_and_a_remedy() {
    let line = |text: &str| GERMAN_TABLE.lines().position(|line| line.starts_with(text)).unwrap() + 1;
    let whole = |text: &str| GERMAN_TABLE.lines().find(|line| line.starts_with(text)).unwrap();
    for (from, to, place, problem, remedy) in [
        (whole("goals = "), "", None, "`[session]` has no `goals`", "translation of \"Goals\""),
        (whole("goals = "), "goals = \" \"", Some("goals = "), "`goals` of `[session]` is empty", "\"Goals\""),
        (whole("points = "), "points = \"{point} Punkte\"", Some("points = "), "other values", "\"score {points}\""),
        ("language = \"de\"", "language = \"Deutsch!\"", Some("language"), "no tag of a language", "\"fr\""),
        (whole("robot_language = "), "robot_language = \"\"", Some("robot_language"), "is empty", "English alone"),
        ("[study]", "[studies]", None, "studies", "into `[session]` and `[study]`"),
    ] {
        let written = GERMAN_TABLE.replacen(from, to, 1);
        let Err(PageTextsError::Problems { problems, .. }) = PageTexts::parse("x.toml", &written) else {
            panic!("`{to}` was taken");
        };
        let found = &problems[0];
        assert!(found.problem.contains(problem) && found.remedy.contains(remedy), "{found}");
        assert!(place.is_none_or(|text| found.line == Some(line(text))), "{found}");
    }
    let unknown = GERMAN_TABLE.replacen("goals = ", "gaols = ", 1);
    let told = PageTexts::parse("own/x.toml", &unknown).unwrap_err().to_string();
    let unknown = format!("own/x.toml:{}: `gaols` is no key of `[session]`; leave it out", line("goals = "));
    assert!(told.contains(&unknown), "{told}");
    assert!(told.contains("own/x.toml: `[session]` has no `goals`; add it with a translation of \"Goals\""), "{told}");
    let told = PageTexts::of("tlh").unwrap_err().to_string();
    assert!(told.contains("`tlh`: choose en, de, es"), "{told}");
}

#[test]
fn tags_have_a_form() {
    for tag in ["en", "pt-BR", "zh-Hant-TW"] {
        assert!(is_tag(tag), "{tag}");
    }
    for tag in ["", "e", "de_DE", "de-", "Deutsch!"] {
        assert!(!is_tag(tag), "{tag}");
    }
}
