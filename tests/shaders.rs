//! Every shader parses and validates, and its structs lie in memory as Rust's do. Needs no adapter.

use furrier::data::coat::LOOK;
use furrier::gpu::light::LightItem;
use furrier::gpu::{Source, compose};
use furrier::hybrid::gpu::items::{InsideItem, StrandItem, TriangleItem, VertexItem, VirtualFragmentItem};
use furrier::hybrid::gpu::kernels;
use furrier::hybrid::gpu::layout::{BlocksUniform, SceneUniform, ViewUniform as CameraUniform};
use furrier::runtime::Item;
use furrier::runtime::gpu::layout::{
    CoatVertex, FinInstance, LayerLook, Mip, PaintUniform, SkinVertex, SlabItem, TileUniform, ViewUniform,
};
use furrier::runtime::gpu::pipelines::{CASTER, EDGES, FIN, FULLY, RESOLVE, SHARED, SHELL, SKIN, UNDER, WEIGHED};
use furrier::shade::fibre::FibreLobe;
use naga::proc::Layouter;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{Module, TypeInner};
use std::mem::offset_of;

/// A struct as one side sees it: (name, offset) of each field, and size of the whole.
#[derive(Debug, PartialEq)]
pub struct Layout {
    pub fields: Vec<(String, usize)>,
    pub size: usize,
}

/// The struct called `name` in a shader; composition adds the file to its name.
pub fn in_shader(module: &Module, name: &str) -> Option<Layout> {
    let plain = |full: &str| full.split("X_naga_oil_mod_X").next().unwrap_or_default().to_owned();
    module.types.iter().find_map(|(_, ty)| match &ty.inner {
        TypeInner::Struct { members, span } if ty.name.as_deref().map(plain).as_deref() == Some(name) => Some(Layout {
            fields: members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize)).collect(),
            size: *span as usize,
        }),
        _ => None,
    })
}

macro_rules! in_rust {
    ($ty:ty { $($field:ident),* }) => {
        Layout { fields: vec![$((stringify!($field).to_owned(), offset_of!($ty, $field))),*], size: size_of::<$ty>() }
    };
}

fn module(source: Source) -> Module {
    compose(source, &SHARED).unwrap()
}

fn kernel(source: Source) -> Module {
    compose(source, &kernels::SHARED).unwrap()
}

#[test]
fn every_shader_is_valid() {
    for source in [SKIN, SHELL, FIN, EDGES, FULLY, UNDER, WEIGHED, RESOLVE, CASTER] {
        let module = module(source);
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::all());
        validator.validate(&module).unwrap_or_else(|error| panic!("{}: {error:?}", source.path));
        // What casts a shadow leaves its depth alone.
        let stages = if source.path == CASTER.path { &["vertex"][..] } else { &["vertex", "fragment"] };
        for &stage in stages {
            assert!(module.entry_points.iter().any(|entry| entry.name == stage), "{}: {stage}", source.path);
        }
    }
}

#[test]
fn every_kernel_is_valid() {
    for source in kernels::ALL {
        let module = kernel(source);
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::all());
        validator.validate(&module).unwrap_or_else(|error| panic!("{}: {error:?}", source.path));
        assert_eq!(module.entry_points.len(), 1, "{}", source.path);
    }
}

#[test]
fn every_shader_file_is_tested() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders");
    let drawn = [SKIN, SHELL, FIN, EDGES, FULLY, UNDER, WEIGHED, RESOLVE, CASTER];
    let all = drawn.iter().chain(&SHARED).chain(&kernels::ALL).chain(&kernels::SHARED);
    let tested: Vec<_> = all.map(|source| source.path.to_owned()).collect();
    for kind in ["runtime", "hybrid", "shared"] {
        for entry in std::fs::read_dir(folder.join(kind)).unwrap() {
            let path = format!("{kind}/{}", entry.unwrap().file_name().to_string_lossy());
            assert!(tested.contains(&path), "shaders/{path} is not among the tested ones");
        }
    }
}

fn light() -> Layout {
    in_rust!(LightItem { place, per_range, strength, near, axis, cone_scale, cone_offset })
}

