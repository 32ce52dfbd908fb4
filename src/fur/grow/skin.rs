//! Hair on a mesh.

use super::parted::{Parted, in_order};
use super::{course, empty, individual};
use crate::data::fields::Fields;
use crate::data::mesh::Mesh;
use crate::data::paint::Paint;
use crate::data::strands::{Root, Strands};
use crate::fur::groom::clump::{Around, ClumpGrid};
use crate::fur::groom::fibre::Fibre;
use crate::math::hash::{combine, unit_f32};
use crate::math::split::cut;
use crate::math::{Mat3, Vec2, Vec3, orthonormal_basis, sampling};
use rayon::prelude::*;

/// Grows one kind of hair on the whole mesh.
///
/// Each triangle decides its own count and roots from its seed, so order and threads do not matter. A posed mesh carries
/// the hairs of its rest pose: as many, with the same ids, lengths and shapes.
pub fn grow(fibre: &Fibre, mesh: &Mesh, fields: &Fields, seed: u64) -> Strands {
    let all: Vec<usize> = (0..mesh.triangles.len()).collect();
    grow_on(fibre, mesh, fields, seed, &all)
}

/// The hair of `triangles` alone, as [`grow`] would grow it.
pub fn grow_on(fibre: &Fibre, mesh: &Mesh, fields: &Fields, seed: u64, triangles: &[usize]) -> Strands {
    let normals = mesh.smooth_normals();
    let field = Field { fibre, mesh, normals: &normals, fields, seed, parted: Parted::new(mesh, fields) };
    let groups = || triangles.par_chunks(GROUP);
    let counts: Vec<usize> = groups().map(|group| group.iter().map(|&t| field.roots(t).count()).sum()).collect();
    let mut all = empty(fibre, 0);
    let count: usize = counts.iter().sum();
    all.points_m = bytemuck::zeroed_vec(count * all.points_per_strand);
    all.tint = bytemuck::zeroed_vec(count);
    all.roots = vec![Root::default(); count];
    all.root_radius_m = vec![fibre.radius_m; count];
    all.id = (0..count as u32).collect();
    let (mut points_m, mut tint, mut roots) = (&mut all.points_m[..], &mut all.tint[..], &mut all.roots[..]);
    let plots: Vec<Plot<'_>> = counts
        .iter()
        .map(|&count| Plot {
            points_m: cut(&mut points_m, count * all.points_per_strand),
            tint: cut(&mut tint, count),
            roots: cut(&mut roots, count),
        })
        .collect();
    groups().zip(plots).for_each(|(group, plot)| field.grow(group, plot, all.points_per_strand));
    if field.parted.is_some() { in_order(&all) } else { all }
}

/// Triangles that one thread grows hair on at a time.
const GROUP: usize = 32;

/// Room for the hairs of a group of triangles.
struct Plot<'a> {
    points_m: &'a mut [Vec3],
    tint: &'a mut [Vec3],
    roots: &'a mut [Root],
}

/// What hair grows on.
struct Field<'a> {
    fibre: &'a Fibre,
    mesh: &'a Mesh,
    normals: &'a [Vec3],
    fields: &'a Fields,
    seed: u64,
    parted: Option<Parted<'a>>,
}

impl Field<'_> {
    /// Where hairs grow on a triangle, and their keys.
    fn roots(&self, t: usize) -> impl Iterator<Item = (Vec3, u64)> {
        let key = combine(self.seed, self.mesh.face_seed(t));
        let corners = self.mesh.triangles[t].map(|v| v as usize);
        let (density, length) = (corners.map(|v| self.fields.density[v]), corners.map(|v| self.fields.length[v]));
        let painted = self.paint(t);
        let most = |values: [f32; 3]| values.into_iter().fold(0.0, f32::max);
        let greatest = match painted {
            // Maps hold at most 1.
            Some(paint) if paint.of(self.mesh, t).has_densities() => most(corners.map(|v| paint.density[v])),
            _ => most(density),
        };
        let expected = self.fibre.density_per_m2 * self.mesh.rest_area_m2(t) * greatest;
        let count = (expected + unit_f32(key)).floor() as u64;
        (0..count).filter_map(move |i| {
            let key = combine(key, i);
            let b = sampling::square_to_triangle(sampling::r2(i, key & !0xFFFF));
            let (density, share) = match painted {
                Some(paint) => {
                    let point = paint.at(self.mesh, t, b);
                    (point.density, paint.share_of_longest(self.mesh, t, b, &point))
                }
                None => (mix1(density, b), 1.0),
            };
            let gone = unit_f32(combine(key, 2)) * greatest >= density || mix1(length, b) * share <= 0.0;
            (!gone).then_some((b, key))
        })
    }

    /// What is painted on a triangle; none where its corners say all.
    fn paint(&self, t: usize) -> Option<&Paint> {
        self.fields.paint.as_deref().filter(|paint| paint.of(self.mesh, t).varies())
    }

    /// Where a root stands once the hair is parted.
    fn place(&self, t: usize, b: Vec3) -> (usize, Vec3) {
        self.parted.as_ref().map_or((t, b), |parted| parted.out(t, b))
    }

    fn grow(&self, group: &[usize], plot: Plot<'_>, points_per_strand: usize) {
        let roots = group.iter().flat_map(|&t| self.roots(t).map(move |(b, key)| (self.place(t, b), key)));
        let mut ground: Option<Ground> = None;
        let room = plot.points_m.chunks_exact_mut(points_per_strand).zip(plot.tint).zip(plot.roots);
        for (((t, b), key), ((points_m, tint), root)) in roots.zip(room) {
            let here = match &ground {
                Some(ground) if ground.t == t => ground,
                _ => ground.insert(Ground::new(self, t)),
            };
            *root = Root { triangle: t as u32, barycentric: [b.x, b.y] };
            *tint = here.hair(self, b, key, points_m);
        }
    }
}

