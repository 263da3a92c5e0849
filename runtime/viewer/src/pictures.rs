//! What cameras saw: colour as JPEG, ids as classes with names, depth in metres, normals.

use std::collections::BTreeMap;

use anyhow::Context as _;
use cohabit_bus::{
    CameraId,
    message::{FrameHeader, FrameView, Plane, StateView, Thing},
};
use cohabit_cdf::{BodyId, Catalog, ClassId, ObjectId, RoomEntry, SemanticClass};
use cohabit_engine::{body_instance_id, object_instance_id};
use cohabit_render::{RoomSurface, instance_color, room_surface_id, room_surface_of_id};
use jpeg_encoder::{ColorType, Encoder};
use re_sdk_types::{
    archetypes::{AnnotationContext, EncodedDepthImage, EncodedImage, Pinhole, SegmentationImage, Transform3D},
    components::{Colormap, ImageFormat, ImagePlaneDistance},
    datatypes::{ChannelDatatype, ClassDescriptionMapElem, Rgba32},
};

use crate::{
    looks,
    recording::{Recording, part},
};

/// The quality of pictures, of 100: ten minutes of them, ten a second, stay under 60 MB.
const QUALITY: u8 = 60;
/// Steps of depth a metre.
const DEPTH_STEPS: f32 = 1000.0;
/// Depth that is told apart by colour, in steps.
const DEPTH_SHOWN: [f64; 2] = [0.0, 6000.0];
/// How large a camera is drawn in the scene, m.
const DRAWN_M: f32 = 0.5;

/// The first class of a body, and of a surface of a room: those of objects are below.
const FIRST_BODY: u16 = 60_000;
const FIRST_SURFACE: u16 = 61_000;

/// The pictures of one session's cameras.
#[derive(Default)]
pub struct Pictures {
    cameras: BTreeMap<CameraId, Shown>,
    /// Names and colours of what is there.
    classes: BTreeMap<u16, (String, [u8; 3])>,
}

/// What was told of a camera last.
#[derive(Default)]
struct Shown {
    place: Option<[f32; 5]>,
    planes: [Vec<u8>; 4],
}

/// Where a camera's pictures are logged.
pub fn camera_path(camera: CameraId) -> String {
    format!("world/cameras/{}", part(&camera.to_string().replace('/', "_")))
}

impl Pictures {
    /// Names what there is to see, where that is new.
    pub fn name(&mut self, recording: &Recording, catalog: &Catalog, state: &StateView<'_>) -> anyhow::Result<()> {
        let before = self.classes.len();
        if before == 0 {
            self.classes.extend(surfaces(catalog).map(|(id, name)| (class_of(id), (name, instance_color(id)))));
        }
        for body in state.bodies {
            let id = body_instance_id(BodyId(body.body));
            self.classes.entry(class_of(id)).or_insert_with(|| (looks::body_name(body), instance_color(id)));
        }
        for object in state.objects {
            let id = object_instance_id(ObjectId(object.object));
            let class = || SemanticClass::Object(ClassId(object.class)).name(catalog).to_owned();
            let name = || format!("{} ({})", class(), object.instance.as_str());
            self.classes.entry(class_of(id)).or_insert_with(|| (name(), instance_color(id)));
        }
        if self.classes.len() == before {
            return Ok(());
        }
        let described = self.classes.iter().map(|(class, (name, [red, green, blue]))| {
            ClassDescriptionMapElem::from((*class, name.as_str(), Rgba32::from_rgb(*red, *green, *blue)))
        });
        recording.log("world/cameras", &AnnotationContext::new(described.collect::<Vec<_>>()))
    }

    /// Tells of a frame what differs from the one before.
    pub fn show(&mut self, recording: &Recording, camera: CameraId, frame: &FrameView<'_>) -> anyhow::Result<()> {
        let path = camera_path(camera);
        let shown = self.cameras.entry(camera).or_default();
        let place = place(&frame.header);
        if shown.place.is_none() {
            recording.log_always(&path, &pinhole(&frame.header))?;
        }
        if shown.place != Some(place) {
            let pose = Transform3D::from_translation_mat3x3(frame.header.position_m, axes(&frame.header));
            recording.log(&path, &pose)?;
            shown.place = Some(place);
        }
        for (plane, before) in Plane::ALL.into_iter().zip(&mut shown.planes) {
            let Some(bytes) = frame.plane(plane).filter(|bytes| *bytes != before.as_slice()) else { continue };
            log_plane(recording, &format!("{path}/{}", plane.name()), plane, bytes, size(&frame.header))?;
            before.clear();
            before.extend_from_slice(bytes);
        }
        Ok(())
    }
}

/// Pictures one above the other, in pixels.
const fn size(header: &FrameHeader) -> [u32; 2] {
    [header.width, header.height * header.views]
}

