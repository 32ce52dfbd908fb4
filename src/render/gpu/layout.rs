//! Structs as the shaders read them; `tests/shaders.rs` compares names, offsets and sizes with the WGSL.

use crate::data::strands::Strands;
use crate::math::Vec3;
use crate::render::pelt::{Layer, Lighting, Pelt};
use crate::render::picture::Settings;
use crate::render::resolve::Blending;
use crate::render::view::View;
use crate::shade::kajiya_kay::KajiyaKay;
use crate::shade::lobes::Lobes;
use bytemuck::{Pod, Zeroable};

/// No triangle, no item: `NOTHING` of `shared/scene.wgsl`.
pub const NOTHING: u32 = u32::MAX;

/// `Kind` of `shared/scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct KindUniform {
    /// Projected hair area per skin area and height, 1/m.
    pub area_per_m: f32,
    /// Mean height, m.
    pub height_m: f32,
    /// Standard deviation of height over its mean.
    pub variation: f32,
    /// Fills sixteen bytes.
    pub unused: f32,
}

/// `Lobe` of `shared/scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct LobeUniform {
    /// Albedo over the lobe's own integral.
    pub albedo: f32,
    /// Shift along the hair, rad.
    pub shift_rad: f32,
    /// −1 / (2σ²).
    pub scale: f32,
    /// Fills sixteen bytes.
    pub unused: f32,
}

/// `Scene` of `shared/scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[expect(missing_docs, reason = "each field is described where the shader declares it")]
pub struct SceneUniform {
    pub triangle_count: u32,
    pub layers: u32,
    pub strand_count: u32,
    pub points_per_strand: u32,
    pub light_count: u32,
    pub undercoat_light_count: u32,
    pub face_count: u32,
    pub inside_count: u32,
    pub density_per_square_m: f32,
    pub diameter_m: f32,
    pub stretch: f32,
    pub slope: f32,
    pub pattern_amplitude: f32,
    pub pattern_wavelength_m: f32,
    pub pattern_jitter: f32,
    pub clump_spacing_m: f32,
    pub clump_strength: f32,
    pub step_depth: f32,
    pub step_layers: f32,
    pub undercoat_albedo: f32,
    pub undercoat_diffuse: f32,
    pub undercoat_specular: f32,
    pub undercoat_exponent: f32,
    pub groups: f32,
    pub ambient: [f32; 3],
    pub guard_albedo: f32,
    pub skin_factor: [f32; 3],
    pub taper: f32,
    pub undercoat_ramp: [[f32; 4]; 3],
    pub guard_ramp: [[f32; 4]; 3],
    pub guard_kind: KindUniform,
    pub undercoat_kind: KindUniform,
    pub tip_transparency: f32,
    pub tip_exponent: f32,
    pub tt_azimuth_scale: f32,
    pub tt_norm: f32,
    pub glint: f32,
    pub glint_angle_rad: f32,
    pub glint_scale: f32,
    pub glint_norm: f32,
    pub surround_norm: f32,
    pub guard_diffuse: f32,
    pub attenuation_per_m: f32,
    pub unused: f32,
    pub lobes: [LobeUniform; 3],
}

