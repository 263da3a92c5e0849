//! The renderer: from a scene and cameras to planes.

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use cohabit_render::backend::{ForPeople, Seen, Sight, Stage, Veil};
use cohabit_render::{Camera, CpuRenderer, FAR_M, Planes, Renderer, Scene, Shot, backend};
use wgpu::{
    Buffer, BufferUsages, Device, DeviceDescriptor, Features, IndexFormat, LoadOp, MapMode, Operations, PollType,
    Queue, RenderPassDepthStencilAttachment, RenderPassDescriptor, StoreOp,
};

use crate::adapter::Adapter;
use crate::arena::Arena;
use crate::atlas::{self, Atlas};
use crate::error::GpuError;
use crate::geometry::Geometry;
use crate::light::Lighting;
use crate::pipeline::Shading;
use crate::targets::{COLOR, DEPTH, FACETS, IDS, Mask, NORMALS, Targets};
use crate::work::{self, Office, Work};

/// Most pixels of an atlas: 36 bytes each where everything is wanted.
const MOST_PIXELS: u64 = 1 << 24;
/// Sizes of atlases kept at a time.
const MOST_TARGETS: usize = 4;
/// With fewer cameras, or fewer bytes to copy, threads cost more than they save.
const WORTH_THREADS: usize = 8;

/// What is said when the GPU is lost.
type OnLoss = Box<dyn FnMut(&GpuError) + Send>;

/// Draws on a GPU.
pub struct GpuRenderer {
    device: Device,
    queue: Queue,
    name: String,
    threads: usize,
    indirect: bool,
    most_side: u32,
    most_pixels: u64,
    /// What went wrong first, as the driver tells.
    failure: Arc<Mutex<Option<String>>>,
    loss: Option<GpuError>,
    on_loss: Option<OnLoss>,
    reference: CpuRenderer,
    geometry: Geometry,
    lighting: Lighting,
    shading: Shading,
    targets: Vec<Targets>,
    /// Cameras, pieces, draws, arguments.
    uploads: [Arena; 4],
    work: Work,
    for_people: ForPeople,
    facets: Vec<u32>,
    ids: Vec<u32>,
}

impl fmt::Debug for GpuRenderer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("GpuRenderer").field("name", &self.name).field("loss", &self.loss).finish_non_exhaustive()
    }
}

/// What one camera sees.
type Culled = (Sight, Vec<Seen>);

