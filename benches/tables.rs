//! The tables of `docs/steps/patch.md` and `docs/steps/field.md`: `cargo bench --bench tables [-- WHAT [SEEDS
//! [MESH]]]`.
//!
//! MESH is a part of the meshes' names. WHAT is `meshes` (every shared mesh by every method), `seams` (each seed of lapped patches), or `comb`; all without.
//! The shared meshes are needed.
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a bench that cannot go on stops, and prints what it found"
)]

use furrier::coat::axes::axes;
use furrier::coat::hair::TileHair;
use furrier::coat::seams::{BeforeAfter, WINDOWS, before_after};
use furrier::coat::tile::{TileRecipe, bake};
use furrier::data::coat::Tile;
use furrier::data::mesh::Mesh;
use furrier::data::patches::Patches;
use furrier::fur::field::{DirectionField, FieldSource, directions};
use furrier::fur::groom::fibre::Fibre;
use furrier::fur::patch::{Parameterisation, parameterise};
use furrier::math::Vec3;
use furrier::preset::Preset;
use std::time::Instant;

const MESHES: [&str; 13] = [
    "bunny_5k.glb",
    "bunny_closed_6k6.glb",
    "spot.glb",
    "spot_control_quads.obj",
    "Fox.glb",
    "quaternius_ShibaInu.glb",
    "quaternius_Deer.glb",
    "RiggedSimple.glb",
    "MorphStressTest.glb",
    "cat_16k.glb",
    "suzanne_15k.glb",
    "bunny_69k.glb",
    "sample:creature",
];

/// The largest part of a shared mesh, as large as what the preset describes.
fn mesh_of(name: &str, preset: &Preset) -> Option<Mesh> {
    let path = format!("{}/../shared/assets/real/{name}", env!("CARGO_MANIFEST_DIR"));
    let asset = furrier::asset::load(if name.starts_with("sample:") { name } else { &path }).ok()?;
    let part = asset.parts.iter().max_by_key(|part| part.stored.triangles.len())?;
    part.mesh(f64::from(preset.size_m) / asset.diagonal_units).ok()
}

fn tile_of(preset: &Preset) -> Tile {
    let guard = Fibre::guard(&preset.guard, &preset.colour, preset.size_m);
    let undercoat = Fibre::undercoat(&preset.undercoat, &preset.colour, preset.size_m);
    let hair = TileHair::grow(&guard, &undercoat, preset.shells.tile_mm * 1e-3, 0);
    let recipe = TileRecipe {
        preset: preset.name.clone(),
        shells: preset.shells,
        fins: preset.fins,
        skin: Vec3::from(preset.colour.skin),
        lean_deg: preset.groom.lean_deg,
        looks: None,
        draft: false,
    };
    bake(&hair, &recipe)
}

fn combed(mesh: &Mesh) -> DirectionField {
    directions(mesh, &[FieldSource::Tailward { sag: 0.3 }]).expect("a comb")
}

fn seams_of(mesh: &Mesh, comb: &[Vec3], lean_deg: f32, patches: &Patches, tile: &Tile) -> BeforeAfter {
    let (sin, cos) = lean_deg.to_radians().sin_cos();
    let offset: Vec<Vec3> = mesh.smooth_normals().iter().zip(comb).map(|(&n, &c)| n * cos + c * sin).collect();
    before_after(mesh, &offset, &axes(mesh, comb, patches), patches, tile, 4 * WINDOWS)
}

