//! Hard cases of the renderer: each ends finite and sane.

use crate::scenes::{self, Grown, grid, looking};
use furrier::data::camera::Camera;
use furrier::data::film::Film;
use furrier::data::mesh::Mesh;
use furrier::data::strands::{Root, Strands};
use furrier::fur::groom::{Guard, Shape, Undercoat};
use furrier::hybrid::{Settings, draw};
use furrier::math::hash::Stream;
use furrier::math::{DVec3, Vec3};
use furrier::metrics::compare::{LinearImage, compare};
use furrier::volume::scene::Scene;

const SIZE: [usize; 2] = [64, 64];

fn settings() -> Settings {
    Settings { size: SIZE, ..Settings::default() }
}

/// Straight hair, thin enough on the ground to be quick.
fn hair() -> (Guard, Undercoat) {
    let (guard, undercoat) = scenes::mink();
    let straight = Shape { length_variation: 0.1, jitter_deg: 3.0, ..Shape::default() };
    (
        Guard { density_per_cm2: 30.0, shape: straight, ..guard },
        Undercoat { density_per_cm2: 2000.0, shape: straight, ..undercoat },
    )
}

fn grown(mesh: Mesh, lean_deg: f32) -> Grown {
    let (guard, undercoat) = hair();
    Grown::new(mesh, &guard, &undercoat, Vec3::X, lean_deg, 3)
}

fn plane(quads: usize) -> Mesh {
    grid(quads, quads, |u, v| Vec3::new(0.1 * u - 0.05, 0.0, 0.05 - 0.1 * v))
}

fn film_of(scene: &Scene<'_>, camera: &Camera) -> Film {
    draw(scene, &scenes::studio(), camera, &settings()).unwrap().film
}

/// Draws, and checks that every value is one that a film may hold.
fn sane(grown: &Grown, camera: &Camera) -> Film {
    let film = film_of(&grown.scene(), camera);
    if let Some(fault) = fault(&film) {
        panic!("{fault}");
    }
    film
}

/// The first pixel that no film may hold.
pub fn fault(film: &Film) -> Option<String> {
    for i in 0..film.alpha.len() {
        let fine = film.radiance[i].is_finite()
            && (0.0..20.0).contains(&film.radiance[i].max_element())
            && film.radiance[i].min_element() >= 0.0
            && (-1e-5..=1.0001).contains(&film.alpha[i])
            && film.depth_m[i].is_finite()
            && film.albedo[i].max_element() <= 1.001
            && film.guard[i] + film.undercoat[i] <= film.alpha[i] + 1e-3;
        if !fine {
            return Some(format!("pixel {i}: {:?}, alpha {}", film.radiance[i], film.alpha[i]));
        }
    }
    None
}

fn flip(a: &Film, b: &Film) -> f64 {
    compare(&LinearImage::from(a), &LinearImage::from(b)).unwrap().flip
}

#[test]
fn rays_along_hair_and_along_layers() {
    let grown = grown(plane(16), 0.0);
    // Straight down on upright hair, and level with the middle, the top and the foot of the coat.
    sane(&grown, &looking(Vec3::Y * 0.4, Vec3::ZERO, Vec3::Z, 15.0));
    for height in [0.006, 0.012, 0.0138, 0.0] {
        let eye = Vec3::new(0.0, height, 0.3);
        let film = sane(&grown, &looking(eye, Vec3::Y * height, Vec3::Y, 15.0));
        assert!(film.coverage() > 0.02, "at {height} m");
    }
    // Leaning hair, seen along its lean.
    let leaning = self::grown(plane(16), 45.0);
    sane(&leaning, &looking(Vec3::new(0.3, 0.3, 0.0), Vec3::ZERO, Vec3::Y, 15.0));
}

#[test]
fn eyes_in_the_shell_see_hair_cut_at_the_near_plane() {
    let grown = grown(plane(16), 35.0);
    for eye in [Vec3::new(0.0, 0.004, 0.0), Vec3::new(0.0123, 0.0001, 0.0045), Vec3::new(0.05, 0.01, 0.0)] {
        for towards in [Vec3::X, Vec3::NEG_X, Vec3::new(1.0, 2.0, 0.5), Vec3::new(0.3, -1.0, 0.2)] {
            let film = sane(&grown, &looking(eye, eye + towards * 0.1, Vec3::Z, 60.0));
            assert!(film.coverage() > 0.05, "at {eye} towards {towards}");
        }
    }
    // One hair that begins behind the eye and ends far before it, to the right: what lies before the eye is drawn.
    let one = one_hair(&[Vec3::new(0.01, 0.0, 0.5), Vec3::new(0.01, 0.0, -1.0)], 1e-4);
    let film = film_of(&bare_scene(&grown, &one), &looking(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 30.0));
    let row = SIZE[1] / 2 * SIZE[0];
    let right = film.guard[row - SIZE[0] / 2..row + SIZE[0]].iter().sum::<f32>();
    assert!(right > 0.5, "{right}");
}

