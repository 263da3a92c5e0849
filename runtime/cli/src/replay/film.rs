//! Pictures of a session that is replayed: any camera, any modality, any size.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::Arc,
};

use anyhow::Context as _;
use cohabit_bus::{
    Local, Subscriber, Topic, Transport as _,
    message::{FrameView, Plane, Thing},
};
use cohabit_engine::{CameraPlan, Replayer, Stills, replay::TICK_S};
use cohabit_render::{Lens, MeshLibrary, room_surface_of_id};

use super::{
    picture::{self, Modality, Picture},
    y4m::Video,
};
use crate::{failure::bad_input, rendering::Rendering};

/// Where pictures go.
#[derive(clap::Args)]
#[group(id = "pictures", multiple = true)]
struct Places {
    /// Render the session anew, a PNG file a picture, into this folder
    #[arg(long, value_name = "FOLDER")]
    frames: Option<PathBuf>,
    /// Render the session anew into this video file (YUV4MPEG2, which ffmpeg and most players read)
    #[arg(long, value_name = "FILE.y4m")]
    video: Option<PathBuf>,
}

/// What is filmed, and where it goes.
#[derive(clap::Args)]
pub struct FilmOptions {
    #[command(flatten)]
    places: Places,
    /// The camera of `--frames` and `--video`: one that the session had, such as eyes/0, or a new one, as of `play`
    #[arg(long, default_value = "spectator/0", value_name = "NAME|NAME=KIND[,OPTION=VALUE]", requires = "pictures")]
    camera: String,
    /// The size of its pictures, if not its own: pixels across and down
    #[arg(long, value_name = "WxH", value_parser = read_size, requires = "pictures")]
    size: Option<[u32; 2]>,
    /// What of it is shown; of a video the first
    #[arg(long = "modality", value_enum, value_delimiter = ',', default_value = "color", requires = "pictures")]
    modalities: Vec<Modality>,
    /// Pictures a second of the session
    #[arg(long, default_value_t = 10.0, value_parser = read_rate)]
    rate: f32,
}

fn read_size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    sides.ok_or_else(|| "pixels across and down, such as 1280x720".to_owned())
}

fn read_rate(text: &str) -> Result<f32, String> {
    let rate = text.parse().ok().filter(|rate| (0.01..=60.0).contains(rate));
    rate.ok_or_else(|| "pictures a second, 0.01 to 60".to_owned())
}

/// A film that is being made.
pub struct Film {
    stills: Stills,
    camera: CameraPlan,
    frames: Box<dyn Subscriber>,
    modalities: Vec<Modality>,
    folder: Option<PathBuf>,
    video: Option<(PathBuf, Video)>,
    /// Ticks between two pictures; may have a fraction.
    every: f64,
    next_tick: f64,
    taken: usize,
    /// What was seen in pictures of ids.
    names: BTreeMap<u32, String>,
}

impl FilmOptions {
    /// Pictures a second.
    pub const fn rate(&self) -> f32 {
        self.rate
    }

    /// The video file that is written, if one is.
    pub fn video(&self) -> Option<&Path> {
        self.places.video.as_deref()
    }

    /// The film of what `replayer` goes through, if one is wanted.
    pub fn begin(&self, replayer: &Replayer<'_>, rendering: Rendering) -> anyhow::Result<Option<Film>> {
        let Places { frames: folder, video } = &self.places;
        if folder.is_none() && video.is_none() {
            return Ok(None);
        }
        let camera = self.camera(replayer)?;
        if let Some(folder) = folder {
            std::fs::create_dir_all(folder).map_err(|error| bad_input(format!("{}: {error}", folder.display())))?;
        }
        let video = match video {
            Some(path) => {
                let created = Video::create(path, self.rate);
                Some((path.clone(), created.map_err(|error| bad_input(format!("{}: {error}", path.display())))?))
            }
            None => None,
        };
        let bus = Local::new(1);
        let frames = bus.subscriber(Topic::Frames(camera.id))?;
        let meshes = Arc::new(MeshLibrary::build(&replayer.plan().catalog).context("build the models")?);
        let renderer = rendering.start()?;
        let stills = Stills::new(replayer.plan(), meshes, renderer, std::slice::from_ref(&camera), &bus)?;
        let next_tick = replayer.world().tick() as f64;
        Ok(Some(Film {
            stills,
            camera,
            frames,
            modalities: self.modalities.clone(),
            folder: folder.clone(),
            video,
            every: 1.0 / (f64::from(self.rate) * TICK_S),
            next_tick,
            taken: 0,
            names: BTreeMap::new(),
        }))
    }

