//! Hair under uniform light sends back its albedo and no more; light's path can be reversed; a map's lights carry its power.

use furrier::math::Vec3;
use furrier::math::hash::Stream;
use furrier::shade::kajiya_kay::KajiyaKay;
use furrier::shade::lobes::{Lobe, LobeParameters, Lobes};
use furrier::shade::{Angles, Real};
use furrier::stage::environment::Environment;
use std::f64::consts::PI;

/// ∫ S cos θ_i dω_i over the sphere for an eye at inclination `theta_out`.
pub fn furnace(theta_out: f64, scatter: impl Fn(Angles<f64>) -> f64) -> f64 {
    let (rows, columns) = (720, 360);
    let sin_out = theta_out.sin();
    let mut sum = 0.0;
    for row in 0..rows {
        let theta_in = PI * ((f64::from(row) + 0.5) / f64::from(rows) - 0.5);
        for column in 0..columns {
            let azimuth = 2.0 * PI * (f64::from(column) + 0.5) / f64::from(columns);
            let angles = Angles { sin_in: theta_in.sin(), sin_out, cos_azimuth: azimuth.cos() };
            sum += scatter(angles) * theta_in.cos() * theta_in.cos();
        }
    }
    sum * (PI / f64::from(rows)) * (2.0 * PI / f64::from(columns))
}

fn eyes() -> impl Iterator<Item = f64> {
    (-8..=8).map(|i| f64::from(i) * 11.0_f64.to_radians())
}

fn wide() -> LobeParameters {
    let lobe = |albedo, width_rad| Lobe { albedo, shift_rad: -0.2, width_rad };
    LobeParameters {
        r: lobe(0.3, 0.5),
        tt: lobe(0.2, 0.9),
        trt: lobe(0.3, 0.3),
        tt_azimuth_rad: 1.5,
        diffuse: 0.2,
        ..LobeParameters::default()
    }
}

#[test]
fn diffuse_hair_sends_back_its_albedo_from_every_side() {
    let hair = KajiyaKay::<f64>::new(0.8, 0.0, 20.0);
    for eye in eyes() {
        let sent = furnace(eye, |angles| hair.scatter(angles).0);
        assert!((sent - 0.8).abs() < 1e-3, "{sent} at {eye} rad");
    }
}

#[test]
fn a_highlight_sends_back_its_albedo_at_most() {
    for exponent in [1.0, 4.0, 20.0, 200.0] {
        let hair = KajiyaKay::<f64>::new(0.0, 0.5, exponent);
        let sent: Vec<f64> = eyes().map(|eye| furnace(eye, |angles| hair.scatter(angles).1)).collect();
        let most = sent.iter().copied().fold(0.0, f64::max);
        assert!((most - 0.5).abs() < 2e-3, "exponent {exponent}: {sent:?}");
    }
}

#[test]
fn guard_hair_sends_back_its_albedo_at_most() {
    for parameters in [LobeParameters::default(), wide()] {
        let lobes = Lobes::<f64>::new(&parameters).unwrap();
        let total = parameters.r.albedo + parameters.tt.albedo + parameters.trt.albedo + parameters.diffuse;
        let sent: Vec<f64> = eyes()
            .map(|eye| {
                furnace(eye, |angles| {
                    let s = lobes.scatter(angles);
                    s.plain + s.once + s.twice
                })
            })
            .collect();
        let most = sent.iter().copied().fold(0.0, f64::max);
        assert!(most <= total + 2e-3, "{most} of {total}: {sent:?}");
        assert!(most >= 0.8 * total, "{most} of {total}: {sent:?}");
    }
}

#[test]
fn light_can_go_the_other_way() {
    let mut stream = Stream::new(7);
    let lobes = Lobes::<f64>::new(&wide()).unwrap();
    let kajiya = KajiyaKay::<f64>::new(0.5, 0.5, 30.0);
    for _ in 0..2000 {
        let [a, b, c] = std::array::from_fn(|_| 2.0 * f64::from(stream.unit()) - 1.0);
        let there = Angles { sin_in: a, sin_out: b, cos_azimuth: c };
        let back = Angles { sin_in: b, sin_out: a, cos_azimuth: c };
        assert!((kajiya.scatter(there).1 - kajiya.scatter(back).1).abs() < 1e-12);
        let (x, y) = (lobes.scatter(there), lobes.scatter(back));
        for (x, y) in [(x.plain, y.plain), (x.once, y.once), (x.twice, y.twice)] {
            assert!((x - y).abs() <= 1e-9 * x.max(1.0), "{x} there, {y} back, at {there:?}");
        }
    }
}