fn one_hair(points_m: &[Vec3], radius_m: f32) -> Strands {
    let (guard, _) = hair();
    let plain = Guard { taper: 1.0, tip_transparency: 0.0, ..guard };
    let fibre = furrier::fur::groom::fibre::Fibre::guard(&plain, &Default::default(), 1.0);
    Strands {
        points_per_strand: points_m.len(),
        points_m: points_m.to_vec(),
        roots: vec![Root::default()],
        root_radius_m: vec![radius_m],
        tint: vec![Vec3::ONE],
        id: vec![0],
        profile: fibre.profile,
    }
}

/// `count` times the same hair, with ids of their own.
fn same_hairs(hair: &Strands, count: u32) -> Strands {
    let n = count as usize;
    Strands {
        points_per_strand: hair.points_per_strand,
        points_m: hair.points_m.repeat(n),
        roots: hair.roots.repeat(n),
        root_radius_m: hair.root_radius_m.repeat(n),
        tint: (0..count).map(|i| Vec3::splat((i % 7) as f32 / 7.0)).collect(),
        id: (0..count).collect(),
        profile: hair.profile,
    }
}

/// These hairs alone, far from a skin that is out of sight.
fn bare_scene<'a>(grown: &'a Grown, strands: &'a Strands) -> Scene<'a> {
    Scene { guard: Some((strands, &grown.guard_fibre)), undercoat: None, ..grown.scene() }
}

/// A plane that no camera here sees.
fn out_of_sight() -> Grown {
    let mesh = grid(1, 1, |u, v| Vec3::new(u, -50.0, v));
    let none = Guard { density_per_cm2: 0.0, ..hair().0 };
    let (_, undercoat) = hair();
    Grown::new(mesh, &none, &Undercoat { density_per_cm2: 0.0, ..undercoat }, Vec3::X, 0.0, 1)
}

#[test]
fn a_thousand_equal_depths_on_a_pixel() {
    let grown = out_of_sight();
    // 1 m away; a pixel is 1/64 of 2 tan 5° m: a radius of 1/1000 of that is a coverage of 1/500.
    let pixel_m = 2.0 * (5.0_f32.to_radians()).tan() / 64.0;
    let one = one_hair(&[Vec3::new(-0.2, pixel_m * 0.5, 0.0), Vec3::new(0.2, pixel_m * 0.5, 0.0)], 1e-3 * pixel_m);
    let camera = looking(Vec3::Z, Vec3::ZERO, Vec3::Y, 10.0);
    let hairs = same_hairs(&one, 1000);
    let film = film_of(&bare_scene(&grown, &hairs), &camera);
    let expected = 1.0 - (1.0_f64 - 0.002).powi(1000);
    let at = 31 * SIZE[0] + 32;
    assert!((f64::from(film.alpha[at]) - expected).abs() < 2e-3, "{} for {expected}", film.alpha[at]);
    // Whatever order they come in, the lowest id is in front.
    let mut shuffled = hairs.clone();
    let mut random = Stream::new(9);
    for i in (1..1000).rev() {
        let j = random.bits() as usize % (i + 1);
        shuffled.id.swap(i, j);
        shuffled.tint.swap(i, j);
    }
    assert_eq!(film_of(&bare_scene(&grown, &shuffled), &camera), film);
}

#[test]
fn hair_of_a_thousandth_of_a_pixel_covers_its_area() {
    let grown = out_of_sight();
    let pixel_m = 2.0 * (5.0_f32.to_radians()).tan() / 64.0;
    let mut random = Stream::new(4);
    let mut strands = same_hairs(&one_hair(&[Vec3::ZERO, Vec3::ZERO], 0.5e-3 * pixel_m), 400);
    let mut area = 0.0;
    for hair in 0..400 {
        let mut place = || Vec3::new(random.unit() - 0.5, random.unit() - 0.5, 0.0) * (60.0 * pixel_m);
        let (a, b) = (place(), place());
        strands.points_m[2 * hair] = a;
        strands.points_m[2 * hair + 1] = b;
        area += f64::from(a.distance(b) / pixel_m) * 1e-3;
    }
    let film = film_of(&bare_scene(&grown, &strands), &looking(Vec3::Z, Vec3::ZERO, Vec3::Y, 10.0));
    let covered = film.alpha.iter().map(|&a| f64::from(a)).sum::<f64>();
    assert!((covered / area - 1.0).abs() < 0.01, "{covered} px for {area}");
}

