//! xatlas.h, as far as it is needed: structs field by field, functions under their C++ names, those of
//! the Itanium ABI or of Microsoft's compiler (which xatlas-rs has, made by bindgen).

use std::ffi::{c_char, c_int, c_void};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

// Links the C++ library that this crate builds.
extern crate xatlas_rs as _;

#[repr(C)]
pub(super) struct AtlasHeader {
    pub width: u32,
    pub height: u32,
    pub atlas_count: u32,
    pub chart_count: u32,
    pub mesh_count: u32,
    pub meshes: *const OutMesh,
    pub utilization: *const f32,
    pub texels_per_unit: f32,
}

#[repr(C)]
pub(super) struct OutChart {
    pub atlas_index: u32,
    pub indices: *const u32,
    pub index_count: u32,
}

#[repr(C)]
pub(super) struct OutVertex {
    pub atlas_index: i32,
    pub uv: [f32; 2],
    pub xref: u32,
}

#[repr(C)]
pub(super) struct OutMesh {
    pub charts: *const OutChart,
    pub chart_count: u32,
    pub indices: *const u32,
    pub index_count: u32,
    pub vertices: *const OutVertex,
    pub vertex_count: u32,
}

#[repr(C)]
pub(super) struct MeshDecl {
    pub vertex_count: u32,
    pub positions: *const c_void,
    pub position_stride: u32,
    pub normals: *const c_void,
    pub normal_stride: u32,
    pub uvs: *const c_void,
    pub uv_stride: u32,
    pub index_count: u32,
    pub indices: *const c_void,
    pub index_offset: i32,
    pub index_format: c_int,
    pub face_ignore: *const bool,
}

#[repr(C)]
pub(super) struct ChartOptions {
    pub max_chart_area: f32,
    pub max_boundary_length: f32,
    pub proxy_fit_weight: f32,
    pub roundness_weight: f32,
    pub straightness_weight: f32,
    pub normal_seam_weight: f32,
    pub texture_seam_weight: f32,
    pub max_threshold: f32,
    pub grow_face_count: u32,
    pub max_iterations: u32,
}

#[repr(C)]
pub(super) struct PackOptions {
    pub attempts: c_int,
    pub texels_per_unit: f32,
    pub resolution: u32,
    pub max_chart_size: u32,
    pub block_align: bool,
    pub conservative: bool,
    pub padding: u32,
}

/// Stops the build where a struct does not lie as the C++ compiler lays it out: its size and where each field begins,
/// bytes. `tests/xatlas.rs` reads these lines and asks a C++ compiler whether xatlas.h agrees, under the names it has there.
macro_rules! layout {
    ($rust:ident = $cpp:ident, $size:literal: $($field:ident = $name:ident $at:literal),+) => {
        #[cfg(target_pointer_width = "64")]
        const _: () = {
            assert!(size_of::<$rust>() == $size);
            $(assert!(std::mem::offset_of!($rust, $field) == $at);)+
        };
    };
}

layout! { AtlasHeader = Atlas, 48: width = width 0, height = height 4, atlas_count = atlasCount 8,
chart_count = chartCount 12, mesh_count = meshCount 16, meshes = meshes 24, utilization = utilization 32,
texels_per_unit = texelsPerUnit 40 }
layout! { OutChart = Chart, 24: atlas_index = atlasIndex 0, indices = indexArray 8, index_count = indexCount 16 }
layout! { OutVertex = Vertex, 16: atlas_index = atlasIndex 0, uv = uv 4, xref = xref 12 }
layout! { OutMesh = Mesh, 48: charts = chartArray 0, chart_count = chartCount 8, indices = indexArray 16,
index_count = indexCount 24, vertices = vertexArray 32, vertex_count = vertexCount 40 }
layout! { MeshDecl = MeshDecl, 80: vertex_count = vertexCount 0, positions = vertexPositionData 8,
position_stride = vertexPositionStride 16, normals = vertexNormalData 24, normal_stride = vertexNormalStride 32,
uvs = vertexUvData 40, uv_stride = vertexUvStride 48, index_count = indexCount 52, indices = indexData 56,
index_offset = indexOffset 64, index_format = indexFormat 68, face_ignore = faceIgnoreData 72 }
layout! { ChartOptions = ChartOptions, 40: max_chart_area = maxChartArea 0, max_boundary_length = maxBoundaryLength 4,
proxy_fit_weight = proxyFitMetricWeight 8, roundness_weight = roundnessMetricWeight 12,
straightness_weight = straightnessMetricWeight 16, normal_seam_weight = normalSeamMetricWeight 20,
texture_seam_weight = textureSeamMetricWeight 24, max_threshold = maxThreshold 28, grow_face_count = growFaceCount 32,
max_iterations = maxIterations 36 }
layout! { PackOptions = PackOptions, 24: attempts = attempts 0, texels_per_unit = texelsPerUnit 4,
resolution = resolution 8, max_chart_size = maxChartSize 12, block_align = blockAlign 16, conservative = conservative 17,
padding = padding 20 }

