//! Cuts triangles in rounds, neighbours along the same edges.

use super::{Cut, Finest, Origin, Refined};
use crate::data::fields::Fields;
use crate::data::mesh::Mesh;
use crate::data::paint::{Paint, PaintedPoint};
use crate::math::{Vec2, Vec3};
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};

/// Bare skin, which nothing blurs, is cut to edges shorter by this.
const OF_BARE: f32 = 0.25;
/// How far what is painted may be off what lies between the vertices: as a share of full density, length or brightness.
const CLOSE: f32 = 0.06;
/// Points along an edge at which the two are compared, at most.
const MOST_POINTS: u32 = 12;
/// Edges are not cut to less than this share of a texel: between texels nothing is told apart.
const OF_TEXEL: f32 = 1.0;

/// A skin with what is painted on it.
#[derive(Clone, Copy)]
pub(super) struct Painting<'a> {
    pub mesh: &'a Mesh,
    pub fields: &'a Fields,
    pub paint: &'a Paint,
}

impl Painting<'_> {
    /// What is painted at a point, its length as hair has it.
    fn at(&self, origin: Origin) -> PaintedPoint {
        let t = origin.triangle as usize;
        let point = self.paint.at(self.mesh, t, origin.b);
        let corners = self.mesh.triangles[t].map(|v| v as usize);
        let length = Vec3::from(corners.map(|v| self.fields.length[v])).dot(origin.b);
        let density = if self.paint.of(self.mesh, t).bare { 0.0 } else { point.density };
        PaintedPoint { length: length * self.paint.share_of_longest(self.mesh, t, origin.b, &point), density, ..point }
    }
}

/// The greatest difference of two points.
fn apart(a: &PaintedPoint, b: &PaintedPoint) -> f32 {
    let tint = (a.tint - b.tint).abs().max_element();
    tint.max((a.density - b.density).abs()).max((a.length - b.length).abs()).max((a.clump - b.clump).abs())
}

fn between(points: [&PaintedPoint; 3], b: Vec3) -> PaintedPoint {
    let mix = |of: fn(&PaintedPoint) -> f32| Vec3::from(points.map(of)).dot(b);
    PaintedPoint {
        tint: points[0].tint * b.x + points[1].tint * b.y + points[2].tint * b.z,
        density: mix(|p| p.density),
        length: mix(|p| p.length),
        clump: mix(|p| p.clump),
    }
}

/// A skin that is being cut.
pub(super) struct Cutter<'a> {
    skin: Painting<'a>,
    finest: Finest,
    /// Per triangle of the skin, about how far its texels are apart.
    texel_m: Vec<f32>,
    pub cuts: Vec<Cut>,
    /// Triangles of the last round.
    fresh: Vec<u32>,
    origin: Vec<Origin>,
    /// Of the vertices.
    painted: Vec<PaintedPoint>,
    class: Vec<u32>,
    /// Vertices in the middle of edges, by their ends.
    middles: HashMap<[u32; 2], u32>,
    /// The first vertex in the middle of an edge between two places.
    places: HashMap<[u32; 2], u32>,
    coarse: bool,
    whole: usize,
}

impl<'a> Cutter<'a> {
    /// Not cut yet.
    pub fn new(skin: Painting<'a>, finest: Finest) -> Self {
        let mesh = skin.mesh;
        let mut origin = vec![Origin { triangle: 0, b: Vec3::ZERO }; mesh.positions_m.len()];
        for (t, triangle) in mesh.triangles.iter().enumerate() {
            for (k, &v) in triangle.iter().enumerate() {
                let mut b = Vec3::ZERO;
                b[k] = 1.0;
                origin[v as usize] = Origin { triangle: t as u32, b };
            }
        }
        let cut = |(t, &corners): (usize, &[u32; 3])| Cut {
            corners,
            within: Vec3::AXES,
            parent: t as u32,
            pieces: Vec::new(),
        };
        Self {
            skin,
            finest,
            texel_m: (0..mesh.triangles.len()).map(|t| skin.paint.texel_m(mesh, t)).collect(),
            cuts: mesh.triangles.iter().enumerate().map(cut).collect(),
            fresh: (0..mesh.triangles.len() as u32).collect(),
            painted: origin.par_iter().map(|&origin| skin.at(origin)).collect(),
            origin,
            class: mesh.position_class.clone(),
            middles: HashMap::new(),
            places: HashMap::new(),
            coarse: false,
            whole: mesh.triangles.len(),
        }
    }

