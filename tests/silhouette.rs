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

/// Rings from the skin's outline to one hair length beyond it.
const RINGS: usize = 4;

/// Which fins are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fins {
    /// All.
    Drawn,
    /// None, though shells leave them their share.
    Lost,
    /// None, and shells keep the whole coat.
    LeftOut,
}

/// A picture's fringe. Lists go from the inner ring to the outer one.
#[derive(Debug)]
pub struct Fringe {
    /// Mean alpha by ring.
    alpha: [f32; RINGS],
    /// Mean alpha over all of them.
    whole: f32,
    /// How far pixels stand out from their neighbours along the outline, root mean square by ring: single hairs do, a haze
    /// does not.
    relief: [f32; RINGS],
}

impl Fringe {
    /// Of a picture by `camera`, which looks from [`EYE`]; the outline runs along its rows where relief is to mean anything.
    fn of(alpha: &[f32], camera: &Camera, height_m: f32) -> Self {
        let (mut sums, mut squares, mut counts) = ([0.0; RINGS], [0.0; RINGS], [0.0; RINGS]);
        let rays = Rays::Perspective { view: scenes::view(camera, [PIXELS; 2]), supersampling: 1 };
        for (i, a) in alpha.iter().enumerate().filter(|(i, _)| (4..PIXELS - 4).contains(&(i % PIXELS))) {
            let ray = rays.ray(i % PIXELS, i / PIXELS, 0);
            let closest = EYE - ray.direction * EYE.dot(ray.direction);
            let at = (closest.length() - RADIUS_M) / height_m;
            if (0.0..1.0).contains(&at) {
                let ring = (at * RINGS as f32) as usize;
                let around = (1..=4).map(|k| alpha[i - k] + alpha[i + k]).sum::<f32>() / 8.0;
                sums[ring] += a;
                squares[ring] += (a - around).powi(2);
                counts[ring] += 1.0;
            }
        }
        let per_ring = |of: [f32; RINGS]| std::array::from_fn(|ring| of[ring] / counts[ring]);
        Self {
            alpha: per_ring(sums),
            whole: sums.iter().sum::<f32>() / counts.iter().sum::<f32>(),
            relief: per_ring(squares).map(f32::sqrt),
        }
    }

    /// Where coverage is not the strands', if anywhere.
    pub fn miscovers(&self, strands: &Self) -> Option<String> {
        let far = |ring: &usize| (self.alpha[*ring] - strands.alpha[*ring]).abs() > 0.08;
        if (self.whole - strands.whole).abs() > 0.05 {
            return Some(format!("{} for {}", self.whole, strands.whole));
        }
        (0..RINGS).find(far).map(|i| format!("ring {i} of {RINGS}: {} for {}", self.alpha[i], strands.alpha[i]))
    }

    /// Relief where hair neither fills a pixel nor is gone, over that of `other`.
    pub fn relief_over(&self, other: &Self) -> f32 {
        self.relief[1..].iter().sum::<f32>() / other.relief[1..].iter().sum::<f32>()
    }
}

/// The whole sphere.
fn camera() -> Camera {
    scenes::looking(EYE, Vec3::ZERO, Vec3::Y, 18.0)
}

/// The sphere's upper outline, near enough for single hairs to show.
fn close_up() -> Camera {
    let up = (Vec3::Y - EYE.normalize() * EYE.normalize().y).normalize();
    scenes::looking(EYE, up * (RADIUS_M + 0.005), Vec3::Y, 5.0)
}

fn frame(camera: &Camera) -> Frame {
    Frame {
        clip_from_world: camera.clip_from_world(furrier::math::DVec3::ZERO, 1.0, 0.05, 1.0).as_mat4(),
        eye: Vec4::from((EYE, 1.0)),
        size: [PIXELS as u32; 2],
        lights: vec![],
        ambient: Vec3::ONE,
        shadow_map: false,
        depths: false,
        level: Some(0),
    }
}