impl GpuRenderer {
    /// A renderer on this adapter; what is left to the CPU takes so many threads, at least one.
    ///
    /// # Errors
    /// [`GpuError::NoDevice`], or [`GpuError::Lost`] if it fails at once.
    pub fn new(adapter: &Adapter, threads: usize) -> Result<Self, GpuError> {
        let name = adapter.describe();
        let features = adapter.inner.features() & Features::INDIRECT_FIRST_INSTANCE;
        let limits = adapter.inner.limits();
        let (most_side, most_buffer) = (limits.max_texture_dimension_2d, limits.max_buffer_size);
        let descriptor = DeviceDescriptor {
            label: Some("cohabit"),
            required_features: features,
            required_limits: limits,
            ..DeviceDescriptor::default()
        };
        let (device, queue) = pollster::block_on(adapter.inner.request_device(&descriptor))
            .map_err(|error| GpuError::NoDevice { adapter: name.clone(), reason: error.to_string() })?;
        let failure = Arc::new(Mutex::new(None));
        let tell = |failure: &Arc<Mutex<Option<String>>>| {
            let failure = Arc::clone(failure);
            move |reason: String| {
                failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(reason);
            }
        };
        let (uncaptured, lost) = (tell(&failure), tell(&failure));
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| uncaptured(error.to_string())));
        device.set_device_lost_callback(move |reason, text| lost(format!("device lost ({reason:?}): {text}")));
        let threads = threads.clamp(1, 64);
        let upload = |label, usage| Arena::new(&device, label, usage);
        let renderer = Self {
            name,
            threads,
            indirect: features.contains(Features::INDIRECT_FIRST_INSTANCE),
            most_side,
            most_pixels: MOST_PIXELS.min(most_buffer / 20),
            failure,
            loss: None,
            on_loss: None,
            reference: CpuRenderer::new(threads),
            geometry: Geometry::new(&device),
            lighting: Lighting::new(&device, &queue),
            shading: Shading::new(&device),
            targets: Vec::new(),
            uploads: [
                upload("cameras", BufferUsages::STORAGE),
                upload("pieces", BufferUsages::STORAGE),
                upload("draws", BufferUsages::STORAGE),
                upload("arguments", BufferUsages::INDIRECT),
            ],
            work: Work::default(),
            for_people: ForPeople::new(threads),
            facets: Vec::new(),
            ids: Vec::new(),
            device,
            queue,
        };
        match renderer.failed() {
            Some(reason) => Err(GpuError::Lost { adapter: renderer.name, reason }),
            None => Ok(renderer),
        }
    }

    /// Has `tell` called once, if the GPU fails; the reference draws from then on.
    #[must_use]
    pub fn on_loss(self, tell: impl FnMut(&GpuError) + Send + 'static) -> Self {
        Self { on_loss: Some(Box::new(tell)), ..self }
    }

    /// The adapter, with its driver.
    #[must_use]
    pub fn describe(&self) -> &str {
        &self.name
    }

    /// Why the GPU draws no more, if it failed.
    #[must_use]
    pub fn loss(&self) -> Option<&GpuError> {
        self.loss.as_ref()
    }

    /// Behaves as if the device were lost.
    pub fn lose(&mut self) {
        self.device.destroy();
    }

    fn failed(&self) -> Option<String> {
        self.failure.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn check(&self) -> Result<(), String> {
        self.failed().map_or(Ok(()), Err)
    }

    fn draw(&mut self, scene: &Scene, shots: &mut [Shot<'_>]) -> Result<(), String> {
        let stage = Stage::new(scene);
        let mut wanted: Vec<&mut Shot<'_>> = shots.iter_mut().filter(|shot| shot.camera.pixels() > 0).collect();
        wanted.retain_mut(|shot| {
            let fits = shot.camera.width.max(shot.camera.height) <= self.most_side / 64 * 64;
            if !fits {
                self.reference.render(scene, &shot.camera, &mut shot.planes);
            }
            fits
        });
        let mask = wanted.iter().fold(Mask::default(), |mask, shot| mask_of(mask, stage, shot));
        if mask == Mask::default() {
            return Ok(());
        }
        let plan = self.geometry.begin(&self.device, &self.queue, stage);
        if mask.has(COLOR) {
            self.lighting.update(&self.device, &self.queue, stage);
        }
        let cameras: Vec<&Camera> = wanted.iter().map(|shot| &shot.camera).collect();
        let culled = cull(stage, &cameras, self.threads);
        let (things, pieces) = stage.things();
        for seen in culled.iter().flat_map(|(_, seen)| seen) {
            if let Some(model) = things[seen.thing as usize].model {
                self.geometry.need(&self.device, &self.queue, stage, model, seen.level);
            }
        }
        let told: Vec<work::Piece> = pieces.iter().map(work::Piece::new).collect();
        self.upload(1, &told);
        let sizes: Vec<[u32; 2]> = cameras.iter().map(|camera| [camera.width, camera.height]).collect();
        for atlas in atlas::pack(&sizes, self.most_side, self.most_pixels) {
            let range = atlas.first..atlas.first + atlas.tiles.len();
            self.work.clear();
            let office = Office { geometry: &self.geometry, plan, things: &things, pieces: &pieces };
            for (tile, number) in atlas.tiles.iter().zip(range.clone()) {
                let (sight, seen) = &culled[number];
                let camera = work::Camera::new(sight, *tile, sizes[number]);
                self.work.add(&office, camera, seen);
            }
            self.draw_atlas(scene, &atlas, &sizes[range.clone()], mask, &mut wanted[range])?;
        }
        Ok(())
    }

    /// Overwrites one of the uploads.
    fn upload<T: bytemuck::NoUninit>(&mut self, which: usize, values: &[T]) {
        self.uploads[which].clear();
        self.uploads[which].push(&self.device, &self.queue, values);
    }

    fn draw_atlas(
        &mut self,
        scene: &Scene,
        atlas: &Atlas,
        sizes: &[[u32; 2]],
        mask: Mask,
        shots: &mut [&mut Shot<'_>],
    ) -> Result<(), String> {
        let work = std::mem::take(&mut self.work);
        self.upload(0, &work.cameras);
        self.upload(2, &work.draws);
        self.upload(3, &work.arguments);
        let target = self.target(atlas.size, mask);
        self.submit(atlas, sizes, &work, target);
        self.work = work;
        self.check()?;
        let targets = &self.targets[target];
        let staging = &targets.staging;
        let mapped = Arc::new(Mutex::new(None));
        let tell = Arc::clone(&mapped);
        staging.slice(..).map_async(MapMode::Read, move |result| {
            *tell.lock().unwrap_or_else(PoisonError::into_inner) = Some(result);
        });
        self.device.poll(PollType::wait_indefinitely()).map_err(|error| error.to_string())?;
        match mapped.lock().unwrap_or_else(PoisonError::into_inner).take() {
            Some(Ok(())) => {}
            _ => return Err(self.failed().unwrap_or_else(|| "its memory cannot be read".to_owned())),
        }
        let bytes = staging.slice(..).get_mapped_range().map_err(|error| error.to_string())?;
        let drawn = Drawn { targets, bytes: &bytes, stride: atlas.size[0] as usize };
        drawn.copy_all(&atlas.tiles, shots, self.threads);
        for (tile, shot) in atlas.tiles.iter().zip(shots) {
            if shot.camera.for_people
                && let Some(color) = shot.planes.color.as_deref_mut()
            {
                let width = shot.camera.width as usize;
                self.facets.resize(color.len() / 4, 0);
                drawn.copy(FACETS, *tile, width, bytemuck::cast_slice_mut(&mut self.facets));
                self.ids.resize(color.len() / 4, 0);
                if mask.has(IDS) {
                    drawn.copy(IDS, *tile, width, bytemuck::cast_slice_mut(&mut self.ids));
                }
                self.for_people.finish(scene, color, &self.facets, &self.ids, width);
            }
        }
        drop(bytes);
        staging.unmap();
        self.check()
    }

    /// Which of the targets has this size.
    fn target(&mut self, size: [u32; 2], mask: Mask) -> usize {
        let found = self.targets.iter().position(|known| known.size == size && known.mask == mask);
        if let Some(found) = found {
            // The one used last stands last.
            let targets = self.targets.remove(found);
            self.targets.push(targets);
        } else {
            if self.targets.len() >= MOST_TARGETS {
                self.targets.remove(0);
            }
            self.targets.push(Targets::new(&self.device, size, mask));
        }
        self.targets.len() - 1
    }

    fn submit(&mut self, atlas: &Atlas, sizes: &[[u32; 2]], work: &Work, target: usize) {
        let targets = &self.targets[target];
        self.shading.prepare(&self.device, targets.mask);
        let Some(pipelines) = self.shading.pipelines(targets.mask) else { return };
        let [cameras, pieces, draws, arguments] = self.uploads.each_ref().map(Arena::buffer);
        let bound = self.shading.bind(&self.device, [cameras, pieces, draws], &self.geometry, &self.lighting);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
            label: Some("pictures"),
            color_attachments: &targets.attachments(f64::from(FAR_M)),
            depth_stencil_attachment: Some(RenderPassDepthStencilAttachment {
                view: &targets.depth,
                depth_ops: Some(Operations { load: LoadOp::Clear(backend::NEAR_M / FAR_M), store: StoreOp::Discard }),
                stencil_ops: None,
            }),
            ..RenderPassDescriptor::default()
        });
        pass.set_bind_group(0, &bound, &[]);
        pass.set_vertex_buffer(0, self.geometry.vertices.buffer().slice(..));
        pass.set_index_buffer(self.geometry.indices.buffer().slice(..), IndexFormat::Uint32);
        let look = |pass: &mut wgpu::RenderPass<'_>, camera: usize| {
            let ([x, y], [width, height]) = (atlas.tiles[camera], sizes[camera]);
            pass.set_viewport(x as f32, y as f32, width as f32, height as f32, 0.0, 1.0);
            pass.set_scissor_rect(x, y, width, height);
        };
        pass.set_pipeline(&pipelines.solid);
        for (camera, range) in work.solid.iter().enumerate() {
            look(&mut pass, camera);
            self.issue(&mut pass, work, arguments, range.clone());
        }
        if let Some(sky) = &pipelines.sky {
            pass.set_pipeline(sky);
            for camera in 0..work.solid.len() {
                look(&mut pass, camera);
                pass.draw(0..3, camera as u32..camera as u32 + 1);
            }
        }
        for run in &work.veils {
            let pipeline = match run.veil {
                Veil::Clear => Some(&pipelines.clear),
                Veil::Airy => pipelines.airy.as_ref(),
            };
            let Some(pipeline) = pipeline else { continue };
            pass.set_pipeline(pipeline);
            look(&mut pass, run.camera as usize);
            self.issue(&mut pass, work, arguments, run.draws.clone());
        }
        drop(pass);
        targets.read_back(&mut encoder);
        self.queue.submit([encoder.finish()]);
    }

    fn issue(&self, pass: &mut wgpu::RenderPass<'_>, work: &Work, arguments: &Buffer, range: core::ops::Range<u32>) {
        if range.is_empty() {
            return;
        }
        if self.indirect {
            let offset = u64::from(range.start) * size_of::<work::Arguments>() as u64;
            pass.multi_draw_indexed_indirect(arguments, offset, range.end - range.start);
            return;
        }
        for own in &work.arguments[range.start as usize..range.end as usize] {
            let indices = own.first_index..own.first_index + own.index_count;
            pass.draw_indexed(indices, own.base_vertex, own.first_instance..own.first_instance + 1);
        }
    }
}

