//! A map's lights carry its power.

use furrier::math::Vec3;
use furrier::math::hash::Stream;
use furrier::stage::environment::Environment;

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
