//! Finding a GPU.

use wgpu::{Backends, DeviceType, InstanceDescriptor, InstanceFlags};

use crate::GpuError;

/// What counts as a GPU.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Wanted {
    /// A discrete or an integrated one.
    Real,
    /// Also a driver in software, which is slower than the renderer on the CPU.
    Any,
}

impl Wanted {
    fn text(self) -> &'static str {
        match self {
            Self::Real => "a discrete or integrated GPU",
            Self::Any => "a GPU, or a driver in software",
        }
    }

    /// The better, the greater; nothing if it does not count.
    fn rank(self, kind: DeviceType) -> Option<u8> {
        match (kind, self) {
            (DeviceType::DiscreteGpu, _) => Some(4),
            (DeviceType::IntegratedGpu, _) => Some(3),
            (DeviceType::VirtualGpu, Self::Any) => Some(2),
            (DeviceType::Other, Self::Any) => Some(1),
            (DeviceType::Cpu, Self::Any) => Some(0),
            (_, Self::Real) => None,
        }
    }
}

/// A GPU that can be used.
#[derive(Clone, Debug)]
pub struct Adapter {
    pub(crate) inner: wgpu::Adapter,
}

impl Adapter {
    /// The best one of the wanted kind.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`].
    pub fn find(wanted: Wanted) -> Result<Self, GpuError> {
        if wanted == Wanted::Real && !has_device_node() {
            return Err(GpuError::NoAdapter { wanted: wanted.text(), found: "no GPU under /dev".to_owned() });
        }
        let mut descriptor = InstanceDescriptor::new_without_display_handle();
        descriptor.backends = Backends::VULKAN;
        // What is drawn indirectly is written by this crate alone, and never out of bounds.
        descriptor.flags = InstanceFlags::empty();
        let instance = wgpu::Instance::new(descriptor);
        let all = pollster::block_on(instance.enumerate_adapters(Backends::VULKAN));
        let found =
            if all.is_empty() { "none".to_owned() } else { all.iter().map(describe).collect::<Vec<_>>().join(", ") };
        let ranked = all.into_iter().filter_map(|inner| Some((wanted.rank(inner.get_info().device_type)?, inner)));
        // Of equal ones the driver's first.
        let best = ranked.reduce(|best, next| if next.0 > best.0 { next } else { best });
        let (_, inner) = best.ok_or(GpuError::NoAdapter { wanted: wanted.text(), found })?;
        Ok(Self { inner })
    }

    /// Its name, its kind, and its driver with the version.
    #[must_use]
    pub fn describe(&self) -> String {
        describe(&self.inner)
    }

    /// Whether it is a driver in software.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.inner.get_info().device_type == DeviceType::Cpu
    }
}

/// Whether the kernel knows of a GPU. Asked first, because loading drivers takes a while, and one in software ends the
/// whole program on processors that it does not know.
fn has_device_node() -> bool {
    if !cfg!(target_os = "linux") {
        return true;
    }
    const NAMES: [&str; 4] = ["renderD", "nvidia", "dxg", "kgsl"];
    let is_gpu = |name: &std::ffi::OsStr| NAMES.iter().any(|known| name.to_string_lossy().starts_with(known));
    let folders = ["/dev", "/dev/dri"].into_iter().filter_map(|folder| std::fs::read_dir(folder).ok());
    folders.flatten().flatten().any(|entry| is_gpu(&entry.file_name()))
}

fn describe(adapter: &wgpu::Adapter) -> String {
    let info = adapter.get_info();
    let kind = match info.device_type {
        DeviceType::DiscreteGpu => "discrete",
        DeviceType::IntegratedGpu => "integrated",
        DeviceType::VirtualGpu => "virtual",
        DeviceType::Cpu => "in software",
        DeviceType::Other => "of unknown kind",
    };
    format!("{} ({kind}, {} {})", info.name, info.driver, info.driver_info)
}
