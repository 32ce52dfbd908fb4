//! Pictures of hand-made coats.

use crate::coats;
use furrier::data::camera::Camera;
use furrier::gpu::{Choice, Gpu};
use furrier::math::{DVec3, Vec3, Vec4};
use furrier::runtime::gpu::Renderer;
use furrier::runtime::{Picture, Show, View};
use furrier::shade::light::Directional;

pub fn save(picture: &Picture, name: &str) {
    let Ok(folder) = std::env::var("FURRIER_PICTURES") else { return };
    let bytes: Vec<u8> = picture
        .pixels
        .iter()
        .flat_map(|p| {
            (0..3).map(|c| {
                furrier::data::image::unorm8(furrier::data::image::srgb_from_linear(
                    (p[c] + 0.6 * (1.0 - p[3])).clamp(0.0, 1.0),
                ))
            })
        })
        .collect();
    image::save_buffer(
        format!("{folder}/{name}.png"),
        &bytes,
        picture.size[0],
        picture.size[1],
        image::ColorType::Rgb8,
    )
    .unwrap();
}

fn look(eye: Vec3, target: Vec3, vfov_deg: f64, size: [u32; 2]) -> View {
    let aspect = size[0] as f32 / size[1] as f32;
    let d = eye.distance(target);
    let camera = Camera { eye: eye.as_dvec3().into(), target: target.as_dvec3().into(), up: [0.0, 1.0, 0.0], vfov_deg };
    let clip = camera.clip_from_world(DVec3::ZERO, f64::from(aspect), f64::from(d) * 0.1, f64::from(d) * 3.0).as_mat4();
    View {
        clip_from_world: clip,
        eye: Vec4::from((eye, 1.0)),
        size,
        lights: vec![Directional { to_light: Vec3::new(-0.5, 0.7, 0.6).normalize(), irradiance: Vec3::splat(3.0) }],
        ambient: Vec3::splat(0.5),
    }
}

#[test]
fn first_pictures() {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let tile = coats::tile(&coats::fox(), 0.008, 16, 128, 1);
    let tiles = [tile];
    let renderer = Renderer::new(&gpu, &tiles, 1).unwrap();
    let sphere = coats::sphere(0.06, 24, 0.5, &tiles[0]);
    let plane = coats::plane(0.1, 8, 0.5, &tiles[0]);
    for (name, furred, eye) in
        [("sphere", &sphere, Vec3::new(0.05, 0.05, 0.3)), ("plane", &plane, Vec3::new(0.0, -0.15, 0.1))]
    {
        for (kind, show) in [
            ("all", Show::default()),
            ("shells", Show { fins: false, ..Show::default() }),
            ("fins", Show { shells: false, ..Show::default() }),
        ] {
            let start = std::time::Instant::now();
            let drawn = renderer.draw(&furred.scene(&tiles), &look(eye, Vec3::ZERO, 30.0, [512, 512]), show).unwrap();
            eprintln!(
                "{name} {kind}: {:?}, coverage {}, {:?}",
                start.elapsed(),
                drawn.picture.coverage(),
                drawn.passes
            );
            save(&drawn.picture, &format!("{name}-{kind}"));
        }
    }
}
