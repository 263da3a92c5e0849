//! Buffers on the GPU that grow.

use wgpu::{Buffer, BufferDescriptor, BufferUsages, Device, Queue};

/// Values one after another in a buffer that grows as needed.
#[derive(Debug)]
pub(crate) struct Arena {
    label: &'static str,
    usage: BufferUsages,
    buffer: Buffer,
    /// Bytes in use.
    used: u64,
}

/// Bytes to begin with.
const FIRST: u64 = 1 << 16;

impl Arena {
    pub(crate) fn new(device: &Device, label: &'static str, usage: BufferUsages) -> Self {
        let usage = usage | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
        Self { label, usage, buffer: make(device, label, usage, FIRST), used: 0 }
    }

    /// Appends values; returns how many of the same kind stand before them.
    pub(crate) fn push<T: bytemuck::NoUninit>(&mut self, device: &Device, queue: &Queue, values: &[T]) -> u32 {
        let bytes: &[u8] = bytemuck::cast_slice(values);
        let first = self.used;
        let needed = first + bytes.len() as u64;
        if needed > self.buffer.size() {
            let larger = make(device, self.label, self.usage, needed.next_power_of_two());
            let mut encoder = device.create_command_encoder(&Default::default());
            encoder.copy_buffer_to_buffer(&self.buffer, 0, &larger, 0, first);
            queue.submit([encoder.finish()]);
            self.buffer = larger;
        }
        if !bytes.is_empty() {
            queue.write_buffer(&self.buffer, first, bytes);
        }
        self.used = needed;
        (first / size_of::<T>() as u64) as u32
    }

    /// Forgets all values.
    pub(crate) fn clear(&mut self) {
        self.used = 0;
    }

    pub(crate) fn buffer(&self) -> &Buffer {
        &self.buffer
    }
}

fn make(device: &Device, label: &str, usage: BufferUsages, size: u64) -> Buffer {
    device.create_buffer(&BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
}
