//! The key light's shadow: stored depths, hair in the mean, and what a scene hides from behind.

use crate::common::{framing, studio};
use crate::scenes::{self, Grown};
use furrier::bake::picture::{self as depicted, Only, PictureRequest};
use furrier::bake::units::Units;
use furrier::hybrid::{Settings, draw};
use furrier::math::Vec3;
use furrier::math::lanes::{self, F32s, Isa, Vec3s, Work};
use furrier::preset::Preset;
use furrier::reference::bvh::DRay;
use furrier::reference::medium::{Counted, DMedium};
use furrier::reference::point::DShellPoint;
use furrier::reference::skin::SkinBvh;
use furrier::volume::mean::MeanShadow;
use furrier::volume::scene::{Above, Scene};
use furrier::volume::shell::block::code;
use furrier::volume::shell::lattice::{self, Lattice, Lattices};

/// What a lattice holds at a point, in the first lane.
struct Read<'a> {
    lattice: &'a Lattice,
    layers: u32,
    b: Vec3,
    t: f32,
}

impl Work for Read<'_> {
    type Output = f32;

    #[inline(always)]
    fn run<I: Isa>(self) -> f32 {
        let mut lattices = Lattices::new(self.layers);
        (0..I::LANES).for_each(|lane| lattices.set(lane, self.lattice));
        lattices.at(Vec3s::<I>::splat(self.b), F32s::splat(self.t * self.layers as f32)).row().0[0]
    }
}

#[test]
fn stored_shadows_are_linear_between_corners_and_levels() {
    let layers = 4;
    let depth = |b: Vec3, t: f32| 1.0 + 2.0 * b.y + 0.5 * b.z + 1.5 * t;
    for d in 0..4 {
        let column = |b: Vec3| (0..=layers).map(move |i| code(depth(b, i as f32 / layers as f32)));
        assert_eq!(lattice::points(d).count(), lattice::corners(d) as usize);
        let stored = Lattice::of_codes(d, lattice::points(d).flat_map(column).collect());
        for (b, t) in [
            (Vec3::new(1.0, 0.0, 0.0), 0.0),
            (Vec3::new(0.0, 1.0, 0.0), 1.0),
            (Vec3::new(0.0, 0.0, 1.0), 0.5),
            (Vec3::new(0.0, 0.37, 0.63), 0.9),
            (Vec3::new(0.21, 0.33, 0.46), 0.13),
            (Vec3::new(0.55, 0.44, 0.01), 0.71),
        ] {
            let found = lanes::run(Read { lattice: &stored, layers, b, t });
            // A byte holds a depth within two hundredths of it up to here.
            assert!((found / depth(b, t) - 1.0).abs() < 0.02, "d {d}, {b} {t}: {found}, {}", depth(b, t));
        }
    }
}

#[test]
fn mean_shadow_is_a_flat_layers_far_from_borders_and_nothing_on_one_towards_the_light() {
    let (mut guard, mut undercoat) = scenes::mink();
    (guard.density_per_cm2, undercoat.density_per_cm2) = (30.0, 900.0);
    // Widths at heights are told by straight hair.
    (guard.taper, guard.tip_transparency) = (1.0, 0.0);
    (guard.shape.jitter_deg, undercoat.shape.jitter_deg) = (0.0, 0.0);
    let mesh = scenes::grid(12, 12, |u, v| Vec3::new((u - 0.5) * 0.6, 0.0, (0.5 - v) * 0.6));
    let grown = Grown::new(mesh, &guard, &undercoat, Vec3::X, 0.0, 3);
    let scene = grown.scene();
    let to_light = Vec3::new(0.6, 0.8, 0.0);
    let shadow = MeanShadow::new(&scene, to_light, f32::INFINITY).unwrap();
    let above = Above::new([Some(scene.guard.unwrap().1), scene.undercoat]);
    let middle = (0..scene.skin.triangles.len() as u32)
        .min_by(|&a, &b| {
            let far = |t: u32| scene.skin.corners_m(t as usize).iter().map(|p| p.length()).sum::<f32>();
            far(a).total_cmp(&far(b))
        })
        .unwrap();
    for share in [0.0, 0.25, 0.5] {
        let height_m = share / shadow.share(1.0, 1.0);
        let expected = above.at(height_m, 1.0, 1.0) * 0.6 / 0.8;
        let found = shadow.depth(middle, Vec3::splat(1.0 / 3.0), share);
        assert!((found / expected - 1.0).abs() < 0.02, "at {share}: {found}, flat {expected}");
    }
    let border = scene.skin.positions_m.iter().map(|p| p.x).fold(f32::MIN, f32::max);
    let of_columns = shadow.of_columns();
    // No two vertices are at one point: column after column is over vertex after vertex.
    let per_column = of_columns.len() / scene.skin.positions_m.len();
    for (v, p) in scene.skin.positions_m.iter().enumerate().filter(|(_, p)| p.x == border) {
        let depths = &of_columns[v * per_column..(v + 1) * per_column];
        assert!(depths.iter().all(|&depth| depth < 1e-4), "at {p}: {depths:?}");
    }
}

