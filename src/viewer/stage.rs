//! An asset with its coat at a moment, as the runtime draws it: skinned and morphed first, then extruded.

use crate::asset::Asset;
use crate::asset::part::Part;
use crate::asset::pose::{Pose, Posed};
use crate::data::coat::{Coat, CoatPrimitive, FinEdge, Sampled, Tile};
use crate::data::image::Image8;
use crate::data::texture::{Texture, Wrap};
use crate::error::Result;
use crate::math::{Vec2, Vec3, Vec4};
use crate::runtime::{CoatMesh, DrawList, SkinMesh};
use std::borrow::Cow;
use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};

/// Decoded textures.
#[derive(Clone, Debug, Default)]
pub struct Textures {
    /// By glTF image.
    pub images: HashMap<usize, Image8>,
    /// What is broken and left out, one sentence each.
    pub notes: Vec<String>,
}

/// Decodes every texture that the parts and their coat use. Those of skin alone are left out where they are broken.
///
/// # Errors
/// Names images of a coat that are broken or too large.
pub fn textures(asset: &Asset, coat: &Coat) -> Result<Textures> {
    let mut decoded = Textures::default();
    let of_coat = coat.primitives.iter().flat_map(|primitive| [&primitive.colour, &primitive.painted]);
    for image in of_coat.flatten().map(|texture| texture.image) {
        if let Entry::Vacant(slot) = decoded.images.entry(image)
            && let Some(pixels) = asset.document.decode_image(image)?
        {
            slot.insert(pixels);
        }
    }
    for part in &asset.parts {
        let image = part.base_colour.texture.as_ref().map(|texture| texture.image);
        let fault = match image.filter(|image| !decoded.images.contains_key(image)) {
            None => part.base_colour.fault.as_deref().cloned(),
            Some(image) => match asset.document.decode_image(image) {
                Ok(pixels) => {
                    decoded.images.extend(pixels.map(|pixels| (image, pixels)));
                    None
                }
                Err(fault) => Some(fault),
            },
        };
        let note = fault.map(|fault| {
            let (place, name) = (fault.field.as_deref().unwrap_or_default(), &part.material_name);
            format!("{}: {place}; material {name:?} is drawn without it", fault.what)
        });
        decoded.notes.extend(note.filter(|note| !decoded.notes.contains(note)));
    }
    Ok(decoded)
}

/// Everything that `asset` shows in `pose`.
pub fn scene<'a>(asset: &'a Asset, coat: &'a Coat, textures: &'a Textures, pose: &Pose) -> DrawList<'a> {
    let mut scene = DrawList { tiles: &coat.tiles, ..Default::default() };
    for part in &asset.parts {
        let carried: Vec<_> = coat
            .primitives
            .iter()
            .filter(|coat_primitive| (coat_primitive.mesh, coat_primitive.primitive) == (part.mesh, part.primitive))
            .collect();
        for &node in part.nodes.iter().filter(|&&node| !asset.scene.hidden[node]) {
            let posed = part.posed(asset, pose, node, coat.metres_per_unit);
            for coat_primitive in &carried {
                scene.skins.push(furred_skin(part, &posed, coat_primitive, &coat.tiles[coat_primitive.tile], textures));
                scene.furs.extend(furs(part, &posed, coat_primitive, &coat.tiles, textures));
            }
            scene.skins.push(bare_skin(part, &posed, &carried, textures));
        }
    }
    scene
}

/// All points of the scene, tips of the offsets included, for framing.
pub fn points_m(scene: &DrawList<'_>) -> Vec<Vec3> {
    let skins =
        scene.skins.iter().flat_map(|skin| skin.triangles.iter().flatten().map(|&v| skin.positions_m[v as usize]));
    let tips = scene.furs.iter().flat_map(|fur| fur.positions_m.iter().zip(&fur.offsets_m).map(|(&p, &o)| p + o));
    skins.chain(tips).filter(|p| p.is_finite()).collect()
}

