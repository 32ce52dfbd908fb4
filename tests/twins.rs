//! The graphics device against the same law on the CPU, pixel by pixel.

use crate::coats;
use furrier::data::coat::{Sampled, Tile};
use furrier::data::shell::guards::FADE_BELOW;
use furrier::data::shell::{Incidence, Stack};
use furrier::gpu::{Choice, Gpu};
use furrier::math::hash::Stream;
use furrier::math::{Mat2, Mat3, Mat4, Vec2, Vec3, Vec4};
use furrier::runtime::gpu::Renderer;
use furrier::runtime::{Frame, Picture, Show};

/// Along the edges of every picture here.
pub const PIXELS: u32 = 128;
const SHELLS: Show = Show { skin: false, shells: true, fins: false };

/// Parallel rays through the plane z = 0, and how hair stands there.
#[derive(Clone, Copy)]
struct Standing {
    /// Of the rays.
    theta_deg: f32,
    phi_deg: f32,
    lean_deg: f32,
    /// Of hair, over the tile's.
    length: f32,
    /// Tiles along the picture's edge.
    tiles: f32,
    texture: Mat2,
    /// Density factor.
    density: f32,
}

impl Standing {
    fn new(theta_deg: f32, phi_deg: f32, lean_deg: f32) -> Self {
        Self { theta_deg, phi_deg, lean_deg, length: 1.0, tiles: 1.0, texture: Mat2::IDENTITY, density: 1.0 }
    }

    fn direction(&self) -> Vec3 {
        let (sin, cos) = self.theta_deg.to_radians().sin_cos();
        let (sin_phi, cos_phi) = self.phi_deg.to_radians().sin_cos();
        Vec3::new(sin * cos_phi, sin * sin_phi, -cos)
    }

    /// Root to the top of the stack, over its height.
    fn up(&self) -> Vec3 {
        let (sin, cos) = self.lean_deg.to_radians().sin_cos();
        Vec3::new(sin, 0.0, cos) * self.length
    }
}

/// Parallel rays along `direction` through `edge_m` of the plane z = 0, one pixel for each of [`PIXELS`] parts of it.
pub fn oblique(direction: Vec3, edge_m: f32) -> Frame {
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
        shadow_map: false,
        depths: false,
        level: Some(0),
    }
}

fn on_cpu(tile: &Tile, standing: &Standing) -> Vec<f32> {
    let stack = Stack::new(tile);
    let pixel = standing.tiles / PIXELS as f32;
    let seen = match tile.sampled {
        Sampled::Square => {
            let map = Mat3::from_cols(Vec3::X, Vec3::Y, standing.up());
            Incidence::new(standing.direction(), map, pixel).on_texture(standing.texture)
        }
        // What one unit of the texture is on the plane.
        Sampled::Skin => {
            let axes = standing.texture.inverse();
            let map = Mat3::from_cols(axes.x_axis.extend(0.0), axes.y_axis.extend(0.0), standing.up());
            Incidence::new(standing.direction(), map, pixel)
        }
    };
    let at = |i: u32| {
        let (x, y) = (i % PIXELS, PIXELS - 1 - i / PIXELS);
        standing.texture * (Vec2::new(x as f32 + 0.5, y as f32 + 0.5) * pixel - 0.5 * standing.tiles)
    };
    let t = (standing.length / FADE_BELOW).min(1.0);
    let present = standing.density * t * t * (3.0 - 2.0 * t);
    let depth = |i: u32| present * stack.optical_depth(at(i), &seen);
    (0..PIXELS * PIXELS).map(|i| -f32::exp_m1(-depth(i))).collect()
}

