//! How well a coat lies on its skin, in numbers that reports and `inspect` print (`docs/steps/patch.md`).

use super::seams::{BeforeAfter, measure_coat};
use crate::asset::{Asset, Part};
use crate::data::coat::{CoatPrimitive, Sampled, Tile};
use crate::data::mesh::Mesh;
use crate::data::patches::{Seams, Spread, Stats};
use crate::error::Result;
use crate::fur::patch;
use crate::math::Vec3;
use serde::Serialize;
use std::collections::HashMap;

/// A parameterisation in numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measures {
    /// Patches, charts or islands.
    pub patches: usize,
    /// Skin triangles that carry the coat, each once.
    pub faces: usize,
    /// Skin triangles that carry it more than once: 0 in a sound coat.
    pub faces_doubled: usize,
    /// Skin triangles without coat.
    pub faces_bare: usize,
    /// Skin area with coat, cm².
    pub area_cm2: f64,
    /// Singular values of the map from skin to texture over the tile scale: 1 is neither stretched nor squeezed.
    pub singular_values: Range,
    /// Share of the area whose singular values both lie in [0.7, 1.4].
    pub share_within: f64,
    /// Mean angle between +u and the hair's direction along the skin, degrees; 0 where hair has none.
    pub field_angle_deg: f64,
    /// Texels per mm of skin.
    pub texels_per_mm: Range,
    /// Length of seams (borders between patches and cuts within them), cm.
    pub seams_cm: f64,
    /// Area that the texture shows mirrored, cm².
    pub mirrored_cm2: f64,
    /// Area whose texture another place uses too, cm²; measured for an asset's own coordinates only.
    pub overlapped_cm2: f64,
    /// How much seams show on the tile that lies on the skin; nothing where hair was sampled on the skin itself, as an atlas' is.
    pub seams: Option<SeamRows>,
}

/// Mean and percentiles over the skin's area.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Range {
    /// Mean.
    pub mean: f64,
    /// 5th percentile.
    pub p5: f64,
    /// 95th percentile.
    pub p95: f64,
}

/// Seams as they lie on the skin, and before anything was done against them where that is known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SeamRows {
    /// As coat_primitive.
    pub on_skin: SeamRow,
    /// With every patch where chance put it in its tile; a file does not say.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by_chance: Option<SeamRow>,
}

/// See [`Seams`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SeamRow {
    /// Edges that are seams.
    pub edges: usize,
    /// Mean squared difference across seams over that across fake borders.
    pub difference_over_fake: f64,
    /// Variance along seams over that inside patches.
    pub variance_over_interior: f64,
}

impl From<Seams> for SeamRow {
    fn from(Seams { edges, difference, variance, .. }: Seams) -> Self {
        Self { edges, difference_over_fake: difference, variance_over_interior: variance }
    }
}

impl From<BeforeAfter> for SeamRows {
    fn from(seams: BeforeAfter) -> Self {
        Self { on_skin: seams.on_skin.into(), by_chance: Some(seams.by_chance.into()) }
    }
}

impl Measures {
    /// The numbers of a parameterisation that covers a skin, for tiles of `texels` along an edge.
    pub fn new(stats: &Stats, texels: f64, seams: Option<SeamRows>) -> Self {
        let scaled = |s: &Spread, by: f64| Range { mean: s.mean * by, p5: s.p5 * by, p95: s.p95 * by };
        Self {
            patches: stats.patches,
            faces: stats.faces,
            faces_doubled: 0,
            faces_bare: 0,
            area_cm2: stats.area_m2 * 1e4,
            singular_values: scaled(&stats.singular_values, 1.0),
            share_within: stats.within,
            field_angle_deg: stats.field_angle_rad.to_degrees(),
            texels_per_mm: scaled(&stats.tiles_per_m, texels * 1e-3),
            seams_cm: stats.seams_m * 1e2,
            mirrored_cm2: stats.mirrored_m2 * 1e4,
            overlapped_cm2: stats.overlapped_m2 * 1e4,
            seams,
        }
    }

    /// Measures what a file's primitive carries. The hair's direction is the axis that the file gives it.
    ///
    /// # Errors
    /// As [`Part::mesh`].
    pub fn of_primitive(
        part: &Part,
        coat_primitive: &CoatPrimitive,
        tile: &Tile,
        metres_per_unit: f64,
    ) -> Result<Self> {
        let skin = part.mesh(metres_per_unit)?;
        let mut times: HashMap<[u32; 3], usize> = skin.triangles.iter().map(|&t| (sorted(t), 0)).collect();
        let triangles = coat_primitive.skin_triangles();
        for &triangle in &triangles {
            *times.entry(sorted(triangle)).or_default() += 1;
        }
        let offset = worlds(part, coat_primitive, &coat_primitive.offset, metres_per_unit / f64::from(tile.height_m));
        let axis = worlds(part, coat_primitive, &coat_primitive.axis, metres_per_unit);
        let mesh = Mesh { triangles, ..skin };
        let patches = coat_primitive.patches();
        let mut stats = patch::measure(&mesh, &axis, tile.edge_m, &patches);
        let mut used = coat_primitive.patch.clone();
        used.sort_unstable();
        used.dedup();
        stats.patches = used.len();
        let tiled = tile.sampled == Sampled::Square;
        let seams = tiled
            .then(|| SeamRows { on_skin: measure_coat(&mesh, &offset, &axis, &patches, tile).into(), by_chance: None });
        let count = |wanted: fn(usize) -> bool| times.values().filter(|&&n| wanted(n)).count();
        Ok(Self {
            faces: count(|n| n == 1),
            faces_doubled: count(|n| n > 1),
            faces_bare: count(|n| n == 0),
            ..Self::new(&stats, f64::from(tile.shells.size), seams)
        })
    }

    /// [`Self::of_primitive`] for every primitive of a coat that a file carries.
    ///
    /// # Errors
    /// As [`Part::mesh`].
    pub fn all(asset: &Asset, coat: &crate::data::coat::Coat) -> Result<Vec<Self>> {
        let part = |coat_primitive: &CoatPrimitive| {
            asset
                .parts
                .iter()
                .find(|part| (part.mesh, part.primitive) == (coat_primitive.mesh, coat_primitive.primitive))
        };
        let measured = |coat_primitive: &CoatPrimitive| {
            part(coat_primitive).map(|part| {
                Self::of_primitive(part, coat_primitive, &coat.tiles[coat_primitive.tile], coat.metres_per_unit)
            })
        };
        coat.primitives.iter().filter_map(measured).collect()
    }
}

fn sorted(mut triangle: [u32; 3]) -> [u32; 3] {
    triangle.sort_unstable();
    triangle
}

/// What vectors of coat vertices are at their skin vertices in world axes, times `scale`; zero where none is coat_primitive.
fn worlds(part: &Part, coat_primitive: &CoatPrimitive, vectors: &[Vec3], scale: f64) -> Vec<Vec3> {
    let mut world = vec![Vec3::ZERO; part.vertices()];
    for (&base, local) in coat_primitive.base_vertex.iter().zip(vectors) {
        world[base as usize] = (part.world_from_local(base as usize) * local.as_dvec3() * scale).as_vec3();
    }
    world
}
