//! Which renderer draws, and with how many threads.

use std::{ffi::OsString, fmt};

use clap::ValueEnum;
use cohabit_gpu::{Adapter, GpuError, GpuRenderer, Wanted};
use cohabit_render::{CpuRenderer, Renderer};

use crate::failure::bad_input;

/// The renderers to choose from.
#[derive(Clone, Copy, Debug, Eq, PartialEq, ValueEnum)]
pub enum Choice {
    /// The GPU where there is a discrete or integrated one, otherwise the CPU
    Auto,
    /// The reference, which needs nothing
    Cpu,
    /// A GPU, or a Vulkan driver in software
    Gpu,
}

impl fmt::Display for Rendering {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [_, name, ..] = self.arguments();
        f.write_str(&name.to_string_lossy())
    }
}

/// What draws.
#[derive(clap::Args, Clone, Copy, Debug)]
pub struct Rendering {
    /// What draws
    #[arg(long, value_enum, default_value = "auto")]
    renderer: Choice,
    /// Threads that render
    #[arg(long, default_value_t = 2)]
    threads: usize,
}

impl Rendering {
    /// The same choice as arguments of another process.
    pub fn arguments(self) -> [OsString; 4] {
        let name = match self.renderer {
            Choice::Auto => "auto",
            Choice::Cpu => "cpu",
            Choice::Gpu => "gpu",
        };
        ["--renderer".into(), name.into(), "--threads".into(), self.threads.to_string().into()]
    }

    /// Fails early if a GPU is asked for and there is none.
    pub fn check(self) -> anyhow::Result<()> {
        match self.renderer {
            Choice::Gpu => Adapter::find(Wanted::Any).map(drop).map_err(none),
            Choice::Auto | Choice::Cpu => Ok(()),
        }
    }

    /// The renderer; says on standard error which GPU it uses, if any.
    pub fn start(self) -> anyhow::Result<Box<dyn Renderer>> {
        match self.renderer {
            Choice::Cpu => Ok(self.on_cpu()),
            Choice::Gpu => Ok(Box::new(self.on_gpu(Wanted::Any).map_err(none)?)),
            Choice::Auto => match self.on_gpu(Wanted::Real) {
                Ok(renderer) => Ok(Box::new(renderer)),
                // The ordinary case: nothing to tell.
                Err(GpuError::NoAdapter { .. }) => Ok(self.on_cpu()),
                Err(error) => {
                    eprintln!("cohabit: drawing on the CPU, because the GPU cannot be used: {error}");
                    Ok(self.on_cpu())
                }
            },
        }
    }

    fn on_cpu(self) -> Box<dyn Renderer> {
        Box::new(CpuRenderer::new(self.threads))
    }

    fn on_gpu(self, wanted: Wanted) -> Result<GpuRenderer, GpuError> {
        let adapter = Adapter::find(wanted)?;
        let renderer = GpuRenderer::new(&adapter, self.threads)?;
        let note = if adapter.is_software() { ", a driver in software: `--renderer cpu` is faster" } else { "" };
        eprintln!("cohabit: drawing on {}{note}", renderer.describe());
        Ok(renderer.on_loss(|loss| eprintln!("cohabit: drawing on the CPU from now on: {loss}")))
    }
}

fn none(error: GpuError) -> anyhow::Error {
    bad_input(format!("`--renderer gpu`: {error}; or leave the choice to `--renderer auto`"))
}