    fn rest_m(&self, v: u32) -> Vec3 {
        let Origin { triangle, b } = self.origin[v as usize];
        let [p, q, r] = self.skin.mesh.rest_corners_m(triangle as usize);
        p * b.x + q * b.y + r * b.z
    }

    /// The edges of a triangle, by the places of their ends.
    fn edges(&self, cut: &Cut) -> [[u32; 2]; 3] {
        std::array::from_fn(|k| {
            let [a, b] = [cut.corners[k], cut.corners[(k + 1) % 3]].map(|v| self.class[v as usize]);
            [a.min(b), a.max(b)]
        })
    }

    /// Whether what is painted shows between a triangle's vertices.
    fn shows(&self, cut: &Cut) -> bool {
        let painted = self.skin.paint.of(self.skin.mesh, cut.parent as usize);
        if !painted.varies() {
            return false;
        }
        let places = cut.corners.map(|v| self.rest_m(v));
        let longest_m = (0..3).map(|k| places[k].distance(places[(k + 1) % 3])).fold(0.0, f32::max);
        let edge_m = if painted.bare { OF_BARE * self.finest.edge_m } else { self.finest.edge_m };
        let least_m = edge_m.max(OF_TEXEL * self.texel_m[cut.parent as usize]);
        if longest_m < 2.0 * least_m {
            return false;
        }
        let b = cut.within;
        let values = cut.corners.map(|v| &self.painted[v as usize]);
        let points = ((longest_m / least_m).ceil() as u32).clamp(2, MOST_POINTS);
        (0..=points).any(|i| {
            (0..=points - i).any(|j| {
                let at = Vec3::new(i as f32, j as f32, (points - i - j) as f32) / points as f32;
                let origin = Origin { triangle: cut.parent, b: b[0] * at.x + b[1] * at.y + b[2] * at.z };
                apart(&self.skin.at(origin), &between(values, at)) > CLOSE
            })
        })
    }

    /// Cuts what shows in the triangles of the last round, and what lies across their edges; whether anything was cut.
    pub fn round(&mut self) -> bool {
        let wanted: Vec<u32> = self.fresh.par_iter().copied().filter(|&t| self.shows(&self.cuts[t as usize])).collect();
        if wanted.is_empty() {
            return false;
        }
        if self.whole + 3 * wanted.len() > self.finest.triangles {
            self.coarse = true;
            return false;
        }
        let marked: HashSet<[u32; 2]> = wanted.iter().flat_map(|&t| self.edges(&self.cuts[t as usize])).collect();
        self.fresh.clear();
        for t in 0..self.cuts.len() {
            if !self.cuts[t].pieces.is_empty() {
                continue;
            }
            let cut = self.edges(&self.cuts[t]).map(|edge| marked.contains(&edge));
            if cut.contains(&true) {
                self.cut(t, cut);
            }
        }
        true
    }

