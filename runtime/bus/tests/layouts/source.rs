//! Records, kinds and numbers as the crate's source declares them.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use syn::{
    Attribute, Expr, Fields, GenericArgument, Item, ItemConst, ItemEnum, ItemStruct, Lit, Meta, PathArguments, Type,
};

/// A `repr(C)` struct.
#[derive(Debug)]
pub struct Record {
    pub name: String,
    pub doc: String,
    pub fields: Vec<Field>,
}

/// A field of one.
#[derive(Debug)]
pub struct Field {
    pub name: String,
    pub doc: String,
    pub type_name: String,
    pub offset: usize,
    pub bytes: usize,
}

/// A `repr(u32)` enum, or the `u32` constants of a file.
#[derive(Debug)]
pub struct Kinds {
    pub name: String,
    pub doc: String,
    /// Value, name, meaning.
    pub values: Vec<(String, String, String)>,
}

/// All that the source declares.
#[derive(Debug, Default)]
pub struct Source {
    /// In the order of files and of the lines in them.
    pub records: Vec<Record>,
    pub kinds: Vec<Kinds>,
}

impl Record {
    pub fn bytes(&self) -> usize {
        self.fields.iter().map(|field| field.bytes).sum()
    }
}

impl Source {
    /// Reads the files under a folder.
    pub fn read(folder: &Path) -> Self {
        let mut files = Vec::new();
        gather(folder, &mut files);
        files.sort();
        let mut structs = Vec::new();
        let mut source = Self::default();
        for path in files {
            let text = fs::read_to_string(&path).unwrap();
            let file = syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            let mut constants = Vec::new();
            for item in file.items {
                match item {
                    Item::Struct(item) if is_record(&item) => structs.push(item),
                    Item::Enum(item) if has_repr(&item.attrs, "u32") => source.kinds.push(kinds_of(&item)),
                    Item::Const(item) => constants.extend(constant(&item)),
                    _ => {}
                }
            }
            if !constants.is_empty() {
                let stem = path.file_stem().unwrap().to_string_lossy().into_owned();
                let doc = format!("Constants of `{}`.", path.file_name().unwrap().to_string_lossy());
                source.kinds.push(Kinds { name: stem, doc, values: constants });
            }
        }
        source.records = resolve(structs);
        source
    }

    pub fn record(&self, name: &str) -> &Record {
        self.records.iter().find(|record| record.name == name).unwrap_or_else(|| panic!("there is no record `{name}`"))
    }
}

fn gather(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            gather(&path, files);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            files.push(path);
        }
    }
}

/// `repr(C)` with named fields; texts and blocks, which are generic or a tuple, are types of fields.
fn is_record(item: &ItemStruct) -> bool {
    has_repr(&item.attrs, "C") && item.generics.params.is_empty() && matches!(item.fields, Fields::Named(_))
}

fn has_repr(attributes: &[Attribute], wanted: &str) -> bool {
    attributes.iter().any(|attribute| {
        let mut found = false;
        if attribute.path().is_ident("repr") {
            let _ = attribute.parse_nested_meta(|meta| {
                found |= meta.path.is_ident(wanted);
                Ok(())
            });
        }
        found
    })
}

/// The first paragraph of a doc comment, without the targets of its links.
fn doc_of(attributes: &[Attribute]) -> String {
    let lines = attributes.iter().filter_map(|attribute| match &attribute.meta {
        Meta::NameValue(pair) if pair.path.is_ident("doc") => match &pair.value {
            Expr::Lit(literal) => match &literal.lit {
                Lit::Str(text) => Some(text.value().trim().to_owned()),
                _ => None,
            },
            _ => None,
        },
        _ => None,
    });
    let paragraph = lines.take_while(|line| !line.is_empty()).collect::<Vec<_>>().join(" ");
    without_links(&paragraph)
}

/// `[text](target)` and `[text]` become `text`, if the text is code.
fn without_links(text: &str) -> String {
    let mut plain = String::new();
    let mut rest = text;
    while let Some(start) = rest.find("[`") {
        let Some(length) = rest[start..].find("`]") else { break };
        plain += &rest[..start];
        plain += &rest[start + 1..start + length + 1];
        rest = &rest[start + length + 2..];
        if rest.starts_with('(') {
            rest = rest.find(')').map_or(rest, |end| &rest[end + 1..]);
        }
    }
    plain + rest
}

