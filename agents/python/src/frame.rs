//! A camera's frame: planes that numpy views where they were rendered, and what is seen in them.

use std::sync::{Arc, Mutex};

use cohabit_bus::{
    Sample,
    message::{FrameView, Malformed, NONE, Plane, SeenRecord, Thing},
};
use cohabit_cdf::{Catalog, SemanticClass};
use pyo3::{
    exceptions::{PyAttributeError, PyKeyError},
    prelude::*,
};

use crate::{
    library::Library,
    memory::{Memory, Owner},
};

/// One frame. Its planes are views of the memory that the simulator rendered into, shared with everybody who looks:
/// they can be read for as long as anything refers to them, and never written.
#[pyclass(frozen, module = "cohabit._native")]
pub struct Frame {
    owner: Owner,
    library: Arc<Library>,
    tick: u64,
    header: cohabit_bus::message::FrameHeader,
    /// Where each plane begins in the payload.
    plane_at: [Option<usize>; 4],
}

/// Something that is seen in a frame.
#[pyclass(frozen, get_all, module = "cohabit._native")]
pub struct Seen {
    /// Its id in the id plane.
    pub id: u32,
    /// The object's number, if it is one.
    pub object: Option<u32>,
    /// The body's number, if it is one.
    pub body: Option<u32>,
    /// The id of its class in the catalogue, or what else it is: `robot`, `person`, `floor`, `wall`.
    pub class_id: String,
    /// What people call things of its kind.
    pub name: String,
    /// The picture: 0, or up to 3 of a panorama.
    pub view: u16,
    /// Pixels that show it.
    pub pixels: u32,
    /// `(left, top, right, bottom)` around them: the first column and row, and those after the last.
    pub bounds: (u16, u16, u16, u16),
}

#[pymethods]
impl Seen {
    fn __repr__(&self) -> String {
        format!("Seen(id={}, class_id={:?}, pixels={})", self.id, self.class_id, self.pixels)
    }
}

impl Frame {
    /// The frame in a message of a session.
    ///
    /// # Errors
    /// [`Malformed`].
    pub fn new(sample: Sample) -> Result<Self, Malformed> {
        Self::of(sample, Library::builtin())
    }

    /// The frame in a message about a world that is made of what a library has.
    ///
    /// # Errors
    /// [`Malformed`].
    pub fn of(sample: Sample, library: &Arc<Library>) -> Result<Self, Malformed> {
        let tick = sample.envelope().tick;
        let (header, plane_at) = {
            let view = FrameView::new(sample.payload())?;
            let start = sample.payload().as_ptr() as usize;
            let at = |plane| view.plane(plane).map(|bytes: &[u8]| bytes.as_ptr() as usize - start);
            (view.header, Plane::ALL.map(at))
        };
        let owner = Owner::Sample(Arc::new(Mutex::new(sample)));
        Ok(Self { owner, library: Arc::clone(library), tick, header, plane_at })
    }

    /// What is seen, by picture, then by id.
    pub fn records(&self) -> Vec<SeenRecord> {
        self.owner.with(|payload| FrameView::new(payload).map_or_else(|_| Vec::new(), |view| view.seen().to_vec()))
    }

    /// Copies a plane to where there is room for it, if the frame has that plane.
    pub fn copy_plane(&self, plane: Plane, to: &mut [u8]) {
        if let Some(at) = self.plane_at[plane as usize] {
            self.owner.with(|payload| to.copy_from_slice(&payload[at..at + to.len()]));
        }
    }

    fn array<'py>(&self, py: Python<'py>, plane: Plane) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(at) = self.plane_at[plane as usize] else { return Ok(None) };
        let (views, width, height) =
            (self.header.views as usize, self.header.width as usize, self.header.height as usize);
        let mut shape = if views == 1 { vec![height, width] } else { vec![views, height, width] };
        let item = item_of(plane);
        if matches!(plane, Plane::Color | Plane::Normals) {
            shape.push(4);
        }
        Memory::array(py, &self.owner, at, shape, item).map(Some)
    }

    fn attribute<'py>(&self, py: Python<'py>, plane: Plane) -> PyResult<Bound<'py, PyAny>> {
        let missing = || {
            let has = self.planes().join(", ");
            PyAttributeError::new_err(format!("this camera's frames have no plane `{}`; they have {has}", plane.name()))
        };
        self.array(py, plane)?.ok_or_else(missing)
    }
}

#[pymethods]
impl Frame {
    /// The tick at which the world was so.
    #[getter]
    const fn tick(&self) -> u64 {
        self.tick
    }