    fn cut(&mut self, t: usize, marked: [bool; 3]) {
        let whole = self.cuts[t].clone();
        let corner = |k: usize| (whole.corners[k % 3], whole.within[k % 3]);
        let middle = |k: usize, this: &mut Self| {
            let within = 0.5 * (whole.within[k % 3] + whole.within[(k + 1) % 3]);
            (this.middle(&whole, k % 3), within)
        };
        // Turned so that the case is one of three.
        let count = marked.iter().filter(|m| **m).count();
        let pieces = match count {
            3 => {
                let [p, q, r] = [0, 1, 2].map(|k| middle(k, self));
                vec![[corner(0), p, r], [p, corner(1), q], [r, q, corner(2)], [p, q, r]]
            }
            2 => {
                // The edge that stays whole comes last.
                let k = marked.iter().position(|m| !m).unwrap_or(0) + 1;
                let (p, q) = (middle(k, self), middle(k + 1, self));
                vec![[p, corner(k + 1), q], [corner(k), p, q], [corner(k), q, corner(k + 2)]]
            }
            _ => {
                let k = marked.iter().position(|m| *m).unwrap_or(0);
                let p = middle(k, self);
                vec![[corner(k), p, corner(k + 2)], [p, corner(k + 1), corner(k + 2)]]
            }
        };
        self.whole += pieces.len() - 1;
        for piece in pieces {
            let number = self.cuts.len() as u32;
            self.cuts[t].pieces.push(number);
            self.fresh.push(number);
            let (corners, within) = (piece.map(|(v, _)| v), piece.map(|(_, b)| b));
            self.cuts.push(Cut { corners, within, parent: whole.parent, pieces: Vec::new() });
        }
    }

    /// The vertex in the middle of edge `k` of a triangle.
    fn middle(&mut self, cut: &Cut, k: usize) -> u32 {
        let ends = [cut.corners[k], cut.corners[(k + 1) % 3]];
        let key = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        if let Some(&known) = self.middles.get(&key) {
            return known;
        }
        let b = 0.5 * (cut.within[k] + cut.within[(k + 1) % 3]);
        let number = self.origin.len() as u32;
        let origin = Origin { triangle: cut.parent, b };
        self.origin.push(origin);
        self.painted.push(self.skin.at(origin));
        let places = ends.map(|v| self.class[v as usize]);
        let place = *self.places.entry([places[0].min(places[1]), places[0].max(places[1])]).or_insert(number);
        self.class.push(place);
        self.middles.insert(key, number);
        number
    }

    /// What came of it.
    pub fn finish(self) -> Refined {
        let Painting { mesh, fields, .. } = self.skin;
        let at3 = |list: &[Vec3], origin: &Origin| {
            let [p, q, r] = mesh.triangles[origin.triangle as usize].map(|v| list[v as usize]);
            p * origin.b.x + q * origin.b.y + r * origin.b.z
        };
        let all3 = |list: &[Vec3]| -> Vec<Vec3> { self.origin.iter().map(|origin| at3(list, origin)).collect() };
        let unit =
            |list: &[Vec3]| -> Vec<Vec3> { all3(list).into_iter().map(|v| v.normalize_or(Vec3::ZERO)).collect() };
        let all2 = |list: &Vec<Vec2>| -> Vec<Vec2> {
            let at = |origin: &Origin| {
                let [p, q, r] = mesh.triangles[origin.triangle as usize].map(|v| list[v as usize]);
                p * origin.b.x + q * origin.b.y + r * origin.b.z
            };
            self.origin.iter().map(at).collect()
        };
        let pieces: Vec<&Cut> = self.cuts.iter().filter(|cut| cut.pieces.is_empty()).collect();
        let normals = unit(&mesh.smooth_normals());
        let mesh = Mesh {
            origin_m: mesh.origin_m,
            positions_m: all3(&mesh.positions_m),
            rest_m: mesh.rest_m.as_deref().map(all3),
            normals: normals.clone(),
            hair_normals: Some(normals),
            triangles: pieces.iter().map(|cut| cut.corners).collect(),
            face_seeds: Vec::new(),
            position_class: self.class.clone(),
            uv_sets: mesh.uv_sets.iter().map(all2).collect(),
            ..Mesh::default()
        };
        let fields = Fields {
            length: self.painted.iter().map(|p| p.length).collect(),
            density: self.painted.iter().map(|p| p.density).collect(),
            direction: unit(&fields.direction),
            lean: unit(&fields.lean),
            clump: self.painted.iter().map(|p| p.clump).collect(),
            tint: self.painted.iter().map(|p| p.tint).collect(),
            paint: None,
            partings: Vec::new(),
        };
        Refined {
            mesh,
            fields,
            piece_of: pieces.iter().map(|cut| cut.parent).collect(),
            origin: self.origin,
            coarse: self.coarse,
            cuts: self.cuts,
        }
    }
}