impl SceneUniform {
    /// Light and hair of a pelt; counts, and what only undercoat has, are left to be filled in.
    ///
    /// # Errors
    /// As [`Lobes::new`].
    pub fn new(pelt: &Pelt<'_>, lighting: &Lighting, settings: &Settings) -> crate::Result<Self> {
        let lobes = Lobes::<f32>::new(&pelt.hair.guard)?;
        let hair = &pelt.hair;
        let scatter = KajiyaKay::<f32>::new(hair.undercoat_diffuse, hair.undercoat_specular, hair.undercoat_exponent);
        let guard = pelt.guard.map(|(strands, fibre)| (strands, Layer::new(fibre, 1.0, 1.0)));
        let [undercoat_diffuse, undercoat_specular, undercoat_exponent] = scatter.coefficients();
        let (groups, attenuation_per_m) = match settings.blending {
            Blending::Virtual { fragments } => (fragments.clamp(1, 64) as f32, 0.0),
            Blending::Simplified { attenuation_per_m } => (1.0, attenuation_per_m),
        };
        let kind = |layer: &Layer| KindUniform {
            area_per_m: layer.area_per_m,
            height_m: layer.height_m,
            variation: layer.spread_m / layer.height_m.max(f32::MIN_POSITIVE),
            unused: 0.0,
        };
        let ramp = |ramp: [Vec3; 3]| ramp.map(|c| c.extend(0.0).to_array());
        let lights = 1 + lighting.fill.len() as u32;
        let profile = guard.map(|(strands, _)| strands.profile);
        Ok(Self {
            triangle_count: pelt.skin.triangles.len() as u32,
            layers: settings.resolution.layers.max(1),
            strand_count: guard.map_or(0, |(strands, _)| strands.len() as u32),
            points_per_strand: guard.map_or(2, |(strands, _)| strands.points_per_strand as u32),
            light_count: lights,
            undercoat_light_count: if lighting.fill_on_undercoat { lights } else { 1 },
            step_depth: settings.stepping.depth,
            step_layers: settings.stepping.layers,
            undercoat_albedo: hair.undercoat_diffuse as f32,
            undercoat_diffuse,
            undercoat_specular,
            undercoat_exponent,
            groups,
            ambient: lighting.ambient.to_array(),
            guard_albedo: (hair.guard.tt.albedo + hair.guard.trt.albedo + hair.guard.diffuse) as f32,
            skin_factor: pelt.skin_factor.to_array(),
            taper: profile.map_or(1.0, |p| p.taper),
            undercoat_ramp: ramp(pelt.undercoat.map_or([Vec3::ONE; 3], |fibre| fibre.profile.ramp)),
            guard_ramp: ramp(profile.map_or([Vec3::ONE; 3], |p| p.ramp)),
            guard_kind: guard.as_ref().map_or(KindUniform::default(), |(_, layer)| kind(layer)),
            undercoat_kind: pelt.undercoat.map_or(KindUniform::default(), |f| kind(&Layer::new(f, 1.0, 1.0))),
            tip_transparency: profile.map_or(0.0, |p| p.tip_transparency),
            tip_exponent: profile.map_or(1.0, |p| p.tip_exponent),
            tt_azimuth_scale: lobes.tt_azimuth_scale,
            tt_norm: lobes.tt_norm,
            glint: lobes.glint,
            glint_angle_rad: lobes.glint_angle_rad,
            glint_scale: lobes.glint_scale,
            glint_norm: lobes.glint_norm,
            surround_norm: lobes.surround_norm,
            guard_diffuse: lobes.diffuse,
            attenuation_per_m,
            lobes: lobes.lobes.map(|lobe| LobeUniform {
                albedo: lobe.albedo,
                shift_rad: lobe.shift_rad,
                scale: lobe.scale,
                unused: 0.0,
            }),
            ..Self::default()
        })
    }
}

/// `Triangle` of `shared/scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct TriangleItem {
    /// Vertices.
    pub corners: [u32; 3],
    /// Subdivisions of the stored density.
    pub density_splits: u32,
    /// Across the edges opposite to each corner: triangle · 4 + its opposite corner, or [`NOTHING`].
    pub beyond: [u32; 3],
    /// Subdivisions of the stored shadow.
    pub shadow_splits: u32,
    /// First column of the stored density, or [`NOTHING`].
    pub density_at: u32,
    /// First column of the stored shadow, or [`NOTHING`].
    pub shadow_at: u32,
    /// Of the skin at rest, m².
    pub rest_area: f32,
    pub(super) _pad0: u32,
}

/// `Vertex` of `shared/scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct VertexItem {
    /// Position, m.
    pub position_m: [f32; 3],
    /// Density over the preset's.
    pub density: f32,
    /// Skin to the top of the shell, m.
    pub offset_m: [f32; 3],
    /// Length over the preset's.
    pub length: f32,
    /// Smooth unit normal.
    pub normal: [f32; 3],
    /// Clump strength over the preset's.
    pub clump: f32,
    /// Unit vector along the mean hair.
    pub lean: [f32; 3],
    pub(super) _pad0: f32,
    /// Hair colour, linear RGB.
    pub tint: [f32; 3],
    pub(super) _pad1: f32,
    /// Position at rest, m.
    pub rest_m: [f32; 3],
    pub(super) _pad2: f32,
    /// Smooth unit normal at rest.
    pub rest_normal: [f32; 3],
    pub(super) _pad3: f32,
}

impl VertexItem {
    /// The vertices of a pelt; `offsets_m` may be empty where there is no undercoat.
    pub fn of(pelt: &Pelt<'_>, normals: &[Vec3], offsets_m: &[Vec3]) -> Vec<Self> {
        let fields = pelt.fields;
        let posed = pelt.skin.rest_m.as_ref().map(|rest_m| (rest_m, pelt.skin.at_rest().smooth_normals()));
        let (rest_m, rest_normals) = match &posed {
            Some((rest_m, rest_normals)) => (&rest_m[..], &rest_normals[..]),
            None => (&pelt.skin.positions_m[..], normals),
        };
        (0..pelt.skin.positions_m.len())
            .map(|v| Self {
                position_m: pelt.skin.positions_m[v].to_array(),
                density: fields.density[v],
                offset_m: offsets_m.get(v).map_or([0.0; 3], |o| o.to_array()),
                length: fields.length[v],
                normal: normals[v].to_array(),
                clump: fields.clump[v],
                lean: fields.lean[v].to_array(),
                _pad0: 0.0,
                tint: fields.tint[v].to_array(),
                _pad1: 0.0,
                rest_m: rest_m[v].to_array(),
                _pad2: 0.0,
                rest_normal: rest_normals[v].to_array(),
                _pad3: 0.0,
            })
            .collect()
    }
}