#[test]
fn hair_of_no_length_density_or_radius() {
    let (guard, undercoat) = hair();
    let camera = scenes::camera(0.25);
    let zero = furrier::fur::groom::Length::Mm(0.0);
    for (guard, undercoat) in [
        (Guard { length: zero, ..guard }, Undercoat { length: zero, ..undercoat }),
        (Guard { density_per_cm2: 0.0, ..guard }, Undercoat { density_per_cm2: 0.0, ..undercoat }),
        (Guard { diameter_um: 0.0, ..guard }, Undercoat { diameter_um: 0.0, ..undercoat }),
    ] {
        let grown = Grown::new(plane(8), &guard, &undercoat, Vec3::X, 35.0, 3);
        let film = sane(&grown, &camera);
        assert_eq!(film.guard.iter().chain(&film.undercoat).copied().fold(0.0, f32::max), 0.0);
    }
}

#[test]
fn slivers_and_folds_and_odd_borders() {
    let camera = scenes::camera(0.3);
    // Triangles a million times as long as wide, among sound ones.
    let sliver = grid(8, 3, |u, v| {
        let v = [0.0, 0.5, 0.500_000_1, 1.0][(v * 3.0 + 0.5) as usize];
        Vec3::new(0.1 * u - 0.05, 0.0, 0.05 - 0.1 * v)
    });
    assert!(sane(&grown(sliver, 35.0), &camera).coverage() > 0.05);
    // A sharp valley: hair of each wall reaches through the other, and prisms overlap.
    let valley = grid(8, 8, |u, v| Vec3::new(0.1 * u - 0.05, 0.3 * (v - 0.5).abs(), 0.01 * (v - 0.5)));
    assert!(sane(&grown(valley, 0.0), &camera).coverage() > 0.05);
    // Three sheets on one edge, one of them turned inside out.
    let mut sheets = plane(2);
    let first = sheets.positions_m.len() as u32;
    sheets.positions_m.extend([Vec3::new(0.0, 0.05, 0.0), Vec3::new(0.0, -0.05, 0.01)]);
    sheets.normals.extend([Vec3::X, Vec3::X]);
    sheets.position_class.extend([first, first + 1]);
    sheets.triangles.extend([[4, 5, first], [5, 4, first], [4, 5, first + 1]]);
    assert!(sane(&grown(sheets, 20.0), &camera).coverage() > 0.05);
    // One triangle is nothing but border.
    let mut alone = plane(1);
    alone.triangles.truncate(1);
    assert!(sane(&grown(alone, 20.0), &camera).coverage() > 0.02);
}

/// Triangles in another order, each hair's root going along; strands in another order, ids going along.
fn shuffled(grown: &Grown) -> Grown {
    let mut random = Stream::new(77);
    let mut order = |n: usize| {
        let mut order: Vec<usize> = (0..n).collect();
        for i in (1..n).rev() {
            order.swap(i, random.bits() as usize % (i + 1));
        }
        order
    };
    let triangles = order(grown.mesh.triangles.len());
    let mut new_of_old = vec![0; triangles.len()];
    triangles.iter().enumerate().for_each(|(new, &old)| new_of_old[old] = new as u32);
    let hairs = order(grown.guard.len());
    let old = &grown.guard;
    let strands = Strands {
        points_per_strand: old.points_per_strand,
        points_m: hairs.iter().flat_map(|&i| old.points_of_m(i).to_vec()).collect(),
        roots: hairs
            .iter()
            .map(|&i| Root { triangle: new_of_old[old.roots[i].triangle as usize], ..old.roots[i] })
            .collect(),
        root_radius_m: hairs.iter().map(|&i| old.root_radius_m[i]).collect(),
        tint: hairs.iter().map(|&i| old.tint[i]).collect(),
        id: hairs.iter().map(|&i| old.id[i]).collect(),
        profile: old.profile,
    };
    let mut mesh = grown.mesh.clone();
    mesh.triangles = triangles.iter().map(|&old| grown.mesh.triangles[old]).collect();
    Grown {
        mesh,
        fields: grown.fields.clone(),
        guard_fibre: grown.guard_fibre,
        undercoat_fibre: grown.undercoat_fibre,
        guard: strands,
    }
}

