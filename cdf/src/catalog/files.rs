//! What the files of a catalogue list: classes of objects, and models.

use serde::Deserialize;

use super::ObjectClass;
use crate::model::Model;

#[derive(Deserialize)]
pub(crate) struct ObjectFile {
    #[serde(default, rename = "object")]
    objects: Vec<ObjectClass>,
}

#[derive(Deserialize)]
pub(crate) struct ModelFile {
    #[serde(default, rename = "model")]
    models: Vec<Model>,
}

/// The classes of files, each with the name of its file; why a file cannot be read goes to `errors`.
pub(crate) fn objects<'f, E>(
    files: impl IntoIterator<Item = (&'f str, &'f str)>,
    errors: &mut Vec<E>,
    read: impl Fn(&str, &str) -> Result<ObjectFile, E>,
) -> Vec<(&'f str, ObjectClass)> {
    entries(files, errors, read, |file| file.objects)
}

/// The same of models.
pub(crate) fn models<'f, E>(
    files: impl IntoIterator<Item = (&'f str, &'f str)>,
    errors: &mut Vec<E>,
    read: impl Fn(&str, &str) -> Result<ModelFile, E>,
) -> Vec<(&'f str, Model)> {
    entries(files, errors, read, |file| file.models)
}

fn entries<'f, F, T, E>(
    files: impl IntoIterator<Item = (&'f str, &'f str)>,
    errors: &mut Vec<E>,
    read: impl Fn(&str, &str) -> Result<F, E>,
    of: impl Fn(F) -> Vec<T>,
) -> Vec<(&'f str, T)> {
    let mut all = Vec::new();
    for (file, text) in files {
        match read(file, text) {
            Ok(read) => all.extend(of(read).into_iter().map(|entry| (file, entry))),
            Err(error) => errors.push(error),
        }
    }
    all
}
