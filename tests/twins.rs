//! The graphics device against the same law on the CPU, pixel by pixel.

use crate::coats;
use furrier::data::coat::Tile;
use furrier::data::shell::{Incidence, Stack};
use furrier::gpu::{Choice, Gpu};
use furrier::math::{Mat2, Mat3, Mat4, Vec2, Vec3, Vec4};
use furrier::runtime::gpu::Renderer;
use furrier::runtime::{Frame, Picture, Show};

const PIXELS: u32 = 128;
const SHELLS: Show = Show { skin: false, shells: true, fins: false };

/// Parallel rays along `direction` through the texels of one tile on the plane z = 0, one pixel each.
fn oblique(direction: Vec3, edge_m: f32) -> Frame {
    let slope = direction / direction.z;
    let scale = 2.0 / edge_m;
    let clip = Mat4::from_cols(
        Vec4::new(scale, 0.0, 0.0, 0.0),
        Vec4::new(0.0, scale, 0.0, 0.0),
        Vec4::new(-slope.x * scale, -slope.y * scale, -1.0, 0.0),
        Vec4::new(0.0, 0.0, 0.5, 1.0),
    );
    Frame {
        clip_from_world: clip,
        eye: Vec4::from((-direction, 0.0)),
        size: [PIXELS; 2],
        lights: vec![],
        ambient: Vec3::ZERO,
    }
}

fn direction(theta_deg: f32, phi_deg: f32) -> Vec3 {
    let ((sin, cos), (sin_phi, cos_phi)) = (theta_deg.to_radians().sin_cos(), phi_deg.to_radians().sin_cos());
    Vec3::new(sin * cos_phi, sin * sin_phi, -cos)
}

fn on_cpu(tile: &Tile, direction: Vec3, lean_rad: f32, texture: Mat2) -> Vec<f32> {
    let stack = Stack::new(tile);
    let offset = Vec3::new(lean_rad.sin(), 0.0, lean_rad.cos());
    let pixel = 1.0 / PIXELS as f32;
    let seen = Incidence::new(direction, Mat3::from_cols(Vec3::X, Vec3::Y, offset), pixel).on_texture(texture);
    let at = |i: u32| {
        let (x, y) = (i % PIXELS, PIXELS - 1 - i / PIXELS);
        texture * (Vec2::new(x as f32 + 0.5, y as f32 + 0.5) * pixel - 0.5)
    };
    (0..PIXELS * PIXELS).map(|i| stack.coverage(at(i), &seen)).collect()
}

fn on_gpu(renderer: &Renderer<'_>, tiles: &[Tile], direction: Vec3, lean_rad: f32, texture: Mat2) -> Picture {
    // Large enough that slanting rays do not pass beside it.
    let mut plane = coats::plane(tiles[0].edge_m * 30.0, 60, lean_rad, &tiles[0]);
    plane.uv.iter_mut().for_each(|uv| *uv = texture * *uv);
    let mut scene = plane.scene(tiles);
    scene.furs[0].axes = vec![Vec3::X; plane.uv.len()];
    renderer.prepare(&scene).unwrap().draw(&oblique(direction, tiles[0].edge_m), SHELLS).unwrap().picture
}

/// Mean and root mean square difference.
pub fn difference(cpu: &[f32], gpu: &Picture) -> (f32, f32) {
    let n = cpu.len() as f32;
    let of = |f: &dyn Fn(f32) -> f32| cpu.iter().zip(&gpu.pixels).map(|(a, b)| f(b[3] - a)).sum::<f32>() / n;
    (of(&|d| d), of(&|d| d * d).sqrt())
}

/// Whether mean and root mean square difference are what different filters explain.
pub fn alike((mean, rms): (f32, f32)) -> bool {
    mean.abs() < 0.01 && rms < 0.03
}

#[test]
fn the_law_is_the_same_on_both() {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let tiles = [coats::tile(&coats::fox()[..1], 0.008, 16, PIXELS, 3)];
    let renderer = Renderer::new(&gpu, &tiles, 1).unwrap();
    for lean_deg in [0.0_f32, 30.0] {
        for (theta, phi) in [(0.0, 0.0), (20.0, 70.0), (40.0, 160.0), (60.0, 250.0), (75.0, 340.0)] {
            let d = direction(theta, phi);
            let cpu = on_cpu(&tiles[0], d, lean_deg.to_radians(), Mat2::IDENTITY);
            let picture = on_gpu(&renderer, &tiles, d, lean_deg.to_radians(), Mat2::IDENTITY);
            let (mean, rms) = difference(&cpu, &picture);
            let coverage = cpu.iter().sum::<f32>() / cpu.len() as f32;
            println!("lean {lean_deg} theta {theta}: coverage {coverage:.3}, mean {mean:+.4}, rms {rms:.4}");
            assert!(alike((mean, rms)), "coverage at {theta}°, lean {lean_deg}°: {mean} in the mean, {rms} by pixel");
        }
    }
}

/// A texture that lies turned and stretched shows as much hair, which leans and shines as it does elsewhere.
#[test]
fn hair_stands_the_same_however_its_texture_lies() {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let tiles = [coats::tile(&coats::fox()[..1], 0.008, 16, PIXELS, 3)];
    let renderer = Renderer::new(&gpu, &tiles, 1).unwrap();
    let lean_rad = 30.0_f32.to_radians();
    let texture = Mat2::from_angle(0.4) * Mat2::from_diagonal(Vec2::new(1.25, 0.85));
    let coverage = |of: &[f32]| of.iter().sum::<f32>() / of.len() as f32;
    for (theta, phi) in [(20.0, 70.0), (40.0, 160.0), (60.0, 250.0)] {
        let d = direction(theta, phi);
        let (plain, cpu) = (on_cpu(&tiles[0], d, lean_rad, Mat2::IDENTITY), on_cpu(&tiles[0], d, lean_rad, texture));
        let picture = on_gpu(&renderer, &tiles, d, lean_rad, texture);
        let found = difference(&cpu, &picture);
        println!("theta {theta}: {:.3} plain, {:.3} turned, {found:?}", coverage(&plain), coverage(&cpu));
        assert!(alike(found), "coverage at {theta}°: {found:?}");
        assert!((coverage(&plain) - coverage(&cpu)).abs() < 0.02, "at {theta}°");
        assert!(!alike(difference(&plain, &picture)), "another texture passes at {theta}°");
    }
}
