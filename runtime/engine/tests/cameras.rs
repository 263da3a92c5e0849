//! Cameras that are asked for by name: their frames, what these show, and what others are told of them.

#![allow(clippy::unwrap_used)]

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

use cohabit_bus::{
    CameraId, Local, Sample, Subscriber, Topic, Transport,
    message::{CameraKind, FrameView, MissionMessage, NONE, Plane, Thing},
};
use cohabit_cdf::{Catalog, SemanticClass, mission};
use cohabit_engine::{BuildError, CameraPlan, Engine, SessionPlan, Simulator, Stills};
use cohabit_render::{CpuRenderer, Lens, MeshLibrary};

fn plan(cameras: &[&str]) -> Result<SessionPlan, BuildError> {
    let (file, text) = mission::builtin()[0];
    let cameras: Vec<CameraPlan> = cameras.iter().map(|text| text.parse().unwrap()).collect();
    let plan = SessionPlan::new(file, text, Arc::new(Catalog::builtin()), 3).unwrap();
    plan.with_bodies(vec!["person@BreakRoom".parse().unwrap()]).with_cameras(cameras)
}

fn next(subscriber: &mut dyn Subscriber, bus: &Local, topic: Topic) -> Sample {
    let mut listener = bus.listener(topic.wake()).unwrap();
    for _ in 0..600 {
        if let Some(sample) = subscriber.receive().unwrap() {
            return sample;
        }
        listener.wait(Duration::from_millis(100)).unwrap();
    }
    panic!("nothing came on {topic}");
}

/// Counts what the ids say, and compares it with the table.
fn check_seen(frame: &FrameView<'_>) {
    let (ids, seen) = (frame.ids().unwrap(), frame.seen());
    let (width, pixels) = (frame.header.width as usize, (frame.header.width * frame.header.height) as usize);
    assert!(!seen.is_empty());
    assert!(seen.is_sorted_by_key(|record| (record.view, record.id)));
    for record in seen {
        let picture = &ids[usize::from(record.view) * pixels..][..pixels];
        assert_eq!(picture.iter().filter(|id| **id == record.id).count(), record.pixels as usize);
        for (place, _) in picture.iter().enumerate().filter(|(_, id)| **id == record.id) {
            let (x, y) = ((place % width) as u16, (place / width) as u16);
            assert!((record.left..record.right).contains(&x) && (record.top..record.bottom).contains(&y));
        }
        let class = SemanticClass::from_index(record.class);
        let expected = match Thing::of_id(record.id) {
            Thing::Object(_) => matches!(class, SemanticClass::Object(_)),
            Thing::Body(body) => class == [SemanticClass::Robot, SemanticClass::Person][body.0 as usize],
            Thing::Surface(_) => !matches!(class, SemanticClass::Object(_) | SemanticClass::Unknown),
            Thing::Nothing => false,
        };
        assert!(expected, "{record:?} is a {class:?}");
    }
}

/// Ends the simulator also when a check fails.
struct Stop<'a>(&'a AtomicBool);

impl Drop for Stop<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

