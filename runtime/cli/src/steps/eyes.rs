//! What bodies saw before their steps, as pictures.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

use anyhow::Context as _;
use cohabit_bus::{
    CameraId, Local, Subscriber, Topic, Transport as _,
    message::{FrameView, Plane},
};
use cohabit_cdf::ObjectId;
use cohabit_engine::{CameraPlan, Mount, Replayer, Stills, object_instance_id};
use cohabit_eval::steps::{Mask, Step};
use cohabit_render::{Lens, MeshLibrary, Renderer};

use crate::{
    failure::bad_input,
    png_file::write_png,
    replay::picture::{Modality, Picture},
};

/// The size of pictures, as people write it.
pub fn read_size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    sides.ok_or_else(|| "pixels across and down, such as 300x300".to_owned())
}

/// The eyes of bodies, whose pictures go into a folder.
pub struct Eyes {
    stills: Stills,
    /// By body.
    cameras: BTreeMap<u32, (CameraId, Box<dyn Subscriber>)>,
    folder: PathBuf,
}

impl Eyes {
    /// Those of these bodies of a session.
    pub fn open(
        folder: &Path,
        size: Option<[u32; 2]>,
        bodies: &BTreeSet<u32>,
        replayer: &Replayer<'_>,
        renderer: Box<dyn Renderer>,
    ) -> anyhow::Result<Self> {
        fs::create_dir_all(folder).map_err(|error| bad_input(format!("{}: {error}", folder.display())))?;
        let (bus, mut cameras, mut plans) = (Local::new(1), BTreeMap::new(), Vec::new());
        for body in bodies.iter().filter_map(|body| u8::try_from(*body).ok()) {
            let id = CameraId::Egocentric(body);
            let mut plan = CameraPlan::usual(id, Mount::Head { body });
            plan.planes = vec![Plane::Color, Plane::Ids];
            if let Some([width, height]) = size {
                plan.lens = Lens::new(width, height, plan.lens.fov_y_deg()).map_err(bad_input)?;
            }
            plans.push(plan);
            cameras.insert(u32::from(body), (id, bus.subscriber(Topic::Frames(id))?));
        }
        let meshes = MeshLibrary::build(&replayer.plan().catalog).context("build the models")?;
        let stills = Stills::new(replayer.plan(), meshes.into(), renderer, &plans, &bus)?;
        Ok(Self { stills, cameras, folder: folder.to_owned() })
    }

    /// Draws what is seen before a step, and notes where that is.
    pub fn look(&mut self, replayer: &Replayer<'_>, step: &mut Step) -> anyhow::Result<()> {
        let Some((camera, frames)) = self.cameras.get_mut(&step.body) else { return Ok(()) };
        self.stills.shoot(replayer.visible(), *camera, None)?;
        let Some(sample) = frames.latest()? else { return Ok(()) };
        let frame = FrameView::new(sample.payload())?;
        let path = |name: &str| self.folder.join(format!("{:04}-{name}.png", step.step));
        let (color, mask) = (path("color"), path("mask"));
        if let Some(picture) = Picture::of(&frame, Modality::Color) {
            picture.write(&color).with_context(|| color.display().to_string())?;
            step.frames.insert("color", color.display().to_string());
        }
        let Some(target) = step.did.as_mut().and_then(|did| did.target.as_mut()) else { return Ok(()) };
        let id = object_instance_id(ObjectId(target.object));
        target.mask = Some(mask_of(&frame, id));
        write_mask(&mask, &frame, id).with_context(|| mask.display().to_string())?;
        step.frames.insert("mask", mask.display().to_string());
        Ok(())
    }
}

/// Where a frame shows a thing.
fn mask_of(frame: &FrameView<'_>, id: u32) -> Mask {
    let seen = frame.seen().iter().find(|seen| seen.id == id);
    seen.map_or_else(Mask::default, |seen| Mask {
        pixels: seen.pixels,
        r#box: [seen.left, seen.top, seen.right, seen.bottom],
    })
}

/// Writes in white what of a frame shows a thing.
fn write_mask(path: &Path, frame: &FrameView<'_>, id: u32) -> anyhow::Result<()> {
    let shows = |seen: &u32| if *seen == id { u8::MAX } else { 0 };
    let bytes: Vec<u8> = frame.ids().unwrap_or_default().iter().map(shows).collect();
    let size = [frame.header.width, frame.header.height * frame.header.views];
    write_png(path, &bytes, size, png::ColorType::Grayscale, png::BitDepth::Eight)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_as_people_write_them() {
        assert_eq!(read_size("64x48"), Ok([64, 48]));
        assert!(["", "64", "64x", "64x48x2", "-1x2"].into_iter().all(|text| read_size(text).is_err()));
    }
}
