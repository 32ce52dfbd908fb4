//! Charts with texels of their own: cut and flattened by xatlas, then turned to the comb, scaled and packed by us.
//!
//! xatlas packs charts as its own boxes lie, stretched to whole texels. Hair needs them along the comb and true to
//! scale, so only its charts are used: the stretch is undone, and the turned boxes are packed again.

use super::align::align;
use super::face::Face;
use super::measure::measure;
use super::pack::pack;
use super::xatlas::{Charts, Options, charts};
use crate::data::mesh::Mesh;
use crate::data::patches::{Patches, Square};
use crate::data::topology::Topology;
use crate::error::{Error, Result};
use crate::math::{DVec2, Vec2, Vec3};
use std::collections::BTreeMap;

/// A chart's largest area in mean triangles. xatlas' time grows with the square of it, its stretch too; chosen by the
/// table in `docs/steps/patch.md`.
const CHART_TRIANGLES: f64 = 200.0;
/// xatlas' own defaults.
const MAX_COST: f32 = 2.0;
const ITERATIONS: u32 = 1;

/// See [`super::parameterise`].
pub(super) fn parameterise(
    mesh: &Mesh,
    direction: &[Vec3],
    tile_edge_m: f32,
    texels_per_tile: u32,
    padding_texels: u32,
) -> Result<Patches> {
    let faces = Face::all(mesh);
    let (mut patches, patch_of) = chart(mesh, &faces, charts_of(mesh, &faces)?);
    undo_stretch(&faces, &patch_of, &patches.triangles, &mut patches.uv);
    align(mesh, &faces, direction, f64::from(tile_edge_m), &patches.triangles, &patch_of, &mut patches.uv);
    place(&mut patches, texels_per_tile as f32, padding_texels);
    let topology = Topology::new(&mesh.triangles, |v| mesh.position_class[v as usize]);
    patches.stats = measure(mesh, &topology, &faces, direction, f64::from(tile_edge_m), &patches);
    Ok(patches)
}

/// Number of charts that xatlas cuts, and nothing else: what [`parameterise`](super::parameterise) is to be timed against.
///
/// # Errors
/// Where xatlas gives the mesh up.
pub fn xatlas_alone(mesh: &Mesh) -> Result<usize> {
    let charts = charts_of(mesh, &Face::all(mesh))?;
    Ok(charts.chart.iter().filter(|&&c| c != u32::MAX).max().map_or(0, |&c| c as usize + 1))
}

/// A mean triangle's edge, m, and the power of two that brings it to about 1.
fn mean_edge(faces: &[Face]) -> (f64, f32) {
    // That keeps clear of xatlas' absolute limits; a power of two keeps every bit.
    let area: f64 = faces.iter().map(|f| f.area_m2).sum();
    let mean_edge = (area / faces.len().max(1) as f64).sqrt();
    (mean_edge, if mean_edge > 0.0 { libm::exp2(-libm::log2(mean_edge).round()) } else { 1.0 } as f32)
}

fn charts_of(mesh: &Mesh, faces: &[Face]) -> Result<Charts> {
    let (mean_edge, scale) = mean_edge(faces);
    // Points that are one place get one position, or xatlas would cut the skin there.
    let positions: Vec<Vec3> = mesh.position_class.iter().map(|&c| mesh.positions_m[c as usize] * scale).collect();
    let max_area = (CHART_TRIANGLES * (mean_edge * f64::from(scale)).powi(2)) as f32;
    let options = Options { max_area, max_cost: MAX_COST, iterations: ITERATIONS };
    charts(&positions, &mesh.triangles, options).ok_or_else(|| {
        Error::input("xatlas could not cut the mesh into charts")
            .with_found(format!("{} triangles", mesh.triangles.len()))
            .with_hint("use `parameterisation` lapped")
    })
}

/// Coat vertices as xatlas cuts them, and each triangle's chart. Triangles that xatlas ignores for want of area become
/// charts of their own.
fn chart(mesh: &Mesh, faces: &[Face], charts: Charts) -> (Patches, Vec<u32>) {
    let (_, scale) = mean_edge(faces);
    let mut patches = Patches::default();
    let mut patch_of = Vec::with_capacity(mesh.triangles.len());
    let mut made: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    let charted = charts.chart.iter().filter(|&&c| c != u32::MAX).max().map_or(0, |&c| c + 1);
    let mut numbers = vec![u32::MAX; charted as usize];
    let mut next_patch = 0;
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let found = charts.triangles[t];
        let sound = found.iter().zip(triangle).all(|(&f, &v)| {
            charts.source[f as usize] == v && charts.chart[f as usize] == charts.chart[found[0] as usize]
        });
        let chart = charts.chart[found[0] as usize];
        let own = !sound || chart == u32::MAX;
        let patch = if own { u32::MAX } else { numbers[chart as usize] };
        let patch = if patch == u32::MAX { next_patch } else { patch };
        if patch == next_patch {
            next_patch += 1;
            if !own {
                numbers[chart as usize] = patch;
            }
        }
        let flat = [Vec2::ZERO, faces[t].corner_m[0].as_vec2() * scale, faces[t].corner_m[1].as_vec2() * scale];
        patches.triangles.push(std::array::from_fn(|k| {
            let next = patches.base_vertex.len() as u32;
            let vertex = *made.entry((patch, if own { k as u32 } else { found[k] })).or_insert(next);
            if vertex == next {
                patches.base_vertex.push(triangle[k]);
                patches.patch.push(patch);
                patches.uv.push(if own { flat[k] } else { Vec2::from_array(charts.uv[found[k] as usize]) });
            }
            vertex
        }));
        patch_of.push(patch);
    }
    (patches, patch_of)
}

