//! What undercoat costs: the march by the neighbour table against rays that ask a hierarchy of all sub-elements
//! (Andersen et al. 2016 §5), by subdivisions d; and how a picture's time grows with hairs and pixels.
//! `cargo bench --bench march`.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a bench that cannot go on stops, and prints what it found"
)]

#[path = "../tests/scenes.rs"]
#[allow(dead_code, reason = "tests use the rest")]
mod scenes;

use furrier::cast::bvh::Bvh;
use furrier::fur::undercoat::Undercoat;
use furrier::hybrid::{Settings, draw};
use furrier::math::Vec3;
use furrier::volume::march::content::{Content, Resolution};
use furrier::volume::march::volume::Volume;
use furrier::volume::march::{MarchRay, Start, Stepping};
use furrier::volume::shell::prism::{Prism, ShellPoint};
use furrier::volume::shell::subelement;
use scenes::Grown;

fn main() {
    let (march, bvh) = (Rays::new(3), Hierarchy::new(3));
    let (ours, theirs) = (march.depths(), bvh.depths(&march));
    let mean = |depths: &[f32]| depths.iter().sum::<f32>() / depths.len() as f32;
    println!("mean optical depth of {} rays: {:.4} marched, {:.4} by prisms", ours.len(), mean(&ours), mean(&theirs));
    divan::main();
}

const LAYERS: u32 = 16;
const RAYS: usize = 2048;

/// A bent scene of 24 triangles: at d = 6 it has 1,572,864 sub-elements.
fn scene() -> &'static Grown {
    static SCENE: std::sync::OnceLock<Grown> = std::sync::OnceLock::new();
    SCENE.get_or_init(|| {
        let mesh = scenes::grid(4, 3, |u, v| {
            let angle = std::f32::consts::PI * (0.25 + 0.5 * v);
            Vec3::new((u - 0.5) * 0.15, 0.04 * angle.sin(), 0.04 * angle.cos())
        });
        let (guard, mut undercoat) = scenes::mink();
        undercoat.density_per_cm2 = 2000.0;
        Grown::new(mesh, &guard, &undercoat, Vec3::X, 35.0, 3)
    })
}

fn volume(d: u8) -> Volume<'static> {
    static NORMALS: std::sync::OnceLock<Vec<Vec3>> = std::sync::OnceLock::new();
    let grown = scene();
    let normals = NORMALS.get_or_init(|| grown.mesh.smooth_normals());
    static CONTENT: std::sync::OnceLock<Content<'static>> = std::sync::OnceLock::new();
    let content = CONTENT.get_or_init(|| {
        let resolution = Resolution { layers: LAYERS, pattern: None, ..Resolution::default() };
        Content::new(&grown.scene(), normals, resolution).expect("a scene has undercoat")
    });
    Volume::new(content, vec![d; grown.mesh.triangles.len()])
}

/// Rays that enter the shell through its top.
struct Rays {
    volume: Volume<'static>,
    rays: Vec<(Vec3, Vec3, Start)>,
}

impl Rays {
    fn new(d: u8) -> Self {
        let volume = volume(d);
        let triangles = volume.shell().skin.triangles.len();
        let rays = (0..RAYS)
            .map(|i| {
                let at = |k: f32| (i as f32 * k).fract();
                let triangle = (i % triangles) as u32;
                let (u, v) = (at(0.754_877_7), at(0.569_840_3));
                let b = if u + v > 1.0 { [1.0 - u, 1.0 - v] } else { [u, v] };
                let point = ShellPoint { b, t: 1.0 };
                let j = volume.shell().prism(triangle).jacobian(&point);
                let up = j.up_m.normalize();
                let aside = up.cross(Vec3::new(at(0.31) - 0.5, at(0.47) - 0.5, at(0.83) - 0.5)).normalize();
                let direction = (aside * (3.0 * at(0.618_034)) - up).normalize();
                (j.at_m, direction, Start { at_m: 0.0, triangle, point })
            })
            .collect();
        Self { volume, rays }
    }

