//! The shader, compiled for what is wanted of it.

use std::collections::HashMap;
use std::fmt::Write as _;

use cohabit_render::FAR_M;
use cohabit_render::backend as from;
use glam::Vec3;
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindGroupLayout, BindGroupLayoutDescriptor, BindGroupLayoutEntry,
    BindingResource, BindingType, Buffer, BufferBindingType, ColorTargetState, ColorWrites, CompareFunction,
    DepthBiasState, DepthStencilState, Device, Face, FragmentState, FrontFace, MultisampleState,
    PipelineCompilationOptions, PipelineLayout, PipelineLayoutDescriptor, PrimitiveState, RenderPipeline,
    RenderPipelineDescriptor, SamplerBindingType, ShaderModule, ShaderModuleDescriptor, ShaderSource, ShaderStages,
    StencilState, TextureSampleType, TextureViewDimension, VertexState,
};

use crate::geometry::Geometry;
use crate::light::Lighting;
use crate::targets::{COLOR, DEPTH_FORMAT, FORMATS, Mask};

/// All ways to draw into some targets.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub solid: RenderPipeline,
    /// The sky, where colour is wanted.
    pub sky: Option<RenderPipeline>,
}

/// The compiled shader.
#[derive(Debug)]
pub(crate) struct Shading {
    module: ShaderModule,
    bindings: BindGroupLayout,
    layout: PipelineLayout,
    by_mask: HashMap<Mask, Pipelines>,
}

impl Shading {
    pub(crate) fn new(device: &Device) -> Self {
        let source = format!("{}{}", constants(), include_str!("office.wgsl"));
        let module = device.create_shader_module(ShaderModuleDescriptor {
            label: Some("office"),
            source: ShaderSource::Wgsl(source.into()),
        });
        let bindings = device
            .create_bind_group_layout(&BindGroupLayoutDescriptor { label: Some("office"), entries: &binding_layout() });
        let layout = device.create_pipeline_layout(&PipelineLayoutDescriptor {
            label: Some("office"),
            bind_group_layouts: &[Some(&bindings)],
            immediate_size: 0,
        });
        Self { module, bindings, layout, by_mask: HashMap::new() }
    }

    /// Compiles the pipelines for some targets, unless they are known.
    pub(crate) fn prepare(&mut self, device: &Device, mask: Mask) {
        let Self { module, layout, by_mask, .. } = self;
        by_mask.entry(mask).or_insert_with(|| Pipelines {
            solid: solid(device, module, layout, mask),
            sky: mask.has(COLOR).then(|| sky(device, module, layout, mask)),
        });
    }

    /// The pipelines for some targets, once prepared.
    pub(crate) fn pipelines(&self, mask: Mask) -> Option<&Pipelines> {
        self.by_mask.get(&mask)
    }

    /// Binds all that the shader reads: cameras, pieces and draws, in this order, then what stays.
    pub(crate) fn bind(
        &self,
        device: &Device,
        frame: [&Buffer; 3],
        geometry: &Geometry,
        light: &Lighting,
    ) -> BindGroup {
        let [cameras, pieces, draws] = frame;
        let resources = [
            cameras.as_entire_binding(),
            pieces.as_entire_binding(),
            draws.as_entire_binding(),
            geometry.surfaces.buffer().as_entire_binding(),
            light.display_bytes.as_entire_binding(),
            light.told.as_entire_binding(),
            BindingResource::TextureView(&light.shadow_map),
            BindingResource::TextureView(&light.pictures),
            BindingResource::Sampler(&light.smoothly),
        ];
        let entries: Vec<BindGroupEntry<'_>> =
            (0..).zip(resources).map(|(binding, resource)| BindGroupEntry { binding, resource }).collect();
        device.create_bind_group(&BindGroupDescriptor {
            label: Some("office"),
            layout: &self.bindings,
            entries: &entries,
        })
    }
}