/// What has to be drawn for one more picture.
fn mask_of(mask: Mask, stage: Stage<'_>, shot: &Shot<'_>) -> Mask {
    let planes = &shot.planes;
    let finished = shot.camera.for_people && planes.color.is_some();
    mask.with(COLOR, planes.color.is_some())
        .with(DEPTH, planes.depth_m.is_some())
        .with(NORMALS, planes.normals.is_some())
        .with(IDS, planes.ids.is_some() || finished && stage.has_highlights())
        .with(FACETS, finished)
}

/// What each camera sees.
fn cull(stage: Stage<'_>, cameras: &[&Camera], threads: usize) -> Vec<Culled> {
    if threads <= 1 || cameras.len() < WORTH_THREADS {
        return cameras.iter().map(|camera| stage.seen(camera)).collect();
    }
    let share = cameras.len().div_ceil(threads);
    std::thread::scope(|scope| {
        let work = |cameras: &[&Camera]| cameras.iter().map(|camera| stage.seen(camera)).collect::<Vec<_>>();
        let workers: Vec<_> = cameras.chunks(share).map(|cameras| scope.spawn(move || work(cameras))).collect();
        workers.into_iter().flat_map(|worker| worker.join().expect("invariant: culling never panics")).collect()
    })
}

/// An atlas that was read back.
#[derive(Clone, Copy)]
struct Drawn<'a> {
    targets: &'a Targets,
    bytes: &'a [u8],
    /// Pixels from row to row.
    stride: usize,
}