#[test]
fn cameras_deliver_what_was_asked_for() {
    let asked = [
        "small=egocentric,size=84x64,fov=90,planes=ids+depth",
        "around=panorama,size=64,fov=90,planes=all",
        "door=fixed,x=4,y=10,z=2.2,yaw=90,pitch=-30,size=120x80,planes=all",
        "plan=top-down,size=160x200,planes=color+ids",
        "over=top-down,body=1,span=4,size=64,planes=all",
    ];
    let plan = plan(&asked).unwrap();
    let bus = Local::new(1);
    let meshes = Arc::new(MeshLibrary::build(&plan.catalog).unwrap());
    let simulator = Simulator::new(&plan, plan.build().unwrap(), meshes, Box::new(CpuRenderer::new(1)), &bus).unwrap();
    let mut missions = bus.subscriber(Topic::Mission).unwrap();
    let topic = |name: &str| Topic::Frames(CameraId::Named(name.parse().unwrap()));
    let names = ["small", "around", "door", "plan", "over"];
    let mut frames: Vec<_> = names.iter().map(|name| bus.subscriber(topic(name)).unwrap()).collect();
    let stop = AtomicBool::new(false);
    thread::scope(|scope| {
        let running = scope.spawn(|| simulator.run(&stop));
        let ending = Stop(&stop);
        let told = next(&mut *missions, &bus, Topic::Mission);
        let cameras = MissionMessage::read(told.payload()).unwrap().cameras;
        // Four of each of the two bodies, then those asked for.
        assert_eq!(cameras.len(), 8 + asked.len());
        let around = cameras.iter().find(|camera| camera.camera() == Some("around".parse().unwrap())).unwrap();
        assert_eq!((around.kind(), around.views, around.body), (Some(CameraKind::Panorama), 4, 0));
        assert!(around.has(Plane::Depth) && cameras[11].body == NONE && !cameras[11].has(Plane::Depth));

        let samples: Vec<Sample> =
            names.iter().zip(&mut frames).map(|(name, frames)| next(&mut **frames, &bus, topic(name))).collect();
        let views: Vec<_> = samples.iter().map(|sample| FrameView::new(sample.payload()).unwrap()).collect();
        let sizes = views.iter().map(|frame| [frame.header.width, frame.header.height, frame.header.views]);
        assert!(sizes.eq([[84, 64, 1], [64, 64, 4], [120, 80, 1], [160, 200, 1], [64, 64, 1]]));
        for frame in &views {
            check_seen(frame);
        }
        assert!(views[0].plane(Plane::Color).is_none() && views[0].depth_m().is_some());
        assert_eq!(views[2].header.position_m, [4.0, 10.0, 2.2]);
        // Its own body is not in a body's eyes; the other is under the camera above it.
        assert!(views[1].seen().iter().all(|record| record.id != Thing::FIRST_BODY));
        assert!(views[4].seen().iter().any(|record| record.id == Thing::FIRST_BODY + 1));
        // All rooms are in the plan.
        let rooms = views[3].seen().iter().filter(|record| record.class == SemanticClass::Floor.index());
        assert_eq!(rooms.count(), 8);
        drop(ending);
        running.join().unwrap().unwrap();
    });
}

#[test]
fn stills_are_taken_when_they_are_asked_for() {
    let plan = plan(&["small=egocentric,size=84x64,fov=90,planes=ids", "over=top-down,size=64,planes=ids"]).unwrap();
    let bus = Local::new(1);
    let meshes = Arc::new(MeshLibrary::build(&plan.catalog).unwrap());
    let mut stills = Stills::new(&plan, meshes, Box::new(CpuRenderer::new(1)), &plan.cameras, &bus).unwrap();
    let mut engine = Engine::new(&plan, plan.build().unwrap(), &plan.cameras, &bus).unwrap();
    let mut frames = bus.subscriber(Topic::Frames(plan.cameras[0].id)).unwrap();
    let mut shoot = |engine: &Engine, lens| {
        stills.shoot(engine.visible(), plan.cameras[0].id, lens).unwrap();
        frames.receive().unwrap().unwrap()
    };
    let size = |sample: &Sample| {
        let frame = FrameView::new(sample.payload()).unwrap();
        check_seen(&frame);
        (sample.envelope().tick, [frame.header.width, frame.header.height], frame.header.fov_y_rad.to_degrees().round())
    };
    // However soon one comes after the other, and whatever the lens of the one before.
    assert_eq!(size(&shoot(&engine, None)), (0, [84, 64], 90.0));
    assert_eq!(size(&shoot(&engine, Some(Lens::new(50, 40, 30.0).unwrap()))), (0, [50, 40], 30.0));
    engine.tick(0).unwrap();
    assert_eq!(size(&shoot(&engine, None)), (1, [84, 64], 90.0));
    assert!(bus.subscriber(Topic::Frames(plan.cameras[1].id)).unwrap().receive().unwrap().is_none());
}

#[test]
fn what_cannot_be_is_said() {
    let error = |cameras: &[&str]| plan(cameras).and_then(|plan| plan.build()).err().unwrap().to_string();
    assert!(error(&["a=egocentric", "a=top-down"]).contains("two cameras are called `a`"));
    assert!(error(&["a=egocentric,body=2"]).contains("bodies 0 to 1"));
    let many: Vec<String> = (0..65).map(|number| format!("c{number}=egocentric")).collect();
    assert!(error(&many.iter().map(String::as_str).collect::<Vec<_>>()).contains("at most 64"));
}
