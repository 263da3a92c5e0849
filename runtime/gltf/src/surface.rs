//! What triangles look like: factors, pictures and colours of points become one colour and one material for each.

use std::{cell::RefCell, collections::BTreeMap, rc::Rc};

use cohabit_cdf::model::Material as Kind;
use gltf_json::{Index, Material, Root, image::Image, material::AlphaMode, texture::Info, validation::Checked};

use crate::{
    accessor::Accessors,
    error::GltfError,
    files::Files,
    picture::{Meaning, Picture, Wrap},
};

/// The most pictures that are decoded.
const MOST_PICTURES: usize = 64;
/// What hides more than this is not seen through.
const OPAQUE: f32 = 0.95;
/// What hides less is not there.
const ABSENT: f32 = 0.05;
/// What shines by more than this is a lamp or a screen.
const SHINES: f32 = 0.3;
/// The colour of what has no material.
const GRAY: f32 = 0.6;

/// What a surface is made of.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) struct Finish {
    pub material: Kind,
    /// Of what is seen through: how much it hides, in tenths.
    pub opacity_tenths: Option<u8>,
}

/// The materials of a document.
pub(crate) struct Surfaces<'a> {
    root: &'a Root,
    accessors: &'a Accessors<'a>,
    files: &'a Files<'a>,
    pictures: RefCell<BTreeMap<(usize, Meaning), Rc<Picture>>>,
    /// How many textures have no picture of a kind that is read.
    unread: RefCell<usize>,
}

/// A material.
pub(crate) struct Surface {
    /// Which set of places on pictures it uses.
    pub tex_coord: Option<u32>,
    pub two_sided: bool,
    /// Linear light, and what it hides.
    factor: [f32; 4],
    metallic: f32,
    rough: f32,
    alpha: Alpha,
    picture: Option<Laid>,
    /// Green: how rough; blue: how metallic.
    gloss: Option<Laid>,
    shines: Option<[f32; 3]>,
}

#[derive(Clone, Copy)]
enum Alpha {
    Opaque,
    /// What hides less than this is not there.
    Cut(f32),
    Blend,
}

/// A picture and how it lies on a surface.
struct Laid {
    picture: Rc<Picture>,
    wrap: Wrap,
    tex_coord: u32,
    offset: [f32; 2],
    scale: [f32; 2],
    /// Sine and cosine.
    turn: (f32, f32),
}

impl<'a> Surfaces<'a> {
    pub(crate) fn new(root: &'a Root, accessors: &'a Accessors<'a>, files: &'a Files<'a>) -> Self {
        Self { root, accessors, files, pictures: RefCell::default(), unread: RefCell::default() }
    }

    /// What of it was not imported.
    pub(crate) fn left_out(&self) -> Vec<String> {
        let unread = *self.unread.borrow();
        if unread > 0 { vec![format!("{unread} × texture that is neither PNG nor JPEG")] } else { Vec::new() }
    }

