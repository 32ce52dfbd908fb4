//! The kernels of a picture and what they bind.

use crate::error::Result;
use crate::gpu::{Binding, Gpu, Kernel, Source};

macro_rules! source {
    ($path:literal) => {
        Source { path: $path, text: include_str!(concat!("../../../shaders/", $path)) }
    };
}

/// Files that others import, imported ones first.
pub const SHARED: [Source; 15] = [
    source!("shared/hash.wgsl"),
    source!("shared/noise.wgsl"),
    source!("shared/prism.wgsl"),
    source!("shared/scene.wgsl"),
    source!("shared/fur_light.wgsl"),
    source!("shared/undercoat.wgsl"),
    source!("shared/camera.wgsl"),
    source!("shared/march.wgsl"),
    source!("shared/undercoat_look.wgsl"),
    source!("shared/blocks.wgsl"),
    source!("shared/faces.wgsl"),
    source!("shared/stretch.wgsl"),
    source!("shared/guard.wgsl"),
    source!("shared/fragments.wgsl"),
    source!("shared/skin_look.wgsl"),
];
/// Fills stored density.
pub const DENSITY: Source = source!("render/density.wgsl");
/// Fills stored shadow.
pub const SHADOW: Source = source!("render/shadow.wgsl");
/// Lights guard hair.
pub const STRANDS: Source = source!("render/strands.wgsl");
/// Draws the skin's depth.
pub const SKIN: Source = source!("render/skin.wgsl");
/// Finds where rays enter the shell.
pub const ENTRANCES: Source = source!("render/entrances.wgsl");
/// Turns counts into places in lists.
pub const ALLOT: Source = source!("render/allot.wgsl");
/// Follows rays through undercoat.
pub const MARCH: Source = source!("render/march.wgsl");
/// Draws guard hair.
pub const GUARD: Source = source!("render/guard.wgsl");
/// Leaves out what is hidden.
pub const TRIM: Source = source!("render/trim.wgsl");
/// Sorts fragments.
pub const ORDER: Source = source!("render/order.wgsl");
/// Puts all into one colour.
pub const COMPOSITE: Source = source!("render/composite.wgsl");
/// Fills a film with what is not a number.
pub const POISON: Source = source!("render/poison.wgsl");
/// All kernels.
pub const ALL: [Source; 12] =
    [DENSITY, SHADOW, STRANDS, SKIN, ENTRANCES, ALLOT, MARCH, GUARD, TRIM, ORDER, COMPOSITE, POISON];

/// What kernels bind: 0 and 1 are the same for all, 2 for all but those that fill blocks.
pub(super) struct Layouts {
    /// Group 0: the scene.
    pub scene: wgpu::BindGroupLayout,
    /// Group 1: stored density and shadow.
    pub volume: wgpu::BindGroupLayout,
    /// Group 2: the view and a band's pixels.
    pub frame: wgpu::BindGroupLayout,
    /// Group 2 of what fills blocks.
    pub blocks: wgpu::BindGroupLayout,
    /// Group 3: one array.
    pub one: wgpu::BindGroupLayout,
    /// Group 3 of the entrances.
    pub entrances: wgpu::BindGroupLayout,
    /// Group 3 of the march.
    pub march: wgpu::BindGroupLayout,
    /// Group 3 of guard hair.
    pub guard: wgpu::BindGroupLayout,
    /// Group 3 of compositing.
    pub composite: wgpu::BindGroupLayout,
    /// Group 3 of sorting.
    pub order: wgpu::BindGroupLayout,
}

impl Layouts {
    fn new(gpu: &Gpu) -> Self {
        use Binding::{Read, Uniform, Write};
        Self {
            scene: gpu.layout("scene", &[Uniform, Read, Read, Read, Read, Read, Read]),
            volume: gpu.layout("volume", &[Read, Read]),
            frame: gpu.layout("frame", &[Uniform, Write, Write, Write, Write, Write, Write, Write]),
            blocks: gpu.layout("blocks", &[Uniform, Read, Write]),
            one: gpu.layout("one", &[Write]),
            entrances: gpu.layout("entrances", &[Read, Write]),
            march: gpu.layout("march", &[Read, Write, Read, Write]),
            guard: gpu.layout("guard", &[Write, Write, Write, Write]),
            order: gpu.layout("order", &[Read, Read, Read, Write]),
            composite: gpu.layout("composite", &[Read, Read, Read, Read, Read, Read, Write]),
        }
    }
}

/// Every kernel, compiled.
pub(super) struct Kernels {
    pub layouts: Layouts,
    pub density: Kernel,
    pub shadow: Kernel,
    pub strands: Kernel,
    /// First depths, then triangles.
    pub skin: [Kernel; 2],
    /// First counts, then lists.
    pub entrances: [Kernel; 2],
    /// First places for starts, then for fragments.
    pub allot: [Kernel; 2],
    pub march: Kernel,
    /// First counts, then lists.
    pub guard: [Kernel; 2],
    pub trim: Kernel,
    pub order: Kernel,
    pub composite: Kernel,
    pub poison: Kernel,
}

impl Kernels {
    /// Compiles all; `simplified` chooses the blending.
    pub(super) fn new(gpu: &Gpu, simplified: bool) -> Result<Self> {
        let layouts = Layouts::new(gpu);
        let Layouts { scene, volume, frame, blocks, one, entrances, march, guard, order, composite } = &layouts;
        let kernel = |main, own: &[&wgpu::BindGroupLayout], constants: &[(&str, f64)]| {
            gpu.kernel(main, &SHARED, &[&[scene, volume], own].concat(), constants)
        };
        let both = |main, own: &[_], name| Ok([kernel(main, own, &[(name, 0.0)])?, kernel(main, own, &[(name, 1.0)])?]);
        Ok(Self {
            density: kernel(DENSITY, &[blocks], &[])?,
            shadow: kernel(SHADOW, &[blocks], &[])?,
            strands: kernel(STRANDS, &[frame, one], &[])?,
            skin: both(SKIN, &[frame], "NAME")?,
            entrances: both(ENTRANCES, &[frame, entrances], "FILL")?,
            allot: both(ALLOT, &[frame], "OF_FRAGMENTS")?,
            march: kernel(MARCH, &[frame, march], &[])?,
            guard: both(GUARD, &[frame, guard], "FILL")?,
            trim: kernel(TRIM, &[frame, guard], &[])?,
            order: kernel(ORDER, &[frame, order], &[])?,
            composite: kernel(COMPOSITE, &[frame, composite], &[("SIMPLIFIED", f64::from(simplified))])?,
            poison: kernel(POISON, &[frame, one], &[])?,
            layouts,
        })
    }
}
