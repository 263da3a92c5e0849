//! `cohabit import-model`: an object of a world pack from a glTF file.

use std::{
    fs,
    io::Write as _,
    path::{Path, PathBuf},
};

use cohabit_cdf::{Catalog, PackFile, Property, WorldData, WorldPack, catalog::Stands};
use cohabit_engine::world_folder_files;
use cohabit_gltf::{DENSITY_KG_M3, Front, Imported, Options, Size, USUAL_TRIANGLES, Up, import, read_document, text};
use cohabit_render::MeshLibrary;

use crate::{check::Check, failure::bad_input, pack_folder::failed, terminal::shown, world::WorldPacks};

/// The file of a pack that imported classes are added to.
const OBJECTS: &str = "objects/imported.toml";

/// Imports an object from a glTF 2.0 file into a world pack: meshes of its default scene, with few triangles and up to 12 colours. What
/// it cannot import, such as animations, it names. Nothing is written if the pack would not be sound with it.
#[derive(clap::Args)]
pub struct ImportModel {
    /// The file: `.glb`, or `.gltf` with its buffers and textures in the same folder
    file: PathBuf,
    /// The id of the new class, for missions and floor plans: letters, digits and `_`
    #[arg(long)]
    id: String,
    /// The folder of the world pack, which exists
    #[arg(long, value_name = "FOLDER")]
    into: PathBuf,
    /// The name that people read; made from the id, if not given
    #[arg(long)]
    name: Option<String>,
    /// What people say besides, such as "cup,beaker"
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    words: Vec<String>,
    /// What can be done with it, such as `PICKUPABLE,FILLABLE`; `cohabit catalog classes` shows what others have
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = property)]
    properties: Vec<Property>,
    /// Its size along its front, its left and upwards, m; that of the file, if not given
    #[arg(long, value_name = "X,Y,Z", value_parser = sides, conflicts_with = "height_m")]
    size_m: Option<[f32; 3]>,
    /// Its height, m; it is scaled alike along all sides
    #[arg(long, value_name = "H")]
    height_m: Option<f32>,
    /// The axis of the file that points up: `y`, as glTF has it, or `z`
    #[arg(long, value_name = "AXIS", default_value = "y")]
    up: Up,
    /// Where its front looks once it stands upright, as Blender shows it: `+x`, `-x`, `+y` or `-y`, as glTF has it
    #[arg(long, value_name = "AXIS", default_value = "-y", allow_hyphen_values = true)]
    front: Front,
    /// Its mass, kg; from its volume, if not given
    #[arg(long, value_name = "KG")]
    mass_kg: Option<f32>,
    /// Where it is found: `on_surface`, `on_floor` or `on_wall`; from its properties and its height, if not given
    #[arg(long, value_name = "WHERE", value_parser = stands)]
    stands: Option<Stands>,
    /// How many triangles it has at most, up to 20000; those of a finer file are reduced
    #[arg(long, value_name = "N", default_value_t = USUAL_TRIANGLES)]
    triangles: usize,
    /// Triangles that meet at less than this angle look round, degrees; 40, if not given
    #[arg(long, value_name = "DEGREES")]
    smooth_deg: Option<f32>,
    /// Make the colour that covers the most one that a colour changer changes
    #[arg(long)]
    tint: bool,
    #[command(flatten)]
    packs: WorldPacks,
}

fn property(text: &str) -> Result<Property, String> {
    let name = |property: &Property| format!("{property:?}").to_uppercase();
    let known = || Property::ALL.iter().map(name).collect::<Vec<_>>().join(", ");
    let found = Property::ALL.into_iter().find(|property| name(property) == text.trim().to_uppercase());
    found.ok_or_else(|| format!("write some of {}", known()))
}

fn sides(text: &str) -> Result<[f32; 3], String> {
    let sides: Option<Vec<f32>> = text.split(',').map(|side| side.trim().parse().ok()).collect();
    sides
        .and_then(|sides| sides.try_into().ok())
        .ok_or_else(|| "write three lengths, such as `0.1,0.1,0.12`".to_owned())
}

fn stands(text: &str) -> Result<Stands, String> {
    match text {
        "on_surface" => Ok(Stands::OnSurface),
        "on_floor" => Ok(Stands::OnFloor),
        "on_wall" => Ok(Stands::OnWall),
        _ => Err("write `on_surface`, `on_floor` or `on_wall`".to_owned()),
    }
}

/// What is written: the pack's files as they are then.
struct Written {
    /// The model's own file, and its text.
    model: (String, String),
    /// The text of [`OBJECTS`].
    objects: String,
    files: Vec<PackFile>,
}

impl ImportModel {
    /// Imports it, writes it, and checks the pack.
    pub fn run(&self) -> anyhow::Result<()> {
        // The name of a pack that comes with the program is taken for its files, into which nothing can be written.
        if !self.into.is_dir() {
            return Err(bad_input(format!(
                "{}: there is no such folder: write a pack by `cohabit new world NAME`, and import into that",
                self.into.display()
            )));
        }
        let world = self.packs.read()?;
        let files = world_folder_files(&self.into).map_err(bad_input)?;
        let bytes = read_document(&self.file).map_err(bad_input)?;
        let folder = self.file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let imported = import(&bytes, Some(folder), &self.options())
            .map_err(|error| bad_input(format!("{}: {error}", self.file.display())))?;
        let written = self.written(files, &imported)?;
        // Nothing is written before all of it is known to be sound.
        let levels = self.levels(&world, &written.files)?;
        self.write(&written)?;
        self.report(&imported, &written, &levels);
        let packs = self.packs.with(&self.into);
        let options: Vec<String> = packs.folders().map(|folder| folder.to_string_lossy().into_owned()).collect();
        Check::of_world(packs).run()?;
        println!("Look at it: cohabit gallery pictures --only {} {}", self.id, shown(options.join(" ")));
        println!(
            "Missions and floor plans name it `{}`; words, properties and mass are in {}",
            self.id,
            shown(self.into.join(OBJECTS).display())
        );
        Ok(())
    }

