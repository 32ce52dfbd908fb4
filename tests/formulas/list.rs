//! No function of a shader is left out: each is called by a kernel that compares it, or is named here with what holds it instead.

use super::{coat, hair, law, look, place};
use furrier::gpu::compose;
use furrier::hybrid::gpu::kernels;
use furrier::runtime::gpu::pipelines;
use naga::{Block, Expression, Function, Handle, Module, Statement};
use std::collections::BTreeSet;
use std::path::Path;

/// File, functions, and why no kernel compares them.
pub const ELSEWHERE: &[(&str, &[&str], &str)] = &[
    (
        "runtime/shell.wgsl",
        &["bend_of", "bend_along", "way_of", "vertex", "place_of", "met", "shaded", "fragment"],
        "twins.rs compares pictures of planes with the law on the CPU, coat_light.rs their light with the renderer's",
    ),
    ("runtime/fin.wgsl", &["bend_along", "vertex", "shaded", "fragment"], "look.rs compares pixels of a fin"),
    ("runtime/shell.wgsl", &["weighted", "hashed"], BLENDS),
    ("runtime/fin.wgsl", &["weighted", "hashed"], BLENDS),
    ("runtime/weighed.wgsl", &["vertex", "fragment"], BLENDS),
    (
        "runtime/blending.wgsl",
        &["plain", "weighted_of", "mixed", "chance", "chance_in", "finest_step", "threshold", "kept_or_not"],
        BLENDS,
    ),
    ("runtime/lights.wgsl", &["lit_by_all"], "look.rs compares pixels of a fin under two lights"),
    ("runtime/skin.wgsl", &["vertex", "fragment"], "look.rs compares pixels of skin"),
    ("runtime/caster.wgsl", &["vertex"], SHADOWS),
    ("shared/shadow_map.wgsl", &["key_share"], SHADOWS),
    ("runtime/items.wgsl", &["uncovered", "shadow_reads", "read_root", "root_level"], EDGES),
    ("runtime/whole.wgsl", &["whole_target"], "covers a target: all tests of the runtime look through it"),
    ("runtime/edges.wgsl", &["vertex", "fragment"], EDGES),
    ("runtime/full.wgsl", &["vertex", "fragment"], HIDDEN),
    ("runtime/under.wgsl", &["vertex", "fragment"], HIDDEN),
    ("runtime/resolve.wgsl", &["vertex", "fragment"], "a mean of samples: all tests of the runtime look through it"),
    ("shared/coat.wgsl", &["fetch"], "samples a texture: twins.rs compares it between texels and mips"),
    (
        "shared/camera.wgsl",
        &["skin_z", "window_of"],
        "which pixels a triangle has: hybrid_twins.rs compares every pixel",
    ),
    ("shared/faces.wgsl", &["on_corner", "face_point", "face_corner", "face_shape", "place_on", "start_m"], WALKS),
    ("shared/march.wgsl", &["walk_from", "crowding", "reach_at", "step_of", "advance"], WALKS),
    ("shared/undercoat_light.wgsl", &["shadow_byte", "key_depth", "undercoat_light"], WALKS),
    ("shared/skin_light.wgsl", &["skin_light"], WALKS),
    ("shared/blocks.wgsl", &["owner_of", "write_byte"], WALKS),
    ("shared/fragments.wgsl", &["hair_of", "read_from", "next_fragment"], LISTS),
    ("hybrid/allot.wgsl", &["allot"], LISTS),
    ("hybrid/order.wgsl", &["hair_of", "order"], LISTS),
    ("hybrid/trim.wgsl", &["trim"], LISTS),
    ("hybrid/entrances.wgsl", &["entrances"], LISTS),
    ("hybrid/skin.wgsl", &["skin"], LISTS),
    ("hybrid/guard.wgsl", &["ramp", "before_skin", "end_of_segment", "put", "guard"], LISTS),
    ("hybrid/density.wgsl", &["density"], WALKS),
    ("hybrid/shadow.wgsl", &["shadow"], WALKS),
    ("hybrid/march.wgsl", &["before", "entry", "place_of", "put", "march_pixel", "march"], WALKS),
    ("hybrid/strands.wgsl", &["step_at", "depth_of", "log_radiance_at", "put", "shade"], COLOURS),
    (
        "hybrid/composite.wgsl",
        &[
            "log_radiance_at",
            "bend_at",
            "radiance_at",
            "opacity_of",
            "add_hair",
            "add_undercoat",
            "add_part",
            "add_skin",
            "fill",
            "composite",
        ],
        COLOURS,
    ),
    ("hybrid/poison.wgsl", &["poison"], "writes NaN: a film that keeps any fails every comparison"),
];

