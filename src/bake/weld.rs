//! All parts of an asset as one surface (`docs/steps/skin.md`): what lies at one place is one place for hair, whichever
//! primitives, materials or seams meet there; and how a file cuts and orders its triangles changes nothing.

use super::fan::fan;
use crate::asset::{Asset, Part};
use crate::data::mesh::{Mesh, position_classes};
use crate::data::spread::{LEAST_RISE, widest};
use crate::data::topology::Topology;
use crate::error::Result;
use crate::math::hash::combine;
use crate::math::{DVec3, Vec2, Vec3, Vec4};
use std::collections::HashMap;

/// Meshes of one skeleton touch where they are closer than this share of the hair's length.
const TOUCHING: f32 = 1e-3;
/// Places of one mesh are one where they are closer than this share of its size.
const SAME: f32 = 2e-6;
/// Share of the shortest edge that welding never reaches.
const OF_EDGE: f32 = 0.45;
/// A double-sided part is a sheet, furred on both sides, where its open side is at least this share of its area (a flat one's
/// is all of it, a body's with a hole at the neck next to nothing) and no more of its edge is held by skin of one side than is
/// free, as an ear's.
const SHEET: f64 = 0.3;

/// The parts of an asset in the rest pose, welded. Vertices that faces on both sides of a hard edge share are told apart.
#[derive(Clone, Debug, Default)]
pub struct Skin {
    /// The surface, m. Triangles lie in an order that their places decide.
    pub mesh: Mesh,
    /// Per vertex: its part, and which of its stored vertices it is.
    pub stored: Vec<(u32, u32)>,
    /// Per triangle: its part.
    pub part_of: Vec<u32>,
    /// Per part: how many sets of texture coordinates it has; the mesh has as many as the richest, zeros for others.
    pub uv_sets: Vec<usize>,
}

/// A triangle before vertices are numbered.
struct Face {
    part: u32,
    /// Stored vertices, the one at the least place first.
    corners: [u32; 3],
    /// The places there.
    points: [u32; 3],
    seed: u64,
    order: u64,
}

/// Joins all parts; `furred` says which of them get hair, and `hair_m` how long it is.
///
/// # Errors
/// As [`Part::mesh`].
pub fn join(asset: &Asset, furred: impl Fn(usize) -> bool, metres_per_unit: f64, hair_m: f32) -> Result<Skin> {
    let meshes: Vec<Mesh> = asset.parts.iter().map(|part| part.mesh(metres_per_unit)).collect::<Result<_>>()?;
    let points = welded(asset, &meshes, hair_m);
    let low = meshes.iter().flat_map(|mesh| &mesh.positions_m).fold(Vec3::INFINITY, |low, &p| low.min(p));
    let high = meshes.iter().flat_map(|mesh| &mesh.positions_m).fold(Vec3::NEG_INFINITY, |high, &p| high.max(p));
    let mut faces = Vec::new();
    for (index, mesh) in meshes.iter().enumerate() {
        for &corners in &mesh.triangles {
            faces.push(Face::new(&asset.parts[index], index, corners, mesh, &points[index], (low, high)));
        }
    }
    faces.extend(backs(asset, &meshes, &faces, furred));
    faces.sort_unstable_by_key(|face| (face.order, face.seed, face.part));
    split(&meshes, &mut faces);
    let mut skin = number(&meshes, &faces);
    let mut normals = skin.mesh.smooth_normals();
    fan(&skin.mesh, &skin.stored, &mut normals);
    skin.mesh.hair_normals = Some(normals);
    Ok(skin)
}

impl Face {
    fn new(
        part: &Part,
        index: usize,
        corners: [u32; 3],
        mesh: &Mesh,
        points: &[u32],
        (low, high): (Vec3, Vec3),
    ) -> Self {
        // Chance is drawn from the places in the mesh's own space, to the bit, so that units and other parts do not matter.
        let local = |v: u32| part.stored.positions[v as usize].to_array().map(|x| (x + 0.0).to_bits());
        let first = (0..3).min_by_key(|&k| local(corners[k])).unwrap_or(0);
        let corners = [corners[first], corners[(first + 1) % 3], corners[(first + 2) % 3]];
        let bits = corners.into_iter().flat_map(local);
        let seed = bits.fold(0, |seed, bits| combine(seed, u64::from(bits)));
        let middle = corners.iter().map(|&v| mesh.positions_m[v as usize]).sum::<Vec3>() / 3.0;
        let extent = (high - low).max(Vec3::splat(f32::MIN_POSITIVE));
        Self {
            part: index as u32,
            corners,
            points: corners.map(|v| points[v as usize]),
            seed,
            order: along_curve((middle - low) / extent),
        }
    }