/// Charts come back stretched along u and v to whole texels. Flattening was conformal, so the ratio that makes the
/// gradients of u and v equal in the mean square undoes it.
fn undo_stretch(faces: &[Face], patch_of: &[u32], triangles: &[[u32; 3]], uv: &mut [Vec2]) {
    let mut squares = vec![DVec2::ZERO; patch_of.iter().max().map_or(0, |&p| p as usize + 1)];
    for (t, face) in faces.iter().enumerate() {
        if let Some([x, y]) = face.jacobian(triangles[t].map(|v| uv[v as usize].as_dvec2())) {
            squares[patch_of[t] as usize] += (x * x + y * y) * face.area_m2;
        }
    }
    let mut done = vec![false; uv.len()];
    for (t, triangle) in triangles.iter().enumerate() {
        let square = squares[patch_of[t] as usize];
        let ratio = if square.min_element() > 0.0 { (square.x / square.y).sqrt() as f32 } else { 1.0 };
        for &v in triangle {
            if !std::mem::replace(&mut done[v as usize], true) {
                uv[v as usize].y *= ratio;
            }
        }
    }
}

/// Corners of the box around each chart, in tiles.
fn boxes(patches: &Patches) -> Vec<[Vec2; 2]> {
    let count = patches.patch.iter().max().map_or(0, |&p| p as usize + 1);
    let mut boxes = vec![[Vec2::INFINITY, Vec2::NEG_INFINITY]; count];
    for (&p, &uv) in patches.patch.iter().zip(&patches.uv) {
        let [low, high] = &mut boxes[p as usize];
        (*low, *high) = (low.min(uv), high.max(uv));
    }
    boxes
}

/// Rectangles of whole texels around boxes, with padding.
fn rectangles(boxes: &[[Vec2; 2]], texels_per_tile: f32, padding: u32) -> Vec<[u32; 2]> {
    let size = |[low, high]: &[Vec2; 2]| {
        let texels = ((*high - *low) * texels_per_tile).ceil();
        [texels.x as u32 + 2 * padding, texels.y as u32 + 2 * padding]
    };
    boxes.iter().map(size).collect()
}

/// Gives each chart a rectangle of whole texels with padding around it.
fn place(patches: &mut Patches, texels_per_tile: f32, padding: u32) {
    let boxes = boxes(patches);
    let packing = pack(&rectangles(&boxes, texels_per_tile, padding));
    for (&p, uv) in patches.patch.iter().zip(&mut patches.uv) {
        let at = packing.at[p as usize].map(|texel| (texel + padding) as f32 / texels_per_tile);
        *uv += Vec2::from_array(at) - boxes[p as usize][0];
    }
    patches.extent = Vec2::new(packing.size[0] as f32, packing.size[1] as f32) / texels_per_tile;
}

/// Packs the charts of all `sets`, made for one edge of tile `tile_edge_m`, into one square of `texels` along its edge, as large as
/// they go, with `padding` texels around each or as many fewer as it takes. UVs then run over the square, from 0 to 1.
///
/// # Errors
/// When there are more charts than the square has room for.
pub fn fit(sets: &mut [Patches], tile_edge_m: f32, texels: u32, padding: u32) -> Result<Square> {
    let of_set: Vec<Vec<[Vec2; 2]>> = sets.iter().map(boxes).collect();
    let all: Vec<[Vec2; 2]> = of_set.iter().flatten().copied().collect();
    let packed = |texels_per_tile: f32, padding: u32| {
        let sizes = rectangles(&all, texels_per_tile, padding);
        let packing = pack(&sizes);
        (packing.size[0].max(packing.size[1]) <= texels).then_some((packing.at, sizes))
    };
    let area: f32 = all.iter().map(|[low, high]| (*high - *low).max_element().powi(2)).sum();
    for padding in [padding, padding / 2, padding / 4, 1] {
        // The whole square would be full at the most; a thousandth of that is no picture of hair any more.
        let mut most = 2.0 * texels as f32 / area.sqrt().max(1e-6);
        let mut least = 1e-3 * most;
        let Some(mut found) = packed(least, padding) else { continue };
        for _ in 0..24 {
            let middle = 0.5 * (least + most);
            match packed(middle, padding) {
                Some(packing) => (least, found) = (middle, packing),
                None => most = middle,
            }
        }
        let scale = least / texels as f32;
        let mut next = 0;
        let mut square = Square { texels, edge_m: tile_edge_m / scale, padding, charts: Vec::new() };
        for (patches, boxes) in sets.iter_mut().zip(&of_set) {
            for (&p, uv) in patches.patch.iter().zip(&mut patches.uv) {
                let at = found.0[next + p as usize].map(|texel| (texel + padding) as f32 / texels as f32);
                *uv = (*uv - boxes[p as usize][0]) * scale + Vec2::from_array(at);
            }
            let rectangle = |i: usize| [found.0[i][0], found.0[i][1], found.1[i][0], found.1[i][1]];
            square.charts.push((next..next + boxes.len()).map(rectangle).collect());
            next += boxes.len();
            patches.extent = Vec2::ONE;
            let density = &mut patches.stats.tiles_per_m;
            for value in [&mut density.mean, &mut density.p5, &mut density.p95] {
                *value *= f64::from(scale);
            }
        }
        return Ok(square);
    }
    Err(Error::usage("the charts do not fit into the texture")
        .with_parameter("texture size")
        .with_found(format!("{texels}\u{b2} texels for {} charts", all.len()))
        .with_expected("room for each with a texel around it")
        .with_hint("give more texels, or use `parameterisation` lapped"))
}
