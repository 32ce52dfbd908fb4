//! The hair that an atlas' fins show: grown at places of the skin, with what its coat puts back taken out.

use super::AtlasSkin;
use super::judge::places;
use crate::coat::hair::TileHair;
use crate::coat::primitive::offset_over_height;
use crate::data::fields::Fields;
use crate::data::mesh::Mesh;
use crate::data::strands::Strands;
use crate::fur::groom::fibre::Fibre;
use crate::fur::grow;
use crate::fur::undercoat::{Columns, Pattern, Undercoat};
use crate::math::hash::{combine, unit_f32};
use crate::math::lanes::Scalar;
use crate::math::{Mat3, Vec2, Vec3};
use crate::volume::medium::Medium;

/// Places whose hair stands side by side in the texture.
const PLACES: usize = 8;

/// Both kinds of hair at places spread over the skins by area, in strips side by side that make a square as wide as `like`'s. Each
/// strip runs along the skin in a direction by chance, as edges do. Every hair is as the groom has it there (clumps, bend,
/// comb), at the density and in the colour of the preset, and lies as M⁻¹ takes it back, M being the frame that a fin spans:
/// along the skin, across, and the coat's offset. So length, density and colour come back where a fin stands, by its own vertices.
/// `None` where nothing grows.
pub fn grown(skins: &[AtlasSkin<'_>], hair: [&Fibre; 2], like: &TileHair, seed: u64) -> Option<TileHair> {
    let area_m2 = |skin: &AtlasSkin<'_>| (0..skin.mesh.triangles.len()).map(|t| skin.mesh.area_m2(t)).sum::<f32>();
    let areas: Vec<f32> = skins.iter().map(area_m2).collect();
    let total: f32 = areas.iter().sum();
    let mut found = Vec::new();
    let mut passed = 0.0;
    for (skin, area) in skins.iter().zip(areas) {
        // As many as fall to its share of the area, those of earlier skins rounded up to the last.
        passed += area;
        let count = ((PLACES as f32 * passed / total.max(f32::MIN_POSITIVE)).round() as usize).max(found.len());
        let furred = |t: usize| {
            skin.mesh.triangles[t].iter().all(|&v| {
                let v = v as usize;
                skin.fields.length[v] > 0.0 && skin.fields.density[v] > 0.0
            })
        };
        let wanted = count - found.len();
        found.extend(places(skin.mesh, wanted, combine(skin.seed, 0xf1), furred).into_iter().map(|at| (skin, at)));
    }
    let count = found.len();
    if count == 0 {
        return None;
    }
    let key = |i: usize| combine(seed, i as u64);
    let strips: Vec<Strip> = found
        .into_iter()
        .enumerate()
        .map(|(i, (skin, (triangle, b)))| {
            Strip::new(skin, triangle, b, like.edge_m, count, unit_f32(combine(key(i), 0)))
        })
        .collect();
    let [guard, undercoat] = hair;
    let mut all = TileHair { guard: like.guard.none_alike(), ..like.clone() };
    for (i, strip) in strips.iter().enumerate() {
        strip.grow(guard, combine(key(i), 1), i, &mut all.guard);
    }
    let of_skin = Undercoat::new(undercoat, Some(Pattern::default()));
    all.undercoat = Medium::of_columns(of_skin, undercoat, like.edge_m, |at| {
        let place = ((at.x / like.edge_m * count as f32) as usize).min(count - 1);
        strips[place].column(&of_skin, at, place)
    });
    Some(all)
}

/// A strip of skin, laid flat where it is.
struct Strip {
    mesh: Mesh,
    fields: Fields,
    /// From the frame that a fin spans there.
    world_from_fin: Mat3,
    width_m: f32,
}

impl Strip {
    /// One of `count` strips that are `edge_m` long, around a place of `skin`, turned by `turn` of a full turn.
    fn new(skin: &AtlasSkin<'_>, triangle: usize, b: Vec3, edge_m: f32, count: usize, turn: f32) -> Self {
        let AtlasSkin { mesh, fields, .. } = *skin;
        let corners = mesh.triangles[triangle].map(|v| v as usize);
        let mix3 = |of: &dyn Fn(usize) -> Vec3| of(corners[0]) * b.x + of(corners[1]) * b.y + of(corners[2]) * b.z;
        let mix1 = |of: &[f32]| corners.iter().zip(b.to_array()).map(|(&v, b)| of[v] * b).sum::<f32>();
        let [p, q, r] = mesh.corners_m(triangle);
        let normal = mix3(&|v| mesh.normals[v]).normalize_or((q - p).cross(r - p).normalize_or(Vec3::Y));
        let (sin, cos) = libm::sincosf(turn * std::f32::consts::TAU);
        let side = normal.any_orthonormal_vector();
        let x = side * cos + normal.cross(side) * sin;
        let y = normal.cross(x);
        let (middle, width_m) = (mix3(&|v| mesh.positions_m[v]), edge_m / count as f32);
        let at = |u: f32, v: f32| middle + x * (u * 0.5 * width_m) + y * (v * 0.5 * edge_m);
        let lean = mix3(&|v| fields.lean[v]).normalize_or(normal);
        let rise = mix3(&|v| offset_over_height(fields, v));
        let four = |value: f32| vec![value; 4];
        Self {
            mesh: Mesh {
                positions_m: vec![at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)],
                normals: vec![normal; 4],
                triangles: vec![[0, 1, 2], [0, 2, 3]],
                position_class: vec![0, 1, 2, 3],
                ..Mesh::default()
            },
            fields: Fields {
                length: four(mix1(&fields.length)),
                density: four(1.0),
                direction: vec![mix3(&|v| fields.direction[v]); 4],
                lean: vec![lean; 4],
                clump: four(mix1(&fields.clump)),
                tint: vec![Vec3::ONE; 4],
                paint: None,
                partings: Vec::new(),
            },
            world_from_fin: Mat3::from_cols(x, y, rise),
            width_m,
        }
    }

    /// How undercoat crowds at a point of the texture's square, where this is the strip with number `place`.
    fn column(&self, undercoat: &Undercoat, at: Vec2, place: usize) -> Columns<Scalar> {
        let (x, y) = (self.world_from_fin.x_axis, self.world_from_fin.y_axis);
        let root_m = self.mesh.positions_m[0] + x * (at.x - place as f32 * self.width_m) + y * at.y;
        undercoat.column(root_m, self.mesh.normals[0], self.fields.clump[0])
    }

    /// Adds guard hair, as the strip with number `place`.
    fn grow(&self, fibre: &Fibre, seed: u64, place: usize, all: &mut Strands) {
        let Self { mesh, fields, world_from_fin, width_m } = self;
        let corner = mesh.positions_m[0];
        // A rise within the skin, where hair lies flat, has no way back.
        let fin_from_world = world_from_fin.inverse();
        if !fin_from_world.is_finite() {
            return;
        }
        let first = Vec3::new(place as f32 * width_m, 0.0, 0.0);
        let strands = grow::skin::grow(fibre, mesh, fields, seed);
        for hair in 0..strands.len() {
            let points = strands.points_of_m(hair);
            all.points_m.extend(points.iter().map(|&p| first + fin_from_world * (p - corner)));
            all.roots.push(strands.roots[hair]);
            all.root_radius_m.push(strands.root_radius_m[hair]);
            all.tint.push(strands.tint[hair]);
            all.id.push(all.id.len() as u32);
        }
    }
}
