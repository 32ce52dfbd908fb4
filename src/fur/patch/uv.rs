//! The asset's own texture coordinates, island by island.

use super::align::align;
use super::face::{Face, singular_values};
use super::measure::measure;
use crate::data::mesh::Mesh;
use crate::data::patches::{Patches, Stats};
use crate::data::topology::Topology;
use crate::error::{Error, Result};
use crate::math::{DVec2, Vec2, Vec3};

/// Texture coordinates count as usable when triangles holding this share of the skin's area are mapped soundly.
const USABLE_SHARE: f64 = 0.9;
/// A triangle is mapped soundly when its coordinates are finite and its singular values differ by less than this.
const SOUND_RATIO: f64 = 50.0;
/// Cells along the edge of the raster that finds overlaps.
const RASTER: usize = 1024;
/// Shares of the skin's area below this are not worth a warning.
const NEGLIGIBLE: f64 = 0.001;

/// The share of the skin's area that UV set `set` maps soundly: finite, and not squeezed to a line or point.
fn sound_share(mesh: &Mesh, faces: &[Face], set: &[Vec2]) -> f64 {
    let (mut sound, mut all) = (0.0, 0.0);
    for (t, face) in faces.iter().enumerate() {
        all += face.area_m2;
        let corners = mesh.triangles[t].map(|v| set[v as usize].as_dvec2());
        let Some(jacobian) = face.jacobian(corners) else { continue };
        let [large, small] = singular_values(jacobian);
        if large.is_finite() && small * SOUND_RATIO > large {
            sound += face.area_m2;
        }
    }
    if all > 0.0 { sound / all } else { 0.0 }
}

/// What to try where a UV set cannot be used.
const HINT: &str = "use `parameterisation` atlas, or another `uv set`";

/// Fails where set `set` is none of `sets`.
///
/// # Errors
/// Names the set.
pub fn need(set: usize, sets: usize) -> Result<()> {
    if set < sets {
        return Ok(());
    }
    Err(Error::input("the mesh lacks the UV set asked for")
        .with_field(format!("TEXCOORD_{set}"))
        .with_found(format!("{sets} sets"))
        .with_expected("a set of that number")
        .with_hint(HINT))
}

/// See [`super::parameterise`].
pub(super) fn parameterise(mesh: &Mesh, direction: &[Vec3], tile_edge_m: f32, set: usize) -> Result<Patches> {
    need(set, mesh.uv_sets.len())?;
    let own = &mesh.uv_sets[set];
    let faces = Face::all(mesh);
    let sound = sound_share(mesh, &faces, own);
    if sound < USABLE_SHARE {
        return Err(Error::input("the UV set cannot carry a texture")
            .with_field(format!("TEXCOORD_{set}"))
            .with_found(format!("{:.1} % of the area mapped soundly", 100.0 * sound))
            .with_expected(format!("at least {:.0} %", 100.0 * USABLE_SHARE))
            .with_hint(HINT));
    }

    let finite = |uv: Vec2| if uv.is_finite() { uv } else { Vec2::ZERO };
    let topology = Topology::new(&mesh.triangles, |v| mesh.position_class[v as usize]);
    let patch_of = islands(mesh, &topology, own);
    let (mut patches, original) = split(mesh, &patch_of, |v| finite(own[v as usize]));
    align(mesh, &faces, direction, f64::from(tile_edge_m), &patches.triangles, &patch_of, &mut patches.uv);

    let mirrored_m2 = mirrored_area(&faces, &patches.triangles, &original);
    let overlapped_m2 = overlapped_area(&faces, &patches.triangles, &original);
    let mut stats = measure(mesh, &topology, &faces, direction, f64::from(tile_edge_m), &patches);
    stats.mirrored_m2 = mirrored_m2;
    stats.overlapped_m2 = overlapped_m2;
    warn(&mut stats, set, own.iter().filter(|uv| !uv.is_finite()).count());
    patches.stats = stats;
    Ok(patches)
}

/// The island of each triangle: triangles belong together across edges where both corners agree in place and
/// coordinate. Numbered in order of their first triangle.
fn islands(mesh: &Mesh, topology: &Topology, uv: &[Vec2]) -> Vec<u32> {
    let joined = |t: usize, k: usize, other: usize| {
        let point = |v: u32| (mesh.position_class[v as usize], uv[v as usize].to_array().map(f32::to_bits));
        let ends = [mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]].map(point);
        let corners = mesh.triangles[other].map(point);
        ends.iter().all(|end| corners.contains(end))
    };
    let mut island = vec![u32::MAX; mesh.triangles.len()];
    let mut count = 0;
    let mut waiting = Vec::new();
    for seed in 0..island.len() {
        if island[seed] != u32::MAX {
            continue;
        }
        island[seed] = count;
        waiting.push(seed);
        while let Some(t) = waiting.pop() {
            for k in 0..3 {
                if let Some(other) = topology.neighbour(t, k)
                    && island[other] == u32::MAX
                    && joined(t, k, other)
                {
                    island[other] = count;
                    waiting.push(other);
                }
            }
        }
        count += 1;
    }
    island
}