/// What a coat primitive's shells and fins are, with its first tile alone.
pub(super) fn fur<'a>(posed: &Posed, coat_primitive: &'a CoatPrimitive) -> CoatMesh<'a> {
    let at = |list: &[Vec3]| coat_primitive.base_vertex.iter().map(|&v| list[v as usize]).collect();
    let turned = |list: &[Vec3]| {
        coat_primitive.base_vertex.iter().zip(list).map(|(&v, &o)| posed.world_from_offset[v as usize] * o).collect()
    };
    CoatMesh {
        tile: coat_primitive.tile,
        positions_m: at(&posed.positions_m),
        normals: if coat_primitive.normal.is_empty() {
            at(&posed.normals)
        } else {
            hair_normals(posed, coat_primitive)
        },
        offsets_m: turned(&coat_primitive.offset),
        axes: turned(&coat_primitive.axis),
        uv: Cow::from(&coat_primitive.uv),
        tint: Cow::from(&coat_primitive.tint),
        triangles: &coat_primitive.triangles,
        fins: Cow::from(&coat_primitive.fins),
        ..CoatMesh::default()
    }
}

/// `fur` with the textures that its roots read.
fn painted_fur<'a>(
    part: &Part,
    fur: CoatMesh<'a>,
    coat_primitive: &'a CoatPrimitive,
    textures: &'a Textures,
) -> CoatMesh<'a> {
    let [colour, painted] =
        [&coat_primitive.colour, &coat_primitive.painted].map(|texture| shown(part, texture.as_ref(), textures));
    if colour.is_none() && painted.is_none() {
        return fur;
    }
    let at = |texture: &Option<Texture>, v: u32| root_uv(part, texture.as_ref(), v);
    let root = |&v: &u32| {
        let (c, p) = (at(&coat_primitive.colour, v), at(&coat_primitive.painted, v));
        Vec4::new(c.x, c.y, p.x, p.y)
    };
    CoatMesh {
        colour,
        painted,
        root: coat_primitive.base_vertex.iter().map(root).collect(),
        longest: Cow::from(&coat_primitive.longest),
        ..fur
    }
}

/// A texture's image and what it shows beyond its borders, where it was decoded and the part has coordinates for it.
fn shown<'a>(part: &Part, texture: Option<&Texture>, textures: &'a Textures) -> Option<(&'a Image8, [Wrap; 2])> {
    let texture = texture.filter(|texture| texture.uv_set < part.stored.uv_sets.len())?;
    textures.images.get(&texture.image).map(|image| (image, texture.wrap))
}

/// Where a texture is read at a vertex of the part.
fn root_uv(part: &Part, texture: Option<&Texture>, v: u32) -> Vec2 {
    let uv = |texture: &Texture| Some(texture.transformed(*part.stored.uv_sets.get(texture.uv_set)?.get(v as usize)?));
    texture.and_then(uv).unwrap_or(Vec2::ZERO)
}

/// Normals of the skin as hair stands on it: they turn as normals do, by the inverse transpose.
fn hair_normals(posed: &Posed, coat_primitive: &CoatPrimitive) -> Vec<Vec3> {
    let turned = |(&v, &normal): (&u32, &Vec3)| {
        (posed.world_from_offset[v as usize].inverse().transpose() * normal).normalize_or(posed.normals[v as usize])
    };
    coat_primitive.base_vertex.iter().zip(&coat_primitive.normal).map(turned).collect()
}

/// What a coat primitive is drawn as: once, or once per tile where it passes from one into another.
fn furs<'a>(
    part: &Part,
    posed: &Posed,
    coat_primitive: &'a CoatPrimitive,
    tiles: &[Tile],
    textures: &'a Textures,
) -> Vec<CoatMesh<'a>> {
    let fur = painted_fur(part, fur(posed, coat_primitive), coat_primitive, textures);
    let Some(blend) = &coat_primitive.blend else { return vec![fur] };
    // Two coats at complementary densities: drawn over one another, optical depths add.
    let dense = |share: &dyn Fn(f32) -> f32| {
        coat_primitive
            .tint
            .iter()
            .zip(&blend.weight)
            .map(|(tint, &w)| tint.truncate().extend(tint.w * share(w)))
            .collect()
    };
    let (first, second) = (&tiles[coat_primitive.tile], &tiles[blend.tile]);
    let longer = first.fin.width_m / second.fin.width_m;
    let thicker = first.fin.thickness_m / second.fin.thickness_m;
    let fin = |f: &FinEdge| FinEdge { u: f.u.map(|u| u * longer), thickness: f.thickness * thicker, ..*f };
    let into = CoatMesh {
        tile: blend.tile,
        uv: coat_primitive.uv.iter().map(|uv| *uv * (first.edge_m / second.edge_m)).collect(),
        tint: dense(&|w| w),
        fins: coat_primitive.fins.iter().map(fin).collect(),
        over_last: true,
        ..fur.clone()
    };
    vec![CoatMesh { tint: dense(&|w| 1.0 - w), ..fur }, into]
}