/// `Light` of `shared/scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct LightItem {
    /// Unit vector towards the light.
    pub to_light: [f32; 3],
    pub(super) _pad0: f32,
    /// Irradiance, linear RGB.
    pub irradiance: [f32; 3],
    pub(super) _pad1: f32,
}

impl LightItem {
    /// The key light, then the others.
    pub fn of(lighting: &Lighting) -> Vec<Self> {
        let item = |light: &crate::shade::light::Directional| Self {
            to_light: light.to_light.to_array(),
            _pad0: 0.0,
            irradiance: light.irradiance.to_array(),
            _pad1: 0.0,
        };
        std::iter::once(&lighting.key).chain(&lighting.fill).map(item).collect()
    }
}

/// `Strand` of `shared/scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct StrandItem {
    /// Linear RGB.
    pub tint: [f32; 3],
    /// Source index.
    pub id: u32,
    /// Of the root, corners 0 and 1.
    pub b: [f32; 2],
    /// Of the root.
    pub triangle: u32,
    /// Radius at the root, m.
    pub root_radius_m: f32,
}

impl StrandItem {
    /// One per hair.
    pub fn of(strands: &Strands) -> Vec<Self> {
        (0..strands.len())
            .map(|i| Self {
                tint: strands.tint[i].to_array(),
                id: strands.id[i],
                b: strands.roots[i].barycentric,
                triangle: strands.roots[i].triangle,
                root_radius_m: strands.root_radius_m[i],
            })
            .collect()
    }
}

/// `Inside` of `render/march.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct InsideItem {
    /// Barycentric coordinates of corners 1 and 2.
    pub b: [f32; 2],
    /// Height in the shell.
    pub t: f32,
    /// Prism.
    pub triangle: u32,
}

/// `Stretch` of `shared/stretch.wgsl`, which only shaders read and write.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[expect(missing_docs, reason = "each field is described where the shader declares it")]
pub struct StretchItem {
    pub radiance: [f32; 3],
    pub from_m: f32,
    pub to_m: f32,
    pub depth: f32,
    pub(super) _pad0: [u32; 2],
    pub faces: [u32; 3],
    pub next: u32,
}

/// `View` of `shared/camera.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct ViewUniform {
    /// Position, m.
    pub eye_m: [f32; 3],
    /// Distance of the picture's plane, px.
    pub focal_px: f32,
    /// Unit vector.
    pub right: [f32; 3],
    /// Smallest depth that is drawn, m.
    pub near_m: f32,
    /// Unit vector.
    pub up: [f32; 3],
    /// How many passes came before.
    pub pass_index: u32,
    /// Unit vector.
    pub forward: [f32; 3],
    /// Room for starts.
    pub most_starts: u32,
    /// Where the optical axis meets the picture, px.
    pub centre_px: [f32; 2],
    /// Of the whole picture.
    pub size: [u32; 2],
    /// First row of the band and the one past its last.
    pub rows: [u32; 2],
    /// Room for fragments.
    pub most_fragments: u32,
    /// Room for stretches.
    pub most_stretches: u32,
}

impl ViewUniform {
    /// Of a view and a band of its rows; room for nothing.
    pub fn new(view: &View, rows: [u32; 2], pass_index: u32) -> Self {
        let [right, up, forward] = view.axes.map(|axis| axis.to_array());
        Self {
            eye_m: view.eye_m.to_array(),
            focal_px: view.focal_px,
            right,
            near_m: view.near_m,
            up,
            pass_index,
            forward,
            most_starts: 0,
            centre_px: view.centre_px.to_array(),
            size: view.size.map(|n| n as u32),
            rows,
            most_fragments: 0,
            most_stretches: 0,
        }
    }
}

/// What a band came to, in the order of the indices in `shared/camera.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct Totals {
    /// Places where rays enter the shell.
    pub starts: u32,
    /// Fragments of guard hair.
    pub fragments: u32,
    /// Stretches of undercoat.
    pub stretches: u32,
    /// Steps through undercoat.
    pub steps: u32,
    /// Not 0 where a list was too short.
    pub overflow: u32,
}

/// `Blocks` of `shared/blocks.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct BlocksUniform {
    /// Columns in all blocks.
    pub columns: u32,
    /// Blocks.
    pub count: u32,
}
