//! The door to xatlas (Jonathan Young, MIT licence), the C++ that crate `xatlas-rs` compiles.
//!
//! The crate's own bindings carry the names that one Windows compiler gives these functions. This module declares the
//! few that are needed under the names of the Itanium C++ ABI, which every other platform follows.
#![allow(unsafe_code, reason = "calls into C++; each block says why it is sound")]

use crate::math::Vec3;
use std::ffi::{c_char, c_int, c_void};

// Links the C++ library that this crate builds.
extern crate xatlas_rs as _;

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

#[repr(C)]
struct AtlasHeader {
    width: u32,
    height: u32,
    atlas_count: u32,
    chart_count: u32,
    mesh_count: u32,
    meshes: *const OutMesh,
    utilization: *const f32,
    texels_per_unit: f32,
}

#[repr(C)]
struct OutChart {
    atlas_index: u32,
    indices: *const u32,
    index_count: u32,
}

#[repr(C)]
struct OutVertex {
    atlas_index: i32,
    uv: [f32; 2],
    xref: u32,
}

#[repr(C)]
struct OutMesh {
    charts: *const OutChart,
    chart_count: u32,
    indices: *const u32,
    index_count: u32,
    vertices: *const OutVertex,
    vertex_count: u32,
}

#[repr(C)]
struct MeshDecl {
    vertex_count: u32,
    positions: *const c_void,
    position_stride: u32,
    normals: *const c_void,
    normal_stride: u32,
    uvs: *const c_void,
    uv_stride: u32,
    index_count: u32,
    indices: *const c_void,
    index_offset: i32,
    index_format: c_int,
    face_ignore: *const bool,
}

#[repr(C)]
struct ChartOptions {
    max_chart_area: f32,
    max_boundary_length: f32,
    proxy_fit_weight: f32,
    roundness_weight: f32,
    straightness_weight: f32,
    normal_seam_weight: f32,
    texture_seam_weight: f32,
    max_threshold: f32,
    grow_face_count: u32,
    max_iterations: u32,
}

#[repr(C)]
struct PackOptions {
    attempts: c_int,
    texels_per_unit: f32,
    resolution: u32,
    max_chart_size: u32,
    block_align: bool,
    conservative: bool,
    padding: u32,
}

type Progress = Option<extern "C" fn(c_int, c_int, *mut c_void)>;
type Parameterise = Option<extern "C" fn(*const f32, *mut f32, u32, *const u32, u32, bool)>;
type Print = Option<unsafe extern "C" fn(*const c_char, ...) -> c_int>;

unsafe extern "C" {
    #[link_name = "_ZN6xatlas6CreateEv"]
    fn create() -> *mut AtlasHeader;
    #[link_name = "_ZN6xatlas7DestroyEPNS_5AtlasE"]
    fn destroy(atlas: *mut AtlasHeader);
    #[link_name = "_ZN6xatlas7AddMeshEPNS_5AtlasERKNS_8MeshDeclE"]
    fn add_mesh(atlas: *mut AtlasHeader, decl: *const MeshDecl) -> c_int;
    #[link_name = "_ZN6xatlas8SetPrintEPFiPKczEb"]
    fn set_print(print: Print, verbose: bool);
    #[link_name = "_ZN6xatlas8GenerateEPNS_5AtlasENS_12ChartOptionsEPFvPKfPfjPKjjbENS_11PackOptionsEPFvNS_16ProgressCategory4EnumEiPvESD_"]
    fn generate(
        atlas: *mut AtlasHeader,
        charts: ChartOptions,
        parameterise: Parameterise,
        pack: PackOptions,
        progress: Progress,
        user: *mut c_void,
    );
}

const INDEX_U32: c_int = 1;

/// Destroys the atlas when it goes, also where copying its results panics.
struct Owned(*mut AtlasHeader);

// SAFETY: xatlas ties no atlas to the thread that made it.
unsafe impl Send for Owned {}

impl Owned {
    fn destroy(self) {
        let pointer = self.0;
        std::mem::forget(self);
        // SAFETY: the pointer came from `create`, and forgetting its owner leaves this the only call.
        unsafe { destroy(pointer) }
    }
}

impl Drop for Owned {
    /// Leaves the work to a thread of its own: in this version, a worker that falls asleep just as xatlas stops its
    /// workers is never woken, and `Destroy` waits for it forever (seen once in some hundred calls on a busy machine).
    /// Then one sleeping thread and the atlas are lost, not the caller. Where no thread can be had the atlas is lost too.
    fn drop(&mut self) {
        let atlas = Self(std::mem::replace(&mut self.0, std::ptr::null_mut()));
        if atlas.0.is_null() {
            return;
        }
        let atlas = std::mem::ManuallyDrop::new(atlas);
        let _ = std::thread::Builder::new().spawn(move || std::mem::ManuallyDrop::into_inner(atlas).destroy());
    }
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
    // SAFETY: the declarations above follow xatlas.h of the compiled version, field by field; positions and indices
    // outlive the call that copies them; without a print function xatlas prints nothing; `generate` runs its threads
    // to their end before it returns.
    let atlas = unsafe {
        set_print(None, false);
        let atlas = Owned(create());
        if atlas.0.is_null() || add_mesh(atlas.0, &decl) != 0 {
            return None;
        }
        generate(atlas.0, chart_options, None, pack, None, std::ptr::null_mut());
        atlas
    };
    // SAFETY: after `generate` the header and the arrays it points to hold the counts stated beside them, until the
    // atlas is destroyed; everything is copied before.
    let (vertices, indices, chart_indices) = unsafe {
        let header = &*atlas.0;
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