#[test]
fn order_bands_and_threads_do_not_show() {
    let grown = grown(scenes::bent_skin(1), 35.0);
    let camera = scenes::camera(0.35);
    let film = sane(&grown, &camera);
    let shuffled = film_of(&shuffled(&grown).scene(), &camera);
    println!("shuffled: FLIP {:.6}, same bytes: {}", flip(&film, &shuffled), film == shuffled);
    assert_eq!(film, shuffled);
    let small = Settings { band_bytes: 1, ..settings() };
    assert_eq!(draw(&grown.scene(), &scenes::studio(), &camera, &small).unwrap().film, film);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(pool.install(|| film_of(&grown.scene(), &camera)), film);
}

#[test]
fn far_from_the_origin_and_very_small_is_the_same_picture() {
    let folder = tempfile::tempdir().unwrap();
    let at_origin = placed(folder.path(), "origin", |_| {}, 1.0, DVec3::ZERO);
    let far = placed(
        folder.path(),
        "far",
        |node| node["translation"] = serde_json::json!([1e6, -1e6, 1e6]),
        1.0,
        DVec3::ZERO,
    );
    let small =
        placed(folder.path(), "small", |node| node["scale"] = serde_json::json!([1e-6, 1e-6, 1e-6]), 1.0, DVec3::ZERO);
    println!(
        "a node 1e6 away: FLIP {:.5}; a millionth as large: FLIP {:.5}",
        flip(&at_origin, &far),
        flip(&at_origin, &small)
    );
    assert!(flip(&at_origin, &far) <= 0.005 && flip(&at_origin, &small) <= 0.005);
    // Baked into f32, an offset rounds the mesh; what is drawn is that rounded mesh.
    let offset = DVec3::splat(1e6);
    let baked = placed(folder.path(), "baked", |_| {}, 1000.0, offset);
    let back = serde_json::json!([-1e6, -1e6, -1e6]);
    let recentred = placed(folder.path(), "recentred", |node| node["translation"] = back.clone(), 1000.0, offset);
    println!("an offset baked into f32: FLIP {:.5}", flip(&recentred, &baked));
    assert!(flip(&recentred, &baked) <= 0.005);
}

/// The torus sample, its positions scaled and shifted in f32 and its node changed, as a file, furred and drawn at the size of
/// a mink.
fn placed(
    folder: &std::path::Path,
    name: &str,
    change: impl Fn(&mut serde_json::Value),
    scale: f64,
    shift: DVec3,
) -> Film {
    use crate::common::{framing, studio};
    use base64::Engine;
    use furrier::bake::picture::{Grown, Only, PictureRequest};
    let mut document = furrier::asset::load("sample:torus").unwrap().document;
    change(&mut document.json["nodes"][0]);
    let accessor = document.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].as_u64().unwrap() as usize;
    let view = document.json["accessors"][accessor]["bufferView"].as_u64().unwrap() as usize;
    let start = document.json["bufferViews"][view]["byteOffset"].as_u64().unwrap_or(0) as usize;
    let count = document.json["accessors"][accessor]["count"].as_u64().unwrap() as usize;
    let mut buffer = document.binary.clone();
    for (i, bytes) in buffer[start..start + 12 * count].chunks_exact_mut(4).enumerate() {
        let value = f64::from(f32::from_le_bytes(bytes.try_into().unwrap())) * scale + shift[i % 3];
        bytes.copy_from_slice(&(value as f32).to_le_bytes());
    }
    for bound in ["min", "max"] {
        document.json["accessors"][accessor].as_object_mut().unwrap().remove(bound);
    }
    let uri = format!("data:application/octet-stream;base64,{}", base64::prelude::BASE64_STANDARD.encode(&buffer));
    document.json["buffers"] = serde_json::json!([{ "byteLength": buffer.len(), "uri": uri }]);
    let path = folder.join(format!("{name}.gltf"));
    std::fs::write(&path, serde_json::to_vec(&document.json).unwrap()).unwrap();
    let thinner = ["guard.density_per_cm2=4".to_owned(), "undercoat.density_per_cm2=100".to_owned()];
    let grown = Grown::new(&PictureRequest {
        input: path.to_str().unwrap().to_owned(),
        reading: Default::default(),
        preset: furrier::preset::Preset::load("mink").unwrap().with_settings(&thinner).unwrap(),
        materials: vec![],
        units: furrier::bake::units::Units::Auto,
        seed: 1,
        only: Only::Hybrid,
        pose: None,
    })
    .unwrap();
    let camera = framing(&grown, 35.0, 20.0, 1.0, SIZE);
    grown.draw(&studio(&camera), &camera, &settings()).unwrap().film
}