fn binding_layout() -> Vec<BindGroupLayoutEntry> {
    let buffer = |ty| BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    let texture =
        |sample_type, view_dimension| BindingType::Texture { sample_type, view_dimension, multisampled: false };
    let storage = buffer(BufferBindingType::Storage { read_only: true });
    let types = [
        storage,
        storage,
        storage,
        storage,
        storage,
        buffer(BufferBindingType::Uniform),
        texture(TextureSampleType::Uint, TextureViewDimension::D2),
        texture(TextureSampleType::Float { filterable: true }, TextureViewDimension::D2Array),
        BindingType::Sampler(SamplerBindingType::Filtering),
    ];
    let visibility = ShaderStages::VERTEX_FRAGMENT;
    (0..).zip(types).map(|(binding, ty)| BindGroupLayoutEntry { binding, visibility, ty, count: None }).collect()
}

/// What the shader shares with the reference, as its first lines.
fn constants() -> String {
    let mut text = String::new();
    let mut number = |name: &str, value: f32| {
        let _ = writeln!(text, "const {name}: f32 = {value:?};");
    };
    number("NEAR_M", from::NEAR_M);
    number("FAR_M", FAR_M);
    number("WHITE", from::WHITE);
    number("LIFT_M", from::LIFT_M);
    number("FADE", from::FADE);
    number("GUARD_PX", from::GUARD_PX);
    number("SUB", from::SUB as f32);
    let levels = from::picture(0).levels.len();
    let [x, y] = from::SLANT;
    let _ = writeln!(text, "const LEVELS: u32 = {levels}u;\nconst SLANT: vec2<f32> = vec2<f32>({x:?}, {y:?});");
    let mut vector = |name: &str, value: Vec3| {
        let [x, y, z] = value.to_array();
        let _ = writeln!(text, "const {name}: vec3<f32> = vec3<f32>({x:?}, {y:?}, {z:?});");
    };
    vector("ABOVE", from::ABOVE);
    vector("BELOW", from::BELOW);
    vector("KEY", from::KEY);
    vector("TOWARDS_LIGHT", from::towards_light());
    vector("DIRT", from::linear_light(from::DIRT));
    vector("SLIME", from::linear_light(from::SLIME));
    vector("FROST", from::linear_light(from::FROST));
    text
}

fn solid(device: &Device, module: &ShaderModule, layout: &PipelineLayout, mask: Mask) -> RenderPipeline {
    device.create_render_pipeline(&RenderPipelineDescriptor {
        label: Some("solid"),
        layout: Some(layout),
        vertex: VertexState {
            module,
            entry_point: Some("corner"),
            compilation_options: PipelineCompilationOptions::default(),
            buffers: &[Some(Geometry::layout())],
        },
        primitive: PrimitiveState {
            front_face: FrontFace::Ccw,
            cull_mode: Some(Face::Back),
            ..PrimitiveState::default()
        },
        depth_stencil: Some(depth(true)),
        multisample: MultisampleState::default(),
        fragment: Some(FragmentState {
            module,
            entry_point: Some("solid"),
            compilation_options: PipelineCompilationOptions {
                constants: &[("COLORED", f64::from(u8::from(mask.has(COLOR))))],
                ..PipelineCompilationOptions::default()
            },
            targets: &targets(mask, |_| true),
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn sky(device: &Device, module: &ShaderModule, layout: &PipelineLayout, mask: Mask) -> RenderPipeline {
    device.create_render_pipeline(&RenderPipelineDescriptor {
        label: Some("sky"),
        layout: Some(layout),
        vertex: VertexState {
            module,
            entry_point: Some("backdrop"),
            compilation_options: PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: PrimitiveState::default(),
        depth_stencil: Some(depth(false)),
        multisample: MultisampleState::default(),
        fragment: Some(FragmentState {
            module,
            entry_point: Some("sky"),
            compilation_options: PipelineCompilationOptions::default(),
            targets: &targets(mask, |target| target == COLOR),
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// What is nearer wins; of what is equally near, the first.
fn depth(written: bool) -> DepthStencilState {
    DepthStencilState {
        format: DEPTH_FORMAT,
        depth_write_enabled: Some(written),
        depth_compare: Some(CompareFunction::Greater),
        stencil: StencilState::default(),
        bias: DepthBiasState::default(),
    }
}

fn targets(mask: Mask, written: impl Fn(usize) -> bool) -> [Option<ColorTargetState>; 5] {
    core::array::from_fn(|target| {
        let write_mask = if written(target) { ColorWrites::ALL } else { ColorWrites::empty() };
        mask.has(target).then_some(ColorTargetState { format: FORMATS[target], blend: None, write_mask })
    })
}
