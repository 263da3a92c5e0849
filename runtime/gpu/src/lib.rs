//! The renderer for machines with a GPU: the pictures of [`cohabit_render`], drawn by wgpu.
//!
//! [`GpuRenderer`] draws what [`cohabit_render::CpuRenderer`], the reference, draws: the same ids but for pixels on
//! edges, the same depth, normals and colours but for rounding. It never decides what there is to see, knows no rules and
//! no clock. Having no GPU is an ordinary case: [`GpuRenderer::new`] says what it looked for and what it found; a GPU that
//! is lost later is replaced by the reference.
//!
//! [`Renderer::render_all`](cohabit_render::Renderer::render_all) draws all its pictures into one atlas, in one
//! submission with one read-back: the more at once, the cheaper each.

mod adapter;
mod arena;
mod atlas;
mod error;
mod geometry;
mod light;
mod pipeline;
mod renderer;
mod targets;
mod work;

pub use adapter::{Adapter, Wanted};
pub use error::GpuError;
pub use renderer::GpuRenderer;