/// The fringe of strands seen by `camera`, and of the runtime's picture with each of `fins`.
fn measured(camera: &Camera, fibres: [&Fibre; 2], lean_rad: f32, fins: &[Fins]) -> (Fringe, Vec<Fringe>) {
    let hair = TileHair::grow(fibres[0], fibres[1], 8e-3, 7);
    let recipe = TileRecipe {
        preset: "test".into(),
        shells: ShellParameters { tile_mm: 8.0, ..ShellParameters::default() },
        fins: FinParameters::default(),
        skin: Vec3::splat(0.5),
        lean_deg: lean_rad.to_degrees(),
        looks: None,
        draft: false,
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
        paint: None,
        partings: Vec::new(),
    };
    let [guard, undercoat] = [0, 1].map(|i| grow::skin::grow(fibres[i], &mesh, &fields, 3 + i as u64));
    let scene = Geometry { guard: Some(&guard), undercoat: Some(&undercoat), skin: Some(&mesh), ..Default::default() };
    let rays = Rays::Perspective { view: scenes::view(camera, [PIXELS; 2]), supersampling: 3 };
    let strands = Fringe::of(&Caster::new(scene).render(&rays, DepthRange::ALL).alpha, camera, height_m);
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let renderer = Renderer::new(&gpu, &tiles, 2).unwrap();
    let ours = fins.iter().map(|fins| {
        let mut list = furred.scene(&tiles);
        if *fins == Fins::Lost {
            list.furs[0].fins = Default::default();
        }
        let show = Show { fins: *fins != Fins::LeftOut, ..Show::default() };
        let picture = renderer.prepare(&list).unwrap().draw(&frame(camera), show).unwrap().picture;
        Fringe::of(&picture.pixels.iter().map(|p| p[3]).collect::<Vec<_>>(), camera, height_m)
    });
    (strands, ours.collect())
}

fn thinned(mut fibre: Fibre, factor: f32) -> Fibre {
    fibre.density_per_m2 *= factor;
    fibre
}

fn guard(factor: f32) -> Fibre {
    thinned(Fibre::guard(&Guard::default(), &Colour::default(), 1.0), factor)
}

fn undercoat(factor: f32) -> Fibre {
    thinned(Fibre::undercoat(&Undercoat::default(), &Colour::default(), 1.0), factor)
}

#[test]
fn the_fringe_covers_what_strands_cover() {
    for (name, fibres, lean_rad) in [
        ("upright guard hair", [&guard(0.5), &undercoat(0.0)], 0.0),
        ("leaning guard hair", [&guard(0.5), &undercoat(0.0)], 0.6),
        ("leaning undercoat", [&guard(0.0), &undercoat(0.1)], 0.3),
    ] {
        let (strands, ours) = measured(&camera(), fibres, lean_rad, &[Fins::Drawn, Fins::LeftOut]);
        println!(
            "{name}: strands {:.3?}, with fins {:.3?}, without {:.3?}",
            strands.alpha, ours[0].alpha, ours[1].alpha
        );
        ours.iter().for_each(|ours| assert_eq!(ours.miscovers(&strands), None, "{name}"));
    }
}

/// Leaning guard hair from near by: the fringe of strands, of shells alone, and of the coat with `fins`.
pub fn near(fins: Fins) -> [Fringe; 3] {
    let (strands, ours) = measured(&close_up(), [&guard(0.5), &undercoat(0.0)], 0.6, &[Fins::LeftOut, fins]);
    println!("strands {strands:.3?}\nshells {:.3?}\n{fins:?} {:.3?}", ours[0], ours[1]);
    let [shells, ours] = ours.try_into().unwrap();
    [strands, shells, ours]
}

/// What fins add to the relief of shells alone, at least.
pub const RELIEF: f32 = 1.2;

/// Shells alone cover as much: what fins bring to an outline is that single hairs stand out there.
#[test]
fn fins_give_the_fringe_relief_and_keep_its_coverage() {
    let [strands, shells, ours] = near(Fins::Drawn);
    assert_eq!(ours.miscovers(&strands), None);
    let (gained, whole) = (ours.relief_over(&shells), ours.relief_over(&strands));
    assert!(gained > RELIEF && whole < 1.0, "{gained} of what shells have alone, {whole} of what strands have");
}
