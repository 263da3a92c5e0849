//! The cameras of a session as data: what is asked for as text, such as `door=fixed,x=4,y=10,yaw=90`, and those that
//! every session has.

use std::{fmt, str::FromStr, time::Duration};

use cohabit_bus::{
    CameraId, CameraName, CameraNameError,
    message::{CameraKind, CameraRecord, NONE, Plane},
};
use cohabit_render::{Lens, LensError};

/// A camera: where it is, what it delivers, and how often.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPlan {
    /// Its name; frames come on `frames/<name>`.
    pub id: CameraId,
    /// Where it is and how it moves.
    pub mount: Mount,
    /// The size of a picture, and what it takes in; of one that looks down its mount says how much it takes in.
    pub lens: Lens,
    /// The planes of its frames, in the order of [`Plane::ALL`].
    pub planes: Vec<Plane>,
    /// Frames a second, at most.
    pub rate_hz: f32,
    /// Whether people look at its colours: highlights are outlined, edges smoothed.
    pub for_people: bool,
}

/// Where a camera is and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mount {
    /// In a body's head, turning with it.
    Head {
        /// Which body.
        body: u8,
    },
    /// The same, four pictures: ahead, to the right, back and to the left.
    Panorama {
        /// Which body.
        body: u8,
    },
    /// Behind a body, clear of walls and furniture.
    Behind {
        /// Which body.
        body: u8,
    },
    /// In one place.
    Fixed {
        /// In the world, m.
        at_m: [f32; 3],
        /// The way it looks, counter-clockwise from east.
        yaw_deg: f32,
        /// How far it looks up.
        pitch_deg: f32,
    },
    /// Above, north up, without ceilings.
    Above {
        /// The body that it follows; it looks at the whole plan if absent.
        body: Option<u8>,
        /// What it sees from south to north, m; all of the plan, or enough around a body, if absent.
        span_m: Option<f32>,
    },
}