    /// Parallel rays through the tops of two prisms, in rows.
    fn of_pixels(d: u8) -> Self {
        let volume = volume(d);
        let mut rays = Vec::new();
        for i in 0..RAYS as u32 {
            let (x, y) = ((i % 32) as f32, (i / 32 % 32) as f32);
            let point = ShellPoint { b: [0.15 + x / 96.0, 0.15 + y / 96.0], t: 1.0 };
            let triangle = 10 + i / 1024;
            let direction = Vec3::new(0.6, -0.5, -0.6).normalize();
            let start = Start { at_m: 0.0, triangle, point };
            rays.push((volume.shell().prism(triangle).jacobian(&point).at_m, direction, start));
        }
        Self { volume, rays }
    }

    fn depths(&self) -> Vec<f32> {
        let march_ray = |&(origin_m, direction, start): &(Vec3, Vec3, Start)| MarchRay {
            origin_m,
            direction,
            start,
            far_m: f32::INFINITY,
        };
        let rays: Vec<MarchRay> = self.rays.iter().map(march_ray).collect();
        self.volume.depths_along(&rays, &Stepping::default(), 0.0, f32::INFINITY).0
    }
}

/// A sub-element as a prism of its own.
struct Cell {
    /// Corners of the lower and of the upper triangle, m.
    corners: [[Vec3; 3]; 2],
    hair: Vec3,
    /// Extinction across the hair, 1/m.
    across_per_m: f32,
}

/// Every sub-element in a hierarchy of boxes: the conventional way.
struct Hierarchy {
    undercoat: Undercoat,
    cells: Vec<Cell>,
    bvh: Bvh,
}

impl Hierarchy {
    fn new(d: u8) -> Self {
        let volume = volume(d);
        let shell = volume.shell();
        let mut cells = Vec::new();
        for t in 0..shell.skin.triangles.len() as u32 {
            let prism = shell.prism(t);
            for layer in 0..LAYERS {
                let heights = [layer, layer + 1].map(|l| l as f32 / LAYERS as f32);
                for i in 0..1_u32 << (2 * d) {
                    cells.push(cell(&volume, &prism, t, i, u32::from(d), heights));
                }
            }
        }
        let bounds = |cell: &Cell| {
            let all = cell.corners.iter().flatten();
            all.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)))
        };
        let mut bvh = Bvh::new(&cells.iter().map(bounds).collect::<Vec<_>>());
        let order = bvh.take_order();
        let mut sorted: Vec<Option<Cell>> = cells.into_iter().map(Some).collect();
        let cells = order.into_iter().filter_map(|i| sorted[i as usize].take()).collect();
        Self { undercoat: shell.undercoat, cells, bvh }
    }

    fn depths(&self, rays: &Rays) -> Vec<f32> {
        let depth = |&(origin, direction, _): &(Vec3, Vec3, Start)| {
            let mut sum = 0.0;
            self.bvh.traverse(origin, direction, 0.0, f32::INFINITY, |item, far| {
                let cell = &self.cells[item as usize];
                if let Some(length) = run_through(cell, origin, direction) {
                    let sine = self.undercoat.mean_sine(cell.hair.cross(direction).length());
                    sum += length * cell.across_per_m * sine;
                }
                far
            });
            sum
        };
        rays.rays.iter().map(depth).collect()
    }
}

fn cell(volume: &Volume<'_>, prism: &Prism, t: u32, i: u32, d: u32, heights: [f32; 2]) -> Cell {
    let shell = volume.shell();
    let centre = subelement::centre(i, d);
    // The corners lie a third of a sub-element's edge from the centre in every coordinate, up or down.
    let n = (1_u32 << d) as f32;
    let fraction = ((1.0 - centre.x) * n).fract();
    let third = if fraction < 0.5 { 1.0 } else { -1.0 } / (3.0 * n);
    let corner = |k: usize, t: f32| {
        let mut b = centre - Vec3::splat(third);
        b[k] += 3.0 * third;
        prism.jacobian(&ShellPoint { b: [b.y, b.z], t }).at_m
    };
    let point = ShellPoint { b: [centre.y, centre.z], t: 0.5 * (heights[0] + heights[1]) };
    let j = prism.jacobian(&point);
    let undercoat = &shell.undercoat;
    let per_volume = undercoat.density_per_m2 * shell.skin.area_vector_m2(t as usize).length() / j.determinant.abs();
    let up_m = j.up_m.length();
    let length = per_volume * up_m * undercoat.stretch * undercoat.reaching(point.t);
    Cell {
        corners: heights.map(|t| [0, 1, 2].map(|k| corner(k, t))),
        hair: j.up_m / up_m,
        across_per_m: length * undercoat.diameter_m,
    }
}

