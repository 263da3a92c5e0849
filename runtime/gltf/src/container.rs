//! From bytes to a document: GLB and JSON, with its version and the extensions that it requires.

use gltf_json::{Root, deserialize};

use crate::error::GltfError;

/// The first bytes of a GLB.
const MAGIC: &[u8; 4] = b"glTF";
/// Bytes before the first chunk: magic, version, length.
const HEADER: usize = 12;
/// Kinds of chunks.
const JSON: &[u8; 4] = b"JSON";
const BIN: &[u8; 4] = b"BIN\0";
/// The most bytes of the JSON, in which coordinates of embedded buffers may stand.
const LARGEST_JSON: usize = 128 << 20;
/// The most objects and the most commas of the JSON: they say how much memory it takes to read it.
const MOST_OBJECTS: u64 = 600_000;
const MOST_COMMAS: u64 = 5_000_000;
/// The most entries of each of the document's lists.
const MOST_ENTRIES: usize = 100_000;
/// Extensions that are read, or change nothing of what is read.
const KNOWN: [&str; 10] = [
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_transmission",
    "KHR_texture_transform",
    "KHR_mesh_quantization",
    "KHR_materials_unlit",
    "KHR_materials_ior",
    "KHR_materials_emissive_strength",
    "KHR_materials_specular",
    "KHR_materials_volume",
    "KHR_materials_clearcoat",
];
const FEWER: &str = "export fewer objects";
const EXPORT_ANEW: &str = "export the model as glTF 2.0 (.glb) anew";

/// A document, and the bytes that came with it.
#[derive(Debug)]
pub(crate) struct Document<'a> {
    pub root: Root,
    /// The binary chunk of a GLB.
    pub binary: Option<&'a [u8]>,
}

/// Reads `bytes` as GLB or as JSON.
pub(crate) fn open(bytes: &[u8]) -> Result<Document<'_>, GltfError> {
    let (json, binary) = if bytes.starts_with(MAGIC) { split(bytes)? } else { (bytes, None) };
    if json.len() > LARGEST_JSON {
        let (have, most) = (json.len() as u64, LARGEST_JSON as u64);
        return Err(GltfError::TooMany { what: "bytes of JSON", have, most, remedy: "export the model as .glb" });
    }
    for (what, byte, most) in [("objects in the JSON", b'{', MOST_OBJECTS), ("commas in the JSON", b',', MOST_COMMAS)] {
        let have = json.iter().filter(|own| **own == byte).count() as u64;
        if have > most {
            return Err(GltfError::TooMany { what, have, most, remedy: FEWER });
        }
    }
    let root: Root = deserialize::from_slice(json)
        .map_err(|error| GltfError::Container { reason: format!("no glTF: {error}"), remedy: EXPORT_ANEW })?;
    check(&root)?;
    Ok(Document { root, binary })
}

/// The JSON and the binary chunk of a GLB.
fn split(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), GltfError> {
    let broken = |reason: String| GltfError::Container { reason, remedy: EXPORT_ANEW };
    let cut = || broken("the file is cut off".to_owned());
    let version = number(bytes, 4).ok_or_else(cut)?;
    if version != 2 {
        return Err(broken(format!("the file is of glTF {version}")));
    }
    let length = number(bytes, 8).ok_or_else(cut)?;
    let bytes = bytes.get(..length).ok_or_else(|| {
        broken(format!("the file is cut off: it has {} bytes, and says that it has {length}", bytes.len()))
    })?;
    let (kind, json, mut rest) = chunk(bytes.get(HEADER..).ok_or_else(cut)?).ok_or_else(cut)?;
    if kind != JSON {
        return Err(broken("its first chunk is not JSON".to_owned()));
    }
    // Chunks of other kinds are of extensions.
    while !rest.is_empty() {
        let (kind, body, behind) = chunk(rest).ok_or_else(cut)?;
        if kind == BIN {
            return Ok((json, Some(body)));
        }
        rest = behind;
    }
    Ok((json, None))
}

/// The first chunk: its kind, what is in it, and what is behind it.
fn chunk(bytes: &[u8]) -> Option<(&[u8], &[u8], &[u8])> {
    let length = number(bytes, 0)?;
    let (body, behind) = bytes.get(8..)?.split_at_checked(length)?;
    Some((&bytes[4..8], body, behind))
}

fn number(bytes: &[u8], at: usize) -> Option<usize> {
    let four = bytes.get(at..at.checked_add(4)?)?;
    usize::try_from(u32::from_le_bytes(four.try_into().ok()?)).ok()
}

fn check(root: &Root) -> Result<(), GltfError> {
    if !root.asset.version.starts_with("2.") {
        let reason = format!("the file is of glTF {}", root.asset.version);
        return Err(GltfError::Container { reason, remedy: EXPORT_ANEW });
    }
    if let Some(name) = root.extensions_required.iter().find(|name| !is_known(name)) {
        return Err(GltfError::Extension { name: name.clone() });
    }
    for (what, have) in [
        ("accessors", root.accessors.len()),
        ("buffers", root.buffers.len()),
        ("buffer views", root.buffer_views.len()),
        ("images", root.images.len()),
        ("materials", root.materials.len()),
        ("meshes", root.meshes.len()),
        ("nodes", root.nodes.len()),
        ("textures", root.textures.len()),
    ] {
        if have > MOST_ENTRIES {
            let (have, most) = (have as u64, MOST_ENTRIES as u64);
            return Err(GltfError::TooMany { what, have, most, remedy: FEWER });
        }
    }
    Ok(())
}

fn is_known(name: &str) -> bool {
    KNOWN.contains(&name)
}

/// What the document has that is not imported, in words.
pub(crate) fn left_out(root: &Root) -> Vec<String> {
    let primitives = || root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let morphs = primitives().filter(|primitive| primitive.targets.is_some()).count();
    let of_pictures = root.materials.iter().flat_map(|material| {
        [material.normal_texture.is_some(), material.occlusion_texture.is_some(), material.emissive_texture.is_some()]
    });
    let counted = [
        ("animation", root.animations.len()),
        ("skin: the object stands as it was modelled", root.skins.len()),
        ("set of morph targets", morphs),
        ("camera", root.cameras.len()),
        ("texture of normals, occlusion or glow", of_pictures.filter(|has| *has).count()),
        ("scene beside the default one", root.scenes.len().saturating_sub(1)),
    ];
    let counted = counted.into_iter().filter(|(_, count)| *count > 0).map(|(what, count)| format!("{count} × {what}"));
    let extensions = root.extensions_used.iter().filter(|name| !is_known(name));
    let extensions = extensions.map(|name| match name.as_str() {
        "KHR_lights_punctual" => format!("lights (`{name}`)"),
        _ => format!("extension `{name}`"),
    });
    counted.chain(extensions).collect()
}