#[test]
fn single_precision_agrees_with_double() {
    let mut stream = Stream::new(11);
    let (single, double) = (Lobes::<f32>::new(&wide()).unwrap(), Lobes::<f64>::new(&wide()).unwrap());
    let mut direction = || loop {
        let v = Vec3::new(stream.unit(), stream.unit(), stream.unit()) * 2.0 - 1.0;
        if (0.01..1.0).contains(&v.length_squared()) {
            return v.normalize();
        }
    };
    for _ in 0..2000 {
        let (hair, light, eye) = (direction(), direction(), direction());
        let a = single.scatter(Angles::new(hair.dot(light), hair.dot(eye), light.dot(eye)));
        let b = double.scatter(Angles::of_dvectors(hair.as_dvec3(), light.as_dvec3(), eye.as_dvec3()));
        for (a, b) in [(a.plain, b.plain), (a.once, b.once), (a.twice, b.twice)] {
            assert!((f64::from(a) - b).abs() <= 2e-3 * b + 1e-5, "{a} and {b}");
        }
    }
    assert_eq!(f32::of(0.5).sqrt(), 0.5_f32.sqrt());
}

#[test]
fn too_bright_a_hair_is_refused_by_name() {
    let parameters = LobeParameters { diffuse: 0.9, ..LobeParameters::default() };
    let error = Lobes::<f32>::new(&parameters).unwrap_err();
    assert!(error.field.unwrap().contains("diffuse"));
    let parameters = LobeParameters { glint: f64::NAN, ..LobeParameters::default() };
    assert_eq!(Lobes::<f32>::new(&parameters).unwrap_err().field.as_deref(), Some("glint"));
}

#[test]
fn a_map_and_its_lights_carry_the_same_power() {
    let (width, height) = (64, 32);
    let mut stream = Stream::new(3);
    let radiance: Vec<Vec3> = (0..width * height)
        .map(|i| {
            let sun = if i == 9 * width + 20 { 900.0 } else { 0.0 };
            Vec3::new(stream.unit(), stream.unit(), stream.unit() + sun)
        })
        .collect();
    let map = Environment::new(width, height, radiance).unwrap();
    let whole: f32 = (0..height).map(|row| map.solid_angle_sr(row) * width as f32).sum();
    assert!((whole - 4.0 * std::f32::consts::PI).abs() < 1e-4);
    let lights = map.median_cut(16);
    assert_eq!(lights.len(), 16);
    let sent: Vec3 = lights.iter().map(|light| light.irradiance).sum();
    let arriving: Vec3 = (0..width * height).map(|i| map.radiance[i] * map.solid_angle_sr(i / width)).sum();
    assert!((sent - arriving).abs().max_element() < 1e-3 * arriving.max_element(), "{sent} and {arriving}");
    let sun = map.direction(20.5, 9.5);
    let brightest = lights.iter().max_by(|a, b| a.irradiance.z.total_cmp(&b.irradiance.z)).unwrap();
    assert!(brightest.to_light.dot(sun) > 0.99, "{:?} for a sun at {sun}", brightest.to_light);
}

#[test]
fn a_shared_exponent_picture_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("small.hdr");
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n\x02\x02\x00\x08".to_vec();
    for value in [128_u8, 64, 0] {
        bytes.extend([128 + 8, value]);
    }
    bytes.extend([8, 129, 129, 129, 129, 130, 130, 130, 0]);
    std::fs::write(&path, &bytes).unwrap();
    let map = Environment::read(&path).unwrap();
    assert_eq!(map.radiance[0], Vec3::new(1.0, 0.5, 0.0));
    assert_eq!(map.radiance[4], Vec3::new(2.0, 1.0, 0.0));
    assert_eq!(map.radiance[7], Vec3::ZERO);
    for end in 0..bytes.len() {
        std::fs::write(&path, &bytes[..end]).unwrap();
        assert!(Environment::read(&path).is_err(), "{end} bytes of {}", bytes.len());
    }
    std::fs::write(&path, b"#?RADIANCE\n\n-Y 4000000000 +X 4000000000\n").unwrap();
    assert_eq!(Environment::read(&path).unwrap_err().field.as_deref(), Some("size"));
}
