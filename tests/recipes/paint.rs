//! Pictures over the creature's texture coordinates, as one would paint them: from where each texel lies on the body.

use furrier::asset;
use furrier::math::hash::{combine, unit_f32};
use furrier::math::{Vec2, Vec3};
use image::{DynamicImage, Rgb, RgbImage};

/// Names of the paintings, and their pixels.
pub fn paintings() -> [(&'static str, DynamicImage); 2] {
    [("length.png", painted(256, length).into()), ("spots.png", painted(512, leopard).into())]
}

/// 0 below `low`, 1 above `high`, smooth in between.
fn smoothstep(low: f32, high: f32, value: f32) -> f32 {
    let t = ((value - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Grey: white is the longest hair. The tail is white, the body at a third, and the face, from the ears forward, black.
fn length(p: Vec3) -> Vec3 {
    let tail = smoothstep(-0.16, -0.24, p.z);
    let face = smoothstep(0.225, 0.27, p.z) * smoothstep(0.24, 0.27, p.y);
    Vec3::splat((0.33 + 0.67 * tail) * (1.0 - face))
}

/// A leopard's coat in sRGB: rosettes on the back, rings on legs and tail, a pale belly.
fn leopard(p: Vec3) -> Vec3 {
    let (ground, belly, dark) = (Vec3::new(0.86, 0.64, 0.34), Vec3::new(0.93, 0.88, 0.79), Vec3::new(0.16, 0.10, 0.06));
    // The belly, not the legs below it.
    let pale = smoothstep(0.17, 0.13, p.y) * smoothstep(0.09, 0.12, p.y) * smoothstep(0.055, 0.03, p.x.abs());
    // Distance to the nearest of points strewn one to a cell, in cells.
    let at = p / 0.042;
    let mut nearest = f32::INFINITY;
    for cell in
        (0..27).map(|i| Vec3::new((i % 3) as f32 - 1.0, (i / 3 % 3) as f32 - 1.0, (i / 9) as f32 - 1.0) + at.floor())
    {
        let key = [cell.x, cell.y, cell.z].iter().fold(7, |key, c| combine(key, *c as i64 as u64));
        let jitter = Vec3::new(unit_f32(combine(key, 1)), unit_f32(combine(key, 2)), unit_f32(combine(key, 3)));
        nearest = nearest.min(at.distance(cell + 0.25 + 0.5 * jitter));
    }
    let ring = smoothstep(0.18, 0.26, nearest) * smoothstep(0.50, 0.42, nearest);
    let inside = smoothstep(0.30, 0.15, nearest);
    let base = ground.lerp(belly, pale).lerp(ground * 0.78, 0.8 * inside);
    base.lerp(dark, ring * (1.0 - 0.4 * pale))
}

/// A picture whose texels are `colour` of the place on the body that they lie on; around charts it goes on with what is next.
fn painted(size: u32, colour: impl Fn(Vec3) -> Vec3) -> RgbImage {
    let creature = asset::load("sample:creature").expect("a sample");
    let mesh = creature.parts.iter().find(|part| part.material_name == "fur").expect("fur").mesh(1.0).expect("a mesh");
    let place = |v: u32| mesh.positions_m[v as usize] + mesh.origin_m.as_vec3();
    let mut texels: Vec<Option<Vec3>> = vec![None; (size * size) as usize];
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| mesh.uv_sets[0][v as usize] * size as f32);
        let [low, high] = [a.min(b).min(c).floor(), a.max(b).max(c).ceil()];
        let area = (b - a).perp_dot(c - a);
        for y in low.y as i32..high.y as i32 {
            for x in low.x as i32..high.x as i32 {
                let point = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
                let share = [(c - b).perp_dot(point - b), (a - c).perp_dot(point - c), (b - a).perp_dot(point - a)]
                    .map(|s| s / area);
                if share.iter().all(|s| *s >= -1e-4) && (0..size as i32).contains(&x) && (0..size as i32).contains(&y) {
                    let on_body: Vec3 = triangle.iter().zip(share).map(|(&v, share)| place(v) * share).sum();
                    texels[(y as u32 * size + x as u32) as usize] = Some(colour(on_body));
                }
            }
        }
    }
    for _ in 0..6 {
        let before = texels.clone();
        for i in (0..texels.len()).filter(|&i| before[i].is_none()) {
            let n = size as usize;
            let around = [i.wrapping_sub(1), i + 1, i.wrapping_sub(n), i + n];
            texels[i] = around.iter().find_map(|&next| before.get(next).copied().flatten());
        }
    }
    RgbImage::from_fn(size, size, |x, y| {
        let colour = texels[(y * size + x) as usize].unwrap_or(Vec3::splat(0.5));
        Rgb(colour.to_array().map(|c| (255.0 * c.clamp(0.0, 1.0)).round() as u8))
    })
}