/// Greatest share of guard hair over the bare side of a bent scene that is seen from below, well inside its outline.
#[test]
fn no_hair_shows_through_the_bare_side() {
    let (guard, undercoat) = scenes::mink();
    let grown = Grown::new(scenes::bent_skin(2), &guard, &undercoat, Vec3::X, 35.0, 3);
    let centre = grown.mesh.positions_m.iter().sum::<Vec3>() / grown.mesh.positions_m.len() as f32;
    let below = scenes::looking(centre - Vec3::new(0.0, 0.25, 0.03), centre, Vec3::X, 34.0);
    let settings = Settings { size: [64, 64], ..Settings::default() };
    let film = draw(&grown.scene(), &scenes::studio(), &below, &settings).unwrap().film;
    let skin = |i: usize| film.alpha[i] - film.guard[i] - film.undercoat[i];
    let inside = (0..film.alpha.len()).filter(|&i| {
        let (x, y) = (i % 64, i / 64);
        x > 1 && y > 1 && x < 62 && y < 62 && [i - 2, i + 2, i - 128, i + 128].iter().all(|&near| skin(near) > 0.9)
    });
    let shown: Vec<f32> = inside.map(|i| film.guard[i]).collect();
    assert!(shown.len() > 100, "{} pixels of bare skin", shown.len());
    let worst = shown.iter().copied().fold(0.0, f32::max);
    assert!(worst < 0.02, "{worst}");
}

/// Light that the key light's shadow lets through over a point of every seventh triangle of a hat, at three heights: what
/// `shadow`, of columns `span` apart, has against the reference's medium, as the mean size of the difference.
fn strays_on_a_hat(b: Vec3, span: f32, shadow: impl Fn(&MeanShadow<'_>, &Scene<'_>, u32, f32, f32) -> f32) -> f64 {
    let mut preset = Preset::load("mink").unwrap();
    preset.undercoat.shape.clump.strength = 0.0;
    let request = PictureRequest {
        input: "sample:hat".to_owned(),
        reading: Default::default(),
        preset,
        materials: Vec::new(),
        units: Units::Auto,
        seed: 0,
        only: Only::Hybrid,
        pose: None,
    };
    let grown = depicted::Grown::new(&request).unwrap();
    let scene = grown.scene();
    let to_light = studio(&framing(&grown, 35.0, 20.0, 1.0, [1, 1])).mean_direction(scene.skin);
    let normals = scene.skin.smooth_normals();
    let medium = DMedium::new(&scene, &normals, None).unwrap();
    let skin = SkinBvh::new(scene.skin);
    let mean = MeanShadow::new(&scene, to_light, span).unwrap();
    let (mut strays, mut count) = (0.0, 0.0);
    for triangle in (0..scene.skin.triangles.len() as u32).step_by(7) {
        let cosine = normals[scene.skin.triangles[triangle as usize][0] as usize].dot(to_light);
        if cosine < 0.05 {
            continue;
        }
        for share in [0.25_f32, 0.5, 0.75] {
            let t = share / mean.share(medium.shell.undercoat.height_m, 1.0);
            let point = DShellPoint { triangle, b: b.as_dvec3(), t: f64::from(t) };
            let ray = DRay::new(medium.slabs.position_m(&point), to_light.as_dvec3());
            let to_m = skin.meet(&ray, 1e-7).map_or(f64::INFINITY, |(at_m, _)| at_m);
            let expected = medium.depth_along(&ray, 1e-9, to_m, Counted::Both, 15.0);
            let found = f64::from(shadow(&mean, &scene, triangle, share, cosine));
            strays += ((-0.5 * found).exp() - (-0.5 * expected).exp()).abs();
            count += 1.0;
        }
    }
    strays / count
}

#[test]
fn mean_shadow_is_the_references_where_a_crown_shades_its_brim() {
    let strays =
        strays_on_a_hat(Vec3::X, f32::INFINITY, |mean, _, triangle, share, _| mean.depth(triangle, Vec3::X, share));
    assert!(strays < 0.015, "{strays}");
    // A flat layer's shadow knows of no crown.
    let flat = strays_on_a_hat(Vec3::X, f32::INFINITY, |mean, scene, _, share, cosine| {
        let above = Above::new([Some(scene.guard.unwrap().1), scene.undercoat]);
        above.at(share / mean.share(1.0, 1.0), 1.0, 1.0) / cosine
    });
    assert!(flat > 0.05, "{flat}");
}

#[test]
fn columns_between_vertices_bring_the_mean_shadow_nearer_the_references_there() {
    // In the middle, and on an edge, whose columns two triangles share.
    for b in [Vec3::splat(1.0 / 3.0), Vec3::new(0.0, 0.3, 0.7)] {
        let strays = |span| strays_on_a_hat(b, span, |mean, _, triangle, share, _| mean.depth(triangle, b, share));
        let (at_vertices, between) = (strays(f32::INFINITY), strays(0.1));
        println!(
            "at {b}, light let through is {at_vertices:.4} off from vertices alone, {between:.4} with columns between"
        );
        assert!(between < 0.004 && between < 0.4 * at_vertices, "{at_vertices}, {between}");
    }
}