    fn options(&self) -> Options {
        let size = match (self.size_m, self.height_m) {
            (Some(sides), _) => Size::Sides(sides),
            (None, Some(height)) => Size::Height(height),
            (None, None) => Size::OfFile,
        };
        Options {
            name: self.name.clone(),
            words: self.words.clone(),
            properties: self.properties.clone(),
            size,
            up: self.up,
            front: self.front,
            mass_kg: self.mass_kg,
            stands: self.stands,
            triangles: self.triangles,
            smooth_deg: self.smooth_deg,
            tint: self.tint,
            ..Options::new(&self.id)
        }
    }

    /// The files of the pack with the new object among them.
    fn written(&self, mut files: Vec<PackFile>, imported: &Imported) -> anyhow::Result<Written> {
        let model = (format!("models/{}.toml", self.id), text::model(&imported.model));
        if files.iter().any(|file| file.path == model.0) {
            return Err(bad_input(format!(
                "{}: exists already: take another --id, or take away this file and the object with this id",
                self.into.join(&model.0).display()
            )));
        }
        let before = files.iter().position(|file| file.path == OBJECTS).map(|index| files.swap_remove(index).bytes);
        let before = String::from_utf8(before.unwrap_or_default()).map_err(|_| {
            bad_input(format!("{}: no UTF-8 text: save the file as UTF-8", self.into.join(OBJECTS).display()))
        })?;
        let object = text::object(&imported.class);
        let objects = match before.trim_end() {
            "" => format!("# Objects from glTF files, by `cohabit import-model`.\n\n{object}"),
            before => format!("{before}\n\n{object}"),
        };
        for (path, text) in [(model.0.as_str(), &model.1), (OBJECTS, &objects)] {
            files.push(PackFile { path: path.to_owned(), bytes: text.clone().into_bytes() });
        }
        Ok(Written { model, objects, files })
    }

    /// How many triangles are drawn of the new object, from near to far, in a world with these files.
    fn levels(&self, world: &WorldData, files: &[PackFile]) -> anyhow::Result<Vec<usize>> {
        let name = self.into.display().to_string();
        let pack = WorldPack::parse(name.trim_end_matches('/'), files.to_vec()).map_err(bad_input)?;
        let packs = world.packs().iter().cloned().chain([pack]).collect();
        let world = WorldData::layered(packs).map_err(bad_input)?;
        let catalog: &Catalog = world.catalog();
        let meshes = MeshLibrary::build(catalog).map_err(bad_input)?;
        Ok(catalog.find(&self.id).map(|class| meshes.triangles_at_once(class)).unwrap_or_default())
    }

    fn write(&self, written: &Written) -> anyhow::Result<()> {
        for path in [written.model.0.as_str(), OBJECTS] {
            let path = self.into.join(path);
            let folder = path.parent().unwrap_or(&self.into);
            fs::create_dir_all(folder).map_err(|error| failed(folder, &error))?;
        }
        let model = self.into.join(&written.model.0);
        let file = fs::File::create_new(&model).and_then(|mut file| file.write_all(written.model.1.as_bytes()));
        file.map_err(|error| failed(&model, &error))?;
        // A model that no class names does no harm; half a file of classes would.
        let (objects, new) = (self.into.join(OBJECTS), self.into.join("objects/.imported.toml.new"));
        fs::write(&new, &written.objects).map_err(|error| failed(&new, &error))?;
        fs::rename(&new, &objects).map_err(|error| failed(&objects, &error))
    }

    fn report(&self, imported: &Imported, written: &Written, levels: &[usize]) {
        let Imported { class, triangles_read, triangles, colors, volume_m3, left_out, .. } = imported;
        let levels: Vec<String> = levels.iter().map(ToString::to_string).collect();
        println!(
            "{}: {triangles} of {triangles_read} triangles, {colors} colours; drawn from near to far: {}",
            shown(self.into.join(&written.model.0).display()),
            levels.join(", ")
        );
        let [x, y, z] = class.size_m;
        println!(
            "{}: `{}`, called {}, {}, {x} m deep, {y} m wide, {z} m high",
            shown(self.into.join(OBJECTS).display()),
            class.id,
            shown(&class.name),
            class.color
        );
        if self.mass_kg.is_none() {
            println!(
                "Its mass is {} kg: {DENSITY_KG_M3} kg for each cubic metre of its {volume_m3:.6} m³; --mass-kg says another one",
                class.mass_kg
            );
        }
        if class.receptacle.is_some() {
            println!("Things stand on top of it; `receptacle` says where");
        }
        for what in left_out {
            println!("Not imported: {}", shown(what));
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_in_arguments_is_read_or_refused_with_what_would_be_right() {
        assert_eq!(property("pickupable"), Ok(Property::Pickupable));
        assert!(property("HEAVY").unwrap_err().contains("PICKUPABLE, RECEPTACLE"));
        assert_eq!(sides("0.1, 0.2,3"), Ok([0.1, 0.2, 3.0]));
        for wrong in ["", "0.1", "0.1,0.2", "1,2,3,4", "a,b,c"] {
            assert!(sides(wrong).unwrap_err().contains("three lengths"), "{wrong}");
        }
        assert_eq!(stands("on_wall"), Ok(Stands::OnWall));
        assert!(stands("wall").is_err());
    }
}
