//! Pictures of how hair lies instead of hair: its direction and length, its patches, the stretch of its texture.

mod colours;
mod field;
mod patches;
mod shapes;
mod stretch;
mod tangents;

use super::stage;
use crate::asset::{Asset, Part, Pose, Posed};
use crate::data::coat::{Coat, CoatPrimitive};
use crate::data::image::Image8;
use crate::data::light::Directional;
use crate::data::mesh::Mesh;
use crate::data::patches::Patches;
use crate::error::Result;
use crate::math::Vec3;
use crate::runtime::{DrawList, SkinMesh};
use crate::stage::light::Lit;
use std::f32::consts::PI;

/// SkinMesh without fur, linear RGB.
const BARE: Vec3 = Vec3::splat(0.30);
/// Light from everywhere: enough that colours keep their meaning in shadow.
pub(super) const AMBIENT: Vec3 = Vec3::splat(0.5);

/// What is shown of a coat beside itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chart {
    /// Strokes along the hair, coloured skin for its length, balls where it has no direction.
    Field,
    /// A colour for each direction of hair.
    Tangents,
    /// A colour for each patch, with the outline of the tile.
    Patches,
    /// How far the texture is stretched or squeezed.
    Stretch,
}

impl Chart {
    /// Whether colours are numbers, to be shown as they are instead of lit.
    pub fn plain(self) -> bool {
        self == Self::Tangents
    }
}

/// A part in its pose and what it carries.
struct CoveredPart<'a> {
    part: &'a Part,
    posed: &'a Posed,
    primitive: &'a CoatPrimitive,
}

/// A chart's surfaces and its legend, one sentence each.
pub struct Drawing<'a> {
    /// Everything that is drawn.
    pub scene: DrawList<'a>,
    /// What colours and signs mean, with the numbers they stand for.
    pub legend: Vec<String>,
}

/// Draws `chart` of an asset's coat in a pose. `tile` is [`tile_outline`].
///
/// # Errors
/// As [`Part::mesh`].
pub fn draw<'a>(asset: &'a Asset, coat: &'a Coat, pose: &Pose, chart: Chart, tile: &'a Image8) -> Result<Drawing<'a>> {
    let mut posed = Vec::new();
    for part in &asset.parts {
        posed.extend(
            part.nodes
                .iter()
                .filter(|&&node| !asset.scene.hidden[node])
                .map(|&node| (part, part.posed(asset, pose, node, coat.metres_per_unit))),
        );
    }
    let mut skins = Vec::new();
    let mut all = Vec::new();
    for (part, posed) in &posed {
        let covers = |w: &&CoatPrimitive| (w.mesh, w.primitive) == (part.mesh, part.primitive);
        let covered: Vec<&CoatPrimitive> = coat.primitives.iter().filter(covers).collect();
        skins.push(bare(part, posed, &covered));
        all.extend(covered.into_iter().map(|primitive| CoveredPart { part, posed, primitive }));
    }
    let (more, legend) = match chart {
        Chart::Field => field::draw(&all),
        Chart::Tangents => tangents::draw(&all),
        Chart::Patches => patches::draw(&all, coat, tile)?,
        Chart::Stretch => stretch::draw(&all, coat)?,
    };
    skins.extend(more);
    Ok(Drawing { scene: DrawList { skins, furs: Vec::new(), tiles: &coat.tiles }, legend })
}

/// What falls on a chart that is looked at along `forward`, a unit vector.
pub fn lit(chart: Chart, forward: Vec3) -> Lit {
    if chart.plain() {
        return Lit { lights: Vec::new(), ambient: Vec3::ONE, fill_on_undercoat: false };
    }
    Lit { lights: vec![light(forward).into()], ambient: AMBIENT, fill_on_undercoat: false }
}

/// A light over the left shoulder of whoever looks along `forward`.
pub(super) fn light(forward: Vec3) -> Directional {
    let right = forward.cross(Vec3::Y).normalize_or(Vec3::X);
    let up = right.cross(forward);
    Directional {
        to_light: (up * 0.8 - forward - right * 0.6).normalize_or(Vec3::Y),
        irradiance: Vec3::splat(0.5 * PI),
    }
}

/// The outline of a tile that [`Chart::Patches`] repeats over the skin: a line at its start and darker towards it.
pub fn tile_outline() -> Image8 {
    let size = 64;
    let mut image = Image8::new(size, size, 4);
    for (i, pixel) in image.pixels.as_chunks_mut::<4>().0.iter_mut().enumerate() {
        let [x, y] = [i as u32 % size, i as u32 / size];
        let value = if x < 4 || y < 3 { 120 } else { 215 + (40 * x / size) as u8 };
        *pixel = [value, value, value, 255];
    }
    image
}

fn bare<'a>(part: &Part, posed: &Posed, covered: &[&CoatPrimitive]) -> SkinMesh<'a> {
    let triangles = stage::uncovered(part, covered);
    let count = posed.positions_m.len();
    SkinMesh {
        positions_m: posed.positions_m.clone(),
        normals: posed.normals.clone(),
        colour: vec![BARE; count],
        triangles,
        ..SkinMesh::default()
    }
}

impl CoveredPart<'_> {
    /// The skin's triangles that carry the coat, and the coat's coordinates on them; rest pose.
    fn laid(&self, coat: &Coat) -> Result<(Mesh, Patches)> {
        let w = self.primitive;
        let triangles = w.triangles.iter().map(|t| t.map(|v| w.base_vertex[v as usize])).collect();
        let mesh = Mesh { triangles, ..self.part.mesh(coat.metres_per_unit)? };
        let patches = Patches {
            base_vertex: w.base_vertex.clone(),
            uv: w.uv.clone(),
            patch: w.patch.clone(),
            triangles: w.triangles.clone(),
            ..Patches::default()
        };
        Ok((mesh, patches))
    }

    /// A skin of every triangle by itself, each in one colour.
    fn facets<'a>(&self, colour: impl Fn(usize) -> Vec3) -> SkinMesh<'a> {
        let base: Vec<usize> = self
            .primitive
            .triangles
            .iter()
            .flatten()
            .map(|&v| self.primitive.base_vertex[v as usize] as usize)
            .collect();
        SkinMesh {
            positions_m: base.iter().map(|&v| self.posed.positions_m[v]).collect(),
            normals: base.iter().map(|&v| self.posed.normals[v]).collect(),
            colour: (0..base.len()).map(|i| colour(i / 3)).collect(),
            triangles: (0..base.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
            ..SkinMesh::default()
        }
    }
}