/// Why a text asks for no camera.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CameraPlanError {
    /// It is not of the form expected.
    #[error("`{0}` is no camera: NAME=KIND, then options after commas, such as `door=fixed,x=4,y=10,yaw=90,fov=70`")]
    Form(String),
    /// Its name cannot be one.
    #[error(transparent)]
    Name(#[from] CameraNameError),
    /// There is no such kind.
    #[error("there is no kind of camera `{0}`: {known}", known = CameraKind::ALL.map(CameraKind::name).join(", "))]
    Kind(String),
    /// The kind has no such option, or it was given twice.
    #[error("`{option}`: not an option of a {kind} camera, or given twice; it has {known}", known = known.join(", "))]
    Option {
        /// The kind.
        kind: &'static str,
        /// What was given.
        option: String,
        /// What there is.
        known: Vec<&'static str>,
    },
    /// An option that the kind cannot do without is not there.
    #[error("a {kind} camera needs `{option}=`")]
    Missing {
        /// The kind.
        kind: &'static str,
        /// What is missing.
        option: &'static str,
    },
    /// An option's value is none.
    #[error("`{option}={value}`: {expected}")]
    Value {
        /// The option.
        option: String,
        /// What was given.
        value: String,
        /// What would be right.
        expected: &'static str,
    },
    /// Its picture is too large, too small, or takes in too much.
    #[error(transparent)]
    Lens(#[from] LensError),
}

/// Options of every kind.
const COMMON: [&str; 4] = ["size", "rate", "planes", "smooth"];
/// How far from the middle of the world a camera may be, m.
const FARTHEST_M: f32 = 1000.0;
/// What a camera above may see from south to north, m.
const SPAN_M: (f32, f32) = (1.0, 100.0);
/// Frames a second.
const RATE_HZ: (f32, f32) = (0.1, 60.0);
/// A fixed camera hangs so high, if nothing else is said, m.
const HANGS_M: f32 = 2.3;
/// And looks down so far, degrees.
const LOOKS_UP_DEG: f32 = -20.0;
/// The field of view of cameras for people, degrees.
const PEOPLE_FOV_DEG: f32 = 55.0;

impl CameraPlan {
    /// The cameras that every session has, of bodies numbered from 0: of each its eyes for its mind, its eyes for
    /// people, and one behind and one above it.
    pub fn of_bodies(bodies: usize) -> impl Iterator<Item = Self> {
        (0..=u8::MAX).take(bodies).flat_map(|body| {
            let eyes = Self::usual(CameraId::Eyes(body), Mount::Behind { body });
            [
                Self::usual(CameraId::Egocentric(body), Mount::Head { body }),
                Self { mount: Mount::Head { body }, ..eyes },
                Self::usual(CameraId::Spectator(body), Mount::Behind { body }),
                Self::usual(CameraId::Overhead(body), Mount::Above { body: Some(body), span_m: None }),
            ]
        })
    }

    /// A camera on that mount with what is usual there.
    #[must_use]
    pub fn usual(id: CameraId, mount: Mount) -> Self {
        let for_people = !matches!(mount, Mount::Head { .. } | Mount::Panorama { .. });
        let planes = if for_people { vec![Plane::Color, Plane::Ids] } else { Plane::ALL.to_vec() };
        let (size, fov_deg, rate_hz) = match mount {
            Mount::Head { .. } => ([300, 300], 60.0, 10.0),
            Mount::Panorama { .. } => ([300, 300], 100.0, 2.0),
            Mount::Behind { .. } | Mount::Fixed { .. } | Mount::Above { .. } => ([854, 480], PEOPLE_FOV_DEG, 30.0),
        };
        let lens = Lens::new(size[0], size[1], fov_deg).expect("invariant: usual sizes are within bounds");
        Self { id, mount, lens, planes, rate_hz, for_people }
    }

    /// The body that it belongs to.
    #[must_use]
    pub const fn body(&self) -> Option<u8> {
        match self.mount {
            Mount::Head { body } | Mount::Panorama { body } | Mount::Behind { body } => Some(body),
            Mount::Above { body, .. } => body,
            Mount::Fixed { .. } => None,
        }
    }

    /// What kind it is.
    #[must_use]
    pub const fn kind(&self) -> CameraKind {
        self.mount.kind()
    }

    /// The pictures of a frame.
    #[must_use]
    pub const fn views(&self) -> u32 {
        if matches!(self.mount, Mount::Panorama { .. }) { 4 } else { 1 }
    }

    /// The time between two frames.
    #[must_use]
    pub fn every(&self) -> Duration {
        Duration::from_secs_f32(1.0 / self.rate_hz)
    }

    /// What others are told of it.
    #[must_use]
    pub fn record(&self) -> CameraRecord {
        let [width, height] = self.lens.size();
        let planes = self.planes.iter().fold(0, |bits, plane| bits | 1 << *plane as u32);
        let body = self.body().map_or(NONE, u32::from);
        let mut record = CameraRecord::new(self.id, self.kind());
        (record.body, record.width, record.height) = (body, width, height);
        (record.views, record.planes) = (self.views(), planes);
        record
    }
}

impl Mount {
    const fn kind(self) -> CameraKind {
        match self {
            Self::Head { .. } => CameraKind::Egocentric,
            Self::Panorama { .. } => CameraKind::Panorama,
            Self::Behind { .. } => CameraKind::ThirdPerson,
            Self::Fixed { .. } => CameraKind::Fixed,
            Self::Above { .. } => CameraKind::TopDown,
        }
    }
}

/// Options as they were written, each taken out once.
struct Options<'a> {
    kind: CameraKind,
    given: Vec<(&'a str, &'a str)>,
}

