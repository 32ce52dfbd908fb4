//! Undercoat as a volume against the same hairs one by one: random cylinders, met by parallel rays.

use crate::scenes;
use furrier::data::fields::Fields;
use furrier::data::mesh::Mesh;
use furrier::data::ray::DepthRange;
use furrier::data::ray::Ray;
use furrier::data::strands::Profile;
use furrier::fur::groom::Shape;
use furrier::fur::groom::fibre::Fibre;
use furrier::math::hash::Stream;
use furrier::math::lanes::{F32s, Scalar, Vec3s};
use furrier::math::{DVec2, DVec3, Mat3, Vec3};
use furrier::volume::march::content::{Content, Resolution};
use furrier::volume::march::volume::Volume;
use furrier::volume::march::{MarchRay, Start, Stepping};
use furrier::volume::medium::Medium;
use furrier::volume::scene::{HairScattering, Scene};
use furrier::volume::shell::prism::ShellPoint;
use furrier::volume::shell::subelement;

/// Upright or leaning cylinders of one length, whose ends are flat.
pub struct Cylinders {
    pub per_m2: f64,
    pub diameter_m: f64,
    pub length_m: f64,
    pub lean: DVec3,
}

/// Rays per edge of the torus, two per diameter.
const CELLS: i64 = 2048;

impl Cylinders {
    fn edge_m(&self) -> f64 {
        CELLS as f64 * 0.5 * self.diameter_m
    }
}

/// Share of parallel rays along `direction` that pass all cylinders with random roots on a torus, one ray per cell.
fn transmittance_of_rays(hairs: &Cylinders, direction: DVec3, seed: u64) -> f64 {
    let (edge_m, cell_m) = (hairs.edge_m(), 0.5 * hairs.diameter_m);
    let count = (hairs.per_m2 * edge_m * edge_m).round() as u64;
    let mut random = Stream::new(seed);
    let mut blocked = vec![false; (CELLS * CELLS) as usize];
    let slope = DVec2::new(direction.x, direction.y) / direction.z;
    let tip = hairs.lean * hairs.length_m;
    // Where rays that meet the tip pass the plane z = 0.
    let shift = DVec2::new(tip.x, tip.y) - slope * tip.z;
    let pad = hairs.diameter_m * (2.0 + slope.length());
    for _ in 0..count {
        let root = DVec2::new(f64::from(random.unit()), f64::from(random.unit())) * edge_m;
        let low = (root.min(root + shift) - pad) / cell_m;
        let high = (root.max(root + shift) + pad) / cell_m;
        for y in low.y.floor() as i64..=high.y.ceil() as i64 {
            for x in low.x.floor() as i64..=high.x.ceil() as i64 {
                let at = (y.rem_euclid(CELLS) * CELLS + x.rem_euclid(CELLS)) as usize;
                if !blocked[at] {
                    let pass = DVec2::new(x as f64, y as f64) * cell_m - root;
                    blocked[at] = meets(hairs, DVec3::new(pass.x, pass.y, 0.0), direction);
                }
            }
        }
    }
    blocked.iter().filter(|&&b| !b).count() as f64 / blocked.len() as f64
}

/// Whether the part above z = 0 of the line through `through` meets the cylinder rooted at the origin.
fn meets(hairs: &Cylinders, through: DVec3, direction: DVec3) -> bool {
    let (axis, radius) = (hairs.lean, 0.5 * hairs.diameter_m);
    let across = |v: DVec3| v - axis * axis.dot(v);
    let (o, d) = (across(through), across(direction));
    let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
    let mut clip = |from: f64, to: f64| {
        enter = enter.max(from.min(to));
        leave = leave.min(from.max(to));
    };
    let (a, b, c) = (d.length_squared(), o.dot(d), o.length_squared() - radius * radius);
    if a > 1e-18 {
        let root = (b * b - a * c).sqrt();
        if root.is_nan() {
            return false;
        }
        clip((-b - root) / a, (-b + root) / a);
    } else if c > 0.0 {
        return false;
    }
    let (along, rate) = (axis.dot(through), axis.dot(direction));
    if rate.abs() > 1e-12 {
        clip(-along / rate, (hairs.length_m - along) / rate);
    } else if !(0.0..=hairs.length_m).contains(&along) {
        return false;
    }
    // Rays go down: above the skin is before they pass z = 0.
    leave = leave.min(0.0);
    enter <= leave
}

/// A level skin large enough that no ray leaves it sideways.
pub fn level(edge_m: f32) -> Mesh {
    scenes::grid(8, 8, |u, v| Vec3::new(u - 0.5, v - 0.5, 0.0) * edge_m)
}

/// Hair like the cylinders.
fn fibre(hairs: &Cylinders) -> Fibre {
    Fibre {
        density_per_m2: hairs.per_m2 as f32,
        length_m: hairs.length_m as f32,
        radius_m: (0.5 * hairs.diameter_m) as f32,
        shape: Shape { length_variation: 0.0, jitter_deg: 0.0, ..Shape::default() },
        profile: Profile { taper: 1.0, ramp: [Vec3::ONE; 3], tip_transparency: 0.0, tip_exponent: 1.0 },
        variation: 0.0,
    }
}

