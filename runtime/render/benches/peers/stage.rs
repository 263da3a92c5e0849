//! A furnished office as files that other renderers read: meshes, what stands where, and cameras.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use cohabit_render::{Camera, Instance, Look, Soup};
use glam::{Quat, Vec3};

use crate::office::Office;

/// The files, and what is in them.
pub struct Stage {
    /// Where they lie.
    pub folder: PathBuf,
    /// For each object its id in this project's pictures.
    pub ids: Vec<u32>,
    /// Different meshes among them.
    pub meshes: usize,
    /// Triangles of all objects.
    pub triangles: usize,
}

impl Stage {
    /// Writes an office anew. Objects of one class and size share a mesh; every colour is a texel of one palette, so that
    /// every object is a single mesh with a single texture: what costs other renderers least.
    pub fn write(folder: &Path, office: &Office, cameras: &[Camera], level: usize) -> io::Result<Self> {
        if folder.exists() {
            fs::remove_dir_all(folder)?;
        }
        fs::create_dir_all(folder)?;
        let soups = office.scene.soups(level);
        let mut colors: Vec<[u8; 3]> = soups.iter().flat_map(|soup| &soup.colors).copied().collect();
        colors.sort_unstable();
        colors.dedup();
        write_palette(&folder.join("palette.png"), &colors)?;
        let known: BTreeMap<u32, &Instance> = office.instances.iter().map(|instance| (instance.id, instance)).collect();
        let mut of_class = BTreeMap::new();
        let (mut meshes, mut objects) = (0, String::new());
        for soup in &soups {
            let instance = known.get(&soup.id);
            let place = instance.map_or((Vec3::ZERO, Quat::IDENTITY), |instance| {
                (Vec3::from_array(instance.position_m), Quat::from_array(instance.rotation))
            });
            let key = instance.and_then(|instance| match instance.look {
                Look::Object(class) => Some((class, instance.scale.map(f32::to_bits))),
                _ => None,
            });
            let mesh = match key.and_then(|key| of_class.get(&key).copied()) {
                Some(mesh) => mesh,
                None => {
                    fs::write(folder.join(format!("{meshes:04}.obj")), obj(soup, place, &colors))?;
                    key.map(|key| of_class.insert(key, meshes));
                    meshes += 1;
                    meshes - 1
                }
            };
            let (Vec3 { x, y, z }, turn) = place;
            let _ = writeln!(objects, "{mesh} {x} {y} {z} {} {} {} {}", turn.x, turn.y, turn.z, turn.w);
        }
        fs::write(folder.join("objects.txt"), objects)?;
        let mut lines = String::new();
        for Camera { position_m: [x, y, z], yaw_rad, pitch_rad, fov_y_rad, .. } in cameras {
            let _ = writeln!(lines, "{x} {y} {z} {yaw_rad} {pitch_rad} {fov_y_rad}");
        }
        fs::write(folder.join("cameras.txt"), lines)?;
        Ok(Self {
            folder: folder.to_owned(),
            ids: soups.iter().map(|soup| soup.id).collect(),
            meshes,
            triangles: soups.iter().map(|soup| soup.triangles.len()).sum(),
        })
    }
}

/// A row of texels, one a colour; some rows high, because some loaders refuse lines.
fn write_palette(path: &Path, colors: &[[u8; 3]]) -> io::Result<()> {
    const ROWS: usize = 4;
    let mut encoder = png::Encoder::new(BufWriter::new(File::create(path)?), colors.len() as u32, ROWS as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header()?.write_image_data(&colors.as_flattened().repeat(ROWS))?;
    Ok(())
}

/// The mesh in its own frame, as a Wavefront OBJ.
fn obj(soup: &Soup, (offset, turn): (Vec3, Quat), colors: &[[u8; 3]]) -> String {
    let mut text = String::new();
    let back = turn.inverse();
    for at in &soup.positions {
        let at = back * (Vec3::from_array(*at) - offset);
        let _ = writeln!(text, "v {:.6} {:.6} {:.6}", at.x, at.y, at.z);
    }
    for normal in &soup.normals {
        let normal = back * Vec3::from_array(*normal);
        let _ = writeln!(text, "vn {:.5} {:.5} {:.5}", normal.x, normal.y, normal.z);
    }
    let mut used: Vec<[u8; 3]> = soup.colors.clone();
    used.sort_unstable();
    used.dedup();
    for color in &used {
        let texel = colors.partition_point(|known| known < color);
        let _ = writeln!(text, "vt {:.7} 0.5", (texel as f64 + 0.5) / colors.len() as f64);
    }
    for (triangle, color) in soup.triangles.iter().zip(&soup.colors) {
        let texel = used.partition_point(|known| known < color) + 1;
        let [a, b, c] = triangle.map(|corner| corner + 1);
        let _ = writeln!(text, "f {a}/{texel}/{a} {b}/{texel}/{b} {c}/{texel}/{c}");
    }
    text
}
