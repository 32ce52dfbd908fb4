//! The structs that pass between Rust and xatlas lie as a C++ compiler lays out those of xatlas.h.

use crate::common::skipped;
use std::fmt::Write;
use std::path::PathBuf;
use std::process::Command;

/// A struct as `src/fur/patch/xatlas/ffi.rs` states it.
pub struct Layout {
    /// Its name in xatlas.h.
    name: String,
    size: usize,
    /// Name there and offset, bytes.
    fields: Vec<(String, usize)>,
}

/// The lines `layout! { Rust = Cpp, size: field = name offset, … }` of `source`.
pub fn layouts(source: &str) -> Vec<Layout> {
    let number = |text: &str| text.trim().parse().expect("a number");
    let stated = source.split("layout! {").skip(1).map(|rest| rest.split('}').next().expect("an end"));
    let layout = |text: &str| {
        let (head, fields) = text.split_once(':').expect("fields");
        let (name, size) = head.split_once('=').and_then(|(_, cpp)| cpp.split_once(',')).expect("name and size");
        let field = |field: &str| {
            let (name, at) =
                field.split_once('=').and_then(|(_, cpp)| cpp.trim().split_once(' ')).expect("name and offset");
            (name.to_owned(), number(at))
        };
        Layout { name: name.trim().to_owned(), size: number(size), fields: fields.split(',').map(field).collect() }
    };
    stated.map(layout).collect()
}

/// A C++ program that compiles only if xatlas.h has these layouts.
pub fn program(layouts: &[Layout]) -> String {
    let mut text = "#include <cstddef>\n#include \"xatlas.h\"\n".to_owned();
    for Layout { name, size, fields } in layouts {
        writeln!(text, "static_assert(sizeof(xatlas::{name}) == {size}, \"{name}\");").expect("text");
        for (field, at) in fields {
            writeln!(text, "static_assert(offsetof(xatlas::{name}, {field}) == {at}, \"{name}.{field}\");")
                .expect("text");
        }
    }
    text + "static_assert(xatlas::IndexFormat::UInt32 == 1 && sizeof(xatlas::IndexFormat::Enum) == 4, \"index format\");\n"
}

/// What a C++ compiler says against `program`, empty if nothing; `Err` says why it cannot be asked.
pub fn objections(program: &str) -> Result<String, String> {
    let header = header().ok_or("xatlas.h is not where cargo unpacks crates")?;
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("layout.cpp");
    std::fs::write(&path, program).expect("written");
    let compiler = std::env::var_os("CXX").unwrap_or_else(|| "c++".into());
    let mut command = Command::new(compiler);
    command.args(["-std=c++11", "-fsyntax-only", "-I"]).arg(header.parent().expect("a folder")).arg(&path);
    let output = command.output().map_err(|error| format!("no C++ compiler: {error}"))?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() != said.contains("error"), "{said}");
    Ok(if output.status.success() { String::new() } else { said })
}

/// xatlas.h of the version in Cargo.lock, in cargo's home.
fn header() -> Option<PathBuf> {
    let lock = include_str!("../Cargo.lock");
    let version = lock.split("name = \"xatlas-rs\"\nversion = \"").nth(1)?.split('"').next()?;
    let home =
        std::env::var_os("CARGO_HOME").map(PathBuf::from).or_else(|| Some(std::env::home_dir()?.join(".cargo")))?;
    let registries = std::fs::read_dir(home.join("registry/src")).ok()?;
    let in_registry = |registry: PathBuf| registry.join(format!("xatlas-rs-{version}/vendor/xatlas.h"));
    registries.flatten().map(|entry| in_registry(entry.path())).find(|path| path.is_file())
}

/// The layouts that the binding states.
pub fn stated() -> Vec<Layout> {
    layouts(include_str!("../src/fur/patch/xatlas/ffi.rs"))
}

#[test]
#[cfg(target_pointer_width = "64")]
fn structs_lie_as_a_cpp_compiler_lays_them_out() {
    let stated = stated();
    assert_eq!((stated.len(), stated.iter().map(|layout| layout.fields.len()).sum::<usize>()), (7, 49));
    match objections(&program(&stated)) {
        Ok(said) => assert_eq!(said, ""),
        Err(reason) => skipped(&reason),
    }
}

#[test]
#[cfg(target_pointer_width = "64")]
fn a_field_that_lies_elsewhere_is_seen() {
    let mut wrong = stated();
    wrong[0].fields[5].1 += 4;
    match objections(&program(&wrong)) {
        Ok(said) => assert!(said.contains("Atlas.meshes"), "{said}"),
        Err(reason) => skipped(&reason),
    }
}