fn on_gpu(renderer: &Renderer<'_>, tiles: &[Tile], standing: &Standing) -> Picture {
    // Large enough that slanting rays do not pass beside it.
    let mut plane = coats::plane(tiles[0].edge_m * 40.0, 60, 0.0, &tiles[0]);
    plane.uv.iter_mut().for_each(|uv| *uv = standing.texture * *uv);
    plane.offsets_m.iter_mut().for_each(|offset| *offset = standing.up() * tiles[0].height_m);
    plane.tint.iter_mut().for_each(|tint| tint.w = standing.density);
    let mut scene = plane.scene(tiles);
    scene.furs[0].axes = vec![Vec3::X; plane.uv.len()];
    let view = oblique(standing.direction(), standing.tiles * tiles[0].edge_m);
    renderer.prepare(&scene).unwrap().draw(&view, SHELLS).unwrap().picture
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

fn coverage(of: &[f32]) -> f32 {
    of.iter().sum::<f32>() / of.len() as f32
}

/// Holds both to each other at every standing.
fn hold(tile: Tile, standings: &[Standing]) {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let tiles = [tile];
    let renderer = Renderer::new(&gpu, &tiles, 1).unwrap();
    for standing in standings {
        let cpu = on_cpu(&tiles[0], standing);
        let (mean, rms) = difference(&cpu, &on_gpu(&renderer, &tiles, standing));
        let Standing { theta_deg, lean_deg, length, tiles, .. } = standing;
        let said = format!("{theta_deg}°, lean {lean_deg}°, length {length}, {tiles} tiles");
        println!("{said}: coverage {:.3}, mean {mean:+.4}, rms {rms:.4}", coverage(&cpu));
        assert!(alike((mean, rms)), "coverage at {said}: {mean} in the mean, {rms} by pixel");
    }
}

fn tile() -> Tile {
    coats::tile(&coats::fox()[..1], 0.008, 16, PIXELS, 3)
}

const ANGLES: [(f32, f32); 5] = [(0.0, 0.0), (20.0, 70.0), (40.0, 160.0), (60.0, 250.0), (75.0, 340.0)];

#[test]
fn the_law_is_the_same_on_both() {
    let standings = [0.0, 30.0].map(|lean| ANGLES.map(|(theta, phi)| Standing::new(theta, phi, lean)));
    hold(tile(), standings.as_flattened());
}

/// Between mips, each of which has a scale of its own, and with gains that differ from angle to angle and from mip to mip.
#[test]
fn the_law_is_the_same_between_mips() {
    let mut tile = tile();
    let mut stream = Stream::new(5);
    tile.shells.gains.iter_mut().flatten().flatten().for_each(|gain| *gain = 0.6 + 0.8 * stream.unit());
    let scales = &tile.shells.extinction_scales_per_m;
    assert!(scales[0] > 1.5 * scales[2], "scales that differ little tell little: {scales:?}");
    let standings =
        [1.4, 2.83, 5.2].map(|tiles| [20.0, 60.0].map(|theta| Standing { tiles, ..Standing::new(theta, 70.0, 15.0) }));
    hold(tile, standings.as_flattened());
}

/// Near the skin's plane: rays that graze it, hair that lies on it, hair that is hardly there or not at all.
#[test]
fn the_law_is_the_same_at_its_guards() {
    let mut standings: Vec<Standing> = [80.0, 85.0, 88.0]
        .map(|lean| Standing::new(30.0, 40.0, lean))
        .into_iter()
        .chain([Standing::new(86.0, 30.0, 0.0)])
        .collect();
    standings.push(Standing::new(80.0, 190.0, 80.0));
    standings.extend([0.5, 0.006, 0.0].map(|length| Standing {
        length,
        density: 0.7,
        ..Standing::new(40.0, 100.0, 20.0)
    }));
    hold(tile(), &standings);
}

/// Texels sampled on the skin: hair stands as its texture lies, tint does not count, nothing repeats.
#[test]
fn the_law_is_the_same_on_texels_of_the_skin() {
    let texture = Mat2::from_angle(0.4) * Mat2::from_diagonal(Vec2::new(0.5, 0.4));
    let standings = ANGLES.map(|(theta, phi)| Standing { texture, ..Standing::new(theta, phi, 25.0) });
    let sampled = Tile { sampled: Sampled::Skin, ..tile() };
    hold(sampled.clone(), &standings);
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let tiles = [sampled];
    let renderer = Renderer::new(&gpu, &tiles, 1).unwrap();
    let tinted = Standing { density: 0.1, ..standings[2] };
    assert_eq!(on_gpu(&renderer, &tiles, &tinted).pixels, on_gpu(&renderer, &tiles, &standings[2]).pixels);
}

/// A texture that lies turned and stretched shows as much hair, which leans and shines as it does elsewhere.
#[test]
fn hair_stands_the_same_however_its_texture_lies() {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let tiles = [tile()];
    let renderer = Renderer::new(&gpu, &tiles, 1).unwrap();
    let texture = Mat2::from_angle(0.4) * Mat2::from_diagonal(Vec2::new(1.25, 0.85));
    for (theta, phi) in [(20.0, 70.0), (40.0, 160.0), (60.0, 250.0)] {
        let standing = Standing::new(theta, phi, 30.0);
        let turned = Standing { texture, ..standing };
        let (plain, cpu) = (on_cpu(&tiles[0], &standing), on_cpu(&tiles[0], &turned));
        let picture = on_gpu(&renderer, &tiles, &turned);
        let found = difference(&cpu, &picture);
        println!("theta {theta}: {:.3} plain, {:.3} turned, {found:?}", coverage(&plain), coverage(&cpu));
        assert!(alike(found), "coverage at {theta}°: {found:?}");
        assert!((coverage(&plain) - coverage(&cpu)).abs() < 0.02, "at {theta}°");
        assert!(!alike(difference(&plain, &picture)), "another texture passes at {theta}°");
    }
}

/// Faults in a tile or in how it is looked at that pictures must show.
#[derive(Clone, Copy, Debug)]
pub enum Fault {
    /// Every mip in the scale of the finest.
    Scale,
    /// The gain of mips alone.
    Gain,
    /// Hair 80° down is taken for 78°.
    Lean,
    /// Hair that should be gone is there.
    Presence,
}

/// All of them.
pub const PLANTED: [Fault; 4] = [Fault::Scale, Fault::Gain, Fault::Lean, Fault::Presence];

/// What the comparison says of a fault: the sound law against the faulty one, both on the CPU.
pub fn planted(fault: Fault) -> (f32, f32) {
    let (sound, mut faulty) = (tile(), tile());
    let between = Standing { tiles: 2.83, ..Standing::new(20.0, 70.0, 15.0) };
    let (standing, other) = match fault {
        Fault::Scale | Fault::Gain => (between, between),
        Fault::Lean => (Standing::new(80.0, 190.0, 80.0), Standing::new(80.0, 190.0, 78.0)),
        Fault::Presence => {
            let gone = Standing { length: 0.006, ..Standing::new(40.0, 100.0, 20.0) };
            (gone, Standing { length: 0.02, ..gone })
        }
    };
    match fault {
        Fault::Scale => faulty.shells.extinction_scales_per_m.fill(sound.shells.extinction_scales_per_m[0]),
        Fault::Gain => faulty.shells.gains[1..].iter_mut().flatten().flatten().for_each(|gain| *gain *= 1.2),
        Fault::Lean | Fault::Presence => {}
    }
    let pixels = on_cpu(&faulty, &other).iter().map(|&alpha| [0.0, 0.0, 0.0, alpha]).collect();
    difference(&on_cpu(&sound, &standing), &Picture { size: [PIXELS; 2], pixels, depth_m: Vec::new() })
}