impl<'a> Options<'a> {
    const fn own(kind: CameraKind) -> &'static [&'static str] {
        match kind {
            CameraKind::Egocentric | CameraKind::Panorama | CameraKind::ThirdPerson => &["body", "fov"],
            CameraKind::Fixed => &["x", "y", "z", "yaw", "pitch", "fov"],
            CameraKind::TopDown => &["body", "span"],
        }
    }

    fn read(kind: CameraKind, text: &'a str) -> Result<Self, CameraPlanError> {
        let known: Vec<&'static str> = Self::own(kind).iter().chain(&COMMON).copied().collect();
        let mut given: Vec<(&str, &str)> = Vec::new();
        for option in text.split(',').filter(|option| !option.is_empty()) {
            let (key, value) = option.split_once('=').unwrap_or((option, ""));
            let (key, value) = (key.trim(), value.trim());
            if !known.contains(&key) || given.iter().any(|(other, _)| *other == key) {
                return Err(CameraPlanError::Option { kind: kind.name(), option: key.to_owned(), known });
            }
            given.push((key, value));
        }
        Ok(Self { kind, given })
    }

    fn get<T>(
        &self,
        option: &'static str,
        expected: &'static str,
        read: impl Fn(&str) -> Option<T>,
    ) -> Result<Option<T>, CameraPlanError> {
        let Some((_, value)) = self.given.iter().find(|(key, _)| *key == option) else { return Ok(None) };
        let wrong = || CameraPlanError::Value { option: option.to_owned(), value: (*value).to_owned(), expected };
        read(value).map(Some).ok_or_else(wrong)
    }

    fn number(
        &self,
        option: &'static str,
        (least, most): (f32, f32),
        expected: &'static str,
    ) -> Result<Option<f32>, CameraPlanError> {
        self.get(option, expected, |text| text.parse().ok().filter(|number| (least..=most).contains(number)))
    }

    fn metres(&self, option: &'static str) -> Result<Option<f32>, CameraPlanError> {
        self.number(option, (-FARTHEST_M, FARTHEST_M), "metres in the world, -1000 to 1000")
    }

    fn needed(&self, option: &'static str, value: Option<f32>) -> Result<f32, CameraPlanError> {
        value.ok_or(CameraPlanError::Missing { kind: self.kind.name(), option })
    }

    fn mount(&self) -> Result<Mount, CameraPlanError> {
        let body = self.get("body", "the number of a body, from 0", |text| text.parse().ok())?;
        let own = body.unwrap_or(0);
        Ok(match self.kind {
            CameraKind::Egocentric => Mount::Head { body: own },
            CameraKind::Panorama => Mount::Panorama { body: own },
            CameraKind::ThirdPerson => Mount::Behind { body: own },
            CameraKind::TopDown => {
                let span_m = self.number("span", SPAN_M, "metres from south to north, 1 to 100")?;
                Mount::Above { body, span_m }
            }
            CameraKind::Fixed => Mount::Fixed {
                at_m: [
                    self.needed("x", self.metres("x")?)?,
                    self.needed("y", self.metres("y")?)?,
                    self.metres("z")?.unwrap_or(HANGS_M),
                ],
                yaw_deg: self.number("yaw", (-360.0, 360.0), "degrees from east, counter-clockwise")?.unwrap_or(0.0),
                pitch_deg: self.number("pitch", (-90.0, 90.0), "degrees up, -90 to 90")?.unwrap_or(LOOKS_UP_DEG),
            },
        })
    }
}

fn read_size(text: &str) -> Option<[u32; 2]> {
    let (width, height) = text.split_once('x').unwrap_or((text, text));
    Some([width.parse().ok()?, height.parse().ok()?])
}

fn read_planes(text: &str) -> Option<Vec<Plane>> {
    if text == "all" {
        return Some(Plane::ALL.to_vec());
    }
    let names: Vec<&str> = text.split('+').collect();
    let all_known = names.iter().all(|name| Plane::ALL.into_iter().any(|plane| plane.name() == *name));
    all_known.then(|| Plane::ALL.into_iter().filter(|plane| names.contains(&plane.name())).collect())
}

fn read_yes(text: &str) -> Option<bool> {
    match text {
        "yes" => Some(true),
        "no" => Some(false),
        _ => None,
    }
}

impl FromStr for CameraPlan {
    type Err = CameraPlanError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let form = || CameraPlanError::Form(text.to_owned());
        let (name, rest) = text.split_once('=').ok_or_else(form)?;
        let (kind, options) = rest.split_once(',').unwrap_or((rest, ""));
        let name: CameraName = name.trim().parse()?;
        let kind = (CameraKind::ALL.into_iter().find(|known| known.name() == kind.trim()))
            .ok_or_else(|| CameraPlanError::Kind(kind.trim().to_owned()))?;
        let options = Options::read(kind, options)?;
        let usual = Self::usual(CameraId::Named(name), options.mount()?);
        let size = options.get("size", "WIDTHxHEIGHT in pixels, such as 640x360, or one number", read_size)?;
        let [width, height] = size.unwrap_or(usual.lens.size());
        let fov = options.number("fov", Lens::FOV_DEG, "degrees from the upper to the lower edge, 1 to 150")?;
        let rate = options.number("rate", RATE_HZ, "frames a second, 0.1 to 60")?;
        let planes =
            options.get("planes", "`all`, or some of color, depth, normals, ids with `+` between", read_planes)?;
        let smooth = options.get("smooth", "yes or no", read_yes)?;
        Ok(Self {
            lens: Lens::new(width, height, fov.unwrap_or(usual.lens.fov_y_deg()))?,
            planes: planes.unwrap_or(usual.planes),
            rate_hz: rate.unwrap_or(usual.rate_hz),
            for_people: smooth.unwrap_or(usual.for_people),
            ..usual
        })
    }
}

