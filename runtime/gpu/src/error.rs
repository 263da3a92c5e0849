//! Why a GPU cannot be used.

/// Why a GPU cannot be used; fits "failed to use a GPU: …".
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GpuError {
    /// No adapter is of the wanted kind.
    #[error(
        "looked for {wanted} through Vulkan, found {found}; install the Vulkan driver of the GPU (for a driver in \
         software: Mesa's lavapipe, `mesa-vulkan-drivers` on Debian and Ubuntu)"
    )]
    NoAdapter {
        /// What was looked for.
        wanted: &'static str,
        /// What there is.
        found: String,
    },
    /// The adapter gives no device.
    #[error("{adapter} gives no device: {reason}; update its driver")]
    NoDevice {
        /// The adapter.
        adapter: String,
        /// What the driver says.
        reason: String,
    },
    /// The device stopped working, or refused what it was told.
    #[error("{adapter} failed: {reason}")]
    Lost {
        /// The adapter.
        adapter: String,
        /// What the driver says.
        reason: String,
    },
}
