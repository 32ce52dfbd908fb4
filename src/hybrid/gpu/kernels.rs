//! The kernels of a picture and what they bind.

use super::constants::CONSTANTS;
use crate::error::{Error, Result};
use crate::gpu::{Binding, Gpu, Kernel, Library, Source, Text};
use crate::volume::lighting::LAW_CONSTANTS;

macro_rules! source {
    ($path:literal) => {
        Source { path: $path, text: Text::Wgsl(include_str!(concat!("../../../shaders/", $path))) }
    };
}

/// Modules that others import, imported ones first.
pub const SHARED: [Source; 22] = [
    Source::constants("constants", &CONSTANTS),
    Source::constants("law_constants", &LAW_CONSTANTS),
    source!("shared/look.wgsl"),
    source!("hybrid/looks.wgsl"),
    source!("shared/law.wgsl"),
    source!("shared/hash.wgsl"),
    source!("shared/noise.wgsl"),
    source!("shared/prism.wgsl"),
    source!("shared/light.wgsl"),
    source!("shared/scene.wgsl"),
    source!("shared/fur_light.wgsl"),
    source!("shared/mean_shadow.wgsl"),
    source!("shared/undercoat.wgsl"),
    source!("shared/camera.wgsl"),
    source!("shared/march.wgsl"),
    source!("shared/undercoat_light.wgsl"),
    source!("shared/blocks.wgsl"),
    source!("shared/faces.wgsl"),
    source!("shared/virtual_fragment.wgsl"),
    source!("shared/guard.wgsl"),
    source!("shared/fragments.wgsl"),
    source!("shared/skin_light.wgsl"),
];
/// Fills stored density.
pub const DENSITY: Source = source!("hybrid/density.wgsl");
/// Fills stored shadow.
pub const SHADOW: Source = source!("hybrid/shadow.wgsl");
/// Lights guard hair.
pub const STRANDS: Source = source!("hybrid/strands.wgsl");
/// Draws the skin's depth.
pub const SKIN: Source = source!("hybrid/skin.wgsl");
/// Finds where rays enter the shell.
pub const ENTRANCES: Source = source!("hybrid/entrances.wgsl");
/// Turns counts into positions in lists.
pub const ALLOT: Source = source!("hybrid/allot.wgsl");
/// Follows rays through undercoat.
pub const MARCH: Source = source!("hybrid/march.wgsl");
/// Draws guard hair.
pub const GUARD: Source = source!("hybrid/guard.wgsl");
/// Leaves out what is hidden.
pub const TRIM: Source = source!("hybrid/trim.wgsl");
/// Sorts fragments.
pub const ORDER: Source = source!("hybrid/order.wgsl");
/// Puts all into one colour.
pub const COMPOSITE: Source = source!("hybrid/composite.wgsl");
/// Fills a film with what is not a number.
pub const POISON: Source = source!("hybrid/poison.wgsl");
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
            scene: gpu.layout("scene", &[Uniform, Read, Read, Read, Read, Read, Read, Read, Read]),
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
    /// First positions of starts, then of fragments.
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
        let mut library = Library::new(&SHARED)?;
        let mut compile = |main: Source, own: &[&wgpu::BindGroupLayout], variants: &[&[(&str, f64)]]| {
            let module = gpu.shader_of(&mut library, main)?;
            let groups = [&[scene, volume], own].concat();
            let kernels = variants.iter().map(|constants| gpu.kernel(main.path, &module, &groups, constants));
            Ok::<_, Error>(kernels.collect::<Vec<_>>())
        };
        let mut one_of = |main, own: &[_], constants: &[_]| Ok::<_, Error>(compile(main, own, &[constants])?.remove(0));
        let simplified = [("SIMPLIFIED", f64::from(simplified))];
        let density = one_of(DENSITY, &[blocks], &[])?;
        let shadow = one_of(SHADOW, &[blocks], &[])?;
        let strands = one_of(STRANDS, &[frame, one], &[])?;
        let march_kernel = one_of(MARCH, &[frame, march], &[])?;
        let trim = one_of(TRIM, &[frame, guard], &[])?;
        let order_kernel = one_of(ORDER, &[frame, order], &[])?;
        let composite_kernel = one_of(COMPOSITE, &[frame, composite], &simplified)?;
        let poison = one_of(POISON, &[frame, one], &[])?;
        let mut both = |main, own: &[_], name| {
            let mut kernels = compile(main, own, &[&[(name, 0.0)], &[(name, 1.0)]])?;
            let second = kernels.remove(1);
            Ok::<_, Error>([kernels.remove(0), second])
        };
        Ok(Self {
            density,
            shadow,
            strands,
            skin: both(SKIN, &[frame], "NAME")?,
            entrances: both(ENTRANCES, &[frame, entrances], "FILL")?,
            allot: both(ALLOT, &[frame], "OF_FRAGMENTS")?,
            march: march_kernel,
            guard: both(GUARD, &[frame, guard], "FILL")?,
            trim,
            order: order_kernel,
            composite: composite_kernel,
            poison,
            layouts,
        })
    }
}