/// A triangle of the skin.
struct Ground {
    t: usize,
    corners_m: [Vec3; 3],
    rest_m: [Vec3; 3],
    normals: [Vec3; 3],
    lean: [Vec3; 3],
    direction: [Vec3; 3],
    tint: [Vec3; 3],
    length: [f32; 3],
    clump: [f32; 3],
    posed_from_rest: Mat3,
    centres: Around,
}

impl Ground {
    fn new(field: &Field<'_>, t: usize) -> Self {
        let Field { fibre, mesh, normals, fields, .. } = *field;
        let corners = mesh.triangles[t].map(|v| v as usize);
        let rest_m = mesh.rest_corners_m(t);
        Self {
            t,
            corners_m: mesh.corners_m(t),
            rest_m,
            normals: corners.map(|v| normals[v]),
            lean: corners.map(|v| fields.lean[v]),
            direction: corners.map(|v| fields.direction[v]),
            tint: corners.map(|v| fields.tint[v]),
            length: corners.map(|v| fields.length[v]),
            clump: corners.map(|v| fields.clump[v]),
            posed_from_rest: mesh.posed_from_rest(t),
            centres: Around::new(&rest_m, ClumpGrid::in_space(fibre.shape.clump.spacing_mm * 1e-3)),
        }
    }

    /// Grows a hair; returns its colour.
    fn hair(&self, field: &Field<'_>, b: Vec3, key: u64, points_m: &mut [Vec3]) -> Vec3 {
        let fibre = field.fibre;
        let root_m = mix3(self.corners_m, b);
        let normal = mix3(self.normals, b).normalize_or(Vec3::Z);
        let mut lean = mix3(self.lean, b).normalize_or(normal);
        let mut direction = mix3(self.direction, b);
        let (mut tint, mut length, mut clump) = (mix3(self.tint, b), mix1(self.length, b), mix1(self.clump, b));
        if let Some(paint) = field.paint(self.t) {
            let point = paint.at(field.mesh, self.t, b);
            (tint, clump) = (point.tint, point.clump);
            length *= paint.share_of_longest(field.mesh, self.t, b, &point);
            let combed = paint.comb(field.mesh, self.t, b).reject_from(normal).normalize_or_zero();
            let from = direction.reject_from(normal).normalize_or_zero();
            if combed != Vec3::ZERO && from != Vec3::ZERO {
                lean = turned(lean, normal, from, combed);
                direction = combed;
            }
        }
        let x_axis = tangent(direction, normal);
        let y_axis = normal.cross(x_axis);
        let to_clump = self.posed_from_rest * self.centres.to_centre_m(mix3(self.rest_m, b));
        let to_clump = Vec2::new(to_clump.dot(x_axis), to_clump.dot(y_axis));
        let (length_m, brightness) = individual(fibre, fibre.length_m * length, key);
        course(fibre, length_m, clump, to_clump, key, points_m);
        // Shell space to the world: sheared along the lean, as the coat's offsets shear a tile.
        for p in points_m {
            *p = root_m + x_axis * p.x + y_axis * p.y + lean * p.z;
        }
        tint * brightness
    }
}

/// `lean` turned around the unit `normal` as far as from one unit tangent to another.
fn turned(lean: Vec3, normal: Vec3, from: Vec3, to: Vec3) -> Vec3 {
    let (cos, sin) = (from.dot(to), normal.dot(from.cross(to)));
    let flat = lean.reject_from_normalized(normal);
    lean - flat + flat * cos + normal.cross(flat) * sin
}

fn mix3(values: [Vec3; 3], b: Vec3) -> Vec3 {
    values[0] * b.x + values[1] * b.y + values[2] * b.z
}

fn mix1(values: [f32; 3], b: Vec3) -> f32 {
    values[0] * b.x + values[1] * b.y + values[2] * b.z
}

/// The comb direction as a unit vector at a right angle to the normal; any such vector where there is none.
fn tangent(direction: Vec3, normal: Vec3) -> Vec3 {
    let along = direction - normal * direction.dot(normal);
    along.try_normalize().unwrap_or_else(|| orthonormal_basis(normal).0)
}
