//! Pictures kept on disk, to be compared with those that another version draws.

use std::fs;
use std::path::Path;

use cohabit_render::{Camera, CpuRenderer, Planes, Renderer, Scene};

use crate::office::Office;

/// Size of a kept picture.
const SIZE: [u32; 2] = [300, 300];
/// Every so many-th viewpoint is kept.
const STEP: usize = 5;

/// Draws and keeps.
pub fn save(folder: &Path, offices: &[Office]) {
    fs::create_dir_all(folder).expect("the folder can be made");
    for (name, scene, camera) in views(offices) {
        fs::write(folder.join(&name), draw(scene, &camera)).expect("the picture can be written");
    }
}

/// Draws and compares.
pub fn compare(folder: &Path, offices: &[Office]) {
    let (mut pixels, mut color, mut most, mut ids, mut depths, mut normals) = (0, 0_u64, (0, String::new()), 0, 0, 0);
    for (name, scene, camera) in views(offices) {
        let Ok(before) = fs::read(folder.join(&name)) else {
            println!("{name}: not kept");
            continue;
        };
        let now = draw(scene, &camera);
        let mut here = 0;
        // Sixteen bytes a pixel: colour, depth, normal, id.
        for (a, b) in before.chunks(16).zip(now.chunks(16)) {
            pixels += 1;
            here += (0..3).map(|c| u64::from(a[c].abs_diff(b[c]))).sum::<u64>();
            let depth = |p: &[u8]| f32::from_le_bytes([p[4], p[5], p[6], p[7]]);
            depths += u32::from((depth(a) - depth(b)).abs() > 0.002 * depth(a));
            normals += u32::from((8..11).any(|c| (a[c] as i8).abs_diff(b[c] as i8) > 2));
            ids += u32::from(a[12..] != b[12..]);
        }
        color += here;
        if here > most.0 {
            most = (here, name);
        }
    }
    let share = |count: u32| f64::from(count) * 100.0 / f64::from(pixels);
    println!("{pixels} pixels");
    println!("colour: {:.4} of 255 apart on average", color as f64 / f64::from(pixels) / 3.0);
    println!("most in {}: {:.4}", most.1, most.0 as f64 / f64::from(SIZE[0] * SIZE[1]) / 3.0);
    println!("other ids: {:.4} %, depths: {:.4} %, normals: {:.4} %", share(ids), share(depths), share(normals));
}

fn views(offices: &[Office]) -> impl Iterator<Item = (String, &Scene, Camera)> {
    offices.iter().flat_map(|office| {
        [false, true].into_iter().flat_map(move |for_people| {
            let cameras = office.cameras(SIZE[0], SIZE[1], for_people, STEP).into_iter().enumerate();
            cameras.map(move |(index, camera)| {
                (format!("{}-{index}-{}.raw", office.id, u8::from(for_people)), &office.scene, camera)
            })
        })
    })
}

/// All planes of a picture, pixel by pixel.
fn draw(scene: &Scene, camera: &Camera) -> Vec<u8> {
    let pixels = camera.pixels();
    let (mut color, mut depth_m) = (vec![0; pixels * 4], vec![0.0; pixels]);
    let (mut normals, mut ids) = (vec![0; pixels * 4], vec![0; pixels]);
    let mut planes = Planes {
        color: Some(&mut color),
        depth_m: Some(&mut depth_m),
        normals: Some(&mut normals),
        ids: Some(&mut ids),
    };
    CpuRenderer::new(2).render(scene, camera, &mut planes);
    let mut all = Vec::with_capacity(pixels * 16);
    for index in 0..pixels {
        all.extend_from_slice(&color[index * 4..index * 4 + 4]);
        all.extend_from_slice(&depth_m[index].to_le_bytes());
        all.extend(normals[index * 4..index * 4 + 4].iter().map(|value| *value as u8));
        all.extend_from_slice(&ids[index].to_le_bytes());
    }
    all
}
