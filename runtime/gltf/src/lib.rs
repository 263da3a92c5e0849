//! Models of others: glTF 2.0 files become objects of a world pack.
//!
//! [`import`] takes the bytes of a file and gives a class of objects with its model: meshes of triangles, few of them, each of one
//! colour. What it does, in this order: it reads the document within bounds (`container`, `files`, `accessor`), puts the meshes
//! of the default scene where their nodes say (`scene`), works out the colour that each triangle shows (`surface`, `picture`), turns and
//! scales the object (`frame`), gathers colours (`palette`), joins points (`weld`) and takes triangles away (`reduce`). [`text`] writes what
//! came of it as the files of a pack. The same file gives the same text on every machine.
//!
//! Files are from strangers. Every index, offset, length and count is checked before it is followed, and nothing outside of the document's
//! own folder is read. The crate knows neither the world nor a renderer.
//!
//! ```
//! use cohabit_gltf::{Options, import};
//!
//! let error = import(b"glTF", None, &Options::new("Mug_Lab")).unwrap_err();
//! assert!(error.to_string().contains("cut off"));
//! ```

mod accessor;
mod container;
mod error;
mod files;
mod frame;
mod import;
mod options;
mod palette;
mod picture;
mod reduce;
mod scene;
mod surface;
pub mod text;
mod weld;

pub use error::GltfError;
pub use files::read_document;
pub use frame::{Front, Size, Up};
pub use import::{DENSITY_KG_M3, Imported, import};
pub use options::{MOST_TRIANGLES, Options, USUAL_TRIANGLES};
