//! What was measured, by name.

use std::collections::BTreeMap;

/// Times, ms, by what they are of.
#[derive(Default)]
pub struct Measures {
    names: Vec<String>,
    times_ms: BTreeMap<String, Vec<f64>>,
}

impl Measures {
    /// Notes how long after `from` something was, ns; what never was counts as for ever.
    pub fn note(&mut self, name: &str, from: u64, to: Option<u64>) {
        let time_ms = to.map_or(f64::INFINITY, |to| (to as f64 - from as f64) * 1e-6);
        if !self.times_ms.contains_key(name) {
            self.names.push(name.to_owned());
        }
        self.times_ms.entry(name.to_owned()).or_default().push(time_ms);
    }

    /// Prints a table.
    pub fn print(&mut self) {
        println!("| ms | n | p50 | p95 | max | above 300 |\n|---|---|---|---|---|---|");
        for name in &self.names {
            let Some(times) = self.times_ms.get_mut(name) else { continue };
            times.sort_by(f64::total_cmp);
            let at = |share: f64| times[((times.len() - 1) as f64 * share).round() as usize];
            let above = times.iter().filter(|time| **time > 300.0).count();
            println!("| {name} | {} | {:.0} | {:.0} | {:.0} | {above} |", times.len(), at(0.5), at(0.95), at(1.0));
        }
    }
}