fn kinds_of(item: &ItemEnum) -> Kinds {
    let values = item.variants.iter().map(|variant| {
        let name = variant.ident.to_string();
        let (_, value) = variant.discriminant.as_ref().unwrap_or_else(|| panic!("`{name}` has no number"));
        (text_of(value), name, doc_of(&variant.attrs))
    });
    Kinds { name: item.ident.to_string(), doc: doc_of(&item.attrs), values: values.collect() }
}

/// A documented `u32`.
fn constant(item: &ItemConst) -> Option<(String, String, String)> {
    let is_u32 = matches!(&*item.ty, Type::Path(path) if path.path.is_ident("u32"));
    is_u32.then(|| {
        let name = item.ident.to_string();
        let doc = doc_of(&item.attrs);
        assert!(!doc.is_empty(), "`{name}` has no doc comment; it is a part of the messages");
        (text_of(&item.expr), name, doc)
    })
}

fn text_of(expression: &Expr) -> String {
    match expression {
        Expr::Lit(literal) => match &literal.lit {
            Lit::Int(number) => number.base10_digits().to_owned(),
            _ => panic!("not a number"),
        },
        Expr::Path(path) => {
            let parts: Vec<_> = path.path.segments.iter().map(|segment| segment.ident.to_string()).collect();
            if parts == ["u32", "MAX"] { u32::MAX.to_string() } else { parts.join("::") }
        }
        _ => panic!("a number of the messages is neither a literal nor a name"),
    }
}

/// Offsets: those of `repr(C)` without padding, which `Pod` excludes.
fn resolve(structs: Vec<ItemStruct>) -> Vec<Record> {
    let mut sizes = BTreeMap::new();
    let order: Vec<_> = structs.iter().map(|item| item.ident.to_string()).collect();
    let mut records = BTreeMap::new();
    let mut left = structs;
    while !left.is_empty() {
        let before = left.len();
        left.retain(|item| match record_of(item, &sizes) {
            Some(record) => {
                sizes.insert(record.name.clone(), record.bytes());
                records.insert(record.name.clone(), record);
                false
            }
            None => true,
        });
        let names: Vec<_> = left.iter().map(|item| item.ident.to_string()).collect();
        assert!(left.len() < before, "records with fields of unknown types: {names:?}");
    }
    order.iter().filter_map(|name| records.remove(name)).collect()
}

/// Nothing while one of its fields is a record that is not known yet.
fn record_of(item: &ItemStruct, sizes: &BTreeMap<String, usize>) -> Option<Record> {
    let name = item.ident.to_string();
    let mut fields = Vec::new();
    let mut offset = 0;
    for field in &item.fields {
        let (type_name, bytes) = type_of(&field.ty, sizes)?;
        let field_name = field.ident.as_ref().unwrap().to_string();
        let doc = doc_of(&field.attrs);
        assert!(!doc.is_empty(), "`{name}::{field_name}` has no doc comment");
        fields.push(Field { name: field_name, doc, type_name, offset, bytes });
        offset += bytes;
    }
    Some(Record { name, doc: doc_of(&item.attrs), fields })
}

/// A type's name and its size.
fn type_of(type_: &Type, sizes: &BTreeMap<String, usize>) -> Option<(String, usize)> {
    match type_ {
        Type::Array(array) => {
            let (name, bytes) = type_of(&array.elem, sizes)?;
            let count: usize = text_of(&array.len).parse().unwrap();
            Some((format!("[{name}; {count}]"), bytes * count))
        }
        Type::Path(path) => {
            let segment = path.path.segments.last()?;
            let name = segment.ident.to_string();
            if let PathArguments::AngleBracketed(arguments) = &segment.arguments {
                let Some(GenericArgument::Const(length)) = arguments.args.first() else { return None };
                let length: usize = text_of(length).parse().unwrap();
                assert_eq!(name, "Text", "the only generic type that a record may have");
                return Some((format!("Text<{length}>"), 2 + length));
            }
            let bytes = match name.as_str() {
                "u8" | "i8" => 1,
                "u16" | "i16" => 2,
                "u32" | "i32" | "f32" | "AtomicU32" => 4,
                "u64" | "i64" | "f64" => 8,
                _ => *sizes.get(&name)?,
            };
            Some((name, bytes))
        }
        _ => None,
    }
}
