//! What is painted on a skin: textures and maps, read where a hair has its root (`docs/steps/paint.md`).

use super::image::Image8;
use super::maps::{Maps, painted_comb, sample, uv_axes};
use super::mesh::Mesh;
use super::texture::Texture;
use crate::math::{Vec2, Vec3, Vec4};
use serde::{Serialize, Serializer};
use std::sync::Arc;

/// What is painted on a part of the skin.
#[derive(Clone, Debug, Default)]
pub struct Painted {
    /// Texture of colour, over the UV set that it names.
    pub colour: Option<(Texture, Arc<Image8>)>,
    /// Groom maps over the first UV set; none where there is no such set.
    pub maps: Option<Arc<Maps>>,
    /// Whether it is skin without hair, whose colour may be brighter than white.
    pub bare: bool,
}

/// What is painted on a skin.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Paint {
    /// Of each part of the skin.
    pub parts: Vec<Painted>,
    /// Per vertex: its part. The corners of a triangle are of one part.
    pub part_of: Vec<u32>,
    /// Per vertex: factor on the texture's colour, linear RGB.
    pub factor: Vec<Vec3>,
    /// Per vertex: the longest length that is painted on the triangles around it, where there is hair, which is that of its
    /// offset.
    pub longest: Vec<f32>,
    /// Per vertex: factor on density.
    pub density: Vec<f32>,
}

/// What is painted at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaintedPoint {
    /// Colour of the hair, linear RGB.
    pub tint: Vec3,
    /// Factor on density.
    pub density: f32,
    /// Factor on length.
    pub length: f32,
    /// Factor on clump strength.
    pub clump: f32,
}

/// Most points along a triangle's edge at which painted length is looked at.
const MOST_POINTS: f32 = 512.0;

impl Serialize for Painted {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { colour, maps, bare } = self;
        let colour = colour.as_ref().map(|(texture, image)| (texture, image.as_ref()));
        (colour, maps.as_deref(), bare).serialize(serializer)
    }
}

impl Painted {
    /// Whether anything in it varies within a triangle.
    pub fn varies(&self) -> bool {
        self.colour.is_some() || self.maps.as_ref().is_some_and(|maps| !maps.is_empty())
    }

    /// UV set and size of every picture in it; texture transforms scale sizes.
    pub fn pictures(&self) -> impl Iterator<Item = (usize, [u32; 2])> {
        let colour = self.colour.as_ref().map(|(texture, image)| {
            let scaled = |size: u32, scale: f32| (size as f32 * scale.abs()).round() as u32;
            (texture.uv_set, [scaled(image.width, texture.scale.x), scaled(image.height, texture.scale.y)])
        });
        let maps = self.maps.iter().flat_map(|maps| [&maps.density, &maps.length, &maps.comb, &maps.clump]);
        colour.into_iter().chain(maps.flatten().map(|image| (0, [image.width, image.height])))
    }

    fn map(&self, of: impl Fn(&Maps) -> &Option<Image8>, uv: Vec2) -> Option<Vec4> {
        let maps = self.maps.as_ref()?;
        of(maps).as_ref().map(|image| sample(image, uv))
    }

    fn length(&self, uv: Vec2) -> f32 {
        self.map(|maps| &maps.length, uv).map_or(1.0, |p| p.x) * self.map(|maps| &maps.comb, uv).map_or(1.0, |p| p.w)
    }

    /// What is painted where the mesh's UV sets have the values that `uv` gives and the colour's factor is `factor`.
    fn at(&self, uv: impl Fn(usize) -> Vec2, factor: Vec3) -> PaintedPoint {
        let first = uv(0);
        let colour = self.colour.as_ref().map(|(texture, image)| texture.sample(image, uv(texture.uv_set)).truncate());
        let tint = factor * colour.unwrap_or(Vec3::ONE);
        if self.bare {
            return PaintedPoint { tint, density: 0.0, length: 1.0, clump: 1.0 };
        }
        PaintedPoint {
            tint: tint.clamp(Vec3::ZERO, Vec3::ONE),
            density: self.map(|maps| &maps.density, first).map_or(1.0, |p| p.x),
            length: self.length(first),
            clump: self.map(|maps| &maps.clump, first).map_or(1.0, |p| p.x),
        }
    }

    /// Whether lengths are painted.
    pub fn has_lengths(&self) -> bool {
        self.maps.as_ref().is_some_and(|maps| maps.length.is_some() || maps.comb.is_some())
    }

    /// Whether densities are painted.
    pub fn has_densities(&self) -> bool {
        self.maps.as_ref().is_some_and(|maps| maps.density.is_some())
    }
}

impl Paint {
    /// The part that triangle `t` lies on.
    pub fn of(&self, mesh: &Mesh, t: usize) -> &Painted {
        &self.parts[self.part_of[mesh.triangles[t][0] as usize] as usize]
    }

    /// What is painted at vertex `v`.
    pub fn at_vertex(&self, mesh: &Mesh, v: usize) -> PaintedPoint {
        let uv = |set: usize| mesh.uv_sets.get(set).map_or(Vec2::ZERO, |uv| uv[v]);
        let point = self.parts[self.part_of[v] as usize].at(uv, self.factor[v]);
        PaintedPoint { density: self.density[v] * point.density, ..point }
    }

