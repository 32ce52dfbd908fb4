//! How well a coat reproduces the hair of the skin that it is on: coverage along rays to places of the skin, through the strands and
//! the undercoat that grow there and through the shells as they lie over them.

use super::flatten::axes;
use crate::cast::Caster;
use crate::cast::Geometry;
use crate::cast::Rays;
use crate::coat::axes::Stand;
use crate::coat::judge::CoverageRow;
use crate::coat::primitive::offset_over_height;
use crate::data::coat::{Sampled, Tile};
use crate::data::fields::Fields;
use crate::data::mesh::Mesh;
use crate::data::patches::Patches;
use crate::data::ray::DepthRange;
use crate::data::ray::Ray;
use crate::data::shell::{Incidence, Stack, slab_optical_depth};
use crate::data::strands::Strands;
use crate::fur::groom::fibre::Fibre;
use crate::fur::grow;
use crate::fur::undercoat::{Pattern, Undercoat};
use crate::math::hash::{combine, unit_f32};
use crate::math::{Mat3, Vec2, Vec3, orthonormal_basis, sampling};
use crate::volume::march::content::{Content, Resolution};
use crate::volume::march::volume::Volume;
use crate::volume::march::{MarchRay, Start, Stepping};
use crate::volume::scene::{HairScattering, Scene};
use crate::volume::shell::locate::within;
use rayon::prelude::*;

/// Angles between ray and normal that are judged, degrees. Beyond them a ray passes more than one place of a curved skin.
pub const ANGLES_DEG: [f32; 4] = [0.0, 20.0, 40.0, 60.0];
/// Pixels along the edge of the block that is looked at in each place, and rays along a pixel's edge.
const BLOCK: (usize, usize) = (4, 3);

/// Up to so many hairs are grown at once; of more, those near a place for each place anew.
const AT_ONCE: f32 = 1e6;

/// A skin, what grows on it, and what it carries.
#[derive(Clone, Copy, Debug)]
pub struct CoatedSkin<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// The groom's fields on it.
    pub fields: &'a Fields,
    /// Texture coordinates.
    pub patches: &'a Patches,
    /// The shells.
    pub tile: &'a Tile,
    /// Guard hair and undercoat.
    pub hair: [&'a Fibre; 2],
    /// Decides where each hair grows.
    pub seed: u64,
}

/// A place on the skin: triangle and barycentric coordinates.
pub type SurfacePoint = (usize, Vec3);

/// `count` places spread by area over the triangles that `accept` takes; none where it takes none.
pub fn places(mesh: &Mesh, count: usize, seed: u64, accept: impl Fn(usize) -> bool) -> Vec<SurfacePoint> {
    let taken: Vec<usize> = (0..mesh.triangles.len()).filter(|&t| accept(t)).collect();
    let sums: Vec<f32> = taken
        .iter()
        .scan(0.0, |sum, &t| {
            *sum += mesh.area_m2(t);
            Some(*sum)
        })
        .collect();
    let Some(&total) = sums.last() else { return Vec::new() };
    let place = |i: usize| {
        let at = (i as f32 + unit_f32(combine(seed, 0))) / count as f32 * total;
        let triangle = taken[sums.partition_point(|&sum| sum < at).min(taken.len() - 1)];
        (triangle, sampling::square_to_triangle(sampling::r2(i as u64, seed & !0xFFFF)))
    };
    (0..count).map(place).collect()
}

/// Rows of [`ANGLES_DEG`] for each group of places.
pub fn surface_tables(coated: &CoatedSkin<'_>, groups: &[Vec<SurfacePoint>]) -> Vec<Vec<CoverageRow>> {
    let stack = Stack::new(coated.tile);
    let normals = coated.mesh.smooth_normals();
    let area_m2: f32 = (0..coated.mesh.triangles.len()).map(|t| coated.mesh.area_m2(t)).sum();
    let all: Vec<usize> = (0..coated.mesh.triangles.len()).collect();
    let all = (area_m2 * coated.hair[0].density_per_m2 <= AT_ONCE).then(|| coated.grown(&all));
    let all = all.as_ref().map(caster);
    let content = coated.content(&normals);
    let volume = content.as_ref().map(|content| Volume::new(content, coated.subdivisions()));
    let judge = Judge { coated, stack: &stack, normals: &normals, all: all.as_ref(), volume: volume.as_ref() };
    groups.iter().map(|places| judge.rows(places)).collect()
}

