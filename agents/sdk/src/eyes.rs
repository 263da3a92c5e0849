//! What a body's cameras show: pictures as they lie in shared memory, and the things in them by name.

use std::sync::Arc;

use cohabit_bus::{
    CameraId, Sample, Subscriber, Topic, Transport,
    message::{BodyRecord, FrameView, Malformed, ObjectRecord, StateView, Thing},
};
use cohabit_cdf::{BodyId, Catalog, ObjectId, SemanticClass};

use crate::error::PeerError;

/// A camera that is looked through; while it lives, its frames are rendered.
pub struct Eyes {
    frames: Box<dyn Subscriber>,
    catalog: Arc<Catalog>,
}

/// One frame of it.
pub struct Glance {
    sample: Sample,
    catalog: Arc<Catalog>,
}

/// A thing that is seen in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenThing<'a> {
    /// Its id in the id plane.
    pub id: u32,
    /// The object or body behind the id.
    pub thing: Thing,
    /// What kind of thing it is.
    pub class: SemanticClass,
    /// What people call things of its kind.
    pub name: &'a str,
    /// The picture: 0, or up to 3 of a panorama.
    pub view: u16,
    /// Pixels that show it.
    pub pixels: u32,
    /// `[left, top, right, bottom]` around them: the first column and row, and those after the last.
    pub bounds: [u16; 4],
}

/// What an agent sees: a picture, and what there is to know of the things in it, and of nothing else.
#[derive(Clone, Copy, Debug)]
pub struct Sight<'a> {
    glance: &'a Glance,
    state: StateView<'a>,
}

/// A thing in view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InView<'a> {
    /// What and where in the picture.
    pub seen: SeenThing<'a>,
    /// What there is to know of it, if it is an object.
    pub object: Option<&'a ObjectRecord>,
    /// The same, if it is somebody.
    pub body: Option<&'a BodyRecord>,
}

impl<'a> Sight<'a> {
    pub(crate) const fn new(glance: &'a Glance, state: StateView<'a>) -> Self {
        Self { glance, state }
    }

    /// The picture.
    #[must_use]
    pub const fn glance(&self) -> &'a Glance {
        self.glance
    }

    /// The things in view, by picture, then by id.
    pub fn things(&self) -> impl Iterator<Item = InView<'a>> + use<'a> {
        let StateView { objects, bodies, .. } = self.state;
        self.glance.things().map(move |seen| {
            let object = objects.iter().find(|object| seen.thing == Thing::Object(ObjectId(object.object)));
            let body = bodies.iter().find(|body| seen.thing == Thing::Body(BodyId(body.body)));
            InView { seen, object, body }
        })
    }
}

impl Eyes {
    /// Looks through a camera of the session on `bus`.
    ///
    /// # Errors
    /// [`PeerError::Bus`].
    pub fn open(bus: &dyn Transport, camera: CameraId, catalog: Arc<Catalog>) -> Result<Self, PeerError> {
        Ok(Self { frames: bus.subscriber(Topic::Frames(camera))?, catalog })
    }

    /// Looks through the egocentric camera of a body.
    ///
    /// # Errors
    /// [`PeerError::NoCamera`] if that body has none; [`PeerError::Bus`].
    pub fn of_body(bus: &dyn Transport, body: u32, catalog: Arc<Catalog>) -> Result<Self, PeerError> {
        let camera = u8::try_from(body).map(CameraId::Egocentric).map_err(|_| PeerError::NoCamera(body))?;
        Self::open(bus, camera, catalog)
    }

    /// The newest frame, if there is one that was not seen yet.
    ///
    /// # Errors
    /// [`PeerError`].
    pub fn look(&mut self) -> Result<Option<Glance>, PeerError> {
        let Some(sample) = self.frames.latest()? else { return Ok(None) };
        FrameView::new(sample.payload())?;
        Ok(Some(Glance { sample, catalog: Arc::clone(&self.catalog) }))
    }
}

impl std::fmt::Debug for Glance {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Glance").field("sample", &self.sample).finish_non_exhaustive()
    }
}

impl Glance {
    /// The tick at which the world was so.
    #[must_use]
    pub fn tick(&self) -> u64 {
        self.sample.envelope().tick
    }

    /// The pictures, viewed in place.
    ///
    /// # Errors
    /// [`Malformed`], if a peer has spoilt them meanwhile.
    pub fn frame(&self) -> Result<FrameView<'_>, Malformed> {
        FrameView::new(self.sample.payload())
    }

    /// What is seen, by picture, then by id.
    pub fn things(&self) -> impl Iterator<Item = SeenThing<'_>> {
        let records = self.frame().map_or(&[][..], |frame| frame.seen());
        records.iter().map(|record| {
            let class = SemanticClass::from_index(record.class);
            SeenThing {
                id: record.id,
                thing: Thing::of_id(record.id),
                class,
                name: class.name(&self.catalog),
                view: record.view,
                pixels: record.pixels,
                bounds: [record.left, record.top, record.right, record.bottom],
            }
        })
    }
}
