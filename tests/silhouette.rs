//! The fringe of a furred sphere against the same strands, ray cast from the same camera.

use crate::coats;
use furrier::coat::fins::FinParameters;
use furrier::coat::shells::ShellParameters;
use furrier::coat::tile::{TileHair, TileRecipe, bake};
use furrier::data::fields::Fields;
use furrier::data::mesh::Mesh;
use furrier::fur::groom::fibre::Fibre;
use furrier::fur::groom::{Colour, Guard, Undercoat};
use furrier::fur::grow;
use furrier::gpu::{Choice, Gpu};
use furrier::math::{Vec3, Vec4};
use furrier::render::cast::Caster;
use furrier::render::rays::{Camera, Rays};
use furrier::render::{DepthRange, Scene};
use furrier::runtime::gpu::Renderer;
use furrier::runtime::{Show, View};

const RADIUS_M: f32 = 0.04;
const PIXELS: usize = 192;
const EYE: Vec3 = Vec3::new(0.06, 0.1, 0.35);

/// Mean alpha over rings from the skin's outline to one hair length (`height_m`) beyond it, inner to outer, and over all.
fn rings(alpha: &[f32], height_m: f32) -> [f32; 5] {
    let mut sums = [(0.0, 0.0); 5];
    let camera = camera();
    let forward = (camera.target_m - camera.eye_m).normalize();
    let rays = Rays::Perspective { camera, size: [PIXELS; 2], supersampling: 1 };
    for (i, a) in alpha.iter().enumerate() {
        let ray = rays.ray(i % PIXELS, i / PIXELS, 0);
        let _ = forward;
        let closest = EYE - ray.direction * EYE.dot(ray.direction);
        let at = (closest.length() - RADIUS_M) / height_m;
        if (0.0..1.0).contains(&at) {
            for slot in [(at * 4.0) as usize, 4] {
                sums[slot].0 += a;
                sums[slot].1 += 1.0;
            }
        }
    }
    sums.map(|(sum, count)| sum / count)
}

fn camera() -> Camera {
    Camera { eye_m: EYE, target_m: Vec3::ZERO, up: Vec3::Y, vfov_rad: 18.0_f32.to_radians() }
}

fn view() -> View {
    let camera = furrier::data::camera::Camera {
        eye: EYE.as_dvec3().into(),
        target: [0.0; 3],
        up: [0.0, 1.0, 0.0],
        vfov_deg: 18.0,
    };
    View {
        clip_from_world: camera.clip_from_world(furrier::math::DVec3::ZERO, 1.0, 0.05, 1.0).as_mat4(),
        eye: Vec4::from((EYE, 1.0)),
        size: [PIXELS as u32; 2],
        lights: vec![],
        ambient: Vec3::ONE,
    }
}

#[test]
fn the_fringe_covers_what_strands_cover() {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    for (guard_on, undercoat_on, lean_rad) in [(true, false, 0.0_f32), (true, false, 0.6), (false, true, 0.3)] {
        let colour = Colour::default();
        let mut guard = Fibre::guard(&Guard::default(), &colour, 1.0);
        let mut undercoat = Fibre::undercoat(&Undercoat::default(), &colour, 1.0);
        guard.density_per_m2 *= if guard_on { 0.5 } else { 0.0 };
        undercoat.density_per_m2 *= if undercoat_on { 0.1 } else { 0.0 };
        let hair = TileHair::grow(&guard, &undercoat, 8e-3, 7);
        let recipe = TileRecipe {
            preset: "test".into(),
            shells: ShellParameters { tile_mm: 8.0, ..ShellParameters::default() },
            fins: FinParameters::default(),
            skin: Vec3::splat(0.5),
            lean_deg: 0.0,
        };
        let tiles = [bake(&hair, &recipe)];
        let height_m = tiles[0].height_m;
        let furred = coats::sphere(RADIUS_M, 20, lean_rad, &tiles[0]);
        let count = furred.positions_m.len();
        let mesh = Mesh {
            positions_m: furred.positions_m.clone(),
            normals: furred.normals.clone(),
            triangles: furred.triangles.clone(),
            position_class: furrier::data::mesh::position_classes(&furred.positions_m, 1e-6),
            ..Default::default()
        };
        let fields = Fields {
            length: vec![1.0; count],
            density: vec![1.0; count],
            direction: vec![Vec3::ZERO; count],
            lean: furred.offsets_m.iter().map(|o| o.normalize()).collect(),
            clump: vec![1.0; count],
            tint: vec![Vec3::ONE; count],
        };
        let (guards, undercoats) =
            (grow::skin::grow(&guard, &mesh, &fields, 3), grow::skin::grow(&undercoat, &mesh, &fields, 4));
        let scene = Scene { guard: Some(&guards), undercoat: Some(&undercoats), skin: Some(&mesh), torus_m: None };
        let rays = Rays::Perspective { camera: camera(), size: [PIXELS; 2], supersampling: 3 };
        let truth = Caster::new(scene).render(&rays, DepthRange::ALL);
        println!("guard {} undercoat {} height {height_m} lean {lean_rad}", guards.len(), undercoats.len());
        println!("strands       {:.3?}", rings(&truth.alpha, height_m));
        let renderer = Renderer::new(&gpu, &tiles, 3).unwrap();
        for (name, show) in [
            ("all    ", Show::default()),
            ("shells ", Show { fins: false, ..Show::default() }),
            ("fins   ", Show { shells: false, ..Show::default() }),
        ] {
            let drawn = renderer.draw(&furred.scene(&tiles), &view(), show).unwrap();
            let alpha: Vec<f32> = drawn.picture.pixels.iter().map(|p| p[3]).collect();
            println!("{name}       {:.3?}", rings(&alpha, height_m));
            crate::runtime::save(&drawn.picture, &format!("ring-{guard_on}-{lean_rad}-{}", name.trim()));
        }
    }
}