/// The skin under a coat, on the coat's vertices, so that it knows how much light the hair lets through.
fn furred_skin<'a>(
    part: &Part,
    posed: &Posed,
    coat_primitive: &CoatPrimitive,
    tile: &Tile,
    textures: &'a Textures,
) -> SkinMesh<'a> {
    let whole = surface(part, posed, textures);
    let at = |list: &[Vec3]| coat_primitive.base_vertex.iter().map(|&v| list[v as usize]).collect();
    SkinMesh {
        positions_m: at(&whole.positions_m),
        normals: at(&whole.normals),
        colour: at(&whole.colour),
        uv: if whole.uv.is_empty() {
            vec![]
        } else {
            coat_primitive.base_vertex.iter().map(|&v| whole.uv[v as usize]).collect()
        },
        painted: shown(part, coat_primitive.painted.as_ref(), textures).filter(|_| tile.sampled == Sampled::Square),
        painted_uv: coat_primitive
            .base_vertex
            .iter()
            .map(|&v| root_uv(part, coat_primitive.painted.as_ref(), v))
            .collect(),
        tile: Some(coat_primitive.tile),
        coat_uv: coat_primitive.uv.clone(),
        coat_density: coat_primitive
            .tint
            .iter()
            .zip(&coat_primitive.offset)
            .map(|(t, o)| match tile.sampled {
                _ if *o == Vec3::ZERO => 0.0,
                Sampled::Square => t.w,
                Sampled::Skin => 1.0,
            })
            .collect(),
        hair_m: hair_m(posed, coat_primitive),
        triangles: coat_primitive.triangles.clone(),
        ..whole
    }
}

/// How high hair stands over each coat vertex's skin, m.
fn hair_m(posed: &Posed, coat_primitive: &CoatPrimitive) -> Vec<f32> {
    let height = |(&v, &offset): (&u32, &Vec3)| {
        (posed.world_from_offset[v as usize] * offset).dot(posed.normals[v as usize]).max(0.0)
    };
    coat_primitive.base_vertex.iter().zip(&coat_primitive.offset).map(height).collect()
}

/// A part where no coat covers it.
fn bare_skin<'a>(part: &Part, posed: &Posed, carried: &[&CoatPrimitive], textures: &'a Textures) -> SkinMesh<'a> {
    SkinMesh { triangles: uncovered(part, carried), ..surface(part, posed, textures) }
}

/// The triangles of a part that no coat covers.
pub(super) fn uncovered(part: &Part, carried: &[&CoatPrimitive]) -> Vec<[u32; 3]> {
    let sorted = |mut triangle: [u32; 3]| {
        triangle.sort_unstable();
        triangle
    };
    let covered: HashSet<[u32; 3]> = carried
        .iter()
        .flat_map(|coat_primitive| {
            coat_primitive.triangles.iter().map(|t| sorted(t.map(|v| coat_primitive.base_vertex[v as usize])))
        })
        .collect();
    part.stored.triangles.iter().copied().filter(|&t| !covered.contains(&sorted(t))).collect()
}

/// Vertices of a part with their base colour; no triangles.
fn surface<'a>(part: &Part, posed: &Posed, textures: &'a Textures) -> SkinMesh<'a> {
    let factor = part.base_colour.factor.truncate();
    let count = posed.positions_m.len();
    let texture = part.base_colour.texture.as_ref();
    let image = texture.and_then(|texture| textures.images.get(&texture.image));
    let set = texture.and_then(|texture| part.stored.uv_sets.get(texture.uv_set));
    let uv: Vec<Vec2> = match (texture, set) {
        (Some(texture), Some(set)) => set.iter().map(|&uv| texture.transformed(uv)).collect(),
        _ => vec![],
    };
    SkinMesh {
        positions_m: posed.positions_m.clone(),
        normals: posed.normals.clone(),
        colour: match &part.stored.colour {
            Some(colours) => colours.iter().map(|c| factor * c.truncate()).collect(),
            None => vec![factor; count],
        },
        texture: image.filter(|_| !uv.is_empty()).zip(texture).map(|(image, texture)| (image, texture.wrap)),
        uv,
        ..Default::default()
    }
}