/// A level scene of undercoat like the cylinders.
pub fn on_level_skin<T>(hairs: &Cylinders, with: impl FnOnce(&Scene<'_>) -> T) -> T {
    let mesh = level((hairs.length_m * 60.0) as f32);
    let n = mesh.positions_m.len();
    let fields = Fields {
        length: vec![1.0; n],
        density: vec![1.0; n],
        direction: vec![Vec3::X; n],
        lean: vec![hairs.lean.as_vec3(); n],
        clump: vec![0.0; n],
        tint: vec![Vec3::ONE; n],
        paint: None,
        partings: Vec::new(),
    };
    let fibre = fibre(hairs);
    with(&Scene {
        skin: &mesh,
        fields: &fields,
        skin_factor: Vec3::ONE,
        guard: None,
        undercoat: Some(&fibre),
        scattering: HairScattering::none(),
    })
}

/// Optical depth of the volume that stands for the cylinders, along a ray through the middle of its top.
pub fn depth_of_volume(hairs: &Cylinders, direction: DVec3) -> f64 {
    on_level_skin(hairs, |scene| depth_of_scene(scene, direction))
}

/// The same of a square's undercoat, as a tile has it.
pub fn depth_of_square(hairs: &Cylinders, direction: DVec3) -> f64 {
    let lean = hairs.lean.as_vec3();
    let worn = Mat3::from_cols(Vec3::X, Vec3::Y, lean);
    let medium = Medium::new(&fibre(hairs), None, (4.0 * hairs.length_m) as f32).unwrap().mapped(worn);
    let origin_m = lean * hairs.length_m as f32 + Vec3::Z * 1e-6;
    let ray = Ray { origin_m, direction: direction.as_vec3() };
    f64::from(medium.depth_along(&ray, DepthRange::ALL, f32::INFINITY))
}

fn depth_of_scene(scene: &Scene<'_>, direction: DVec3) -> f64 {
    let mesh = scene.skin;
    let normals = mesh.smooth_normals();
    let subdivisions = vec![3; mesh.triangles.len()];
    let resolution = Resolution { pattern: None, ..Resolution::default() };
    let content = Content::new(scene, &normals, resolution).unwrap();
    let volume = Volume::new(&content, subdivisions);
    // A triangle near the middle, entered at its top.
    let triangle = mesh.triangles.len() as u32 / 2 + 8;
    let point = ShellPoint { b: [0.3, 0.3], t: 1.0 };
    let origin_m = volume.shell().prism(triangle).jacobian(&point).at_m;
    let start = Start { at_m: 0.0, triangle, point };
    let march_ray = MarchRay { origin_m, direction: direction.as_vec3(), start, far_m: f32::INFINITY };
    let (depths, _) = volume.depths_along(&[march_ray], &Stepping::default(), 0.0, f32::INFINITY);
    f64::from(depths[0])
}

pub fn directions() -> Vec<DVec3> {
    [0.0_f64, 30.0, 45.0, 60.0, 75.0, 85.0]
        .into_iter()
        .flat_map(|deg| [deg, -deg])
        .map(|deg| DVec3::new(deg.to_radians().sin(), 0.0, -deg.to_radians().cos()))
        .skip(1)
        .collect()
}

/// Hairs as dense as a mean transmittance of e^−0.35 needs: of a fixed count of hairs, the overlaps alone are random.
///
/// Leaning hairs are longer: what the skin cuts off their slanting ends is not in the model.
pub fn scaled(lean: DVec3, direction: DVec3) -> Cylinders {
    let length_m = if lean.z < 1.0 { 48e-5 } else { 16e-5 };
    let mut hairs = Cylinders { per_m2: 1.0, diameter_m: 1e-5, length_m, lean };
    hairs.per_m2 = 0.35 / depth_of_volume(&hairs, direction);
    hairs
}

fn agree(lean: DVec3) {
    for direction in directions() {
        let hairs = scaled(lean, direction);
        // Enough hairs in all for a standard error of 0.3 %.
        let seeds = (16_000.0 / (hairs.per_m2 * hairs.edge_m() * hairs.edge_m())).ceil();
        let mean = (0..seeds as u64).map(|seed| transmittance_of_rays(&hairs, direction, seed)).sum::<f64>() / seeds;
        let rays = -mean.ln();
        let volumes = [depth_of_volume(&hairs, direction), depth_of_square(&hairs, direction)];
        println!("along {direction:.3}: {rays:.5} by rays, {volumes:.5?} by the volumes");
        assert!(volumes.iter().all(|v| (rays - v).abs() < 0.01 * rays), "along {direction}: {rays}, {volumes:?}");
    }
}

#[test]
fn upright_undercoat_hides_what_its_hairs_hide() {
    agree(DVec3::Z);
}

#[test]
fn leaning_undercoat_hides_what_its_hairs_hide() {
    agree(DVec3::new(0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt()));
}

#[test]
fn every_place_has_a_subelement_and_every_centre_its_own() {
    let mut random = Stream::new(2);
    for d in 0..=7 {
        let n = (1 << d) as f32;
        let index = |b: Vec3| subelement::indices(Vec3s::<Scalar>::splat(b), F32s::splat(n)).row()[0];
        let mut seen = vec![false; 1 << (2 * d)];
        for i in 0..1_u32 << (2 * d) {
            let centre = subelement::centre(i, d);
            assert!((centre.element_sum() - 1.0).abs() < 1e-5 && centre.min_element() > 0.0, "{centre} of {i} at {d}");
            let index = index(centre);
            assert_eq!(index, i, "centre {centre} at d = {d}");
            seen[index as usize] = true;
        }
        assert!(seen.into_iter().all(|s| s));
        for k in 0..4000 {
            // Half of the points lie on lattice lines, some outside.
            let (mut x, mut y) = (1.2 * random.unit() - 0.1, 1.2 * random.unit() - 0.1);
            if k % 2 == 0 {
                (x, y) = ((x * n).round() / n, (y * n).round() / n);
            }
            assert!(index(Vec3::new(x, y, 1.0 - x - y)) < 1 << (2 * d));
        }
    }
}
