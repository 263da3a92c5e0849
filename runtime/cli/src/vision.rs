//! `cohabit vision`: annotated views of the floor plans.

use std::{path::PathBuf, time::Instant};

use cohabit_vision::{Filters, Recipe, Summary, VisionError, make};
use indicatif::{ProgressBar, ProgressStyle};

use crate::{
    demonstrate::Size,
    failure::{bad_input, environment},
    terminal::shown,
    world::WorldPacks,
};

/// Images of Alexa Arena's vision data set.
const ARENA_IMAGES: f64 = 660_000.0;

/// Draws views of the floor plans with things, states, lights and cameras at random, and writes a data set: colour, depth, normals
/// and instance ids as PNG, the state of each scene, and annotations in COCO's format. A call that was interrupted goes on when it
/// is made again; a call for more images goes on, too.
#[derive(clap::Args)]
pub struct Vision {
    /// How many images the data set is to have
    #[arg(long, value_name = "N")]
    images: usize,
    /// The folder of the data set
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// The seed: image number i follows from it plus i
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Images that are drawn side by side; one for each core if not given. They do not change what is made
    #[arg(long, value_name = "N")]
    workers: Option<usize>,
    /// Pixels across and down
    #[arg(long, value_name = "WxH", default_value = "300x300")]
    size: Size,
    /// Floor plans to draw; all if not given
    #[arg(long = "plan", value_name = "NAME", num_args = 1..)]
    plans: Vec<String>,
    /// Things of fewer visible pixels are not annotated
    #[arg(long, value_name = "PIXELS", default_value_t = Filters::default().min_pixels)]
    min_pixels: u32,
    /// Images with fewer annotated things are drawn anew
    #[arg(long, value_name = "N", default_value_t = Filters::default().min_things)]
    min_things: usize,
    /// Images are drawn anew that look like an earlier one of the same room but for so many of 64 bits, from 0 to 16
    #[arg(long, value_name = "BITS", default_value_t = Filters::default().near_bits)]
    near_bits: u32,
    #[command(flatten)]
    packs: WorldPacks,
}

impl Vision {
    /// Makes the data set, or goes on with it.
    pub fn run(&self) -> anyhow::Result<()> {
        let Self { min_pixels, min_things, near_bits, .. } = *self;
        let filters = Filters { min_pixels, min_things, near_bits };
        let world = self.packs.read()?;
        let recipe = Recipe::new(self.seed, self.size.0, &self.plans, filters, world.catalog()).map_err(bad_input)?;
        let workers = self.workers.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
        let bar = ProgressBar::new(self.images as u64).with_style(
            ProgressStyle::with_template("{bar:30} {pos}/{len} images, {elapsed} ({eta} left)")
                .unwrap_or_else(|_| ProgressStyle::default_bar()),
        );
        let began = Instant::now();
        let made = make(self.images, &self.out, &recipe, workers, &|| bar.inc(1));
        bar.finish_and_clear();
        let summary = made.map_err(failed)?;
        self.print(&summary, began.elapsed().as_secs_f64());
        Ok(())
    }

    fn print(&self, summary: &Summary, seconds: f64) {
        let Summary { images, drawn, annotations, small_things, dropped, bytes } = *summary;
        println!("{images} images with {annotations} annotations: {}", shown(self.out.display()));
        println!(
            "left out: {small_things} things of fewer than {} pixels; drawn anew: {} images of few things, {} near-duplicates, {} \
             without a place",
            self.min_pixels, dropped.few_things, dropped.near_duplicates, dropped.unplaceable
        );
        let bytes_each = bytes as f64 / images as f64;
        let (kilobytes, gigabytes) = (bytes_each / 1e3, bytes_each * ARENA_IMAGES / 1e9);
        let disk = format!("{kilobytes:.0} kB an image; {ARENA_IMAGES} images would take {gigabytes:.0} GB");
        if drawn == 0 {
            println!("all of them were there before; {disk}");
            return;
        }
        let seconds_each = seconds / drawn as f64;
        println!(
            "{drawn} drawn in {seconds:.1} s, {:.1} ms and {disk} and {:.1} hours on this machine",
            seconds_each * 1e3,
            seconds_each * ARENA_IMAGES / 3600.0
        );
    }
}

fn failed(error: VisionError) -> anyhow::Error {
    if error.is_bad_input() { bad_input(error) } else { environment(error) }
}
