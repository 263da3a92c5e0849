//! What shading reads besides the triangles: patterns, shadows, and how light becomes display bytes.

use bytemuck::{Pod, Zeroable};
use cohabit_render::backend::{self, PlanKey, Shadows, Stage};
use wgpu::util::{BufferInitDescriptor, DeviceExt as _};
use wgpu::{
    AddressMode, Buffer, BufferDescriptor, BufferUsages, Device, Extent3d, FilterMode, Origin3d, Queue, Sampler,
    SamplerDescriptor, TexelCopyBufferLayout, TexelCopyTextureInfo, Texture, TextureAspect, TextureDescriptor,
    TextureDimension, TextureFormat, TextureUsages, TextureView,
};

/// The map of shadows, as the shader is told of it.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Told {
    origin: [f32; 2],
    most: [f32; 2],
    texels_a_metre: f32,
    spots: f32,
    spots_a_metre: f32,
    unused: f32,
}

/// Textures and tables.
#[derive(Debug)]
pub(crate) struct Lighting {
    pub display_bytes: Buffer,
    pub told: Buffer,
    pub pictures: TextureView,
    pub smoothly: Sampler,
    pub shadow_map: TextureView,
    shadow_texture: Texture,
    /// Whose shadows are on the map.
    known: Option<(PlanKey, u64)>,
}

impl Lighting {
    pub(crate) fn new(device: &Device, queue: &Queue) -> Self {
        let bytes = |label, contents, usage| {
            device.create_buffer_init(&BufferInitDescriptor { label: Some(label), contents, usage })
        };
        let shadow_texture = shadow_texture(device, [8, 8]);
        Self {
            display_bytes: bytes("display bytes", backend::display_bytes(), BufferUsages::STORAGE),
            told: device.create_buffer(&BufferDescriptor {
                label: Some("shadows"),
                size: size_of::<Told>() as u64,
                usage: BufferUsages::UNIFORM | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
            pictures: pictures(device, queue),
            smoothly: device.create_sampler(&SamplerDescriptor {
                label: Some("pictures"),
                address_mode_u: AddressMode::Repeat,
                address_mode_v: AddressMode::Repeat,
                mag_filter: FilterMode::Linear,
                min_filter: FilterMode::Linear,
                ..SamplerDescriptor::default()
            }),
            shadow_map: shadow_texture.create_view(&Default::default()),
            shadow_texture,
            known: None,
        }
    }

    /// Brings the shadows up to date.
    pub(crate) fn update(&mut self, device: &Device, queue: &Queue, stage: Stage<'_>) {
        let shadows = stage.shadows();
        let now = (stage.plan(), shadows.revision());
        if self.known.as_ref() == Some(&now) {
            return;
        }
        let [width, height] = shadows.size();
        if [self.shadow_texture.width(), self.shadow_texture.height()] != [width, height] {
            self.shadow_texture = shadow_texture(device, [width, height]);
            self.shadow_map = self.shadow_texture.create_view(&Default::default());
        }
        queue.write_texture(
            whole(&self.shadow_texture, 0, 0),
            bytemuck::cast_slice(shadows.texels()),
            TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(width * 2), rows_per_image: None },
            Extent3d { width, height, depth_or_array_layers: 1 },
        );
        queue.write_buffer(&self.told, 0, bytemuck::bytes_of(&told(&shadows)));
        self.known = Some(now);
    }
}

fn told(shadows: &Shadows<'_>) -> Told {
    let [width, height] = shadows.size();
    let spots = backend::picture(backend::spots());
    Told {
        origin: shadows.origin_m(),
        most: [width as f32 - 4.0, height as f32 - 4.0],
        texels_a_metre: shadows.texels_a_metre(),
        spots: backend::spots() as f32,
        spots_a_metre: spots.per_m / spots.side as f32,
        unused: 0.0,
    }
}

fn shadow_texture(device: &Device, [width, height]: [u32; 2]) -> Texture {
    device.create_texture(&TextureDescriptor {
        label: Some("map of shadows"),
        size: Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: TextureDimension::D2,
        format: TextureFormat::R16Uint,
        usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

/// All patterns' pictures, a layer each.
fn pictures(device: &Device, queue: &Queue) -> TextureView {
    let all: Vec<_> = (0..backend::PICTURES).map(backend::picture).collect();
    let (side, levels) = (all[0].side, all[0].levels.len() as u32);
    let texture = device.create_texture(&TextureDescriptor {
        label: Some("pictures"),
        size: Extent3d { width: side, height: side, depth_or_array_layers: backend::PICTURES as u32 },
        mip_level_count: levels,
        sample_count: 1,
        dimension: TextureDimension::D2,
        format: TextureFormat::Rgba8Unorm,
        usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
        view_formats: &[],
    });
    for (layer, picture) in (0..).zip(&all) {
        for (level, texels) in (0..levels).zip(&picture.levels) {
            let side = side >> level;
            queue.write_texture(
                whole(&texture, level, layer),
                bytemuck::cast_slice(texels),
                TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(side * 4), rows_per_image: None },
                Extent3d { width: side, height: side, depth_or_array_layers: 1 },
            );
        }
    }
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    })
}

fn whole(texture: &Texture, mip_level: u32, z: u32) -> TexelCopyTextureInfo<'_> {
    TexelCopyTextureInfo { texture, mip_level, origin: Origin3d { x: 0, y: 0, z }, aspect: TextureAspect::All }
}
