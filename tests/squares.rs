//! The undercoat of a square as a volume: it repeats without a seam, crowds as it does on a skin, and stands between guard hairs in
//! the order of depth.

use furrier::cast::Caster;
use furrier::cast::Geometry;
use furrier::cast::Rays;
use furrier::data::film::Film;
use furrier::data::ray::DepthRange;
use furrier::data::ray::Ray;
use furrier::fur::groom::fibre::Fibre;
use furrier::fur::groom::{Clump, Colour, Guard, Shape, Undercoat as Table};
use furrier::fur::grow;
use furrier::fur::undercoat::{Pattern, Undercoat};
use furrier::math::hash::Stream;
use furrier::math::{Mat3, Vec2, Vec3};
use furrier::volume::medium::Medium;

const EDGE_M: f32 = 8e-3;

/// Undercoat with clumps.
pub fn hair() -> Fibre {
    let shape = Shape { clump: Clump { spacing_mm: 1.1, strength: 0.4 }, ..Shape::default() };
    let undercoat = Table { density_per_cm2: 3000.0, shape, ..Table::default() };
    Fibre::undercoat(&undercoat, &Colour::default(), 1.0)
}

/// Crowding over random points of a square, and one edge further along x, y or both.
fn pairs(undercoat: &Undercoat) -> Vec<[f32; 2]> {
    let mut random = Stream::new(5);
    (0..2000)
        .map(|i| {
            let at = Vec2::new(random.unit(), random.unit()) * EDGE_M;
            let t = random.unit();
            let edges = Vec2::new((1 - i % 3 / 2) as f32, (i % 3).min(1) as f32) * EDGE_M;
            [at, at + edges].map(|at| undercoat.column(at.extend(0.0), Vec3::Z, 1.0).crowding(t))
        })
        .collect()
}

/// Share of the points that are not crowded as they are one edge further: a few lie on the very wall of a clump.
pub fn torn(undercoat: &Undercoat) -> f64 {
    let pairs = pairs(undercoat);
    pairs.iter().filter(|[a, b]| (a - b).abs() > 2e-3).count() as f64 / pairs.len() as f64
}

#[test]
fn the_pattern_and_the_clumps_of_a_square_repeat() {
    let square = Undercoat::new(&hair(), Some(Pattern::default())).on_torus(EDGE_M);
    let torn = torn(&square);
    println!("torn {torn}, clumps {} m, waves {} m", square.clump_spacing_m, square.wavelength_m());
    assert!(torn <= 1e-3, "{torn}");
    // Distances on the square are about what they are on a skin.
    let skin = Undercoat::new(&hair(), Some(Pattern::default()));
    assert!((square.clump_spacing_m / skin.clump_spacing_m - 1.0).abs() < 0.1);
    assert!((square.wavelength_m() / skin.wavelength_m() - 1.0).abs() < 0.2);
}

/// Mean and standard deviation.
fn moments(values: &[f32]) -> [f32; 2] {
    let n = values.len() as f32;
    let mean = values.iter().sum::<f32>() / n;
    [mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f32>() / n).sqrt()]
}

#[test]
fn hair_crowds_on_a_square_as_on_a_skin() {
    let skin = Undercoat::new(&hair(), Some(Pattern::default()));
    let square = skin.on_torus(0.08);
    let mut random = Stream::new(6);
    let at: Vec<Vec3> = (0..20_000).map(|_| Vec3::new(random.unit(), random.unit(), 0.0) * 0.08).collect();
    for t in [0.1, 0.5, 0.9] {
        let of = |undercoat: &Undercoat| {
            moments(&at.iter().map(|&at| undercoat.column(at, Vec3::Z, 1.0).crowding(t)).collect::<Vec<_>>())
        };
        let (a, b) = (of(&skin), of(&square));
        println!("at {t}: skin {a:.3?}, square {b:.3?}");
        assert!((a[0] - b[0]).abs() < 0.03 && (a[1] / b[1] - 1.0).abs() < 0.1, "at {t}: {a:?} and {b:?}");
    }
    // Stored by cells it is the same.
    let medium = Medium::new(&hair(), Some(Pattern::default()), EDGE_M).unwrap();
    let cells = medium.cells() as f32;
    for i in 0..2000 {
        let cell = Vec2::new((i * 37 % medium.cells()) as f32, (i * 91 % medium.cells()) as f32);
        let at = (cell + 0.5) / cells * EDGE_M;
        let exact = medium.undercoat().column(at.extend(0.0), Vec3::Z, 1.0).crowding(9.5 / 16.0);
        let wrapped = medium.crowding(at - EDGE_M, 0.6);
        assert!((medium.crowding(at, 0.6) - exact).abs() < 1e-3 && wrapped == medium.crowding(at, 0.6));
    }
}