    fn area_vector(&self, meshes: &[Mesh]) -> DVec3 {
        let [a, b, c] = self.corners.map(|v| meshes[self.part as usize].positions_m[v as usize].as_dvec3());
        (b - a).cross(c - a)
    }
}

/// Where a point of the unit cube lies along a curve that keeps what is near near: its coordinates' bits in turns (Morton 1966).
fn along_curve(at: Vec3) -> u64 {
    let bits = at.to_array().map(|x| (x.clamp(0.0, 1.0) * 65535.0) as u64);
    (0..16).rev().fold(0, |sum, bit| bits.iter().fold(sum, |sum, b| sum << 1 | (b >> bit & 1)))
}

/// Per part, the place of each stored vertex: one number for all that are one point.
fn welded(asset: &Asset, meshes: &[Mesh], hair_m: f32) -> Vec<Vec<u32>> {
    let mut start = Vec::new();
    let mut count = 0;
    for mesh in meshes {
        start.push(count);
        count += mesh.positions_m.len() as u32;
    }
    let mut points: Vec<Vec<u32>> = meshes
        .iter()
        .zip(&start)
        .map(|(mesh, start)| mesh.position_class.iter().map(|c| start + c).collect())
        .collect();
    for group in groups(asset).into_iter().filter(|group| group.len() > 1) {
        let one_mesh = group.iter().all(|&part| asset.parts[part].mesh == asset.parts[group[0]].mesh);
        // The vertices that stand for a place in their part.
        let candidates: Vec<(usize, u32)> = group
            .iter()
            .flat_map(|&part| {
                meshes[part].position_class.iter().zip(0..).filter(|(c, v)| **c == *v).map(move |(_, v)| (part, v))
            })
            .collect();
        let positions: Vec<Vec3> = candidates.iter().map(|&(part, v)| meshes[part].positions_m[v as usize]).collect();
        let low = positions.iter().fold(Vec3::INFINITY, |low, &p| low.min(p));
        let high = positions.iter().fold(Vec3::NEG_INFINITY, |high, &p| high.max(p));
        let touching_m = if one_mesh { 0.0 } else { TOUCHING * hair_m };
        let tolerance_m = (SAME * (high - low).length()).max(touching_m).min(OF_EDGE * shortest_edge_m(&group, meshes));
        let classes = position_classes(&positions, tolerance_m);
        for (&(part, v), class) in candidates.iter().zip(classes) {
            let (of, first) = candidates[class as usize];
            points[part][v as usize] = start[of] + first;
        }
        for &part in &group {
            for (v, &class) in meshes[part].position_class.iter().enumerate() {
                points[part][v] = points[part][class as usize];
            }
        }
    }
    points
}

/// Parts whose vertices may be one: those of a mesh, and of meshes that hang on common joints. Levels of detail lie within one
/// another and have nothing to do with each other.
fn groups(asset: &Asset) -> Vec<Vec<usize>> {
    let joints = |part: &Part| -> Vec<usize> {
        let skins = part.skins.iter().flatten();
        skins.flat_map(|&skin| asset.scene.skins[skin].joints.iter().map(|(node, _)| *node)).collect()
    };
    let mut groups: Vec<(Vec<usize>, Vec<usize>)> = Vec::new();
    for (index, part) in asset.parts.iter().enumerate() {
        let own = joints(part);
        let (joined, apart): (Vec<_>, Vec<_>) = groups.into_iter().partition(|(parts, of)| {
            let first = &asset.parts[parts[0]];
            first.level == part.level && (first.mesh == part.mesh || of.iter().any(|joint| own.contains(joint)))
        });
        let mut group = (vec![index], own);
        for (parts, of) in joined {
            group.0.extend(parts);
            group.1.extend(of);
        }
        group.0.sort_unstable();
        group.1.sort_unstable();
        group.1.dedup();
        groups = apart;
        groups.push(group);
    }
    groups.into_iter().map(|(parts, _)| parts).collect()
}

fn shortest_edge_m(group: &[usize], meshes: &[Mesh]) -> f32 {
    let edges = group.iter().flat_map(|&part| {
        let mesh = &meshes[part];
        (0..mesh.triangles.len()).flat_map(|t| {
            let [a, b, c] = mesh.corners_m(t);
            [a.distance(b), b.distance(c), c.distance(a)]
        })
    });
    edges.filter(|&length| length > 0.0).fold(f32::INFINITY, f32::min)
}