/// Length of a ray inside a prism: by its eight triangles.
fn run_through(cell: &Cell, origin: Vec3, direction: Vec3) -> Option<f32> {
    let [low, high] = &cell.corners;
    let (mut near, mut far) = (f32::INFINITY, f32::NEG_INFINITY);
    let mut offer = |a: Vec3, b: Vec3, c: Vec3| {
        if let Some(at) = meet(origin, direction, a, b, c) {
            (near, far) = (near.min(at), far.max(at));
        }
    };
    offer(low[0], low[1], low[2]);
    offer(high[0], high[1], high[2]);
    for i in 0..3 {
        let k = (i + 1) % 3;
        offer(low[i], low[k], high[k]);
        offer(low[i], high[k], high[i]);
    }
    let length = far - near.max(0.0);
    (length > 0.0).then_some(length)
}

/// Möller and Trumbore 1997.
fn meet(origin: Vec3, direction: Vec3, a: Vec3, b: Vec3, c: Vec3) -> Option<f32> {
    let (e1, e2) = (b - a, c - a);
    let p = direction.cross(e2);
    let inverse = e1.dot(p).recip();
    let s = origin - a;
    let u = s.dot(p) * inverse;
    let q = s.cross(e1);
    let v = direction.dot(q) * inverse;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| e2.dot(q) * inverse)
}

#[divan::bench(args = [0, 1, 2, 3, 4, 5, 6], sample_count = 10, sample_size = 1)]
fn march_by_neighbours(bencher: divan::Bencher, d: u8) {
    let rays = Rays::new(d);
    // Sub-elements are filled before the clock starts, as the hierarchy is built.
    rays.depths();
    bencher.bench_local(|| rays.depths());
}

/// Rays as a picture's pixels send them: side by side, two thirds of a sub-element of d = 6 apart.
#[divan::bench(args = [0, 1, 2, 3, 4, 5, 6], sample_count = 20, sample_size = 1)]
fn march_of_pixels(bencher: divan::Bencher, d: u8) {
    let rays = Rays::of_pixels(d);
    rays.depths();
    bencher.bench_local(|| rays.depths());
}

#[divan::bench(args = [0, 1, 2, 3, 4, 5, 6], sample_count = 5, sample_size = 1)]
fn rays_through_a_hierarchy(bencher: divan::Bencher, d: u8) {
    let (rays, hierarchy) = (Rays::new(0), Hierarchy::new(d));
    bencher.bench_local(|| hierarchy.depths(&rays));
}

fn picture(bencher: divan::Bencher, guard_per_cm2: f32, size: usize) {
    let (mut guard, undercoat) = scenes::mink();
    guard.density_per_cm2 = guard_per_cm2;
    let grown = Grown::new(scenes::bent_skin(1), &guard, &undercoat, Vec3::X, 35.0, 3);
    let settings = Settings { size: [size; 2], ..Settings::default() };
    let camera = scenes::camera(0.35);
    bencher.bench_local(|| draw(&grown.scene(), &scenes::studio(), &camera, &settings));
}

/// Each twice the pixels of the one before: 181², 256², 362², 512², 724².
#[divan::bench(args = [181, 256, 362, 512, 724], sample_count = 3, sample_size = 1)]
fn pixels(bencher: divan::Bencher, edge: usize) {
    picture(bencher, 650.0, edge);
}

/// Each twice the guard hairs of the one before, at 256².
#[divan::bench(args = [163.0, 325.0, 650.0, 1300.0, 2600.0], sample_count = 3, sample_size = 1)]
fn strands(bencher: divan::Bencher, per_cm2: f32) {
    picture(bencher, per_cm2, 256);
}
