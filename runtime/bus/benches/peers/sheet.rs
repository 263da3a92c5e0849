//! The figures as people read them.

use crate::case::Case;
use crate::contender::Contender;
use crate::measure::Figures;

/// A case and what each contender made of it.
pub struct Row {
    /// The case.
    pub case: Case,
    /// By contender; nothing where it failed.
    pub figures: Vec<Option<Figures>>,
}

/// A size as people say it.
pub fn size(bytes: usize) -> String {
    match bytes {
        0..1_000 => format!("{bytes} B"),
        1_000..1_000_000 => format!("{:.0} KB", bytes as f64 / 1e3),
        _ => format!("{:.1} MB", bytes as f64 / 1e6),
    }
}

impl Row {
    /// Prints it.
    pub fn print(&self, contenders: &[Contender]) {
        let Case { bytes, subscribers, touched, .. } = self.case;
        let many = if subscribers == 1 { "subscriber" } else { "subscribers" };
        let touch = if touched { "written and read whole" } else { "not touched" };
        println!("\n{}, {subscribers} {many}, {touch}", size(bytes));
        println!(
            "{:38} {:>9} {:>9} {:>9} {:>9} {:>10} {:>9} {:>6}",
            "", "p50 µs", "p99 µs", "max µs", "CPU µs", "messages/s", "MB/s", "ratio"
        );
        let best = self.best_copying(contenders);
        for (contender, figures) in contenders.iter().zip(&self.figures) {
            let Some(figures) = figures else {
                println!("{:38} failed", contender.title);
                continue;
            };
            let Figures { p50_us, p99_us, most_us, cpu_us, messages_s, lost, left_out } = figures;
            // Where nothing is copied and nobody reads, no bytes move.
            let moved = touched || contender.copies;
            let mb_s = if moved { format!("{:.0}", messages_s * bytes as f64 / 1e6) } else { "-".to_owned() };
            let ratio = best / p50_us;
            let mut notes = String::new();
            if *lost > 0 {
                notes += &format!("  {lost} lost");
            }
            if *left_out > 0 {
                notes += &format!("  {left_out} beats left out");
            }
            println!(
                "{:38} {p50_us:9.0} {p99_us:9.0} {most_us:9.0} {cpu_us:9.0} {messages_s:10.0} {mb_s:>9} {ratio:6.1}\
                 {notes}",
                contender.title
            );
        }
    }

    /// The lowest p50 of those that copy, µs.
    fn best_copying(&self, contenders: &[Contender]) -> f64 {
        let copying = contenders.iter().zip(&self.figures).filter(|(contender, _)| contender.copies);
        copying.filter_map(|(_, figures)| figures.map(|figures| figures.p50_us)).fold(f64::NAN, f64::min)
    }
}

/// What it all comes to: beside the best that copies, and from size to size.
pub fn print_summary(rows: &[Row], contenders: &[Contender]) {
    println!("\nthe first contender's p50 beside the lowest of those that copy, not touched:");
    let own = |row: &Row| row.figures.first().copied().flatten();
    let plain = || rows.iter().filter(|row| !row.case.touched);
    for row in plain() {
        let Some(figures) = own(row) else { continue };
        println!(
            "  {:>7}, {:2} subscribers: {:5.1} times lower",
            size(row.case.bytes),
            row.case.subscribers,
            row.best_copying(contenders) / figures.p50_us
        );
    }
    let mut counts: Vec<_> = plain().map(|row| row.case.subscribers).collect();
    counts.dedup();
    counts.sort_unstable();
    counts.dedup();
    for subscribers in counts {
        let large = plain().filter(|row| row.case.subscribers == subscribers && row.case.bytes > 1_000);
        let p50s: Vec<_> = large.filter_map(|row| Some((row.case.bytes, own(row)?.p50_us))).collect();
        if let [(small, first), .., (large, last)] = p50s[..] {
            println!(
                "  {subscribers} subscribers: {first:.0} µs at {}, {last:.0} µs at {} ({:.2} times)",
                size(small),
                size(large),
                last / first
            );
        }
    }
}