#[test]
fn structs_lie_as_in_rust() {
    let (shell, fin) = (module(SHELL), module(FIN));
    for (module, name, rust) in [
        (&shell, "Light", light()),
        (
            &shell,
            "View",
            in_rust!(ViewUniform {
                clip_from_world,
                eye,
                ambient,
                light_count,
                lights,
                shadow_from_world,
                shadow_bias_m
            }),
        ),
        (&shell, "Tile", in_rust!(TileUniform { edge_m, height_m, size, layers, mips, tinted, medium_unit_per_m })),
        (&shell, "Mip", in_rust!(Mip { gains })),
        (&shell, "LayerLook", in_rust!(LayerLook { crowding, area, top_share, scale })),
        (&shell, "Slab", in_rust!(SlabItem { slope, bottom, top })),
        (
            &shell,
            "CoatVertex",
            in_rust!(CoatVertex {
                position_m,
                u,
                offset_m,
                v,
                normal,
                longest,
                axis,
                bend_per_m,
                tint,
                root,
                outer_normal,
                away_m
            }),
        ),
        (&shell, "Item", in_rust!(Item { index, layer })),
        (&shell, "Paint", in_rust!(PaintUniform { has_colour, has_painted, share, fins })),
        (&fin, "FinEdge", in_rust!(FinInstance { ends, u, thickness, spacing_m })),
    ] {
        assert_eq!(in_shader(module, name), Some(rust), "{name}");
    }
}

#[test]
fn structs_of_kernels_lie_as_in_rust() {
    let (strands, march, density) = (kernel(kernels::STRANDS), kernel(kernels::MARCH), kernel(kernels::DENSITY));
    for (module, name, rust) in [
        (
            &strands,
            "Scene",
            in_rust!(SceneUniform {
                triangle_count,
                layers,
                strand_count,
                points_per_strand,
                light_count,
                undercoat_light_count,
                face_count,
                inside_count,
                density_per_square_m,
                diameter_m,
                stretch,
                slope,
                pattern_amplitude,
                pattern_wavelength_m,
                pattern_jitter,
                clump_spacing_m,
                clump_strength,
                step_depth,
                step_layers,
                groups,
                ambient,
                attenuation_per_m,
                skin_factor,
                taper,
                undercoat_ramp,
                guard_ramp,
                guard_top_m,
                undercoat_top_m,
                above_top_m,
                tip_transparency,
                tip_exponent,
                opaque,
                guard_crowding,
                undercoat_crowding
            }),
        ),
        (
            &strands,
            "Triangle",
            in_rust!(TriangleItem {
                corners,
                density_splits,
                beyond,
                shadow_splits,
                density_at,
                shadow_at,
                rest_area,
                traits,
                mean_splits,
                mean_at
            }),
        ),
        (
            &strands,
            "Vertex",
            in_rust!(VertexItem {
                position_m,
                density,
                offset_m,
                length,
                normal,
                clump,
                lean,
                tint,
                rest_m,
                rest_normal
            }),
        ),
        (&strands, "Light", light()),
        (&strands, "Strand", in_rust!(StrandItem { tint, id, b, triangle, root_radius_m })),
        (
            &strands,
            "View",
            in_rust!(CameraUniform {
                eye_m,
                focal_px,
                right,
                near_m,
                up,
                most_fragments,
                forward,
                most_starts,
                centre_px,
                size,
                rows,
                most_virtual_fragments,
                padding
            }),
        ),
        (&march, "Inside", in_rust!(InsideItem { b, t, triangle })),
        (&march, "VirtualFragment", in_rust!(VirtualFragmentItem { radiance, from_m, to_m, depth, faces, next })),
        (&density, "Blocks", in_rust!(BlocksUniform { columns, count })),
    ] {
        assert_eq!(in_shader(module, name), Some(rust), "{name}");
    }
}

/// What a look is packed from is compared number by number in `formulas/law.rs`; here it must have as many.
#[test]
fn a_look_has_as_many_numbers_as_in_rust() {
    for module in [module(SHELL), kernel(kernels::STRANDS)] {
        assert_eq!(in_shader(&module, "Look").map(|look| look.size), Some(16 * LOOK));
        let lobe = in_shader(&module, "FibreLobe").map(|lobe| lobe.size);
        assert_eq!(lobe, Some(size_of::<FibreLobe>()));
    }
}

#[test]
fn vertex_attributes_lie_as_in_rust() {
    let module = module(SKIN);
    let entry = module.entry_points.iter().find(|entry| entry.name == "vertex").unwrap();
    let mut layouter = Layouter::default();
    layouter.update(module.to_ctx()).unwrap();
    let mut offset = 0;
    for (argument, attribute) in entry.function.arguments.iter().zip(SkinVertex::ATTRIBUTES) {
        assert_eq!(argument.binding.as_ref().map(location), Some(attribute.shader_location), "{:?}", argument.name);
        assert_eq!(u64::from(offset), attribute.offset, "{:?}", argument.name);
        assert_eq!(u64::from(layouter[argument.ty].size), attribute.format.size(), "{:?}", argument.name);
        offset += layouter[argument.ty].size;
    }
    assert_eq!(entry.function.arguments.len(), SkinVertex::ATTRIBUTES.len());
    assert_eq!(offset as usize, size_of::<SkinVertex>());
}

fn location(binding: &naga::Binding) -> u32 {
    match binding {
        naga::Binding::Location { location, .. } => *location,
        naga::Binding::BuiltIn(_) => u32::MAX,
    }
}
