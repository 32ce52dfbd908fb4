//! The door to xatlas (Jonathan Young, MIT licence), the C++ that crate `xatlas-rs` compiles.
//!
//! The crate's own bindings carry the names that one Windows compiler gives these functions. `ffi` declares the few that
//! are needed under the names of the Itanium C++ ABI, which every other platform follows.
#![allow(unsafe_code, reason = "calls into C++; each block says why it is sound")]

mod ffi;

use crate::math::Vec3;
use ffi::{Atlas, ChartOptions, INDEX_U32, MeshDecl, PackOptions, add_mesh, generate, set_print};

/// What xatlas made of a mesh.
pub(super) struct Charts {
    /// Per output vertex: the input vertex it lies on.
    pub source: Vec<u32>,
    /// Per output vertex: coordinates in texels of the packed atlas.
    pub uv: Vec<[f32; 2]>,
    /// Per input triangle: output vertices, in the input's order.
    pub triangles: Vec<[u32; 3]>,
    /// Per output vertex: its chart, or `u32::MAX` for triangles that xatlas ignores (no area).
    pub chart: Vec<u32>,
}

/// Chart options; the rest keep xatlas' defaults.
#[derive(Clone, Copy, Debug)]
pub(super) struct Options {
    /// Area at which a chart stops growing, in squared units of the positions.
    pub max_area: f32,
    /// Sum of weighted costs at which a chart stops growing: larger gives fewer charts with more stretch.
    pub max_cost: f32,
    /// Rounds of seeding and growing: more give better charts.
    pub iterations: u32,
}

/// Charts of the triangles over `positions`, which must be finite and about one unit per edge: xatlas compares with
/// absolute limits. `None` where it rejects the mesh or gives back something inconsistent.
pub(super) fn charts(positions: &[Vec3], triangles: &[[u32; 3]], options: Options) -> Option<Charts> {
    let index_count = u32::try_from(3 * triangles.len()).ok()?;
    let decl = MeshDecl {
        vertex_count: u32::try_from(positions.len()).ok()?,
        positions: positions.as_ptr().cast(),
        position_stride: size_of::<Vec3>() as u32,
        normals: std::ptr::null(),
        normal_stride: 0,
        uvs: std::ptr::null(),
        uv_stride: 0,
        index_count,
        indices: triangles.as_ptr().cast(),
        index_offset: 0,
        index_format: INDEX_U32,
        face_ignore: std::ptr::null(),
    };
    let chart_options = ChartOptions {
        max_chart_area: options.max_area,
        max_boundary_length: 0.0,
        proxy_fit_weight: 2.0,
        roundness_weight: 0.01,
        straightness_weight: 6.0,
        normal_seam_weight: 4.0,
        texture_seam_weight: 0.5,
        max_threshold: options.max_cost,
        grow_face_count: 32,
        max_iterations: options.iterations,
    };
    // The charts are packed anew once they are turned to the comb, so xatlas' own packing is made cheap: one try per
    // chart, and about one texel per triangle.
    let pack = PackOptions {
        attempts: 1,
        texels_per_unit: 1.0,
        resolution: 0,
        max_chart_size: 1024,
        block_align: false,
        conservative: false,
        padding: 0,
    };
    let atlas = Atlas::new()?;
    // SAFETY: the declarations follow xatlas.h of the compiled version, field by field; positions and indices outlive the
    // call that copies them; without a print function xatlas prints nothing; `generate` returns when all its work is done.
    unsafe {
        set_print(None, false);
        if add_mesh(atlas.pointer(), &decl) != 0 {
            return None;
        }
        generate(atlas.pointer(), chart_options, None, pack, None, std::ptr::null_mut());
    }
    // SAFETY: after `generate` the header and the arrays it points to hold the counts stated beside them, until the
    // atlas is destroyed; everything is copied before.
    let (vertices, indices, chart_indices) = unsafe {
        let header = &*atlas.pointer();
        if header.mesh_count != 1 || header.meshes.is_null() {
            return None;
        }
        let mesh = &*header.meshes;
        let charts: Vec<&[u32]> =
            slice(mesh.charts, mesh.chart_count).iter().map(|c| slice(c.indices, c.index_count)).collect();
        (slice(mesh.vertices, mesh.vertex_count), slice(mesh.indices, mesh.index_count), charts)
    };
    if indices.len() != index_count as usize || indices.iter().any(|&i| i as usize >= vertices.len()) {
        return None;
    }
    let mut chart = vec![u32::MAX; vertices.len()];
    for (c, members) in chart_indices.iter().enumerate() {
        for &v in *members {
            *chart.get_mut(v as usize)? = c as u32;
        }
    }
    Some(Charts {
        source: vertices.iter().map(|v| v.xref).collect(),
        uv: vertices.iter().map(|v| v.uv).collect(),
        triangles: indices.as_chunks().0.to_vec(),
        chart,
    })
}

/// A C array as a slice.
///
/// # Safety
/// `data` points to `count` initialised values that live as long as the result is used, or is null.
unsafe fn slice<'a, T>(data: *const T, count: u32) -> &'a [T] {
    if data.is_null() || count == 0 {
        return &[];
    }
    // SAFETY: promised by the caller.
    unsafe { std::slice::from_raw_parts(data, count as usize) }
}