    /// Pixels across, of one picture.
    #[getter]
    const fn width(&self) -> u32 {
        self.header.width
    }

    /// Pixels down, of one picture.
    #[getter]
    const fn height(&self) -> u32 {
        self.header.height
    }

    /// Pictures: 1, or 4 of a panorama.
    #[getter]
    const fn views(&self) -> u32 {
        self.header.views
    }

    /// The body it belongs to, if to one.
    #[getter]
    fn body(&self) -> Option<u32> {
        (self.header.body != NONE).then_some(self.header.body)
    }

    /// The camera's place in the world, m.
    #[getter]
    fn position(&self) -> (f32, f32, f32) {
        self.header.position_m.into()
    }

    /// The camera's heading, rad, counter-clockwise from east; of a panorama that of the first picture.
    #[getter]
    const fn yaw_rad(&self) -> f32 {
        self.header.yaw_rad
    }

    /// The camera's pitch, rad, up positive.
    #[getter]
    const fn pitch_rad(&self) -> f32 {
        self.header.pitch_rad
    }

    /// The vertical field of view, rad.
    #[getter]
    const fn fov_y_rad(&self) -> f32 {
        self.header.fov_y_rad
    }

    /// When the world was so, ns of the monotonic clock (`time.monotonic_ns`).
    #[getter]
    const fn seen_nanos(&self) -> u64 {
        self.header.seen_nanos
    }

    /// The latest command that had begun to move a body by then; 0 is none.
    #[getter]
    const fn command(&self) -> u64 {
        self.header.command
    }

    /// The names of its planes.
    #[getter]
    fn planes(&self) -> Vec<&'static str> {
        Plane::ALL.into_iter().filter(|plane| self.plane_at[*plane as usize].is_some()).map(Plane::name).collect()
    }

    /// `[height, width, 4]` `u1`: red, green, blue, 255; `[4, …]` of a panorama.
    #[getter]
    fn color<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.attribute(py, Plane::Color)
    }

    /// `[height, width]` `f4`: metres along the camera's axis.
    #[getter]
    fn depth<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.attribute(py, Plane::Depth)
    }

    /// `[height, width, 4]` `i1`: the surface's normal in the world, times 127, and 0.
    #[getter]
    fn normals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.attribute(py, Plane::Normals)
    }

    /// `[height, width]` `u4`: whose pixel it is; 0 is nothing.
    #[getter]
    fn ids<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.attribute(py, Plane::Ids)
    }

    /// The plane of that name.
    fn __getitem__<'py>(&self, py: Python<'py>, plane: &str) -> PyResult<Bound<'py, PyAny>> {
        let known = Plane::ALL.into_iter().find(|known| known.name() == plane);
        let array = known.map_or(Ok(None), |plane| self.array(py, plane))?;
        array.ok_or_else(|| PyKeyError::new_err(format!("no plane `{plane}`; there are {}", self.planes().join(", "))))
    }

    /// What is seen, by picture, then by id; empty where the camera delivers no ids.
    #[getter]
    fn seen(&self) -> Vec<Seen> {
        self.records().iter().map(|record| Seen::new(record, self.library.catalog())).collect()
    }

    fn __repr__(&self) -> String {
        format!("Frame(tick={}, {}x{}, {})", self.tick, self.header.width, self.header.height, self.planes().join("+"))
    }
}

/// The type of an item of a plane, as numpy writes it.
pub const fn item_of(plane: Plane) -> &'static str {
    match plane {
        Plane::Color => "|u1",
        Plane::Depth => "<f4",
        Plane::Normals => "|i1",
        Plane::Ids => "<u4",
    }
}

impl Seen {
    fn new(record: &SeenRecord, catalog: &Catalog) -> Self {
        let class = SemanticClass::from_index(record.class);
        let name = class.name(catalog);
        let class_id = match class {
            SemanticClass::Object(id) => {
                catalog.classes().get(usize::from(id.0)).map_or(name, |class| class.id.as_str())
            }
            _ => name,
        };
        let (object, body) = match Thing::of_id(record.id) {
            Thing::Object(object) => (Some(object.0), None),
            Thing::Body(body) => (None, Some(body.0)),
            Thing::Surface(_) | Thing::Nothing => (None, None),
        };
        Self {
            id: record.id,
            object,
            body,
            class_id: class_id.to_owned(),
            name: name.to_owned(),
            view: record.view,
            pixels: record.pixels,
            bounds: (record.left, record.top, record.right, record.bottom),
        }
    }
}
