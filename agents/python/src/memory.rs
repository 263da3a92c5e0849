//! Memory that numpy views without a copy, and cannot write to.

use std::sync::{Arc, Mutex, PoisonError};

use cohabit_bus::Sample;
use pyo3::{prelude::*, sync::PyOnceLock, types::PyDict};

/// Who keeps memory alive. Where its bytes lie does not change while it lives.
#[derive(Clone)]
pub enum Owner {
    /// A message, perhaps in memory that other processes see too.
    Sample(Arc<Mutex<Sample>>),
    /// This process alone.
    Bytes(Arc<[u64]>),
    /// This process alone, which uses it anew once nobody else refers to it.
    Page(Arc<Vec<u64>>),
}

/// Some memory with a shape, kept alive by whoever refers to this.
///
/// It speaks numpy's array interface, and says there that it is read-only. It has no buffer interface, so numpy finds
/// nobody who would let it write.
#[pyclass(frozen, module = "cohabit._native")]
pub struct Memory {
    owner: Owner,
    /// Where it begins in the owner's bytes.
    from: usize,
    shape: Vec<usize>,
    /// The type of an item, as numpy writes it: `<f4`.
    item: &'static str,
}

impl Owner {
    /// Looks at the bytes.
    pub fn with<T>(&self, look: impl FnOnce(&[u8]) -> T) -> T {
        match self {
            Self::Sample(sample) => look(sample.lock().unwrap_or_else(PoisonError::into_inner).payload()),
            Self::Bytes(words) => look(bytemuck::cast_slice(words)),
            Self::Page(words) => look(bytemuck::cast_slice(words.as_slice())),
        }
    }
}

impl Memory {
    /// A numpy array over `shape` items of type `item` that begin `from` bytes into the owner's.
    ///
    /// # Errors
    /// When numpy cannot be imported.
    pub fn array<'py>(
        py: Python<'py>,
        owner: &Owner,
        from: usize,
        shape: Vec<usize>,
        item: &'static str,
    ) -> PyResult<Bound<'py, PyAny>> {
        static ASARRAY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
        let as_array = ASARRAY.import(py, "numpy", "asarray")?;
        as_array.call1((Self { owner: owner.clone(), from, shape, item },))
    }

    /// The same over records that belong to this process alone.
    ///
    /// # Errors
    /// As [`Self::array`].
    pub fn array_of<'py, T: bytemuck::NoUninit>(
        py: Python<'py>,
        items: &[T],
        shape: Vec<usize>,
        item: &'static str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let bytes: &[u8] = bytemuck::cast_slice(items);
        let mut words = vec![0_u64; bytes.len().div_ceil(size_of::<u64>())];
        bytemuck::cast_slice_mut(&mut words)[..bytes.len()].copy_from_slice(bytes);
        Self::array(py, &Owner::Bytes(words.into()), 0, shape, item)
    }
}

#[pymethods]
impl Memory {
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let address = self.owner.with(|bytes| bytes[self.from..].as_ptr() as usize);
        let interface = PyDict::new(py);
        interface.set_item("version", 3)?;
        interface.set_item("shape", pyo3::types::PyTuple::new(py, &self.shape)?)?;
        interface.set_item("typestr", self.item)?;
        interface.set_item("data", (address, true))?;
        Ok(interface)
    }
}
