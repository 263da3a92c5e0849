//! The weights of the [`Rewriter`], in a crate of their own: only what talks to people carries them.

use std::sync::LazyLock;

use cohabit_parser::Rewriter;

static MODEL: &[u8] = include_bytes!("../rewriter.safetensors");

/// The rewriter that comes with the project; it takes some tenths of a second to load, once.
///
/// # Panics
/// Never: its model is checked by a test.
#[must_use]
pub fn builtin() -> &'static Rewriter {
    static BUILTIN: LazyLock<Rewriter> = LazyLock::new(|| {
        Rewriter::new(MODEL).unwrap_or_else(|error| panic!("dialog/rewriter/rewriter.safetensors: {error}"))
    });
    &BUILTIN
}
