//! Small glTF files, put together by hand.

use std::fmt::Write as _;

use base64::{Engine as _, engine::general_purpose::STANDARD};

/// Points and triangles.
pub type Mesh = (Vec<[f32; 3]>, Vec<[u32; 3]>);

/// A document that grows.
#[derive(Clone, Debug, Default)]
pub struct Builder {
    pub binary: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
    meshes: std::cell::RefCell<Vec<String>>,
    materials: Vec<String>,
    images: Vec<String>,
    textures: Vec<String>,
    nodes: Vec<String>,
    roots: Vec<usize>,
    /// Members besides, each behind a comma.
    pub more: &'static str,
}

fn added<T>(list: &mut Vec<T>, value: T) -> usize {
    list.push(value);
    list.len() - 1
}

impl Builder {
    pub fn view(&mut self, bytes: &[u8], stride: Option<usize>) -> usize {
        let start = self.binary.len();
        self.binary.extend_from_slice(bytes);
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let mut text = format!(r#"{{"buffer":0,"byteOffset":{start},"byteLength":{}"#, bytes.len());
        if let Some(stride) = stride {
            let _ = write!(text, r#","byteStride":{stride}"#);
        }
        added(&mut self.views, text + "}")
    }

    pub fn accessor(&mut self, bytes: &[u8], stride: Option<usize>, rest: &str) -> usize {
        let view = self.view(bytes, stride);
        added(&mut self.accessors, format!(r#"{{"bufferView":{view},{rest}}}"#))
    }

    /// An accessor as it is written.
    pub fn raw_accessor(&mut self, text: &str) -> usize {
        added(&mut self.accessors, text.to_owned())
    }

    pub fn vectors<const N: usize>(&mut self, vectors: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = vectors.as_flattened().iter().flat_map(|number| number.to_le_bytes()).collect();
        self.accessor(&bytes, None, &format!(r#""componentType":5126,"count":{},"type":"VEC{N}""#, vectors.len()))
    }

    pub fn sparse(&mut self, vectors: &[[f32; 3]], place: u8, value: [f32; 3]) -> usize {
        let bytes: Vec<u8> = vectors.as_flattened().iter().flat_map(|number| number.to_le_bytes()).collect();
        let value: Vec<u8> = value.iter().flat_map(|number| number.to_le_bytes()).collect();
        let (places, values) = (self.view(&[place], None), self.view(&value, None));
        let sparse = format!(
            r#"{{"count":1,"indices":{{"bufferView":{places},"componentType":5121}},"values":{{"bufferView":{values}}}}}"#
        );
        let rest = format!(r#""componentType":5126,"count":{},"type":"VEC3","sparse":{sparse}"#, vectors.len());
        self.accessor(&bytes, None, &rest)
    }

    /// Indices whose kind has this number.
    pub fn indices(&mut self, kind: u32, bytes: &[u8]) -> usize {
        let count = bytes.len() / [1, 1, 2, 2, 4, 4][kind as usize - 5120];
        self.accessor(bytes, None, &format!(r#""componentType":{kind},"count":{count},"type":"SCALAR""#))
    }

    pub fn primitive(&mut self, (points, triangles): &Mesh, material: Option<usize>) -> String {
        let positions = self.vectors(points);
        let bytes: Vec<u8> = triangles.as_flattened().iter().flat_map(|index| index.to_le_bytes()).collect();
        let indices = self.indices(5125, &bytes);
        let material = material.map(|index| format!(r#","material":{index}"#)).unwrap_or_default();
        format!(r#"{{"attributes":{{"POSITION":{positions}}},"indices":{indices}{material}}}"#)
    }

    pub fn textured(&mut self, (points, triangles): &Mesh, places: [[f32; 2]; 4], material: usize) -> String {
        let plain = self.primitive(&(points.clone(), triangles.clone()), Some(material));
        let places = self.vectors(&places);
        plain.replacen(r#""POSITION""#, &format!(r#""TEXCOORD_0":{places},"POSITION""#), 1)
    }

    pub fn png(&mut self, size: [u32; 2], rgb: &[u8]) -> usize {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
        encoder.set_color(png::ColorType::Rgb);
        encoder.write_header().unwrap().write_image_data(rgb).unwrap();
        let view = self.view(&bytes, None);
        added(&mut self.images, format!(r#"{{"bufferView":{view},"mimeType":"image/png"}}"#))
    }

    pub fn image(&mut self, text: &str) -> usize {
        added(&mut self.images, text.to_owned())
    }

    pub fn texture(&mut self, text: &str) -> usize {
        added(&mut self.textures, text.to_owned())
    }

    pub fn material(&mut self, text: &str) -> usize {
        added(&mut self.materials, text.to_owned())
    }

    pub fn mesh(&self, primitives: &[String]) -> usize {
        added(&mut self.meshes.borrow_mut(), format!(r#"{{"primitives":[{}]}}"#, primitives.join(",")))
    }

    /// A node of the scene.
    pub fn node(&mut self, text: &str) -> usize {
        let index = self.json_node(text);
        added(&mut self.roots, index);
        index
    }

    /// A node that others have as a child.
    pub fn json_node(&mut self, text: &str) -> usize {
        added(&mut self.nodes, text.to_owned())
    }

    fn document(&self, buffer: &str) -> String {
        let roots: Vec<String> = self.roots.iter().map(ToString::to_string).collect();
        let mut text =
            format!(r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[{}]}}]"#, roots.join(","));
        for (name, list) in [
            ("bufferViews", &self.views),
            ("accessors", &self.accessors),
            ("meshes", &self.meshes.borrow()),
            ("materials", &self.materials),
            ("images", &self.images),
            ("textures", &self.textures),
            ("nodes", &self.nodes),
        ] {
            if !list.is_empty() {
                let _ = write!(text, r#","{name}":[{}]"#, list.join(","));
            }
        }
        format!(r#"{text},"buffers":[{buffer}]{}}}"#, self.more)
    }

    /// As GLB.
    pub fn glb(&self) -> Vec<u8> {
        self.glb_of(&format!(r#"{{"byteLength":{}}}"#, self.binary.len()))
    }

    /// As GLB that says this of its buffer.
    pub fn glb_of(&self, buffer: &str) -> Vec<u8> {
        let mut json = self.document(buffer).into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut bytes = b"glTF\x02\0\0\0".to_vec();
        let number = |length: usize| u32::try_from(length).unwrap().to_le_bytes();
        bytes.extend(number(12 + 8 + json.len() + 8 + self.binary.len()));
        for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &self.binary)] {
            bytes.extend(number(chunk.len()));
            bytes.extend(kind);
            bytes.extend(chunk);
        }
        bytes
    }

    /// As JSON with the buffer in it.
    pub fn json(&self) -> Vec<u8> {
        let data = STANDARD.encode(&self.binary);
        let uri = format!("data:application/octet-stream;base64,{data}");
        self.document(&format!(r#"{{"byteLength":{},"uri":"{uri}"}}"#, self.binary.len())).into_bytes()
    }

    /// As JSON with the buffer in a file of this name.
    pub fn json_beside(&self, uri: &str) -> Vec<u8> {
        self.document(&format!(r#"{{"byteLength":{},"uri":"{uri}"}}"#, self.binary.len())).into_bytes()
    }
}

/// A cube of these sides about the origin.
pub fn cube(sides: [f32; 3]) -> Mesh {
    let corner =
        |index: u32| [0, 1, 2].map(|axis| if index >> axis & 1 == 0 { -sides[axis] } else { sides[axis] } / 2.0);
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    ((0..8).map(corner).collect(), faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

/// A rectangle that looks along z.
pub fn quad([left, low, z]: [f32; 3], [right, high, _]: [f32; 3]) -> Mesh {
    (vec![[left, low, z], [right, low, z], [right, high, z], [left, high, z]], vec![[0, 1, 2], [0, 2, 3]])
}

/// A ball with a diameter of a fifth of a metre.
pub fn ball(rows: u32) -> Mesh {
    let columns = 2 * rows;
    let place = |row: u32, column: u32| {
        let latitude = std::f32::consts::PI * (row as f32 / rows as f32 - 0.5);
        let longitude = std::f32::consts::TAU * (column % columns) as f32 / columns as f32;
        let ring = if row.is_multiple_of(rows) { 0.0 } else { 0.1 * latitude.cos() };
        [ring * longitude.sin(), 0.1 * latitude.sin(), ring * longitude.cos()]
    };
    let points = (0..=rows).flat_map(|row| (0..=columns).map(move |column| place(row, column))).collect();
    let at = |row: u32, column: u32| row * (columns + 1) + column;
    let squares = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    let triangles = squares.flat_map(|(row, column)| {
        let [a, b] = [at(row, column), at(row, column + 1)];
        let [c, d] = [at(row + 1, column + 1), at(row + 1, column)];
        [[a, b, c], [a, c, d]]
    });
    (points, triangles.collect())
}