/// How far from the rays' origins [`film`]'s slabs meet, m.
pub const MIDDLE_M: f32 = 3e-3;

/// Guard hair and undercoat of a square that leans, seen at a slant.
pub fn film(range: DepthRange) -> Film {
    let guard = Guard { density_per_cm2: 60.0, tip_transparency: 0.0, ..Guard::default() };
    let mut guard = grow::tile::grow(&Fibre::guard(&guard, &Colour::default(), 1.0), EDGE_M, 3);
    let worn = Mat3::from_cols(Vec3::X, Vec3::Y, Vec3::new(0.3, 0.0, 0.9));
    guard.points_m.iter_mut().for_each(|p| *p = worn * *p);
    let medium = Medium::new(&hair(), Some(Pattern::default()), EDGE_M).unwrap().mapped(worn);
    let scene = Geometry {
        guard: Some(&guard),
        medium: Some(&medium),
        torus_m: Some(EDGE_M),
        upright_from_world: worn.inverse(),
        ..Geometry::default()
    };
    let direction = Vec3::new(-0.3, 0.5, -0.8).normalize();
    let ray = |i: usize| {
        let at = Vec2::new((i % 64) as f32, (i / 64) as f32) * (EDGE_M / 64.0);
        Ray { origin_m: at.extend(5e-3), direction }
    };
    let rays: Vec<Ray> = (0..64 * 64).map(ray).collect();
    Caster::new(scene).render(&Rays::Texels { rays: &rays, size: [64, 64] }, range)
}

/// Greatest difference of alpha, colour or direction.
pub fn farthest(a: &Film, b: &Film) -> f32 {
    let of = |i: usize| {
        let colour = (a.albedo[i] - b.albedo[i]).abs().max_element();
        let tangent = (a.tangent[i] - b.tangent[i]).abs().max_element();
        (a.alpha[i] - b.alpha[i]).abs().max(colour).max(tangent)
    };
    (0..a.alpha.len()).map(of).fold(0.0, f32::max)
}

#[test]
fn slabs_of_guard_hair_and_undercoat_lie_over_each_other() {
    let whole = film(DepthRange::ALL);
    let near = film(DepthRange { near_m: 0.0, far_m: MIDDLE_M });
    let far = film(DepthRange { near_m: MIDDLE_M, far_m: f32::INFINITY });
    let mut over = near.clone();
    for i in 0..over.alpha.len() {
        let clear = 1.0 - near.alpha[i];
        over.alpha[i] += clear * far.alpha[i];
        over.albedo[i] += clear * far.albedo[i];
        over.tangent[i] += clear * far.tangent[i];
    }
    // A hair that is cut shows its cut: colour and direction alone differ, and where they meet.
    let off = farthest(&whole, &over);
    println!("off by {off}, coverage {:.3}, undercoat in front of guard hair and behind it", whole.coverage());
    assert!(off < 0.02, "{off}");
    let seen = |part: &[f32]| part.iter().filter(|&&p| p > 0.05).count();
    let both = (0..whole.alpha.len()).filter(|&i| whole.guard[i] > 0.05 && whole.undercoat[i] > 0.05).count();
    assert!(both > 100 && seen(&whole.guard) > both, "{both}");
    let sums = (0..whole.alpha.len()).all(|i| (whole.guard[i] + whole.undercoat[i] - whole.alpha[i]).abs() < 1e-3);
    assert!(sums, "guard hair and undercoat make up what is seen");
}
