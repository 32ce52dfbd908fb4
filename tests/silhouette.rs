//! The fringe of a furred sphere against the same strands, ray cast from the same camera.

use crate::{coats, scenes};
use furrier::cast::Caster;
use furrier::cast::Geometry;
use furrier::cast::Rays;
use furrier::coat::fins::FinParameters;
use furrier::coat::hair::TileHair;
use furrier::coat::shells::ShellParameters;
use furrier::coat::tile::{TileRecipe, bake};
use furrier::data::camera::Camera;
use furrier::data::fields::Fields;
use furrier::data::mesh::Mesh;
use furrier::data::ray::DepthRange;
use furrier::fur::groom::fibre::Fibre;
use furrier::fur::groom::{Colour, Guard, Undercoat};
use furrier::fur::grow;
use furrier::gpu::{Choice, Gpu};
use furrier::math::{Vec3, Vec4};
use furrier::runtime::gpu::Renderer;
use furrier::runtime::{Frame, Show};

const RADIUS_M: f32 = 0.04;
const PIXELS: usize = 128;
const EYE: Vec3 = Vec3::new(0.06, 0.1, 0.35);

/// Mean alpha over rings from the skin's outline to one hair length (`height_m`) beyond it, inner to outer, and over all.
fn rings(alpha: &[f32], height_m: f32) -> [f32; 5] {
    let mut sums = [(0.0, 0.0); 5];
    let rays = Rays::Perspective { view: scenes::view(&camera(), [PIXELS; 2]), supersampling: 1 };
    for (i, a) in alpha.iter().enumerate() {
        let ray = rays.ray(i % PIXELS, i / PIXELS, 0);
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
    scenes::looking(EYE, Vec3::ZERO, Vec3::Y, 18.0)
}

fn view() -> Frame {
    Frame {
        clip_from_world: camera().clip_from_world(furrier::math::DVec3::ZERO, 1.0, 0.05, 1.0).as_mat4(),
        eye: Vec4::from((EYE, 1.0)),
        size: [PIXELS as u32; 2],
        lights: vec![],
        ambient: Vec3::ONE,
    }
}

/// Coverage of the rings by strands, and by the runtime showing `show`, for each.
fn measured(gpu: &Gpu, fibres: [&Fibre; 2], lean_rad: f32, shows: &[Show]) -> ([f32; 5], Vec<[f32; 5]>) {
    let hair = TileHair::grow(fibres[0], fibres[1], 8e-3, 7);
    let recipe = TileRecipe {
        preset: "test".into(),
        shells: ShellParameters { tile_mm: 8.0, ..ShellParameters::default() },
        fins: FinParameters::default(),
        skin: Vec3::splat(0.5),
        lean_deg: lean_rad.to_degrees(),
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
    let [guard, undercoat] = [0, 1].map(|i| grow::skin::grow(fibres[i], &mesh, &fields, 3 + i as u64));
    let scene = Geometry { guard: Some(&guard), undercoat: Some(&undercoat), skin: Some(&mesh), ..Default::default() };
    let rays = Rays::Perspective { view: scenes::view(&camera(), [PIXELS; 2]), supersampling: 3 };
    let strands = rings(&Caster::new(scene).render(&rays, DepthRange::ALL).alpha, height_m);
    let renderer = Renderer::new(gpu, &tiles, 2).unwrap();
    let ours = shows.iter().map(|&show| {
        let drawn = renderer.prepare(&furred.scene(&tiles)).unwrap().draw(&view(), show).unwrap();
        rings(&drawn.picture.pixels.iter().map(|p| p[3]).collect::<Vec<_>>(), height_m)
    });
    (strands, ours.collect())
}

#[test]
fn the_fringe_covers_what_strands_cover() {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let colour = Colour::default();
    let thinned = |mut fibre: Fibre, factor: f32| {
        fibre.density_per_m2 *= factor;
        fibre
    };
    let guard = |factor| thinned(Fibre::guard(&Guard::default(), &colour, 1.0), factor);
    let undercoat = |factor| thinned(Fibre::undercoat(&Undercoat::default(), &colour, 1.0), factor);
    let shows = [Show::default(), Show { fins: false, ..Show::default() }];
    for (name, fibres, lean_rad) in [
        ("upright guard hair", [&guard(0.5), &undercoat(0.0)], 0.0),
        ("leaning guard hair", [&guard(0.5), &undercoat(0.0)], 0.6),
        ("leaning undercoat", [&guard(0.0), &undercoat(0.1)], 0.3),
    ] {
        let (strands, ours) = measured(&gpu, fibres, lean_rad, &shows);
        println!("{name}: strands {strands:.3?}, shells and fins {:.3?}, shells alone {:.3?}", ours[0], ours[1]);
        for ours in &ours {
            assert!((ours[4] - strands[4]).abs() < 0.05, "{name}: {} for {}", ours[4], strands[4]);
            for ring in 0..4 {
                let (a, b) = (ours[ring], strands[ring]);
                assert!((a - b).abs() < 0.08, "{name}, ring {ring} of 4: {a} for {b}");
            }
        }
    }
}