/// One coat vertex for each pair of island and mesh vertex, in order of first use, with `uv` of the mesh vertex; the
/// second result is a copy of the coordinates before alignment.
fn split(mesh: &Mesh, patch_of: &[u32], uv: impl Fn(u32) -> Vec2) -> (Patches, Vec<Vec2>) {
    let mut patches = Patches::default();
    // A mesh vertex is rarely in two islands (they touch in a point): the last coat vertices made of it suffice.
    let mut latest: Vec<Vec<u32>> = vec![Vec::new(); mesh.positions_m.len()];
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        patches.triangles.push(triangle.map(|v| {
            let made = &mut latest[v as usize];
            if let Some(&found) = made.iter().find(|&&c| patches.patch[c as usize] == patch_of[t]) {
                return found;
            }
            let new = patches.base_vertex.len() as u32;
            patches.base_vertex.push(v);
            patches.patch.push(patch_of[t]);
            patches.uv.push(uv(v));
            made.push(new);
            new
        }));
    }
    let original = patches.uv.clone();
    (patches, original)
}

fn mirrored_area(faces: &[Face], triangles: &[[u32; 3]], uv: &[Vec2]) -> f64 {
    let mirrored = |t: usize| {
        let [x, y] = faces[t].jacobian(triangles[t].map(|v| uv[v as usize].as_dvec2()))?;
        (x.perp_dot(y) < 0.0).then_some(faces[t].area_m2)
    };
    // Images have v downwards, so sound coordinates are mirrored throughout in one of the two conventions: the rarer
    // sense is the one an artist mirrored.
    let all: f64 = faces.iter().map(|f| f.area_m2).sum();
    let mirrored: f64 = (0..faces.len()).filter_map(mirrored).sum();
    mirrored.min(all - mirrored)
}

/// Skin area whose texture is used more than once, found on a raster over the coordinates' bounds.
fn overlapped_area(faces: &[Face], triangles: &[[u32; 3]], uv: &[Vec2]) -> f64 {
    let low = uv.iter().fold(Vec2::INFINITY, |low, &p| low.min(p)).as_dvec2();
    let high = uv.iter().fold(Vec2::NEG_INFINITY, |high, &p| high.max(p)).as_dvec2();
    let scale = RASTER as f64 / (high - low).max(DVec2::splat(f64::MIN_POSITIVE));
    let corners = |t: usize| triangles[t].map(|v| (uv[v as usize].as_dvec2() - low) * scale);
    let mut used = vec![0_u8; RASTER * RASTER];
    for t in 0..triangles.len() {
        for_each_cell(corners(t), |cell| used[cell] = used[cell].saturating_add(1));
    }
    (0..triangles.len())
        .map(|t| {
            let (mut shared, mut cells) = (0_u32, 0_u32);
            for_each_cell(corners(t), |cell| {
                cells += 1;
                shared += u32::from(used[cell] > 1);
            });
            faces[t].area_m2 * f64::from(shared) / f64::from(cells.max(1))
        })
        .sum()
}

/// Visits the raster cells whose centre lies inside the triangle; a centre on an edge counts for one side only.
fn for_each_cell(mut p: [DVec2; 3], mut visit: impl FnMut(usize)) {
    if (p[1] - p[0]).perp_dot(p[2] - p[0]) < 0.0 {
        p.swap(1, 2);
    }
    let low = p[0].min(p[1]).min(p[2]).floor().max(DVec2::ZERO);
    let high = p[0].max(p[1]).max(p[2]).ceil().min(DVec2::splat(RASTER as f64));
    for y in low.y as usize..high.y as usize {
        for x in low.x as usize..high.x as usize {
            let centre = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            let inside = (0..3).all(|k| {
                let (a, b) = (p[k], p[(k + 1) % 3]);
                let side = (b - a).perp_dot(centre - a);
                side > 0.0 || (side == 0.0 && (b.y < a.y || (b.y == a.y && b.x > a.x)))
            });
            if inside {
                visit(y * RASTER + x);
            }
        }
    }
}

fn warn(stats: &mut Stats, set: usize, not_finite: usize) {
    let cm2 = |m2: f64| format!("{:.4} cm² ({:.1} %)", 1e4 * m2, 100.0 * m2 / stats.area_m2);
    let mut warnings = Vec::new();
    if not_finite > 0 {
        warnings.push(format!("TEXCOORD_{set}: {not_finite} coordinates are not finite and were set to 0"));
    }
    if stats.mirrored_m2 > NEGLIGIBLE * stats.area_m2 {
        warnings.push(format!("TEXCOORD_{set}: {} of the skin is mirrored", cm2(stats.mirrored_m2)));
    }
    if stats.overlapped_m2 > NEGLIGIBLE * stats.area_m2 {
        warnings.push(format!("TEXCOORD_{set}: {} of the skin shares its texels", cm2(stats.overlapped_m2)));
    }
    let stretched = (1.0 - stats.within) * stats.area_m2;
    if stretched > NEGLIGIBLE * stats.area_m2 {
        warnings.push(format!("TEXCOORD_{set}: {} of the skin is stretched beyond 0.7 … 1.4", cm2(stretched)));
    }
    stats.warnings = warnings;
}