    /// What is painted at a point of triangle `t`.
    pub fn at(&self, mesh: &Mesh, t: usize, b: Vec3) -> PaintedPoint {
        let corners = mesh.triangles[t].map(|v| v as usize);
        let factor = self.factor[corners[0]] * b.x + self.factor[corners[1]] * b.y + self.factor[corners[2]] * b.z;
        let point = self.of(mesh, t).at(|set| uv_at(mesh, set, corners, b), factor);
        PaintedPoint { density: Vec3::from(corners.map(|v| self.density[v])).dot(b) * point.density, ..point }
    }

    /// The length at a point of triangle `t` over that of the offsets around it, in [0, 1].
    pub fn share_of_longest(&self, mesh: &Mesh, t: usize, b: Vec3, painted: &PaintedPoint) -> f32 {
        let longest = Vec3::from(mesh.triangles[t].map(|v| self.longest[v as usize])).dot(b);
        if longest > 0.0 { (painted.length / longest).min(1.0) } else { 0.0 }
    }

    /// The comb painted at a point of triangle `t`, of any length; zero where there is none.
    pub fn comb(&self, mesh: &Mesh, t: usize, b: Vec3) -> Vec3 {
        let Some(map) = self.of(mesh, t).maps.as_ref().and_then(|maps| maps.comb.as_ref()) else { return Vec3::ZERO };
        let corners = mesh.triangles[t].map(|v| v as usize);
        let Some(uv) = mesh.uv_sets.first() else { return Vec3::ZERO };
        let [right, up] = painted_comb(map, uv_at(mesh, 0, corners, b));
        let [along_u, along_v] = uv_axes(mesh.corners_m(t), corners.map(|v| uv[v]));
        along_u.normalize_or_zero() * right - along_v.normalize_or_zero() * up
    }

    /// About how far the finest texels on a triangle are apart, m.
    pub fn texel_m(&self, mesh: &Mesh, t: usize) -> f32 {
        let corners = mesh.triangles[t].map(|v| v as usize);
        let texels = |set: usize, [width, height]: [u32; 2]| {
            let Some(uv) = mesh.uv_sets.get(set) else { return 0.0 };
            let [p, q, r] = corners.map(|v| uv[v] * Vec2::new(width as f32, height as f32));
            0.5 * (q - p).perp_dot(r - p).abs()
        };
        let most = self.of(mesh, t).pictures().map(|(set, size)| texels(set, size)).fold(0.0, f32::max);
        (mesh.rest_area_m2(t) / most.max(f32::MIN_POSITIVE)).sqrt()
    }

    /// Finds what [`Self::longest`] says. Vertices at one place share it.
    pub fn find_longest(&mut self, mesh: &Mesh) {
        let mut longest = vec![0.0_f32; mesh.positions_m.len()];
        for (t, triangle) in mesh.triangles.iter().enumerate() {
            let painted = self.of(mesh, t);
            let told = painted.has_lengths() || painted.has_densities();
            let found = if told { longest_on(painted, mesh, t) } else { 1.0 };
            for &v in triangle {
                let slot = &mut longest[mesh.position_class[v as usize] as usize];
                *slot = slot.max(found);
            }
        }
        self.longest = mesh.position_class.iter().map(|&class| longest[class as usize]).collect();
    }
}

fn uv_at(mesh: &Mesh, set: usize, corners: [usize; 3], b: Vec3) -> Vec2 {
    let Some(uv) = mesh.uv_sets.get(set) else { return Vec2::ZERO };
    uv[corners[0]] * b.x + uv[corners[1]] * b.y + uv[corners[2]] * b.z
}

/// The longest length that is painted on a triangle where there is hair at all, looked for a texel apart.
fn longest_on(painted: &Painted, mesh: &Mesh, t: usize) -> f32 {
    let corners = mesh.triangles[t].map(|v| v as usize);
    let Some(maps) = &painted.maps else { return 1.0 };
    let size = [&maps.length, &maps.comb, &maps.density]
        .into_iter()
        .flatten()
        .map(|image| Vec2::new(image.width as f32, image.height as f32))
        .fold(Vec2::ONE, Vec2::max);
    let [p, q, r] = [Vec3::X, Vec3::Y, Vec3::Z].map(|b| uv_at(mesh, 0, corners, b) * size);
    let texels = p.distance(q).max(q.distance(r)).max(r.distance(p));
    let points = texels.ceil().clamp(1.0, MOST_POINTS) as usize;
    let mut longest: f32 = 0.0;
    for i in 0..=points {
        for j in 0..=points - i {
            let b = Vec3::new(i as f32, j as f32, (points - i - j) as f32) / points as f32;
            let uv = uv_at(mesh, 0, corners, b);
            if painted.map(|maps| &maps.density, uv).is_none_or(|p| p.x > 0.0) {
                longest = longest.max(painted.length(uv));
            }
        }
    }
    longest
}