/// The other sides of double-sided sheets, wound the other way. Their places are their own.
fn backs(asset: &Asset, meshes: &[Mesh], faces: &[Face], furred: impl Fn(usize) -> bool) -> Vec<Face> {
    let double_sided = |t: usize| asset.parts[faces[t].part as usize].double_sided;
    let wanted = |t: usize| double_sided(t) && furred(faces[t].part as usize);
    if !(0..faces.len()).any(wanted) {
        return Vec::new();
    }
    let points: Vec<[u32; 3]> = faces.iter().map(|face| face.points).collect();
    let topology = Topology::new(&points, |v| v);
    let mut component = vec![usize::MAX; faces.len()];
    let mut is_sheet = Vec::new();
    for first in (0..faces.len()).filter(|&t| double_sided(t)) {
        if component[first] != usize::MAX {
            continue;
        }
        let (number, mut waiting) = (is_sheet.len(), vec![first]);
        let (mut open, mut area) = (DVec3::ZERO, 0.0);
        // Edges where it ends, and where it goes on in what has one side.
        let (mut free, mut held) = (0, 0);
        component[first] = number;
        while let Some(t) = waiting.pop() {
            let vector = faces[t].area_vector(meshes);
            open += vector;
            area += vector.length();
            for k in 0..3 {
                match topology.neighbour(t, k) {
                    None => free += 1,
                    Some(other) if !double_sided(other) => held += 1,
                    Some(other) if component[other] == usize::MAX => {
                        component[other] = number;
                        waiting.push(other);
                    }
                    Some(_) => {}
                }
            }
        }
        is_sheet.push(open.length() > SHEET * area && free >= held);
    }
    let past = points.iter().flatten().max().map_or(0, |&most| most + 1);
    let turned = |[a, b, c]: [u32; 3]| [a, c, b];
    let back = |face: &Face| Face {
        part: face.part,
        corners: turned(face.corners),
        points: turned(face.points).map(|point| past + point),
        seed: combine(face.seed, 1),
        order: face.order,
    };
    (0..faces.len()).filter(|&t| wanted(t) && is_sheet[component[t]]).map(|t| back(&faces[t])).collect()
}

/// Gives faces around a place places of their own where no hair could leave all of them.
fn split(meshes: &[Mesh], faces: &mut [Face]) {
    let mut around: HashMap<u32, Vec<(u32, u8)>> = HashMap::new();
    for (t, face) in faces.iter().enumerate() {
        for (k, &point) in face.points.iter().enumerate() {
            around.entry(point).or_default().push((t as u32, k as u8));
        }
    }
    let mut past = faces.iter().flat_map(|face| face.points).max().map_or(0, |most| most + 1);
    let normals: Vec<Vec3> =
        faces.iter().map(|face| face.area_vector(meshes).try_normalize().map_or(Vec3::ZERO, |n| n.as_vec3())).collect();
    let mut points: Vec<u32> = around.keys().copied().collect();
    points.sort_unstable();
    for point in points {
        let corners = &around[&point];
        let of = |&(t, _): &(u32, u8)| normals[t as usize];
        let mut waiting = vec![corners.clone()];
        let mut first = true;
        while let Some(some) = waiting.pop() {
            let directions: Vec<Vec3> = some.iter().map(of).filter(|n| *n != Vec3::ZERO).collect();
            if directions.len() > 1 && widest(&directions).1 < LEAST_RISE {
                let (one, other) = apart(&some, &normals);
                if !one.is_empty() && !other.is_empty() {
                    waiting.extend([one, other]);
                    continue;
                }
            }
            // The first keeps the place.
            if !std::mem::replace(&mut first, false) {
                some.iter().for_each(|&(t, k)| faces[t as usize].points[k as usize] = past);
                past += 1;
            }
        }
    }
}

type Corners = Vec<(u32, u8)>;

/// Faces in two, each with what it faces like most of the two that face apart most.
fn apart(corners: &Corners, normals: &[Vec3]) -> (Corners, Corners) {
    let of = |&(t, _): &(u32, u8)| normals[t as usize];
    let (mut least, mut ends) = (f32::INFINITY, [Vec3::Y; 2]);
    for (i, a) in corners.iter().enumerate() {
        for b in &corners[i + 1..] {
            if of(a).dot(of(b)) < least {
                (least, ends) = (of(a).dot(of(b)), [of(a), of(b)]);
            }
        }
    }
    corners.iter().partition(|corner| of(corner).dot(ends[0]) >= of(corner).dot(ends[1]))
}