    /// The material at this index; a gray one for none.
    pub(crate) fn surface(&self, index: Option<Index<Material>>) -> Result<Surface, GltfError> {
        let Some(index) = index else { return Ok(Surface::plain()) };
        let at = format!("materials[{}]", index.value());
        let material = self.root.get(index).ok_or_else(|| GltfError::at(&at, "there is none"))?;
        let pbr = &material.pbr_metallic_roughness;
        let extensions = material.extensions.as_ref();
        let mut surface = Surface {
            factor: pbr.base_color_factor.0,
            metallic: pbr.metallic_factor.0,
            rough: pbr.roughness_factor.0,
            two_sided: material.double_sided,
            alpha: match material.alpha_mode {
                Checked::Valid(AlphaMode::Opaque) => Alpha::Opaque,
                Checked::Valid(AlphaMode::Mask) => Alpha::Cut(material.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0)),
                Checked::Valid(AlphaMode::Blend) => Alpha::Blend,
                Checked::Invalid => return Err(GltfError::at(at, "`alphaMode` is none of glTF 2.0")),
            },
            picture: self.laid(pbr.base_color_texture.as_ref(), Meaning::Color)?,
            gloss: self.laid(pbr.metallic_roughness_texture.as_ref(), Meaning::Shares)?,
            ..Surface::plain()
        };
        if let Some(older) = extensions.and_then(|own| own.pbr_specular_glossiness.as_ref()) {
            surface.factor = older.diffuse_factor.0;
            surface.picture = self.laid(older.diffuse_texture.as_ref(), Meaning::Color)?;
            (surface.metallic, surface.rough, surface.gloss) = (0.0, 1.0 - older.glossiness_factor.0, None);
        }
        if let Some(glass) = extensions.and_then(|own| own.transmission.as_ref())
            && glass.transmission_factor.0 > 0.5
        {
            surface.alpha = Alpha::Blend;
            surface.factor[3] *= 1.0 - glass.transmission_factor.0.min(0.8);
        }
        let shines = material.emissive_factor.0;
        if material.emissive_texture.is_none() && shines.iter().fold(0.0, |most: f32, one| most.max(*one)) > SHINES {
            surface.shines = Some(shines);
        }
        // What lies by another set of places than the first picture does counts by its factors alone.
        surface.tex_coord = surface.picture.iter().chain(&surface.gloss).map(|laid| laid.tex_coord).next();
        surface.gloss = surface.gloss.filter(|laid| Some(laid.tex_coord) == surface.tex_coord);
        Ok(surface)
    }

    fn laid(&self, info: Option<&Info>, meaning: Meaning) -> Result<Option<Laid>, GltfError> {
        let Some(info) = info else { return Ok(None) };
        let at = format!("textures[{}]", info.index.value());
        let texture = self.root.get(info.index).ok_or_else(|| GltfError::at(at, "there is none"))?;
        // A texture whose picture an extension alone names has no source.
        let Some(image) = self.root.get(texture.source) else {
            *self.unread.borrow_mut() += 1;
            return Ok(None);
        };
        let picture = self.picture(image, texture.source.value(), meaning)?;
        let wrap = Wrap::of(texture.sampler.and_then(|sampler| self.root.get(sampler)));
        let transform = info.extensions.as_ref().and_then(|own| own.texture_transform.clone()).unwrap_or_default();
        Ok(Some(Laid {
            picture,
            wrap,
            tex_coord: transform.tex_coord.unwrap_or(info.tex_coord),
            offset: transform.offset.0,
            scale: transform.scale.0,
            turn: libm::sincosf(transform.rotation.0),
        }))
    }

    fn picture(&self, image: &Image, index: usize, meaning: Meaning) -> Result<Rc<Picture>, GltfError> {
        if let Some(known) = self.pictures.borrow().get(&(index, meaning)) {
            return Ok(Rc::clone(known));
        }
        let have = self.pictures.borrow().len() + 1;
        if have > MOST_PICTURES {
            let (have, most) = (have as u64, MOST_PICTURES as u64);
            let remedy = "export fewer objects, or join their textures";
            return Err(GltfError::TooMany { what: "textures or more", have, most, remedy });
        }
        let at = format!("images[{index}]");
        let picture = match (image.buffer_view, &image.uri) {
            (Some(view), _) => Picture::read(self.accessors.view(view)?, meaning, &at)?,
            (None, Some(uri)) => Picture::read(&self.files.uri(uri, &at)?, meaning, &at)?,
            (None, None) => return Err(GltfError::at(at, "it has no data: export the model anew")),
        };
        let picture = Rc::new(picture);
        self.pictures.borrow_mut().insert((index, meaning), Rc::clone(&picture));
        Ok(picture)
    }
}

impl Laid {
    fn over(&self, places: [[f32; 2]; 3]) -> [f32; 4] {
        let (sin, cos) = self.turn;
        let moved = places.map(|place| {
            let [u, v] = [0, 1].map(|axis| place[axis] * self.scale[axis]);
            [self.offset[0] + cos * u + sin * v, self.offset[1] + cos * v - sin * u]
        });
        self.picture.over(moved, self.wrap)
    }
}

impl Surface {
    fn plain() -> Self {
        Self {
            tex_coord: None,
            two_sided: false,
            factor: [GRAY, GRAY, GRAY, 1.0],
            metallic: 0.0,
            rough: 1.0,
            alpha: Alpha::Opaque,
            picture: None,
            gloss: None,
            shines: None,
        }
    }

    /// The colour of a triangle in linear light, and its material; nothing, if one sees through it altogether. `places` are on
    /// pictures, `colors` of points.
    pub(crate) fn shown(
        &self,
        places: Option<[[f32; 2]; 3]>,
        colors: Option<[[f32; 4]; 3]>,
    ) -> Option<([f32; 3], Finish)> {
        let texel = self.picture.as_ref().zip(places).map_or([1.0; 4], |(laid, places)| laid.over(places));
        let point = colors.map_or([1.0; 4], |[a, b, c]| [0, 1, 2, 3].map(|at| (a[at] + b[at] + c[at]) / 3.0));
        let [red, green, blue, alpha] = [0, 1, 2, 3].map(|at| within(self.factor[at] * texel[at] * point[at]));
        let opacity = match self.alpha {
            Alpha::Opaque => 1.0,
            Alpha::Cut(least) if alpha < least => return None,
            Alpha::Cut(_) => 1.0,
            Alpha::Blend if alpha < ABSENT => return None,
            Alpha::Blend => alpha,
        };
        if opacity < OPAQUE {
            let opacity_tenths = Some(((opacity * 10.0).round() as u8).clamp(1, 9));
            return Some(([red, green, blue], Finish { material: Kind::Clear, opacity_tenths }));
        }
        if let Some(shines) = self.shines {
            let finish = Finish { material: Kind::Glow, opacity_tenths: None };
            return Some((shines.map(within), finish));
        }
        let gloss = self.gloss.as_ref().zip(places).map_or([1.0; 4], |(laid, places)| laid.over(places));
        let material = match (self.metallic * gloss[2], self.rough * gloss[1]) {
            (metallic, _) if metallic >= 0.5 => Kind::Metal,
            (_, rough) if rough < 0.35 => Kind::Ceramic,
            (_, rough) if rough < 0.65 => Kind::Plastic,
            _ => Kind::Plain,
        };
        Some(([red, green, blue], Finish { material, opacity_tenths: None }))
    }
}

/// A share; none for what is no number.
fn within(value: f32) -> f32 {
    if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) }
}