impl fmt::Display for CameraPlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.id, self.kind().name())?;
        match self.mount {
            Mount::Fixed { at_m: [x, y, z], yaw_deg, pitch_deg } => {
                write!(f, ",x={x},y={y},z={z},yaw={yaw_deg},pitch={pitch_deg}")?;
            }
            Mount::Above { span_m: Some(span), .. } => write!(f, ",span={span}")?,
            _ => {}
        }
        if let Some(body) = self.body() {
            write!(f, ",body={body}")?;
        }
        if !matches!(self.mount, Mount::Above { .. }) {
            write!(f, ",fov={}", self.lens.fov_y_deg())?;
        }
        let [width, height] = self.lens.size();
        let planes: Vec<&str> = self.planes.iter().map(|plane| plane.name()).collect();
        let smooth = if self.for_people { "yes" } else { "no" };
        write!(f, ",size={width}x{height},rate={},planes={},smooth={smooth}", self.rate_hz, planes.join("+"))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn plans_read_as_they_print() {
        let texts = [
            "a=egocentric",
            "a=egocentric,body=3,size=84,fov=90.5,rate=0.5,planes=ids+depth",
            "look-around=panorama,size=128x96,planes=color",
            "b=third-person,body=1,size=3840x2160,smooth=no",
            "door=fixed,x=-4.25,y=10,z=2,yaw=90,pitch=-33.3,planes=all",
            "plan=top-down",
            "c=top-down,body=0,span=6.5,rate=60",
        ];
        for text in texts {
            let plan: CameraPlan = text.parse().unwrap();
            assert_eq!(plan.to_string().parse::<CameraPlan>().unwrap(), plan, "{text}");
        }
        let plan: CameraPlan = "a=egocentric,size=84,planes=ids+depth".parse().unwrap();
        assert_eq!((plan.lens.size(), &plan.planes[..]), ([84, 84], &[Plane::Depth, Plane::Ids][..]));
        assert_eq!((plan.mount, plan.for_people), (Mount::Head { body: 0 }, false));
    }

    #[test]
    fn mistakes_are_named_with_their_remedy() {
        let check = |text: &str, part: &str| {
            let error = text.parse::<CameraPlan>().unwrap_err().to_string();
            assert!(error.contains(part), "{text}: no `{part}` in {error}");
        };
        check("door", "NAME=KIND");
        check("Two Words=fixed", "lower-case letters");
        check("a=drone", "egocentric, panorama, third-person, fixed, top-down");
        check("a=fixed,y=2", "needs `x=`");
        check("a=fixed,x=1,y=2,body=0", "it has x, y, z, yaw, pitch, fov");
        check("a=top-down,fov=60", "it has body, span, size");
        check("a=egocentric,size=84,size=90", "given twice");
        check("a=egocentric,size=8", "16 to 4096");
        check("a=egocentric,size=4096x4096", "at most 8388608");
        check("a=egocentric,size=big", "WIDTHxHEIGHT");
        check("a=egocentric,fov=180", "1 to 150");
        check("a=egocentric,rate=0", "0.1 to 60");
        check("a=egocentric,planes=colour", "color, depth, normals, ids");
        check("a=egocentric,body=300", "number of a body");
        check("a=fixed,x=nan,y=2", "metres");
        check("a=fixed,x=1,y=2,smooth=maybe", "yes or no");
    }

    #[test]
    fn every_body_has_its_own() {
        let all: Vec<CameraPlan> = CameraPlan::of_bodies(2).collect();
        let names: Vec<String> = all.iter().map(|plan| plan.id.to_string()).collect();
        assert_eq!(names[..4], ["egocentric/0", "eyes/0", "spectator/0", "overhead/0"]);
        assert_eq!((names.len(), all[5].body()), (8, Some(1)));
        assert_eq!(CameraPlan::of_bodies(1000).count(), 1024);
        let record = all[1].record();
        assert_eq!((record.camera(), record.kind()), (Some(CameraId::Eyes(0)), Some(CameraKind::Egocentric)));
    }
}
