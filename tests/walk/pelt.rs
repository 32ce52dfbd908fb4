//! Flat pelts whose radiance is known from a path tracer by others.

use furrier::bake::picture::{Grown, Only, PictureRequest};
use furrier::bake::units::Units;
use furrier::data::camera::Camera;
use furrier::data::light::Directional;
use furrier::data::strands::Strands;
use furrier::math::{DVec3, Vec3};
use furrier::preset::Preset;
use furrier::reference::walk::scatter::Scatter;
use furrier::reference::walk::{Bounces, Fibres, Ready, Settings, draw_with};
use furrier::volume::scene::Lighting;

/// Which way the hair of a pelt stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pelt {
    /// Leaning 36° in the mean.
    T,
    /// Upright.
    U,
    /// Leaning 60°.
    F,
}

/// What the pelt is lit by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// From a zenith angle and an azimuth, degrees, of irradiance 1.
    From(f64, f64),
    /// Radiance 1 from everywhere.
    Sky,
}

/// A direction by zenith angle and azimuth, degrees: azimuth 0 is +z, where hair comes from, 90 is +x.
pub fn direction(zenith: f64, azimuth: f64) -> DVec3 {
    let [z, a] = [zenith, azimuth].map(f64::to_radians);
    DVec3::new(z.sin() * a.sin(), z.cos(), z.sin() * a.cos())
}

/// Grows a square pelt of guard hair alone on black skin.
pub fn grow(pelt: Pelt, edge_m: f32, tint: [f64; 3]) -> Grown {
    let (bend, jitter, lean, comb) = match pelt {
        Pelt::T => (20.0, 8.0, 35.0, "tailward"),
        Pelt::U => (0.0, 10.0, 0.0, "upright"),
        Pelt::F => (20.0, 10.0, 60.0, "tailward"),
    };
    let preset = format!(
        "name = \"pelt\"\ndescription = \"a pelt of known radiance\"\nsize_m = 0.14142136
[guard]\ndensity_per_cm2 = 3000.0\nlength = {{ mm = 20.0 }}\ndiameter_um = 60.0\ntaper = 1.0\ntip_transparency = 0.0
[guard.shape]\nlength_variation = 0.1\nbend_deg = {bend:?}\njitter_deg = {jitter:?}\nnoise = 0.02
clump = {{ spacing_mm = 4.0, strength = 0.0 }}
[undercoat]\ndensity_per_cm2 = 0.0\nlength = {{ mm = 10.0 }}\ndiameter_um = 18.0
[groom]\ncomb = \"{comb}\"\nlean_deg = {lean:?}\ngravity = 0.0
[colour]\nfrom = \"preset\"\ntint = {tint:?}\nguard = [[1.0,1.0,1.0],[1.0,1.0,1.0],[1.0,1.0,1.0]]
undercoat = [[1.0,1.0,1.0],[1.0,1.0,1.0],[1.0,1.0,1.0]]\nvariation = 0.0\nskin = [0.0, 0.0, 0.0]
[shells]\nlayers = 16\ntexture_size = 128\ntile_mm = 20.0
[fins]\ntexture_width = 512\ntexture_height = 64\nthickness_mm = 2.0\n"
    );
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("plane.obj");
    std::fs::write(&file, square(edge_m)).unwrap();
    Grown::new(&PictureRequest {
        input: file.to_str().unwrap().to_owned(),
        reading: Default::default(),
        preset: Preset::from_toml(&preset).unwrap(),
        materials: Vec::new(),
        units: Units::Metres,
        seed: 1,
        only: Only::Guard,
        pose: None,
    })
    .unwrap()
}

/// Hairs as natural cubic splines through their points, each segment cut into `pieces`: what the other path tracer was given.
pub fn smooth(strands: &Strands, pieces: usize) -> Strands {
    let n = strands.points_per_strand;
    let mut smooth = Strands { points_per_strand: (n - 1) * pieces + 1, points_m: Vec::new(), ..strands.clone() };
    for hair in 0..strands.len() {
        let y: Vec<DVec3> = strands.points_of_m(hair).iter().map(|p| p.as_dvec3()).collect();
        // Second derivatives: M₋ + 4 M + M₊ = 6 (y₋ − 2y + y₊), none at the ends.
        let (mut c, mut d) = (vec![0.0; n], vec![DVec3::ZERO; n]);
        for i in 1..n - 1 {
            let pivot = 4.0 - c[i - 1];
            c[i] = 1.0 / pivot;
            d[i] = (6.0 * (y[i - 1] - 2.0 * y[i] + y[i + 1]) - d[i - 1]) / pivot;
        }
        let mut m = vec![DVec3::ZERO; n];
        for i in (1..n - 1).rev() {
            m[i] = d[i] - c[i] * m[i + 1];
        }
        for i in 0..n - 1 {
            for piece in 0..pieces {
                let t = piece as f64 / pieces as f64;
                let (u, cube) = (1.0 - t, |t: f64| (t * t * t - t) / 6.0);
                let point = y[i] * u + y[i + 1] * t + m[i] * cube(u) + m[i + 1] * cube(t);
                smooth.points_m.push(point.as_vec3());
            }
        }
        smooth.points_m.push(y[n - 1].as_vec3());
    }
    smooth
}

/// A level square of 16 × 16 quads.
fn square(edge_m: f32) -> String {
    let mut obj = String::new();
    for j in 0..17 {
        for i in 0..17 {
            let [u, v] = [i, j].map(|n| n as f32 / 16.0);
            obj += &format!("v {} 0 {}\nvt {u} {v}\n", (u - 0.5) * edge_m, (0.5 - v) * edge_m);
        }
    }
    obj += "vn 0 1 0\n";
    let at = |i: usize, j: usize| {
        let n = j * 17 + i + 1;
        format!("{n}/{n}/1")
    };
    for j in 0..16 {
        for i in 0..16 {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            obj += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
        }
    }
    obj
}

/// The radiance of a pelt's middle, 14 mm wide, and its standard error over it.
pub fn radiance(
    ready: &Ready<'_>,
    fibre: &dyn Scatter,
    view: (f64, f64),
    light: Light,
    paths: usize,
    bounces: Bounces,
) -> (DVec3, f64) {
    let target = DVec3::new(0.0, 0.02, 0.0);
    let to_eye = direction(view.0, view.1);
    let up = if view.0 < 1.0 { DVec3::Z } else { DVec3::Y };
    let camera =
        Camera { eye: (target + to_eye * 0.8).to_array(), target: target.to_array(), up: up.to_array(), vfov_deg: 1.0 };
    let dark = Directional { to_light: Vec3::Y, irradiance: Vec3::ZERO };
    let key = match light {
        Light::From(zenith, azimuth) => {
            Directional { to_light: direction(zenith, azimuth).as_vec3(), irradiance: Vec3::ONE }
        }
        Light::Sky => dark,
    };
    let ambient = if light == Light::Sky { Vec3::ONE } else { Vec3::ZERO };
    let lighting = Lighting { key: key.into(), fill: Vec::new(), ambient, fill_on_undercoat: true };
    let settings = Settings { paths, bounces, ..Settings::new([1, 1]) };
    let fibres = Fibres { guard: fibre, undercoat: fibre };
    let walked = draw_with(ready, fibres, &lighting, &camera, &settings).unwrap();
    (walked.film.radiance[0].as_dvec3(), walked.noise.mean)
}