impl<'a> CoatedSkin<'a> {
    /// The guard hair of some triangles.
    fn grown(&self, triangles: &[usize]) -> Strands {
        grow::skin::grow_on(self.hair[0], self.mesh, self.fields, combine(self.seed, 1), triangles)
    }

    /// The undercoat, as a picture has it.
    fn content(&self, normals: &[Vec3]) -> Option<Content<'a>> {
        let scene = Scene {
            skin: self.mesh,
            fields: self.fields,
            skin_factor: Vec3::ONE,
            guard: None,
            undercoat: Some(self.hair[1]),
            scattering: HairScattering::none(),
        };
        Content::new(&scene, normals, Resolution::default())
    }

    /// How finely it is resolved: two sub-elements to the finest detail.
    fn subdivisions(&self) -> Vec<u8> {
        let wanted_m = 0.5 * Undercoat::new(self.hair[1], Some(Pattern::default())).detail_m();
        let resolution = Resolution::default();
        let subdivisions = (0..self.mesh.triangles.len()).map(|t| {
            let [p, q, r] = self.mesh.corners_m(t);
            let edge_m = (p.distance(q) + q.distance(r) + r.distance(p)) / 3.0;
            libm::log2f(edge_m / wanted_m).ceil().clamp(0.0, resolution.most_subdivisions as f32) as u8
        });
        subdivisions.collect()
    }
}

/// The strands with a point that `passes` within half the distance to the next.
fn kept(strands: &Strands, passes: impl Fn(Vec3, f32) -> bool) -> Strands {
    let near = |i: &usize| {
        strands.points_of_m(*i).windows(2).any(|pair| {
            let half_m = 0.5 * pair[0].distance(pair[1]);
            passes((pair[0] + pair[1]) * 0.5, half_m)
        })
    };
    let mut kept = strands.none_alike();
    for i in (0..strands.len()).filter(near) {
        kept.push_alike(strands, i, strands.points_of_m(i).iter().copied(), 1.0);
    }
    kept
}

fn caster(guard: &Strands) -> Caster<'_> {
    Caster::new(Geometry { guard: Some(guard), ..Geometry::default() })
}

/// Finer than a picture's steps: what they miss would count as the stack's error.
const STEPPING: Stepping = Stepping { depth: 0.15, layers: 1.0 };
/// Optical depth beyond which nothing passes.
const OPAQUE_DEPTH: f32 = 12.0;
/// Places along a ray that are tried for one inside the shell, where its end lies below a hollow skin.
const TRIES: u8 = 16;

struct Judge<'a> {
    coated: &'a CoatedSkin<'a>,
    stack: &'a Stack<'a>,
    normals: &'a [Vec3],
    /// All guard hair, where it was grown at once.
    all: Option<&'a Caster<'a>>,
    volume: Option<&'a Volume<'a>>,
}

