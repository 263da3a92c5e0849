//! The shader, compiled for what is wanted of it.

use std::collections::HashMap;
use std::fmt::Write as _;

use cohabit_render::FAR_M;
use cohabit_render::backend::{self as from, Veil};
use glam::Vec3;
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindGroupLayout, BindGroupLayoutDescriptor, BindGroupLayoutEntry,
    BindingResource, BindingType, BlendComponent, BlendFactor, BlendOperation, BlendState, Buffer, BufferBindingType,
    ColorTargetState, ColorWrites, CompareFunction, DepthBiasState, DepthStencilState, Device, Face, FragmentState,
    FrontFace, MultisampleState, PipelineCompilationOptions, PipelineLayout, PipelineLayoutDescriptor, PrimitiveState,
    RenderPipeline, RenderPipelineDescriptor, SamplerBindingType, ShaderModule, ShaderModuleDescriptor, ShaderSource,
    ShaderStages, StencilState, TextureSampleType, TextureViewDimension, VertexState,
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
    /// See-through surfaces that have ids.
    pub clear: RenderPipeline,
    /// Those that have none, where colour is wanted.
    pub airy: Option<RenderPipeline>,
}

/// What a pipeline draws.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Kind {
    Solid,
    Sky,
    Veil(Veil),
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
            solid: compile(device, module, layout, mask, Kind::Solid),
            sky: mask.has(COLOR).then(|| compile(device, module, layout, mask, Kind::Sky)),
            clear: compile(device, module, layout, mask, Kind::Veil(Veil::Clear)),
            airy: mask.has(COLOR).then(|| compile(device, module, layout, mask, Kind::Veil(Veil::Airy))),
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
    vector("VEIL_DIRT", from::linear_light([110, 90, 62]));
    vector("VEIL_FROST", from::linear_light([214, 233, 246]));
    text
}

fn compile(device: &Device, module: &ShaderModule, layout: &PipelineLayout, mask: Mask, kind: Kind) -> RenderPipeline {
    let (vertex, fragment) = match kind {
        Kind::Solid => ("corner", "solid"),
        Kind::Sky => ("backdrop", "sky"),
        Kind::Veil(_) => ("veil_corner", "veil"),
    };
    let flag = |set: bool| f64::from(u8::from(set));
    let airy = kind == Kind::Veil(Veil::Airy);
    let constants = [("COLORED", flag(mask.has(COLOR))), ("AIRY", flag(airy))];
    let compilation_options = PipelineCompilationOptions { constants: &constants, ..Default::default() };
    let corners = Some(Geometry::layout());
    let only_color = airy || kind == Kind::Sky;
    device.create_render_pipeline(&RenderPipelineDescriptor {
        label: Some(fragment),
        layout: Some(layout),
        vertex: VertexState {
            module,
            entry_point: Some(vertex),
            compilation_options: compilation_options.clone(),
            buffers: if kind == Kind::Sky { &[] } else { core::slice::from_ref(&corners) },
        },
        primitive: PrimitiveState {
            front_face: FrontFace::Ccw,
            cull_mode: (kind != Kind::Sky).then_some(Face::Back),
            ..PrimitiveState::default()
        },
        depth_stencil: Some(depth(!only_color)),
        multisample: MultisampleState::default(),
        fragment: Some(FragmentState {
            module,
            entry_point: Some(fragment),
            compilation_options,
            targets: &core::array::from_fn::<_, 5, _>(|target| {
                let written = target == COLOR || !only_color;
                mask.has(target).then_some(ColorTargetState {
                    format: FORMATS[target],
                    blend: (target == COLOR && matches!(kind, Kind::Veil(_))).then_some(LAID_OVER),
                    write_mask: if written { ColorWrites::ALL } else { ColorWrites::empty() },
                })
            }),
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Display bytes are mixed by opacity; pictures stay opaque.
const LAID_OVER: BlendState = BlendState {
    color: BlendComponent {
        src_factor: BlendFactor::SrcAlpha,
        dst_factor: BlendFactor::OneMinusSrcAlpha,
        operation: BlendOperation::Add,
    },
    alpha: BlendComponent {
        src_factor: BlendFactor::Zero,
        dst_factor: BlendFactor::One,
        operation: BlendOperation::Add,
    },
};

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
