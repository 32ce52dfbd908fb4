//! What a coat holds and costs, in numbers.

use crate::data::coat::{Coat, CoatPrimitive, Sampled, ShellStack, Tile};
use crate::data::image::Image8;
use serde::Serialize;

/// The screen that [`TileSummary::gap_distance_m`] is given for: pixels up, and vertical field of view in degrees.
pub const SCREEN: (f64, f64) = (1080.0, 40.0);
/// From this many pixels between neighbouring shells on, they are seen as layers.
const GAP_PIXELS: f64 = 2.0;
/// Draw calls that a game can spare for a coat.
const MANY_DRAW_CALLS: usize = 200;
/// Graphics memory of a coat vertex: base vertex, patch, UV, offset, axis, normal, tint and longest length. Textures that it reads at
/// the root are the asset's own.
const VERTEX_BYTES: usize = 4 + 4 + 8 + 12 + 12 + 12 + 16 + 4;
/// Graphics memory of a fin: four vertex indices, an interval and a thickness.
const FIN_BYTES: usize = 16 + 8 + 4;

/// A coat in numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// One per tile.
    pub tiles: Vec<TileSummary>,
    /// One per coat primitive.
    pub primitives: Vec<PrimitiveSummary>,
    /// Triangles drawn when all shells and all fins are: those of the skin once per shell, two per fin.
    pub drawn_triangles: usize,
    /// Draw calls: one per shell, and one for the fins, of every primitive; the skin is not counted.
    pub draw_calls: usize,
    /// Graphics memory: textures uncompressed with their mips, and geometry.
    pub vram_bytes: usize,
}

/// A tile in numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TileSummary {
    /// Preset it was grown from.
    pub preset: String,
    /// Whether its hair was sampled on the skin: an atlas of unique texels instead of a square that repeats.
    pub sampled_on_skin: bool,
    /// Edge, mm.
    pub edge_mm: f32,
    /// Height of the stack, mm.
    pub height_mm: f32,
    /// Layers, the opaque skin included.
    pub layers: u32,
    /// Texels along an edge.
    pub texture_size: u32,
    /// Share of an atlas' texels that lie on skin; the rest is padding and what charts leave between them. Nothing for a tile,
    /// all of whose texels are hair.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub texels_used: Option<f64>,
    /// Mip levels.
    pub mips: usize,
    /// Texels of the fin texture, along the edge and along the hair.
    pub fin_size: [u32; 2],
    /// Distance, m, at which neighbouring shells seen from the side are 2 pixels apart on a screen 1080 pixels high with
    /// a vertical field of view of 40°; nearer than that, layers can be told apart.
    pub gap_distance_m: f64,
    /// Its levels of detail, the finest first.
    pub levels: Vec<LevelSummary>,
    /// Graphics memory of its textures, those of all levels, uncompressed.
    pub vram_bytes: usize,
}

/// A level of detail in numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LevelSummary {
    /// Layers, the opaque skin included.
    pub layers: u32,
    /// Texels along an edge.
    pub texture_size: u32,
    /// How high the longest hair is in a picture, pixels, up to which it suffices; none of the finest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub most_px: Option<f32>,
    /// Graphics memory of its shells' textures, uncompressed.
    pub vram_bytes: usize,
}

/// A coat primitive in numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PrimitiveSummary {
    /// glTF mesh.
    pub mesh: usize,
    /// Primitive of that mesh.
    pub primitive: usize,
    /// Tile it carries.
    pub tile: usize,
    /// Tile that it passes into.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub into_tile: Option<usize>,
    /// Coat vertices.
    pub vertices: usize,
    /// Triangles of one shell.
    pub triangles: usize,
    /// Patches, charts or islands.
    pub patches: usize,
    /// Edges that may carry a fin.
    pub fins: usize,
}