fn log_plane(
    recording: &Recording,
    path: &str,
    plane: Plane,
    bytes: &[u8],
    [width, height]: [u32; 2],
) -> anyhow::Result<()> {
    match plane {
        Plane::Color => recording.log(path, &jpeg(bytes, [width, height], ColorType::Rgba)?),
        Plane::Normals => {
            let colors: Vec<u8> =
                bytes.chunks_exact(4).flat_map(|pixel| [0, 1, 2].map(|axis| pixel[axis] ^ 0x80)).collect();
            recording.log(path, &jpeg(&colors, [width, height], ColorType::Rgb)?)
        }
        Plane::Depth => {
            let depth = EncodedDepthImage::new(depth_png(bytes, [width, height])?).with_media_type("image/png");
            recording
                .log(path, &depth.with_meter(DEPTH_STEPS).with_colormap(Colormap::Turbo).with_depth_range(DEPTH_SHOWN))
        }
        Plane::Ids => {
            let ids: &[u32] = bytemuck::cast_slice(bytes);
            let classes: Vec<u8> = ids.iter().flat_map(|id| class_of(*id).to_le_bytes()).collect();
            let format = ImageFormat::segmentation([width, height], ChannelDatatype::U16);
            recording.log(path, &SegmentationImage::new(classes, format))
        }
    }
}

fn jpeg(bytes: &[u8], [width, height]: [u32; 2], colors: ColorType) -> anyhow::Result<EncodedImage> {
    let mut encoded = Vec::with_capacity(32 << 10);
    let [width, height] = [width, height].map(u16::try_from);
    let (width, height) = (width.context("a picture is too wide")?, height.context("a picture is too high")?);
    Encoder::new(&mut encoded, QUALITY).encode(bytes, width, height, colors).context("encode a picture")?;
    Ok(EncodedImage::new(encoded).with_media_type("image/jpeg"))
}

/// Depth in steps, as a picture of 16 bits.
fn depth_png(bytes: &[u8], [width, height]: [u32; 2]) -> anyhow::Result<Vec<u8>> {
    let metres: &[f32] = bytemuck::cast_slice(bytes);
    let steps = metres.iter().flat_map(|metres| ((metres * DEPTH_STEPS + 0.5) as u16).to_be_bytes());
    let mut encoded = Vec::with_capacity(64 << 10);
    let mut encoder = png::Encoder::new(&mut encoded, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header().context("encode depth")?;
    writer.write_image_data(&steps.collect::<Vec<u8>>()).context("encode depth")?;
    writer.finish().context("encode depth")?;
    Ok(encoded)
}

fn pinhole(header: &FrameHeader) -> Pinhole {
    let [width, height] = [header.width, header.height].map(|side| side as f32);
    let focal = height / 2.0 / (header.fov_y_rad / 2.0).tan();
    Pinhole::from_focal_length_and_resolution([focal, focal], [width, height])
        .with_image_plane_distance(ImagePlaneDistance(DRAWN_M.into()))
}

const fn place(header: &FrameHeader) -> [f32; 5] {
    let [x, y, z] = header.position_m;
    [x, y, z, header.yaw_rad, header.pitch_rad]
}

/// The camera's axes in the world: to the right, down, and forward.
fn axes(header: &FrameHeader) -> [[f32; 3]; 3] {
    let ((sin, cos), (up, along)) = (header.yaw_rad.sin_cos(), header.pitch_rad.sin_cos());
    [[sin, -cos, 0.0], [up * cos, up * sin, -along], [along * cos, along * sin, up]]
}

/// The class of an id of the id plane: rerun's have 16 bits.
fn class_of(id: u32) -> u16 {
    let small = |number: u32, first: u16| first.saturating_add(u16::try_from(number).unwrap_or(u16::MAX));
    match Thing::of_id(id) {
        Thing::Nothing => 0,
        Thing::Object(object) => small(object.0 + 1, 0).min(FIRST_BODY - 1),
        Thing::Body(body) => small(body.0, FIRST_BODY).min(FIRST_SURFACE - 1),
        Thing::Surface(_) => {
            let place = room_surface_of_id(id)
                .map_or(0, |(room, surface)| u32::from(room) * RoomSurface::ALL.len() as u32 + surface as u32);
            small(place, FIRST_SURFACE)
        }
    }
}

/// The ids and names of all surfaces that rooms may have.
fn surfaces(catalog: &Catalog) -> impl Iterator<Item = (u32, String)> {
    let of_room = |(index, room): (u8, &RoomEntry)| {
        RoomSurface::ALL.map(|surface| (room_surface_id(index, surface), format!("{surface:?} ({})", room.name)))
    };
    (0..).zip(catalog.rooms().all()).flat_map(of_room)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_id_has_a_class_of_its_own() {
        let objects = (0..2000).map(|object| object_instance_id(ObjectId(object)));
        let bodies = (0..200).map(|body| body_instance_id(BodyId(body)));
        let surfaces: Vec<u32> = surfaces(&Catalog::builtin()).map(|(id, _)| id).collect();
        let ids: Vec<u32> = objects.chain(bodies).chain(surfaces).collect();
        let mut classes: Vec<u16> = ids.iter().map(|id| class_of(*id)).collect();
        classes.sort_unstable();
        classes.dedup();
        assert_eq!(classes.len(), ids.len());
        assert_eq!(class_of(0), 0);
    }

    #[test]
    fn cameras_stand_as_they_look() {
        let header = FrameHeader { yaw_rad: 0.7, pitch_rad: -0.4, ..FrameHeader::default() };
        let [right, down, forward] = axes(&header);
        let cross = [
            right[1] * down[2] - right[2] * down[1],
            right[2] * down[0] - right[0] * down[2],
            right[0] * down[1] - right[1] * down[0],
        ];
        for (found, wanted) in cross.iter().zip(forward) {
            assert!((found - wanted).abs() < 1e-6, "{found} is not {wanted}");
        }
    }
}
