//! What is drawn into, and how it comes back.

use wgpu::{
    Buffer, BufferDescriptor, BufferUsages, CommandEncoder, Device, Extent3d, LoadOp, Operations, Origin3d,
    RenderPassColorAttachment, StoreOp, TexelCopyBufferInfo, TexelCopyBufferLayout, TexelCopyTextureInfo, Texture,
    TextureAspect, TextureDescriptor, TextureDimension, TextureFormat, TextureUsages, TextureView,
};

/// What can be drawn, in the order of the shader's outputs.
pub(crate) const FORMATS: [TextureFormat; 5] = [
    TextureFormat::Rgba8Unorm,
    TextureFormat::R32Float,
    TextureFormat::R32Uint,
    TextureFormat::R32Uint,
    TextureFormat::R32Uint,
];
/// Which of them is which.
pub(crate) const COLOR: usize = 0;
pub(crate) const DEPTH: usize = 1;
pub(crate) const NORMALS: usize = 2;
pub(crate) const IDS: usize = 3;
pub(crate) const FACETS: usize = 4;
/// The depth buffer.
pub(crate) const DEPTH_FORMAT: TextureFormat = TextureFormat::Depth32Float;

/// Which of [`FORMATS`] are drawn, a bit each.
#[derive(Clone, Copy, Debug, Default, Eq, Hash, PartialEq)]
pub(crate) struct Mask(pub u8);

impl Mask {
    pub(crate) fn has(self, target: usize) -> bool {
        self.0 >> target & 1 == 1
    }

    /// With one more, if it is wanted.
    pub(crate) fn with(self, target: usize, wanted: bool) -> Self {
        Self(self.0 | u8::from(wanted) << target)
    }
}

/// Textures for one atlas, and the buffer that it is read from.
#[derive(Debug)]
pub(crate) struct Targets {
    pub size: [u32; 2],
    pub mask: Mask,
    textures: [Option<(Texture, TextureView)>; 5],
    pub depth: TextureView,
    pub staging: Buffer,
}

impl Targets {
    pub(crate) fn new(device: &Device, size: [u32; 2], mask: Mask) -> Self {
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
        let textures = core::array::from_fn(|target| {
            mask.has(target).then(|| {
                let texture = texture(device, size, FORMATS[target], usage);
                let view = texture.create_view(&Default::default());
                (texture, view)
            })
        });
        let depth = texture(device, size, DEPTH_FORMAT, TextureUsages::RENDER_ATTACHMENT);
        Self {
            size,
            mask,
            textures,
            depth: depth.create_view(&Default::default()),
            staging: device.create_buffer(&BufferDescriptor {
                label: Some("read-back"),
                size: plane_bytes(size) * u64::from(mask.0.count_ones()),
                usage: BufferUsages::MAP_READ | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            }),
        }
    }

    /// What a pass draws into; everything is empty at first.
    pub(crate) fn attachments(&self, nothing_m: f64) -> [Option<RenderPassColorAttachment<'_>>; 5] {
        core::array::from_fn(|target| {
            let (_, view) = self.textures[target].as_ref()?;
            let clear = match target {
                COLOR => wgpu::Color::BLACK,
                DEPTH => wgpu::Color { r: nothing_m, g: 0.0, b: 0.0, a: 0.0 },
                _ => wgpu::Color::TRANSPARENT,
            };
            Some(RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: Operations { load: LoadOp::Clear(clear), store: StoreOp::Store },
            })
        })
    }

    /// Has all that was drawn copied to where it can be read.
    pub(crate) fn read_back(&self, encoder: &mut CommandEncoder) {
        let [width, height] = self.size;
        for (target, drawn) in self.textures.iter().enumerate() {
            let Some((texture, _)) = drawn else { continue };
            let source =
                TexelCopyTextureInfo { texture, mip_level: 0, origin: Origin3d::ZERO, aspect: TextureAspect::All };
            let layout = TexelCopyBufferLayout {
                offset: self.offset(target) as u64,
                bytes_per_row: Some(width * 4),
                rows_per_image: None,
            };
            encoder.copy_texture_to_buffer(
                source,
                TexelCopyBufferInfo { buffer: &self.staging, layout },
                Extent3d { width, height, depth_or_array_layers: 1 },
            );
        }
    }

    /// Where a target begins in what is read.
    pub(crate) fn offset(&self, target: usize) -> usize {
        let before = (self.mask.0 & ((1 << target) - 1)).count_ones();
        plane_bytes(self.size) as usize * before as usize
    }
}

fn plane_bytes([width, height]: [u32; 2]) -> u64 {
    u64::from(width) * u64::from(height) * 4
}

fn texture(device: &Device, [width, height]: [u32; 2], format: TextureFormat, usage: TextureUsages) -> Texture {
    device.create_texture(&TextureDescriptor {
        label: Some("picture"),
        size: Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}