impl Drawn<'_> {
    /// Copies one target's part of the atlas.
    fn copy(self, target: usize, [x, y]: [u32; 2], width: usize, out: &mut [u8]) {
        let first = self.targets.offset(target) + (y as usize * self.stride + x as usize) * 4;
        for (row, out) in out.chunks_mut(width * 4).enumerate() {
            let from = first + row * self.stride * 4;
            out.copy_from_slice(&self.bytes[from..from + out.len()]);
        }
    }

    fn copy_planes(self, tile: [u32; 2], shot: &mut Shot<'_>) {
        let width = shot.camera.width as usize;
        let Planes { color, depth_m, normals, ids, .. } = &mut shot.planes;
        if let Some(color) = color {
            self.copy(COLOR, tile, width, color);
        }
        if let Some(depth_m) = depth_m {
            self.copy(DEPTH, tile, width, bytemuck::cast_slice_mut(depth_m));
        }
        if let Some(normals) = normals {
            self.copy(NORMALS, tile, width, bytemuck::cast_slice_mut(normals));
        }
        if let Some(ids) = ids {
            self.copy(IDS, tile, width, bytemuck::cast_slice_mut(ids));
        }
    }

    fn copy_all(self, tiles: &[[u32; 2]], shots: &mut [&mut Shot<'_>], threads: usize) {
        let copy = |tiles: &[[u32; 2]], shots: &mut [&mut Shot<'_>]| {
            for (tile, shot) in tiles.iter().zip(shots) {
                self.copy_planes(*tile, shot);
            }
        };
        if threads <= 1 || shots.len() < WORTH_THREADS {
            copy(tiles, shots);
            return;
        }
        let share = shots.len().div_ceil(threads);
        std::thread::scope(|scope| {
            for (tiles, shots) in tiles.chunks(share).zip(shots.chunks_mut(share)) {
                scope.spawn(move || copy(tiles, shots));
            }
        });
    }
}

impl Renderer for GpuRenderer {
    fn render(&mut self, scene: &Scene, camera: &Camera, planes: &mut Planes<'_>) {
        let planes = Planes {
            color: planes.color.as_deref_mut(),
            depth_m: planes.depth_m.as_deref_mut(),
            normals: planes.normals.as_deref_mut(),
            ids: planes.ids.as_deref_mut(),
        };
        self.render_all(scene, &mut [Shot { camera: *camera, planes }]);
    }

    fn render_all(&mut self, scene: &Scene, shots: &mut [Shot<'_>]) {
        for shot in &*shots {
            shot.planes.check_lengths(shot.camera.pixels());
        }
        if self.loss.is_none()
            && let Err(reason) = self.draw(scene, shots)
        {
            let loss = GpuError::Lost { adapter: self.name.clone(), reason };
            if let Some(tell) = &mut self.on_loss {
                tell(&loss);
            }
            self.loss = Some(loss);
        }
        if self.loss.is_some() {
            self.reference.render_all(scene, shots);
        }
    }
}