const SHADOWS: &str = "draws and samples the shadow map: shadow_map.rs looks for it in pictures, place by place";
const EDGES: &str = "finds and reads the skin's edges: runtime.rs looks at a bare edge before fur, and counts reads";
const BLENDS: &str = "blends without an order: runtime.rs holds their light and coverage to the sorted picture's";
const HIDDEN: &str =
    "hides what lies behind opaque hair: runtime.rs counts it, and all tests of the runtime look at what is left";
const WALKS: &str = "walks the volume as it lies on the device: hybrid_twins.rs compares the pictures pixel by pixel";
const LISTS: &str = "makes and reads lists of a picture's pixels: hybrid_twins.rs compares the pictures pixel by pixel";
const COLOURS: &str = "reads what other passes wrote: hybrid_twins.rs compares every layer of the pictures";

/// The functions that a shader's text declares.
pub fn declared(text: &str) -> Vec<String> {
    let names = text.lines().filter_map(|line| line.strip_prefix("fn "));
    names.filter_map(|rest| rest.split('(').next()).map(str::to_owned).collect()
}

/// The functions that a module's entry points call, directly or over others, by their own names.
pub fn reached(module: &Module) -> BTreeSet<String> {
    let mut seen = BTreeSet::new();
    let mut open: Vec<&Function> = module.entry_points.iter().map(|entry| &entry.function).collect();
    while let Some(function) = open.pop() {
        let mut called = Vec::new();
        calls(&function.body, &mut called);
        called.extend(function.expressions.iter().filter_map(|(_, expression)| match expression {
            Expression::CallResult(function) => Some(*function),
            _ => None,
        }));
        for handle in called {
            let function = &module.functions[handle];
            let full = function.name.as_deref().unwrap_or_default();
            // Composition adds the file to the name.
            if seen.insert(full.split("X_naga_oil_mod_X").next().unwrap_or_default().to_owned()) {
                open.push(function);
            }
        }
    }
    seen
}

fn calls(block: &Block, found: &mut Vec<Handle<Function>>) {
    for statement in block {
        match statement {
            Statement::Call { function, .. } => found.push(*function),
            Statement::Block(inner) => calls(inner, found),
            Statement::If { accept, reject, .. } => [accept, reject].iter().for_each(|inner| calls(inner, found)),
            Statement::Switch { cases, .. } => cases.iter().for_each(|case| calls(&case.body, found)),
            Statement::Loop { body, continuing, .. } => [body, continuing].iter().for_each(|inner| calls(inner, found)),
            _ => {}
        }
    }
}

/// What is wrong with the list: functions that nothing holds, and names of none or of some that are compared after all. `files`
/// are paths and the functions in them.
pub fn faults(
    files: &[(String, Vec<String>)],
    compared: &BTreeSet<String>,
    elsewhere: &[(&str, &[&str], &str)],
) -> Vec<String> {
    let named =
        |path: &str, name: &str| elsewhere.iter().any(|(file, names, _)| *file == path && names.contains(&name));
    // In files that others import names are compared; what only one pass has cannot be called from elsewhere.
    let held = |path: &str, name: &str| path.starts_with("shared/") && compared.contains(name);
    let mut found = Vec::new();
    for (path, names) in files {
        for name in names {
            match (held(path, name), named(path, name)) {
                (false, false) => found.push(format!("shaders/{path}: nothing compares `{name}`")),
                (true, true) => found.push(format!("shaders/{path}: `{name}` is compared; take it off the list")),
                _ => {}
            }
        }
    }
    for (path, names, _) in elsewhere {
        let own = files.iter().find(|(file, _)| file == path).map(|(_, names)| names);
        let gone = names.iter().filter(|name| !own.is_some_and(|own| own.iter().any(|own| own == *name)));
        found.extend(gone.map(|name| format!("shaders/{path}: there is no `{name}`")));
    }
    found
}

#[test]
fn every_function_of_the_shaders_is_compared_or_held_elsewhere() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    let mut files = Vec::new();
    for kind in ["shared", "hybrid", "runtime"] {
        for entry in std::fs::read_dir(folder.join(kind)).unwrap() {
            let path = entry.unwrap().path();
            let name = format!("{kind}/{}", path.file_name().unwrap().to_string_lossy());
            files.push((name, declared(&std::fs::read_to_string(path).unwrap())));
        }
    }
    files.sort();
    let mut compared = BTreeSet::new();
    for main in [hair::MAIN, law::MAIN, place::MAIN] {
        compared.extend(reached(&compose(main, &kernels::SHARED).unwrap()));
    }
    for main in [coat::MAIN, look::MAIN] {
        compared.extend(reached(&compose(main, &pipelines::SHARED).unwrap()));
    }
    println!(
        "{} of {} functions are compared",
        compared.len(),
        files.iter().map(|(_, names)| names.len()).sum::<usize>()
    );
    let faults = faults(&files, &compared, ELSEWHERE);
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
