//! What fills the shell, whatever the view: the skin's corners, the hair over them, and the tables of its heights.

use super::MarchSteps;
use crate::fur::undercoat::{Pattern, Undercoat};
use crate::math::Vec3;
use crate::math::lanes::{F32s, Isa};
use crate::math::table::Table;
use crate::volume::scene::{Above, Scene};
use crate::volume::shell::Shell;
use crate::volume::shell::prisms::{Prisms, Vertex};

/// How the volume is resolved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Layers between skin and top.
    pub layers: u32,
    /// Edge of a sub-element that is aimed at, px.
    pub subelement_px: f32,
    /// Most subdivisions of a triangle.
    pub most_subdivisions: u32,
    /// How many subdivisions fewer the stored shadow has, where `coarsest_details` does not ask for more.
    pub shadow_coarser: u32,
    /// Largest sub-elements of density, in finest details of clumps and pattern; those of the shadow are at most twice as
    /// large.
    pub coarsest_details: f32,
    /// Pattern of the density; none for the mean density everywhere but for clumps.
    pub pattern: Option<Pattern>,
}

impl Default for Resolution {
    fn default() -> Self {
        Self {
            layers: 16,
            subelement_px: 1.5,
            most_subdivisions: 7,
            shadow_coarser: 2,
            coarsest_details: f32::INFINITY,
            pattern: Some(Pattern::default()),
        }
    }
}

/// How many [`Content::tables`] there are.
pub const TABLES: usize = 3;

/// What fills the shell over a skin. Nothing in it hangs on the view.
#[derive(Debug)]
pub struct Content<'a> {
    /// The shell.
    pub shell: Shell<'a>,
    /// How finely a view resolves it.
    pub resolution: Resolution,
    /// Normals of the rest pose.
    pub(super) rest_normals: Vec<Vec3>,
    vertices: Vec<Vertex>,
    /// Twice the area of each triangle in the rest pose, m².
    twice_area_m2: Vec<f32>,
    reaching: Table,
    /// Hair area per skin area above a height, of both kinds.
    above: Table,
    /// Where between the levels of the stored shadow a height lies.
    level: Table,
}

impl<'a> Content<'a> {
    /// Of a scene's undercoat; none where it has no such hair. `normals` are the skin's smooth ones.
    pub fn new(scene: &Scene<'a>, normals: &[Vec3], resolution: Resolution) -> Option<Self> {
        let fibre = scene.undercoat?;
        let undercoat = Undercoat::new(fibre, resolution.pattern);
        if undercoat.density_per_m2 <= 0.0 || undercoat.height_m <= 0.0 {
            return None;
        }
        let triangles = scene.skin.triangles.len();
        let both = Above::new([scene.guard.map(|(_, fibre)| fibre), Some(fibre)]);
        let above = Table::new(|t| both.at(t * undercoat.height_m, 1.0, 1.0));
        let last_level = resolution.layers.max(1) as f32;
        let level = Table::new(|t| {
            let low = (t * last_level).floor().min(last_level - 1.0);
            let [below, here, over] = [low, t * last_level, low + 1.0].map(|level| above.at(level / last_level));
            if over < below { low + (here - below) / (over - below) } else { t * last_level }
        });
        let shell = Shell::new(scene.skin, scene.fields, undercoat);
        let fields = scene.fields;
        let vertex = |v: usize| Vertex {
            foot_m: scene.skin.positions_m[v],
            offset_m: shell.offsets_m[v],
            normal: normals[v],
            tint: fields.tint[v],
            density: fields.density[v],
            length: fields.length[v],
        };
        Some(Self {
            vertices: (0..scene.skin.positions_m.len()).map(vertex).collect(),
            twice_area_m2: (0..triangles).map(|t| 2.0 * scene.skin.rest_area_m2(t)).collect(),
            rest_normals: match scene.skin.rest_m {
                Some(_) => scene.skin.at_rest().smooth_normals(),
                None => normals.to_vec(),
            },
            resolution,
            reaching: Table::new(|t| undercoat.reaching(t)),
            above,
            level,
            shell,
        })
    }

    /// By height in 64ths of the shell's: the share of hairs that reach it; the hair area of both kinds above it per skin
    /// area; where between the stored shadow's levels it lies.
    pub fn tables(&self) -> [&[f32]; TABLES] {
        [self.reaching.values(), self.above.values(), self.level.values()]
    }

    /// Where between the stored shadow's levels heights lie: linear there is what a flat coat's shadow is in between, which
    /// falls off fast towards the tips.
    #[inline(always)]
    pub fn level<I: Isa>(&self, t: F32s<I>) -> F32s<I> {
        self.level.at_lanes(t)
    }

    /// The corners of a triangle.
    #[inline]
    pub fn corners(&self, triangle: u32) -> [&Vertex; 3] {
        self.shell.skin.triangles[triangle as usize].map(|v| &self.vertices[v as usize])
    }

    /// Twice the area of a triangle in the rest pose, m²: what its hair grew on.
    #[inline]
    pub fn twice_area_m2(&self, triangle: u32) -> f32 {
        self.twice_area_m2[triangle as usize]
    }

    /// Hair area of both kinds above heights per skin area.
    #[inline(always)]
    pub fn above<I: Isa>(&self, prisms: &Prisms, steps: &MarchSteps<I>) -> F32s<I> {
        prisms.density(steps.b) * prisms.length(steps.b) * self.above.at_lanes(steps.t)
    }

    /// Share of the hairs that reach heights.
    #[inline(always)]
    pub(super) fn reaching<I: Isa>(&self, t: F32s<I>) -> F32s<I> {
        self.reaching.at_lanes(t)
    }

    /// As [`Undercoat::reaching`], with all hairs ended where the ray is at the top.
    #[inline(always)]
    pub(super) fn reach_at<I: Isa>(&self, t: F32s<I>) -> F32s<I> {
        t.lt(F32s::splat(1.0 - 1e-4)).keep(self.reaching.at_lanes(t))
    }
}