/// Numbers vertices as faces use them.
fn number(meshes: &[Mesh], faces: &[Face]) -> Skin {
    let uv_sets = meshes.iter().map(|mesh| mesh.uv_sets.len()).collect();
    let mut skin = Skin { uv_sets, ..Skin::default() };
    let mut known: HashMap<(u32, u32, u32), u32> = HashMap::new();
    let mut first: HashMap<u32, u32> = HashMap::new();
    for face in faces {
        let vertex = |k: usize| {
            let (v, point) = (face.corners[k], face.points[k]);
            *known.entry((face.part, v, point)).or_insert_with(|| {
                let number = skin.stored.len() as u32;
                skin.stored.push((face.part, v));
                skin.mesh.position_class.push(*first.entry(point).or_insert(number));
                number
            })
        };
        let triangle = std::array::from_fn(vertex);
        skin.mesh.triangles.push(triangle);
        skin.mesh.face_seeds.push(face.seed);
        skin.part_of.push(face.part);
    }
    let stored = &skin.stored;
    fn gather<T: Copy>(stored: &[(u32, u32)], of: impl Fn(usize, usize) -> T) -> Vec<T> {
        stored.iter().map(|&(part, v)| of(part as usize, v as usize)).collect()
    }
    let any = |has: &dyn Fn(&Mesh) -> bool| meshes.iter().any(has);
    let sets = meshes.iter().map(|mesh| mesh.uv_sets.len()).max().unwrap_or(0);
    let or = |list: &Option<Vec<f32>>, v: usize, other: f32| list.as_ref().map_or(other, |list| list[v]);
    skin.mesh = Mesh {
        origin_m: meshes.first().map_or(DVec3::ZERO, |mesh| mesh.origin_m),
        positions_m: gather(stored, |part, v| meshes[part].positions_m[v]),
        normals: gather(stored, |part, v| meshes[part].normals[v]),
        uv_sets: (0..sets)
            .map(|set| gather(stored, |part, v| meshes[part].uv_sets.get(set).map_or(Vec2::ZERO, |uv| uv[v])))
            .collect(),
        colour: any(&|mesh| mesh.colour.is_some())
            .then(|| gather(stored, |part, v| meshes[part].colour.as_ref().map_or(Vec4::ONE, |c| c[v]))),
        fur_length: any(&|mesh| mesh.fur_length.is_some())
            .then(|| gather(stored, |part, v| or(&meshes[part].fur_length, v, 1.0))),
        fur_region: any(&|mesh| mesh.fur_region.is_some())
            .then(|| gather(stored, |part, v| or(&meshes[part].fur_region, v, 0.0))),
        fur_direction: any(&|mesh| mesh.fur_direction.is_some())
            .then(|| gather(stored, |part, v| meshes[part].fur_direction.as_ref().map_or(Vec3::ZERO, |d| d[v]))),
        ..skin.mesh
    };
    skin
}

impl Skin {
    /// Some of its triangles on the vertices that they need, and which of its vertices these are. Hair stands on them as it
    /// does on the whole.
    pub fn cut(&self, keep: impl Fn(u32) -> bool) -> (Self, Vec<u32>) {
        let whole = &self.mesh;
        let normals = whole.smooth_normals();
        let mut new = vec![u32::MAX; self.stored.len()];
        let mut old = Vec::new();
        let mut cut = Self::default();
        for (t, triangle) in whole.triangles.iter().enumerate().filter(|(t, _)| keep(self.part_of[*t])) {
            cut.mesh.triangles.push(triangle.map(|v| {
                if new[v as usize] == u32::MAX {
                    new[v as usize] = old.len() as u32;
                    old.push(v);
                }
                new[v as usize]
            }));
            cut.mesh.face_seeds.push(whole.face_seeds[t]);
            cut.part_of.push(self.part_of[t]);
        }
        fn at<T: Copy>(list: &[T], old: &[u32]) -> Vec<T> {
            old.iter().map(|&v| list[v as usize]).collect()
        }
        let mut first: HashMap<u32, u32> = HashMap::new();
        let sets = cut.part_of.iter().map(|&part| self.uv_sets[part as usize]).max().unwrap_or(0);
        cut.uv_sets = self.uv_sets.clone();
        cut.mesh = Mesh {
            origin_m: whole.origin_m,
            positions_m: at(&whole.positions_m, &old),
            rest_m: None,
            normals: at(&whole.normals, &old),
            hair_normals: Some(at(&normals, &old)),
            position_class: old
                .iter()
                .zip(0..)
                .map(|(&v, number)| *first.entry(whole.position_class[v as usize]).or_insert(number))
                .collect(),
            uv_sets: whole.uv_sets[..sets].iter().map(|set| at(set, &old)).collect(),
            colour: whole.colour.as_ref().map(|list| at(list, &old)),
            fur_length: whole.fur_length.as_ref().map(|list| at(list, &old)),
            fur_region: whole.fur_region.as_ref().map(|list| at(list, &old)),
            fur_direction: whole.fur_direction.as_ref().map(|list| at(list, &old)),
            ..cut.mesh
        };
        cut.stored = at(&self.stored, &old);
        (cut, old)
    }
}
