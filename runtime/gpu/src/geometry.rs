//! All triangles that were drawn so far, on the GPU. A mesh is uploaded when it is first drawn, and stays.

use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use cohabit_render::MeshLibrary;
use cohabit_render::backend::{self, Light, MeshData, Paint, PlanKey, Stage, Veil};
use wgpu::{BufferUsages, Device, Queue, VertexAttribute, VertexBufferLayout, VertexFormat, VertexStepMode};

use crate::arena::Arena;

/// Floor plans kept; beyond, everything is forgotten.
const MOST_PLANS: usize = 16;

/// A corner as the shader reads it.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Vertex {
    position: [f32; 3],
    normal: [f32; 3],
    ambient: f32,
    surface: u32,
}

/// A surface as the shader reads it.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Surface {
    paint: [f32; 4],
    u: [f32; 4],
    v: [f32; 4],
    gloss: [f32; 4],
    pattern: [f32; 4],
    veil: [f32; 4],
}

/// Where a piece's indices lie.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlotPiece {
    pub first_index: u32,
    pub index_count: u32,
    pub veil: Option<Veil>,
}

/// Where a mesh lies in the buffers.
#[derive(Clone, Debug)]
pub(crate) struct Slot {
    pub base_vertex: i32,
    pub pieces: Vec<SlotPiece>,
}

/// All triangles.
#[derive(Debug)]
pub(crate) struct Geometry {
    pub vertices: Arena,
    pub indices: Arena,
    pub surfaces: Arena,
    library: Option<Arc<MeshLibrary>>,
    /// By model, then by level of detail.
    models: Vec<[Option<Slot>; LEVELS]>,
    plans: Vec<(PlanKey, Slot)>,
}

/// Levels of detail.
const LEVELS: usize = 3;

impl Geometry {
    pub(crate) fn new(device: &Device) -> Self {
        Self {
            vertices: Arena::new(device, "vertices", BufferUsages::VERTEX),
            indices: Arena::new(device, "indices", BufferUsages::INDEX),
            surfaces: Arena::new(device, "surfaces", BufferUsages::STORAGE),
            library: None,
            models: Vec::new(),
            plans: Vec::new(),
        }
    }

    /// How its corners are laid out.
    pub(crate) fn layout() -> VertexBufferLayout<'static> {
        const ATTRIBUTES: [VertexAttribute; 4] = [
            VertexAttribute { format: VertexFormat::Float32x3, offset: 0, shader_location: 0 },
            VertexAttribute { format: VertexFormat::Float32x3, offset: 12, shader_location: 1 },
            VertexAttribute { format: VertexFormat::Float32, offset: 24, shader_location: 2 },
            VertexAttribute { format: VertexFormat::Uint32, offset: 28, shader_location: 3 },
        ];
        VertexBufferLayout {
            array_stride: size_of::<Vertex>() as u64,
            step_mode: VertexStepMode::Vertex,
            attributes: &ATTRIBUTES,
        }
    }

    /// Makes ready for a scene. Its plan is uploaded, unless it is known.
    pub(crate) fn begin(&mut self, device: &Device, queue: &Queue, stage: Stage<'_>) -> usize {
        let plan = stage.plan();
        let same = self.library.as_ref().is_some_and(|known| Arc::ptr_eq(known, stage.library()));
        if let Some(known) = self.plans.iter().position(|(key, _)| *key == plan)
            && same
        {
            return known;
        }
        if !same || self.plans.len() >= MOST_PLANS {
            self.library = Some(Arc::clone(stage.library()));
            self.models.clear();
            self.plans.clear();
            self.vertices.clear();
            self.indices.clear();
            self.surfaces.clear();
        }
        let slot = self.upload(device, queue, &stage.plan_mesh());
        self.plans.push((plan, slot));
        self.plans.len() - 1
    }

    pub(crate) fn plan(&self, plan: usize) -> &Slot {
        &self.plans[plan].1
    }

    /// Where a model lies at a level of detail, once it was uploaded.
    pub(crate) fn model(&self, model: u32, level: u32) -> Option<&Slot> {
        self.models.get(model as usize)?.get(level as usize)?.as_ref()
    }

    /// Uploads a model at a level of detail, unless it is known.
    pub(crate) fn need(&mut self, device: &Device, queue: &Queue, stage: Stage<'_>, model: u32, level: u32) {
        if self.model(model, level).is_some() {
            return;
        }
        let slot = self.upload(device, queue, &stage.model_mesh(model, level));
        if self.models.len() <= model as usize {
            self.models.resize(model as usize + 1, [const { None }; LEVELS]);
        }
        if let Some(place) = self.models[model as usize].get_mut(level as usize) {
            *place = Some(slot);
        }
    }

    fn upload(&mut self, device: &Device, queue: &Queue, mesh: &MeshData) -> Slot {
        let surfaces: Vec<Surface> = mesh.surfaces.iter().map(surface).collect();
        let first_surface = self.surfaces.push(device, queue, &surfaces);
        let vertices: Vec<Vertex> = mesh
            .vertices
            .iter()
            .map(|vertex| Vertex {
                position: vertex.position.to_array(),
                normal: vertex.normal.to_array(),
                ambient: vertex.ambient,
                surface: vertex.surface + first_surface,
            })
            .collect();
        let base_vertex = self.vertices.push(device, queue, &vertices) as i32;
        let first_index = self.indices.push(device, queue, &mesh.indices);
        let pieces = mesh.pieces.iter().map(|piece| SlotPiece {
            first_index: first_index + piece.indices.start,
            index_count: piece.indices.len() as u32,
            veil: piece.veil,
        });
        Slot { base_vertex, pieces: pieces.collect() }
    }
}

fn surface(own: &backend::Surface) -> Surface {
    let paint = match own.paint {
        Paint::Fixed(color) => color.extend(0.0),
        Paint::Tint => glam::Vec4::W,
        Paint::Fluid => glam::Vec4::W * 2.0,
    };
    let picture = own.picture.map(|index| (index, backend::picture(index)));
    let (layer, per_m, squared) = picture.map_or((-1.0, 1.0, 0.0), |(index, picture)| {
        (index as f32, picture.per_m / picture.side as f32, picture.squared)
    });
    let light = match own.light {
        Light::Lit => 0.0,
        Light::Glow => 1.0,
        Light::Lamp => 2.0,
        Light::Sky => 3.0,
    };
    let gloss = own.gloss;
    Surface {
        paint: paint.to_array(),
        u: own.u.0.extend(own.u.1).to_array(),
        v: own.v.0.extend(own.v.1).to_array(),
        gloss: [gloss.shine, f32::from(gloss.squarings), gloss.mirror, f32::from(u8::from(gloss.colored))],
        pattern: [layer, per_m, squared, light],
        veil: own.veil.map_or([1.0, 1.0, 0.0, 0.0], |look| {
            [own.opacity, look.glancing, look.shine, f32::from(u8::from(look.shines))]
        }),
    }
}