    /// The camera, delivering what is wanted of it.
    fn camera(&self, replayer: &Replayer<'_>) -> anyhow::Result<CameraPlan> {
        let bodies = replayer.world().bodies().len();
        let known = replayer.plan().all_cameras(bodies);
        let mut camera = match known.iter().find(|plan| plan.id.to_string() == self.camera) {
            Some(plan) => plan.clone(),
            None if self.camera.contains('=') => self.camera.parse().map_err(bad_input)?,
            None => {
                let names: Vec<_> = known.iter().map(|plan| plan.id.to_string()).collect();
                return Err(bad_input(format!(
                    "the session had no camera `{}`: it had {}; or describe one, such as top=top-down",
                    self.camera,
                    names.join(", ")
                )));
            }
        };
        if let Some(body) = camera.body().filter(|body| usize::from(*body) >= bodies) {
            return Err(bad_input(format!("`--camera`: the session had bodies 0 to {}, not {body}", bodies - 1)));
        }
        if let Some([width, height]) = self.size {
            camera.lens = Lens::new(width, height, camera.lens.fov_y_deg()).map_err(bad_input)?;
        }
        let wanted = |plane: &Plane| self.modalities.iter().any(|modality| modality.plane() == *plane);
        camera.planes = Plane::ALL.into_iter().filter(wanted).collect();
        Ok(camera)
    }
}

impl Film {
    /// Takes a picture, if one is due at the tick that `replayer` is at.
    pub fn see(&mut self, replayer: &Replayer<'_>) -> anyhow::Result<()> {
        let tick = replayer.world().tick();
        if (tick as f64) < self.next_tick {
            return Ok(());
        }
        while self.next_tick <= tick as f64 {
            self.next_tick += self.every;
        }
        self.stills.follow(replayer.visible(), self.camera.id, self.every * TICK_S)?;
        let Some(sample) = self.frames.latest()? else { return Ok(()) };
        let frame = FrameView::new(sample.payload())?;
        self.taken += 1;
        if let Some((path, video)) = &mut self.video
            && let Some(picture) = self.modalities.first().and_then(|modality| Picture::of(&frame, *modality))
        {
            video.push(&picture).with_context(|| path.display().to_string())?;
        }
        let Some(folder) = self.folder.clone() else { return Ok(()) };
        for modality in self.modalities.clone() {
            let path = folder.join(format!("{tick:07}-{}.png", modality.plane().name()));
            self.write(&path, &frame, modality, replayer).with_context(|| path.display().to_string())?;
        }
        Ok(())
    }

    fn write(
        &mut self,
        path: &Path,
        frame: &FrameView<'_>,
        modality: Modality,
        replayer: &Replayer<'_>,
    ) -> anyhow::Result<()> {
        if modality == Modality::Depth {
            return picture::write_depth(path, frame);
        }
        for id in frame.ids().filter(|_| modality == Modality::Ids).unwrap_or_default() {
            self.names.entry(*id).or_insert_with(|| name(*id, replayer));
        }
        Picture::of(frame, modality).map_or(Ok(()), |picture| picture.write(path))
    }

    /// Ends the film; says what was made.
    pub fn finish(self) -> anyhow::Result<String> {
        let mut places = Vec::new();
        if let Some((path, video)) = self.video {
            video.finish().with_context(|| path.display().to_string())?;
            places.push(path.display().to_string());
        }
        if let Some(folder) = self.folder {
            if !self.names.is_empty() {
                let path = folder.join("ids.csv");
                picture::write_ids(&path, &self.names).with_context(|| path.display().to_string())?;
            }
            places.push(folder.display().to_string());
        }
        Ok(format!("{} pictures of {} in {}", self.taken, self.camera.id, places.join(" and ")))
    }
}

/// What a thing in a picture of ids is called.
fn name(id: u32, replayer: &Replayer<'_>) -> String {
    match Thing::of_id(id) {
        Thing::Object(id) => replayer.world().object(id).map_or_else(String::new, |object| object.instance.to_owned()),
        Thing::Body(id) => format!("body {}", id.0),
        Thing::Surface(room) => {
            let catalog = replayer.world().catalog();
            let surface = room_surface_of_id(id).map_or("surface", |(_, surface)| surface.class().name(catalog));
            catalog.room_at(room).map_or_else(String::new, |room| format!("{surface} of {}", room.name_in(catalog)))
        }
        Thing::Nothing => "nothing".to_owned(),
    }
}