type Progress = Option<extern "C" fn(c_int, c_int, *mut c_void)>;
type Parameterise = Option<extern "C" fn(*const f32, *mut f32, u32, *const u32, u32, bool)>;
type Print = Option<unsafe extern "C" fn(*const c_char, ...) -> c_int>;

unsafe extern "C" {
    #[cfg_attr(not(target_env = "msvc"), link_name = "_ZN6xatlas6CreateEv")]
    #[cfg_attr(target_env = "msvc", link_name = "\u{1}?Create@xatlas@@YAPEAUAtlas@1@XZ")]
    fn create() -> *mut AtlasHeader;
    #[cfg_attr(not(target_env = "msvc"), link_name = "_ZN6xatlas7DestroyEPNS_5AtlasE")]
    #[cfg_attr(target_env = "msvc", link_name = "\u{1}?Destroy@xatlas@@YAXPEAUAtlas@1@@Z")]
    fn destroy(atlas: *mut AtlasHeader);
    #[cfg_attr(not(target_env = "msvc"), link_name = "_ZN6xatlas7AddMeshEPNS_5AtlasERKNS_8MeshDeclE")]
    #[cfg_attr(
        target_env = "msvc",
        link_name = "\u{1}?AddMesh@xatlas@@YA?AW4Enum@AddMeshError@1@PEAUAtlas@1@AEBUMeshDecl@1@@Z"
    )]
    pub(super) fn add_mesh(atlas: *mut AtlasHeader, decl: *const MeshDecl) -> c_int;
    #[cfg_attr(not(target_env = "msvc"), link_name = "_ZN6xatlas8SetPrintEPFiPKczEb")]
    #[cfg_attr(target_env = "msvc", link_name = "\u{1}?SetPrint@xatlas@@YAXP6AHPEBDZZ_N@Z")]
    pub(super) fn set_print(print: Print, verbose: bool);
    #[cfg_attr(
        not(target_env = "msvc"),
        link_name = "_ZN6xatlas8GenerateEPNS_5AtlasENS_12ChartOptionsEPFvPKfPfjPKjjbENS_11PackOptionsEPFvNS_16ProgressCategory4EnumEiPvESD_"
    )]
    #[cfg_attr(
        target_env = "msvc",
        link_name = "\u{1}?Generate@xatlas@@YAXPEAUAtlas@1@UChartOptions@1@P6AXPEBMPEAMIPEBII_N@ZUPackOptions@1@P6AXW4Enum@ProgressCategory@1@HPEAX@Z9@Z"
    )]
    pub(super) fn generate(
        atlas: *mut AtlasHeader,
        charts: ChartOptions,
        parameterise: Parameterise,
        pack: PackOptions,
        progress: Progress,
        user: *mut c_void,
    );
}

/// `IndexFormat::UInt32`.
pub(super) const INDEX_U32: c_int = 1;

/// Longest wait for xatlas to stop its 16 workers: some milliseconds, 0.2 s at most on a busy machine.
const LONGEST_STOP: Duration = Duration::from_secs(2);

/// An atlas, destroyed when it goes, also where copying its results panics.
pub(super) struct Atlas(*mut AtlasHeader);

impl Atlas {
    /// An empty atlas; `None` where xatlas has no memory for it.
    pub(super) fn new() -> Option<Self> {
        // SAFETY: it takes nothing and gives an atlas or null.
        let atlas = unsafe { create() };
        (!atlas.is_null()).then_some(Self(atlas))
    }

    /// What xatlas' functions take; it lives as long as `self`.
    pub(super) fn pointer(&self) -> *mut AtlasHeader {
        self.0
    }
}

/// An atlas on its way out.
struct Doomed(*mut AtlasHeader);

// SAFETY: xatlas ties no atlas to the thread that made it.
unsafe impl Send for Doomed {}

impl Doomed {
    fn destroy(self) {
        // SAFETY: the pointer came from `create`, its owner is gone, and this is the only call.
        unsafe { destroy(self.0) }
    }
}

impl Drop for Atlas {
    /// Waits until the atlas is destroyed, though not forever: in this version, a worker that falls asleep just as xatlas
    /// stops its workers is never woken, and `Destroy` waits for it without end (`docs/decisions/patch.md`). Then a sleeping
    /// thread and the atlas are lost, not the caller. Where no thread can be had the atlas is lost too.
    fn drop(&mut self) {
        let doomed = Doomed(self.0);
        let (done, stopped) = channel();
        let work = move || {
            doomed.destroy();
            drop(done);
        };
        let Ok(thread) = std::thread::Builder::new().name("xatlas stop".to_owned()).spawn(work) else { return };
        match stopped.recv_timeout(LONGEST_STOP) {
            Err(RecvTimeoutError::Timeout) => tracing::warn!("xatlas did not stop; a thread of it stays asleep"),
            Ok(()) | Err(RecvTimeoutError::Disconnected) => drop(thread.join()),
        }
    }
}
