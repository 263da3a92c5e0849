//! What changed: compared, written as pictures, and said.

use std::fmt;
use std::path::{Path, PathBuf};

use crate::hashes::{Hashes, MODALITIES};
use crate::picture::{Distance, Image};
use crate::{Drawn, pictures, sheet};

/// Lines of a message.
const MOST_LINES: usize = 60;

/// What changed in all floor plans.
#[derive(Default)]
pub struct Changes {
    views: Vec<Change>,
    /// Small pictures of floor plans: before, after, difference.
    sheets: Vec<PathBuf>,
    gone: Vec<String>,
    count: usize,
}

/// What changed in a view.
struct Change {
    name: String,
    /// Nothing, if the view is new.
    modalities: Vec<&'static str>,
    /// To what was before, where that is at hand, and before, after and difference side by side.
    distance: Option<(Distance, PathBuf)>,
    /// As it is now.
    now: PathBuf,
}

/// Where a picture with these hashes lies, once it has been drawn here.
fn path(name: &str, hashes: [u64; 4]) -> PathBuf {
    let all = hashes.iter().fold(0, |all: u64, hash| all.rotate_left(17) ^ hash);
    pictures().join(format!("{}-{all:016x}.png", name.replace('/', "-")))
}

/// Compares the views of one floor plan with what is known; keeps those that are as known, or blessed, for later.
pub fn compare(layout: &str, known: &Hashes, drawn: &[Drawn], bless: bool) -> Changes {
    let mut changes = Changes { count: drawn.len(), ..Changes::default() };
    for view in drawn {
        let now = view.picture.hashes();
        let kept = path(&view.name, now);
        let before = known.get(&view.name);
        if (before == Some(now) || bless) && !kept.exists() {
            view.picture.all().write(&kept, png::Compression::Fastest);
        }
        if before != Some(now) {
            changes.views.push(change(view, before, now));
        }
    }
    if !changes.views.is_empty() && sheet::is_kept(layout) {
        changes.sheets.extend(sheet::compare(layout, drawn));
        if bless {
            sheet::bless(layout, drawn);
        }
    }
    changes
}

fn change(view: &Drawn, before: Option<[u64; 4]>, now: [u64; 4]) -> Change {
    let modalities = before.map_or(Vec::new(), |before| {
        (0..4).filter(|index| before[*index] != now[*index]).map(|index| MODALITIES[index]).collect()
    });
    let picture = view.picture.all();
    let out = pictures().join("changed").join(format!("{}.png", view.name.replace('/', "-")));
    let earlier = before.and_then(|before| Image::read(&path(&view.name, before)));
    let distance = earlier.filter(|earlier| earlier.size == picture.size).map(|earlier| {
        let three = [&earlier, &picture, &picture.difference(&earlier)];
        Image::beside(&three).write(&out, png::Compression::Fastest);
        (picture.distance(&earlier), out.clone())
    });
    if distance.is_none() {
        picture.write(&out, png::Compression::Fastest);
    }
    Change { name: view.name.clone(), modalities, distance, now: out }
}

impl Changes {
    pub fn is_empty(&self) -> bool {
        self.views.is_empty() && self.gone.is_empty()
    }

    pub fn add(&mut self, other: Self) {
        self.views.extend(other.views);
        self.sheets.extend(other.sheets);
        self.count += other.count;
    }

    /// Notes the views that are known but not drawn any more.
    pub fn gone(&mut self, known: &Hashes, seen: &Hashes) {
        let gone = known.names().filter(|name| seen.get(name).is_none());
        self.gone = gone.map(str::to_owned).collect();
    }

    fn lines(&self) -> Vec<String> {
        let mut views: Vec<&Change> = self.views.iter().collect();
        let mean = |change: &Change| change.distance.as_ref().map_or(f64::INFINITY, |(distance, _)| distance.mean);
        views.sort_by(|a, b| mean(b).total_cmp(&mean(a)).then(a.name.cmp(&b.name)));
        let mut lines: Vec<String> = views.iter().map(|change| change.line()).collect();
        if lines.len() > MOST_LINES {
            lines.push(format!("... and {} more", lines.len() - MOST_LINES));
            lines.swap_remove(MOST_LINES);
            lines.truncate(MOST_LINES + 1);
        }
        lines
    }
}

impl Change {
    fn line(&self) -> String {
        let what = if self.modalities.is_empty() { "new".to_owned() } else { self.modalities.join(", ") };
        let path = |path: &Path| path.display().to_string();
        match &self.distance {
            Some((distance, three)) => format!(
                "{}: {what}; {:.2} % of pixels, {:.3} of 255 on average, {} at most\n    before, after, difference: {}",
                self.name,
                distance.share,
                distance.mean,
                distance.most,
                path(three)
            ),
            None => format!("{}: {what}\n    now: {} (no picture of before at hand)", self.name, path(&self.now)),
        }
    }
}

impl fmt::Display for Changes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} of {} views changed", self.views.len(), self.count)?;
        for line in self.lines() {
            writeln!(f, "{line}")?;
        }
        for sheet in &self.sheets {
            writeln!(f, "small, before, after, difference: {}", sheet.display())?;
        }
        for name in &self.gone {
            writeln!(f, "{name}: is not drawn any more")?;
        }
        Ok(())
    }
}