/// Counts what `coat` holds.
pub fn summarise(coat: &Coat) -> Summary {
    let used =
        |tile: usize| coat.primitives.iter().filter(|coat_primitive| coat_primitive.tile == tile).map(uv_area).sum();
    let tiles: Vec<_> = coat.tiles.iter().enumerate().map(|(i, t)| tile(t, used(i))).collect();
    let primitives: Vec<_> = coat.primitives.iter().map(primitive).collect();
    let shells = |p: &PrimitiveSummary| tiles.get(p.tile).map_or(0, |tile| tile.layers.saturating_sub(1) as usize);
    // A passage between two tiles is drawn with each.
    let times = |p: &PrimitiveSummary| 1 + usize::from(p.into_tile.is_some());
    let geometry: usize =
        primitives.iter().map(|p| p.vertices * VERTEX_BYTES + p.triangles * 12 + p.fins * FIN_BYTES).sum();
    Summary {
        drawn_triangles: primitives.iter().map(|p| times(p) * (p.triangles * shells(p) + 2 * p.fins)).sum(),
        draw_calls: primitives.iter().map(|p| times(p) * (shells(p) + usize::from(p.fins > 0))).sum(),
        vram_bytes: geometry + tiles.iter().map(|tile| tile.vram_bytes).sum::<usize>(),
        tiles,
        primitives,
    }
}

/// What to tell of a coat that takes many draw calls.
pub fn draw_calls_note(coat: &Coat) -> Option<String> {
    let Summary { draw_calls, primitives, .. } = summarise(coat);
    let layers = "fewer layers (`set` shells.layers=…)";
    let advice = match primitives.len() {
        0 | 1 => format!("; {layers} take fewer"),
        n => format!(
            " over {n} primitives: meshes of one material, joined in the modelling program, or {layers} take fewer"
        ),
    };
    (draw_calls > MANY_DRAW_CALLS).then(|| format!("the coat takes {draw_calls} draw calls{advice}"))
}

/// Area of a primitive's triangles in texture space, in squares of one unit.
fn uv_area(coat_primitive: &CoatPrimitive) -> f64 {
    let area = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| coat_primitive.uv[v as usize].as_dvec2());
        0.5 * (b - a).perp_dot(c - a).abs()
    };
    coat_primitive.triangles.iter().map(area).sum()
}

/// `used` is the area of texture space that all who carry it take together.
fn tile(tile: &Tile, used: f64) -> TileSummary {
    let shells = &tile.shells;
    let bytes = |images: &mut dyn Iterator<Item = &Image8>| images.map(|image| image.pixels.len()).sum::<usize>();
    let level = |stack: &ShellStack, most_px| LevelSummary {
        layers: stack.layers,
        texture_size: stack.size,
        most_px,
        vram_bytes: bytes(&mut stack.albedo.iter().chain(&stack.medium).chain(&stack.ends).flatten()),
    };
    let coarser = tile.levels.iter().map(|coarser| level(&coarser.shells, Some(coarser.most_px)));
    let levels: Vec<_> = std::iter::once(level(shells, None)).chain(coarser).collect();
    let stacks = levels.iter().map(|level| level.vram_bytes).sum::<usize>();
    let gap_m = f64::from(tile.height_m) / f64::from(shells.layers.max(2) - 1);
    TileSummary {
        preset: tile.preset.clone(),
        sampled_on_skin: tile.sampled == Sampled::Skin,
        edge_mm: tile.edge_m * 1e3,
        height_mm: tile.height_m * 1e3,
        layers: shells.layers,
        texture_size: shells.size,
        texels_used: (tile.sampled == Sampled::Skin).then_some(used),
        mips: shells.albedo.len(),
        fin_size: tile.fin.size,
        gap_distance_m: gap_m * SCREEN.0 / (GAP_PIXELS * 2.0 * (0.5 * SCREEN.1.to_radians()).tan()),
        vram_bytes: stacks + bytes(&mut tile.fin.albedo.iter().chain(&tile.fin.tangent)),
        levels,
    }
}

fn primitive(coat_primitive: &CoatPrimitive) -> PrimitiveSummary {
    let mut patches = coat_primitive.patch.clone();
    patches.sort_unstable();
    patches.dedup();
    PrimitiveSummary {
        mesh: coat_primitive.mesh,
        primitive: coat_primitive.primitive,
        tile: coat_primitive.tile,
        into_tile: coat_primitive.blend.as_ref().map(|blend| blend.tile),
        vertices: coat_primitive.base_vertex.len(),
        triangles: coat_primitive.triangles.len(),
        patches: patches.len(),
        fins: coat_primitive.fins.len(),
    }
}
