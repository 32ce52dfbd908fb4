//! Uniforms as the shaders read them; `tests/shaders.rs` compares names, offsets and sizes with the WGSL.

use crate::fur::groom::fibre::Fibre;
use crate::hybrid::Settings;
use crate::hybrid::resolve::Blending;
use crate::math::Vec3;
use crate::stage::projection::Projection;
use crate::volume::scene::{self, Above, Lighting, Scene};
use bytemuck::{Pod, Zeroable};

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
    pub groups: f32,
    pub ambient: [f32; 3],
    pub attenuation_per_m: f32,
    pub skin_factor: [f32; 3],
    pub taper: f32,
    pub undercoat_ramp: [[f32; 4]; 3],
    pub guard_ramp: [[f32; 4]; 3],
    pub guard_top_m: f32,
    pub undercoat_top_m: f32,
    pub above_top_m: f32,
    pub tip_transparency: f32,
    pub tip_exponent: f32,
    pub opaque: f32,
    pub guard_crowding: f32,
    pub undercoat_crowding: f32,
}

impl SceneUniform {
    /// Light and hair of a scene; counts, and what only undercoat has, are left to be filled in.
    pub fn new(scene: &Scene<'_>, above: &Above, lighting: &Lighting, settings: &Settings) -> Self {
        let guard = scene.guard;
        let (groups, attenuation_per_m) = match settings.blending {
            Blending::Virtual { fragments } => (fragments.clamp(1, 64) as f32, 0.0),
            Blending::Simplified { attenuation_per_m } => (1.0, attenuation_per_m),
        };
        let ramp = |ramp: [Vec3; 3]| ramp.map(|c| c.extend(0.0).to_array());
        let lights = 1 + lighting.fill.len() as u32;
        let profile = guard.map(|(strands, _)| strands.profile);
        Self {
            triangle_count: scene.skin.triangles.len() as u32,
            layers: settings.resolution.layers.max(1),
            strand_count: guard.map_or(0, |(strands, _)| strands.len() as u32),
            points_per_strand: guard.map_or(2, |(strands, _)| strands.points_per_strand as u32),
            light_count: lights,
            undercoat_light_count: if lighting.fill_on_undercoat { lights } else { 1 },
            step_depth: settings.stepping.depth,
            step_layers: settings.stepping.layers,
            groups,
            ambient: lighting.ambient.to_array(),
            attenuation_per_m,
            skin_factor: scene.skin_factor.to_array(),
            taper: profile.map_or(1.0, |p| p.taper),
            undercoat_ramp: ramp(scene.undercoat.map_or([Vec3::ONE; 3], |fibre| fibre.profile.ramp)),
            guard_ramp: ramp(profile.map_or([Vec3::ONE; 3], |p| p.ramp)),
            guard_top_m: guard.map_or(0.0, |(_, fibre)| fibre.height_m()),
            undercoat_top_m: scene.undercoat.map_or(0.0, Fibre::height_m),
            above_top_m: above.top_m,
            tip_transparency: profile.map_or(0.0, |p| p.tip_transparency),
            tip_exponent: profile.map_or(1.0, |p| p.tip_exponent),
            opaque: settings.opaque,
            guard_crowding: guard.map_or(0.0, |(_, fibre)| scene::crowding(fibre)),
            undercoat_crowding: scene.undercoat.map_or(0.0, scene::crowding),
            ..Self::default()
        }
    }
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
    /// Room for fragments.
    pub most_fragments: u32,
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
    /// Room for virtual fragments.
    pub most_virtual_fragments: u32,
    /// Nothing.
    pub padding: u32,
}

impl ViewUniform {
    /// Of a view and a band of its rows; room for nothing.
    pub fn new(view: &Projection, rows: [u32; 2]) -> Self {
        let [right, up, forward] = view.axes.map(|axis| axis.to_array());
        Self {
            eye_m: view.eye_m.to_array(),
            focal_px: view.focal_px,
            right,
            near_m: view.near_m,
            up,
            most_fragments: 0,
            forward,
            most_starts: 0,
            centre_px: view.centre_px.to_array(),
            size: view.size.map(|n| n as u32),
            rows,
            most_virtual_fragments: 0,
            padding: 0,
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
    /// Virtual fragments of undercoat.
    pub virtual_fragments: u32,
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