impl Judge<'_> {
    fn rows(&self, places: &[SurfacePoint]) -> Vec<CoverageRow> {
        // Per place and angle: mean coverage of the block by strands, by the stack, by constant α.
        let seed = |i: usize| combine(self.coated.seed, i as u64);
        let blocks: Vec<[[f32; 3]; 4]> =
            places.par_iter().enumerate().map(|(i, &place)| self.place(place, seed(i))).collect();
        let n = blocks.len().max(1) as f32;
        let row = |(angle, &theta_deg): (usize, &f32)| {
            let mean = |what: usize| blocks.iter().map(|b| b[angle][what]).sum::<f32>() / n;
            let rmse =
                |what: usize| (blocks.iter().map(|b| (b[angle][what] - b[angle][0]).powi(2)).sum::<f32>() / n).sqrt();
            CoverageRow {
                theta_deg,
                strands: mean(0),
                stack: mean(1),
                constant: mean(2),
                rmse: rmse(1),
                rmse_constant: rmse(2),
            }
        };
        ANGLES_DEG.iter().enumerate().map(row).collect()
    }

    fn place(&self, (triangle, b): SurfacePoint, key: u64) -> [[f32; 3]; 4] {
        let CoatedSkin { mesh, fields, tile, hair, .. } = *self.coated;
        let corners = mesh.triangles[triangle].map(|v| v as usize);
        let mix = |values: [Vec3; 3]| values[0] * b.x + values[1] * b.y + values[2] * b.z;
        let at_m = mix(mesh.corners_m(triangle));
        let normal = mix(corners.map(|v| self.normals[v])).normalize_or(Vec3::Z);
        let (x, y) = orthonormal_basis(normal);
        let azimuth = std::f32::consts::TAU * unit_f32(key);
        let aside = x * libm::cosf(azimuth) + y * libm::sinf(azimuth);
        let rise_m = tile.height_m * mix(corners.map(|v| offset_over_height(fields, v))).length();
        let pixel_m = tile.edge_m / tile.shells.size as f32;
        let views = ANGLES_DEG.map(|theta| {
            let (sin, cos) = libm::sincosf(theta.to_radians());
            (aside * sin - normal * cos, 1.1 * rise_m / cos)
        });
        // Whether a point lies within a reach of the rays.
        let radius_m = BLOCK.0 as f32 * pixel_m;
        let passes = |p: Vec3, reach_m: f32| {
            views.iter().any(|&(direction, far_m)| {
                let along_m = (p - at_m).dot(-direction).clamp(0.0, far_m);
                p.distance(at_m - direction * along_m) < radius_m + reach_m
            })
        };
        // Hair and shells whose triangles some ray may come near.
        let hair_m = hair.iter().map(|fibre| fibre.longest_m()).fold(0.0, f32::max);
        let near = |t: usize| {
            let [p, q, r] = mesh.corners_m(t);
            let middle = (p + q + r) / 3.0;
            let length = mesh.triangles[t].map(|v| fields.length[v as usize]).iter().copied().fold(0.0, f32::max);
            let reach_m =
                p.distance(middle).max(q.distance(middle)).max(r.distance(middle)) + hair_m.max(tile.height_m) * length;
            passes(middle, reach_m)
        };
        let triangles: Vec<usize> = (0..mesh.triangles.len()).filter(|&t| near(t)).collect();
        let nearby = self.all.is_none().then(|| kept(&self.coated.grown(&triangles), passes));
        let own = nearby.as_ref().map(caster);
        let caster = self.all.or(own.as_ref());
        views.map(|(direction, far_m)| {
            let ray = |across: usize, i: usize| {
                let place = |n: usize| ((n as f32 + 0.5) / across as f32 - 0.5) * BLOCK.0 as f32 * pixel_m;
                let target = at_m + x * place(i % across) + y * place(i / across);
                Ray { origin_m: target - direction * far_m, direction }
            };
            let fine = BLOCK.0 * BLOCK.1;
            let rays: Vec<Ray> = (0..fine * fine).map(|i| ray(fine, i)).collect();
            let range = DepthRange { near_m: 0.0, far_m };
            let film = caster.map(|caster| caster.render(&Rays::Texels { rays: &rays, size: [fine, fine] }, range));
            let depths = self.undercoat_depths(&rays, far_m, &triangles);
            let clear = |i: usize| libm::expf(-depths[i]) * film.as_ref().map_or(1.0, |film| 1.0 - film.alpha[i]);
            let strands = 1.0 - (0..rays.len()).map(clear).sum::<f32>() / rays.len() as f32;
            let mut seen = [strands, 0.0, 0.0];
            for i in 0..BLOCK.0 * BLOCK.0 {
                let depths = self.depths(&ray(BLOCK.0, i), far_m, &triangles);
                let share = 1.0 / (BLOCK.0 * BLOCK.0) as f32;
                seen[1] -= libm::expm1f(-depths[0]) * share;
                seen[2] -= libm::expm1f(-depths[1]) * share;
            }
            seen
        })
    }

    /// Optical depths of undercoat along rays, followed from their ends, `far_m` from their origins, outwards.
    fn undercoat_depths(&self, rays: &[Ray], far_m: f32, triangles: &[usize]) -> Vec<f32> {
        let mut depths = vec![0.0; rays.len()];
        let Some(volume) = self.volume else { return depths };
        let start = |ray: &Ray| {
            (0..TRIES).find_map(|i| {
                let at_m = far_m * f32::from(i) / f32::from(TRIES);
                let point_m = ray.origin_m + ray.direction * (far_m - at_m);
                let holds = |&t: &usize| Some((t as u32, within(volume.shell(), t as u32, point_m)?));
                triangles.iter().find_map(holds).map(|(triangle, point)| Start { at_m, triangle, point })
            })
        };
        let march_ray = |(i, ray): (usize, &Ray)| {
            let origin_m = ray.origin_m + ray.direction * far_m;
            Some((i, MarchRay { origin_m, direction: -ray.direction, start: start(ray)?, far_m }))
        };
        let (found, rays): (Vec<usize>, Vec<MarchRay>) = rays.iter().enumerate().filter_map(march_ray).unzip();
        for (i, depth) in found.into_iter().zip(volume.depths_along(&rays, &STEPPING, 0.0, OPAQUE_DEPTH).0) {
            depths[i] = depth;
        }
        depths
    }

    /// Optical depth of the shells over `triangles` along a ray: by the law, and with each texel's as it is from above.
    fn depths(&self, ray: &Ray, far_m: f32, triangles: &[usize]) -> [f32; 2] {
        let CoatedSkin { mesh, fields, patches, tile, .. } = *self.coated;
        let pixel = 1.0 / tile.shells.size as f32;
        let above = Incidence::new(Vec3::NEG_Z, Mat3::IDENTITY, pixel);
        let mut depths = [0.0; 2];
        for &t in triangles {
            let corners = mesh.triangles[t].map(|v| v as usize);
            let offsets = corners.map(|v| offset_over_height(fields, v));
            let uv = patches.triangles[t].map(|v| patches.uv[v as usize]);
            for layer in 1..tile.shells.layers as usize {
                let height_m = self.stack.middle_m(layer);
                let skin_m = mesh.corners_m(t);
                let shell_m = [0, 1, 2].map(|i| skin_m[i] + offsets[i] * height_m);
                let Some(b) = crossing(shell_m, ray, far_m) else { continue };
                let Some([x, y]) = axes(shell_m, uv.map(|p| p * tile.edge_m)) else { continue };
                let z = offsets[0] * b.x + offsets[1] * b.y + offsets[2] * b.z;
                let seen = match tile.sampled {
                    Sampled::Skin => Incidence::new(ray.direction, Mat3::from_cols(x, y, z), pixel),
                    Sampled::Square => {
                        let around = |of: [Vec3; 3]| of[0] * b.x + of[1] * b.y + of[2] * b.z;
                        let twice_area = |[a, b, c]: [Vec3; 3]| (b - a).cross(c - a);
                        let (here, foot) = (twice_area(shell_m), twice_area(skin_m));
                        let spread = (here.length() / foot.length().max(f32::MIN_POSITIVE)).sqrt();
                        let axis = around(corners.map(|v| fields.direction[v]));
                        let stand = Stand { normal: here.normalize_or_zero(), axis, up: z, texture: [x, y], spread };
                        stand.seen(ray.direction, pixel)
                    }
                };
                let at: Vec2 = uv[0] * b.x + uv[1] * b.y + uv[2] * b.z;
                let density = match tile.sampled {
                    Sampled::Skin => 1.0,
                    Sampled::Square => {
                        corners.iter().zip(b.to_array()).map(|(&v, b)| fields.density[v] * b).sum::<f32>()
                    }
                };
                let slab_m = self.stack.slab_m(layer);
                let law = slab_optical_depth(&self.stack.fetch_middle(layer, at, &seen), &seen, slab_m);
                let plain = slab_optical_depth(&self.stack.fetch_middle(layer, at, &above), &above, slab_m);
                depths[0] += density * self.stack.gain(layer, &seen) * law;
                depths[1] += density * self.stack.gain(layer, &above) * plain;
            }
        }
        depths
    }
}

/// Barycentric coordinates of where a ray enters through a triangle, within `far_m` (Möller and Trumbore 1997).
fn crossing([a, b, c]: [Vec3; 3], ray: &Ray, far_m: f32) -> Option<Vec3> {
    let (e1, e2) = (b - a, c - a);
    let p = ray.direction.cross(e2);
    let determinant = e1.dot(p);
    if determinant <= 0.0 {
        return None;
    }
    let to = (ray.origin_m - a) / determinant;
    let u = to.dot(p);
    let q = to.cross(e1);
    let v = ray.direction.dot(q);
    let along_m = e2.dot(q);
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && (0.0..=far_m).contains(&along_m);
    inside.then(|| Vec3::new(1.0 - u - v, u, v))
}