fn meshes(part: &str) {
    let preset = Preset::load("fox").expect("built in");
    let tile = tile_of(&preset);
    println!(
        "| mesh | method | triangles | patches | singular values: mean, 5 %, 95 % | within, % | angle, ° | texels per mm: 5 %, 95 % | seams | difference | variance | ms |"
    );
    for name in MESHES.into_iter().filter(|name| name.contains(part)) {
        let Some(mesh) = mesh_of(name, &preset) else { continue };
        let comb = combed(&mesh).direction;
        let mut methods = vec![("lapped", Parameterisation::Lapped { seed: 0 })];
        if mesh.triangles.len() < 20_000 {
            methods.push(("atlas", Parameterisation::Atlas { texels_per_tile: 128, padding_texels: 4 }));
        }
        let own = Parameterisation::Uv { set: 0 };
        if parameterise(&mesh, &comb, tile.edge_m, own).is_ok() {
            methods.push(("uv", own));
        }
        for (method, of) in methods {
            let start = Instant::now();
            let patches = parameterise(&mesh, &comb, tile.edge_m, of).expect("patches");
            let ms = start.elapsed().as_secs_f64() * 1e3;
            let seams = seams_of(&mesh, &comb, preset.groom.lean_deg, &patches, &tile);
            let loose = furrier::fur::patch::measure(&mesh, &comb, tile.edge_m, &patches.by_chance());
            let s = &patches.stats;
            let root = s.area_m2.sqrt();
            let texels = f64::from(tile.shells.size) * 1e-3;
            let arrow = |before: String, after: String| {
                if before == after || method != "lapped" { after } else { format!("{before} → {after}") }
            };
            println!(
                "| {} | {method} | {} | {} | {:.3} {:.3} {:.3} | {:.1} | {:.1} | {:.2} {:.2} | {} | {} | {:.2} | {ms:.0} |",
                name.split('.').next().unwrap_or(name),
                s.faces,
                s.patches,
                s.singular_values.mean,
                s.singular_values.p5,
                s.singular_values.p95,
                s.within * 100.0,
                s.field_angle_rad.to_degrees(),
                s.tiles_per_m.p5 * texels,
                s.tiles_per_m.p95 * texels,
                arrow(format!("{:.1}", loose.seams_m / root), format!("{:.1}", s.seams_m / root)),
                arrow(format!("{:.2}", seams.by_chance.difference), format!("{:.2}", seams.on_skin.difference)),
                seams.on_skin.variance,
            );
        }
    }
}

fn seams(seeds: u64, part: &str) {
    for (preset, names) in [("rabbit", &["bunny_5k.glb"][..]), ("fox", &MESHES[..])] {
        let preset = Preset::load(preset).expect("built in");
        let tile = tile_of(&preset);
        for name in names.iter().filter(|name| name.contains(part)) {
            let Some(mesh) = mesh_of(name, &preset) else { continue };
            let comb = combed(&mesh).direction;
            let rows: Vec<String> = (0..seeds)
                .map(|seed| {
                    let patches =
                        parameterise(&mesh, &comb, tile.edge_m, Parameterisation::Lapped { seed }).expect("patches");
                    let seams = seams_of(&mesh, &comb, preset.groom.lean_deg, &patches, &tile).on_skin;
                    let s = &patches.stats;
                    format!(
                        "{:.3} {:.2} ({} p, {:.1} %, {:.1}°, {:.1})",
                        seams.difference,
                        seams.variance,
                        s.patches,
                        s.within * 100.0,
                        s.field_angle_rad.to_degrees(),
                        s.seams_m / s.area_m2.sqrt()
                    )
                })
                .collect();
            println!("{} {name}: {}", preset.name, rows.join("; "));
        }
    }
}

fn comb() {
    let preset = Preset::load("fox").expect("built in");
    println!("| mesh | triangles | singularities | sum of indices | ms |");
    for name in MESHES {
        let Some(mesh) = mesh_of(name, &preset) else { continue };
        let start = Instant::now();
        let found = combed(&mesh).singularities;
        let ms = start.elapsed().as_secs_f64() * 1e3;
        let sum: i32 = found.iter().map(|s| s.index).sum();
        println!(
            "| {} | {} | {} | {sum} | {ms:.0} |",
            name.split('.').next().unwrap_or(name),
            mesh.triangles.len(),
            found.len()
        );
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let what = arguments.first().map_or("", String::as_str);
    let part = arguments.get(2).map_or("", String::as_str);
    let seeds = arguments.get(1).and_then(|n| n.parse().ok()).unwrap_or(3);
    if what.is_empty() || what == "comb" {
        comb();
    }
    if what.is_empty() || what == "seams" {
        seams(seeds, part);
    }
    if what.is_empty() || what == "meshes" {
        meshes(part);
    }
}
