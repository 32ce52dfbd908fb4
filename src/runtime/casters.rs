//! What casts the key light's shadow: the skin of all parts, as one list of triangles.

use super::draw_list::{DrawList, SkinMesh};
use crate::math::{DVec3, Vec3};
use std::collections::HashMap;

/// Share of its hair's height by which a limb is wider across the light: half of it stands denser than that.
const SWELL: f32 = 0.5;

/// Length of the sum of a surface's areas, as vectors, over the sum of their lengths from which on it is a sheet: 0 for all that
/// is closed, a half for half a sphere, 1 for a plane.
const SHEET: f64 = 0.25;

/// Size of what counts as one place, over that of all.
const WELD: f32 = 1.0 / 65536.0;

/// A box along the axes, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Its least corner.
    pub low: Vec3,
    /// Its greatest corner.
    pub high: Vec3,
}

impl Bounds {
    /// Around those of `points` that are finite; none without any.
    pub fn of(points: impl Iterator<Item = Vec3>) -> Option<Self> {
        points.filter(|p| p.is_finite()).fold(None, |bounds: Option<Self>, p| {
            let Self { low, high } = bounds.unwrap_or(Self { low: p, high: p });
            Some(Self { low: low.min(p), high: high.max(p) })
        })
    }

    /// Around both.
    pub fn and(self, other: Option<Self>) -> Self {
        other.map_or(self, |other| Self { low: self.low.min(other.low), high: self.high.max(other.high) })
    }

    /// Its middle.
    pub fn middle(&self) -> Vec3 {
        0.5 * (self.low + self.high)
    }

    /// Its corners.
    pub fn corners(&self) -> [Vec3; 8] {
        let pick = |i: usize, axis: usize| if i >> axis & 1 == 0 { self.low[axis] } else { self.high[axis] };
        std::array::from_fn(|i| Vec3::new(pick(i, 0), pick(i, 1), pick(i, 2)))
    }
}

/// The skin of a scene as it hides a light.
#[derive(Clone, Debug, Default)]
pub struct Casters {
    /// Vertices, m.
    pub positions_m: Vec<Vec3>,
    /// Outwards, as far as the vertex moves across the light for its hair, m.
    pub swell_m: Vec<Vec3>,
    /// Counter-clockwise from outside; those of sheets from either side.
    pub triangles: Vec<[u32; 3]>,
    /// Around the asset with its hair.
    pub asset: Option<Bounds>,
    /// Around what is no part of it.
    pub guests: Option<Bounds>,
}

impl Casters {
    /// Those of `scene`.
    pub fn of(scene: &DrawList<'_>) -> Self {
        let mut casters = Self::default();
        for skin in &scene.skins {
            casters.add(skin);
        }
        let sheet = sheets(&casters.positions_m, &casters.triangles);
        for t in sheet {
            let [a, b, c] = casters.triangles[t];
            casters.triangles.push([a, c, b]);
            // Its near side is drawn too, and must not rise into its own hair.
            [a, b, c].iter().for_each(|&v| casters.swell_m[v as usize] = Vec3::ZERO);
        }
        let of_skins = |guest| {
            let skins = scene.skins.iter().filter(move |skin| skin.guest == guest);
            skins.flat_map(|skin| skin.triangles.iter().flatten().map(|&v| skin.positions_m[v as usize]))
        };
        let tips = scene.furs.iter().flat_map(|fur| fur.positions_m.iter().zip(&fur.offsets_m).map(|(&p, &o)| p + o));
        casters.asset = Bounds::of(of_skins(false).chain(tips));
        casters.guests = Bounds::of(of_skins(true));
        casters
    }

    fn add(&mut self, skin: &SkinMesh<'_>) {
        if skin.triangles.is_empty() {
            return;
        }
        let first = self.positions_m.len() as u32;
        self.positions_m.extend(&skin.positions_m);
        let swell = |v: usize| skin.normals[v] * (SWELL * skin.hair_m.get(v).copied().unwrap_or(0.0));
        self.swell_m.extend((0..skin.positions_m.len()).map(swell));
        let outwards = |&[a, b, c]: &[u32; 3]| {
            let [p, q, r] = [a, b, c].map(|v| skin.positions_m[v as usize]);
            let up: Vec3 = [a, b, c].map(|v| skin.normals[v as usize]).iter().sum();
            let mirrored = (q - p).cross(r - p).dot(up) < 0.0;
            if mirrored { [a, c, b] } else { [a, b, c] }.map(|v| first + v)
        };
        self.triangles.extend(skin.triangles.iter().map(outwards));
    }
}

/// The triangles that belong to a sheet, which has no far side that could cast its shadow. What hangs together by points that lie in
/// one place is one surface.
fn sheets(positions_m: &[Vec3], triangles: &[[u32; 3]]) -> Vec<usize> {
    let Some(Bounds { low, high }) = Bounds::of(positions_m.iter().copied()) else { return Vec::new() };
    let per_cell = 1.0 / (WELD * (high - low).max_element()).max(f32::MIN_POSITIVE);
    let mut known = HashMap::with_capacity(positions_m.len());
    let mut parent: Vec<u32> = (0..positions_m.len() as u32).collect();
    for (v, p) in (0..).zip(positions_m) {
        let cell = ((*p - low) * per_cell).round().as_ivec3();
        parent[v as usize] = *known.entry(cell).or_insert(v);
    }
    for &[a, b, c] in triangles {
        for other in [b, c] {
            let (one, other) = (root(&mut parent, a), root(&mut parent, other));
            parent[other as usize] = one;
        }
    }
    let mut areas: HashMap<u32, (DVec3, f64)> = HashMap::new();
    let surface: Vec<u32> = triangles.iter().map(|t| root(&mut parent, t[0])).collect();
    for (t, of) in triangles.iter().zip(&surface) {
        let [p, q, r] = t.map(|v| positions_m[v as usize].as_dvec3());
        let area = (q - p).cross(r - p);
        let (sum, size) = areas.entry(*of).or_default();
        (*sum, *size) = (*sum + area, *size + area.length());
    }
    let is_sheet = |of: &u32| areas.get(of).is_some_and(|(sum, size)| sum.length() > SHEET * size);
    (0..triangles.len()).filter(|&t| is_sheet(&surface[t])).collect()
}

/// The vertex that stands for all that hang together with `v`.
fn root(parent: &mut [u32], mut v: u32) -> u32 {
    while parent[v as usize] != v {
        // Halving the path keeps it short.
        parent[v as usize] = parent[parent[v as usize] as usize];
        v = parent[v as usize];
    }
    v
}
