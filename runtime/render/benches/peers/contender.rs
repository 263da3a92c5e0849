//! What is measured: a renderer that draws a frame from each camera of the stage.

use std::fs;
use std::io::{self, BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout};
use std::time::Instant;

use cohabit_render::{Camera, Renderer, Scene};
use rustix::time::ClockId;

use crate::buffers::Buffers;
use crate::machine::cpu_time;
use crate::stage::Stage;

/// Frames drawn before any is measured, to find warm caches after others were at work.
const WARM_UP_FRAMES: usize = 2;

/// A kind of picture.
pub struct Kind {
    /// Columns and rows.
    pub size: [u32; 2],
    /// All modalities that a contender has; otherwise colour alone.
    pub all: bool,
}

/// What one frame took.
#[derive(Clone, Copy)]
pub struct Frame {
    /// Processor time of all threads, ms.
    pub cpu_ms: f64,
    /// Time on the wall, ms.
    pub wall_ms: f64,
}

/// A renderer.
pub trait Contender {
    /// Its name and version.
    fn name(&self) -> &str;

    /// How many triangles the whole scene has for it.
    fn triangles(&self) -> usize;

    /// What it delivers when all is wanted.
    fn modalities(&self) -> &'static str;

    /// A frame from each camera in turn. With a folder, each is kept there as `NAME-CAMERA.raw`: all colours as three bytes,
    /// all depths as floats, all objects by their places on the stage as integers, -1 for none.
    fn draw_all(&mut self, kind: &Kind, keep: Option<&Path>) -> io::Result<Vec<Frame>>;
}

/// A renderer of this project.
pub struct Own<'a> {
    pub name: String,
    pub renderer: Box<dyn Renderer>,
    pub scene: &'a Scene,
    pub cameras: Vec<Camera>,
    /// The same things as others draw them.
    pub stage: &'a Stage,
}

impl Contender for Own<'_> {
    fn name(&self) -> &str {
        &self.name
    }

    fn triangles(&self) -> usize {
        self.stage.triangles
    }

    fn modalities(&self) -> &'static str {
        "colour, depth, normals, ids"
    }

    fn draw_all(&mut self, kind: &Kind, keep: Option<&Path>) -> io::Result<Vec<Frame>> {
        let [width, height] = kind.size;
        let mut buffers = Buffers::new((width * height) as usize);
        let mut frame = |camera: &Camera, buffers: &mut Buffers| {
            let camera = Camera { width, height, ..*camera };
            let (wall, cpu) = (Instant::now(), cpu_time(ClockId::ProcessCPUTime));
            self.renderer.render(self.scene, &camera, &mut buffers.planes(kind.all));
            let cpu_ms = (cpu_time(ClockId::ProcessCPUTime) - cpu).as_secs_f64() * 1e3;
            Frame { cpu_ms, wall_ms: wall.elapsed().as_secs_f64() * 1e3 }
        };
        for camera in self.cameras.iter().cycle().take(WARM_UP_FRAMES) {
            frame(camera, &mut buffers);
        }
        let mut frames = Vec::new();
        for (index, camera) in self.cameras.iter().enumerate() {
            frames.push(frame(camera, &mut buffers));
            let Some(folder) = keep else { continue };
            let mut raw: Vec<u8> = buffers.color.chunks(4).flat_map(|pixel| &pixel[..3]).copied().collect();
            raw.extend(buffers.depth_m.iter().flat_map(|depth| depth.to_le_bytes()));
            let place = |id: &u32| self.stage.ids.iter().position(|known| known == id).map_or(-1, |place| place as i32);
            raw.extend(buffers.ids.iter().flat_map(|id| place(id).to_le_bytes()));
            fs::write(folder.join(format!("{}-{index}.raw", short(&self.name))), raw)?;
        }
        Ok(frames)
    }
}

/// A name without its version.
pub fn short(name: &str) -> &str {
    name.split(' ').next().unwrap_or_default()
}

/// A process that draws what it is told to, line by line: see `stage.py`.
pub struct Peer {
    name: String,
    triangles: usize,
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
}

impl Peer {
    /// Waits until the process is ready.
    pub fn new(mut child: Child, triangles: usize) -> io::Result<Self> {
        let (Some(input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(io::Error::other("its input and output must be pipes"));
        };
        let mut peer = Self { name: String::new(), triangles, child, input, output: BufReader::new(output) };
        peer.name = peer.answer("ready ")?;
        Ok(peer)
    }

    /// The rest of the next line that begins so; libraries write lines of their own.
    fn answer(&mut self, begin: &str) -> io::Result<String> {
        let mut line = String::new();
        while self.output.read_line(&mut line)? > 0 {
            if let Some(rest) = line.strip_prefix(begin) {
                return Ok(rest.trim().to_owned());
            }
            line.clear();
        }
        Err(io::Error::other("it has ended"))
    }
}

impl Contender for Peer {
    fn name(&self) -> &str {
        &self.name
    }

    fn triangles(&self) -> usize {
        self.triangles
    }

    fn modalities(&self) -> &'static str {
        "colour, depth, ids"
    }

    fn draw_all(&mut self, kind: &Kind, keep: Option<&Path>) -> io::Result<Vec<Frame>> {
        let ([width, height], what) = (kind.size, if kind.all { "all" } else { "color" });
        let folder = keep.map_or_else(String::new, |folder| folder.display().to_string());
        writeln!(self.input, "{width} {height} {what} {folder}")?;
        let line = self.answer("times ")?;
        let times: Vec<f64> = line.split(' ').filter_map(|time| time.parse().ok()).collect();
        Ok(times.as_chunks().0.iter().map(|[cpu_ms, wall_ms]| Frame { cpu_ms: *cpu_ms, wall_ms: *wall_ms }).collect())
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
