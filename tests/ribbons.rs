//! Guard hair as ribbons: areas, order, and agreement with rays cast at the same hairs.

use crate::scenes::{self, Grown};
use furrier::cast::Caster;
use furrier::cast::Geometry;
use furrier::cast::Rays;
use furrier::data::film::{Film, Layers};
use furrier::data::ray::DepthRange;
use furrier::hybrid::resolve::{Appearance, Blending, composite, settle};
use furrier::hybrid::strands::ribbon::{Narrow, Share, Window, rasterise};
use furrier::hybrid::strands::{Fragment, Parts, RibbonPoint};
use furrier::hybrid::{Picture, Settings, draw};
use furrier::math::hash::Stream;
use furrier::math::lanes::{self, Isa};
use furrier::math::{Vec3, radix};
use furrier::volume::scene::Scene;

pub fn covered(a: &RibbonPoint, b: &RibbonPoint) -> f64 {
    let mut sum = 0.0;
    rasterise(a, b, Window { from: [-64, -64], to: [64, 64] }, |share| sum += f64::from(share.coverage));
    sum
}

fn ribbon_point(x: f32, y: f32, half_px: f32) -> RibbonPoint {
    RibbonPoint { x, y, z_m: 1.0, half_px }
}

#[test]
fn coverage_sums_to_the_ribbons_area() {
    let mut random = Stream::new(1);
    for _ in 0..2000 {
        let mut coordinate = || 20.0 * (2.0 * random.unit() - 1.0);
        let (a, b) = ((coordinate(), coordinate()), (coordinate(), coordinate()));
        let half_px = libm::expf(4.0 * (2.0 * random.unit() - 1.0) - 4.0);
        let length = f64::from((a.0 - b.0).hypot(a.1 - b.1));
        let area = 2.0 * f64::from(half_px) * length;
        let sum = covered(&ribbon_point(a.0, a.1, half_px), &ribbon_point(b.0, b.1, half_px));
        assert!((sum - area).abs() < 2e-3 * area + 1e-5, "{sum} of {area}");
    }
}

/// Finds the shares of a ribbon in lanes.
struct InLanes<'a>(&'a RibbonPoint, &'a RibbonPoint, Window);

impl lanes::Work for InLanes<'_> {
    type Output = Option<Vec<Share>>;

    #[inline(always)]
    fn run<I: Isa>(self) -> Option<Vec<Share>> {
        let narrow = Narrow::new(self.0, self.1, self.2)?;
        let mut shares = Vec::new();
        for first in (narrow.rows[0]..narrow.rows[1]).step_by(I::LANES) {
            let rows = narrow.rows::<I>(first);
            for lane in 0..I::LANES.min((narrow.rows[1] - first) as usize) {
                for k in 0..rows.count[lane] as usize {
                    let (row, across) = (first + lane as i32, (rows.begin[lane] as usize + k) as i32);
                    let pixel = if narrow.flat { [row, across] } else { [across, row] };
                    let (coverage, linear, along) = (rows.coverage[k].0[lane], rows.linear.0[lane], rows.along.0[lane]);
                    if coverage > 0.0 {
                        shares.push(Share { pixel, coverage, linear, along });
                    }
                }
            }
        }
        Some(shares)
    }
}

#[test]
fn rows_in_lanes_have_the_bits_of_ribbons() {
    let mut random = Stream::new(8);
    let window = Window { from: [8, 16], to: [40, 48] };
    let mut narrow = 0;
    for i in 0..4000 {
        let mut end = || {
            let half_px = if i % 3 == 0 { 0.6 } else { 0.2 } * random.unit();
            let (x, y) = (48.0 * random.unit(), 56.0 * random.unit());
            RibbonPoint { half_px, z_m: 1.0 + random.unit(), ..ribbon_point(x, y, half_px) }
        };
        let (a, mut b) = (end(), end());
        match i % 8 {
            0 => b.x = a.x,
            1 => b.y = a.y,
            2 => (b.x, b.y) = (a.x, a.y),
            _ => {}
        }
        let mut expected = Vec::new();
        rasterise(&a, &b, window, |share| expected.push(share));
        if let Some(found) = lanes::run(InLanes(&a, &b, window)) {
            assert_eq!(found, expected, "{a:?} {b:?}");
            narrow += 1;
        }
    }
    assert!(narrow > 3000, "{narrow}");
}

#[test]
fn a_hair_thinner_than_a_pixel_covers_its_share() {
    let sum = covered(&ribbon_point(0.3, 0.0, 0.0005), &ribbon_point(0.7, 10.0, 0.0005));
    assert!((sum - 0.01).abs() < 1e-4, "{sum}");
    assert_eq!(covered(&ribbon_point(0.3, 0.0, 0.0), &ribbon_point(0.7, 10.0, 0.0)), 0.0);
    assert_eq!(covered(&ribbon_point(2.0, 3.0, 1.0), &ribbon_point(2.0, 3.0, 1.0)), 0.0);
}

#[test]
fn a_thousand_fragments_at_one_depth_are_ordered_by_id() {
    let mut random = Stream::new(5);
    let mut fragments: Vec<Fragment> =
        (0..1000).map(|id| Fragment::new(if id < 500 { 1.0 } else { 2.0 }, id, Parts::new(0.002, 1.0), id)).collect();
    let draw = |fragments: &[Fragment]| {
        composite(
            Layers::All,
            fragments,
            &[],
            Blending::Virtual { fragments: 1 },
            0.001,
            || None,
            |f| {
                let radiance = Vec3::splat(f.id() as f32 * 1e-3);
                Appearance { z_m: f.z_m(), radiance, ..Default::default() }
            },
        )
    };
    let mut veil = [0.0; 1000];
    let mut settled = |fragments: &mut [Fragment]| {
        let count = settle(fragments, &mut veil, 0.0005);
        draw(&fragments[..count])
    };
    let first = settled(&mut fragments);
    assert!((first.alpha - (1.0 - 0.998_f32.powi(1000))).abs() < 1e-4, "{}", first.alpha);
    for _ in 0..5 {
        fragments.sort_by_cached_key(|_| random.bits());
        assert_eq!(settled(&mut fragments), first);
    }
}

#[test]
fn a_pixels_fragments_are_joined_and_cut_off() {
    let of = |z_m, id, coverage| Fragment::new(z_m, id, Parts::new(coverage, 0.5), id);
    let mut fragments = [of(3.0, 8, 1.0), of(4.0, 9, 1.0), of(1.0, 7, 0.5), of(2.0, 7, 0.5)];
    let mut veil = [0.0; 4];
    // A hair's neighbouring segments cover the pixel once; the last one is hidden.
    assert_eq!(settle(&mut fragments, &mut veil, 0.3), 2);
    assert_eq!((fragments[0].z_m(), fragments[0].id(), fragments[0].alpha(), veil[0]), (1.0, 7, 0.5, 0.5));
    assert_eq!((fragments[1].z_m(), fragments[1].id(), fragments[1].alpha(), veil[1]), (3.0, 8, 0.5, 0.25));
}

#[test]
fn radix_sort_sorts() {
    let mut random = Stream::new(5);
    for (count, spread) in
        [(0, 1.0), (1, 1.0), (90, 1.0), (3000, 1.0), (3000, 1e-3), (3000, 1e-7), (3000, 0.0), (3000, 1e9)]
    {
        let key = |number: u64| {
            let z_m = 0.7 + spread * libm::powf(random.unit(), 6.0);
            u64::from(z_m.to_bits()) << 32 | number
        };
        let mut keys: Vec<u64> = (0..count).map(key).collect();
        let mut expected = keys.clone();
        expected.sort_unstable();
        radix::sort(&mut keys, &mut Vec::new());
        assert_eq!(keys, expected, "{count} by {spread}");
    }
}

fn sparse() -> Grown {
    let (mut guard, undercoat) = scenes::mink();
    guard.density_per_cm2 = 40.0;
    Grown::new(scenes::bent_skin(1), &guard, &undercoat, Vec3::X, 35.0, 3)
}

fn only_guard(grown: &Grown) -> Scene<'_> {
    Scene { undercoat: None, ..grown.scene() }
}

fn drawn(grown: &Grown, settings: &Settings) -> Picture {
    draw(&only_guard(grown), &scenes::studio(), &scenes::camera(0.35), settings).unwrap()
}

/// Largest difference of guard hair's coverage between two films, over blocks of 8 × 8 pixels.
pub fn worst_block(a: &Film, b: &Film) -> f32 {
    let mut worst = 0.0_f32;
    for y in (0..a.height).step_by(8) {
        for x in (0..a.width).step_by(8) {
            let mean = |film: &Film| -> f32 {
                (0..64).map(|i| film.guard[(y + i / 8) * film.width + x + i % 8]).sum::<f32>() / 64.0
            };
            worst = worst.max((mean(a) - mean(b)).abs());
        }
    }
    worst
}

pub fn ribbons_and_rays() -> (Film, Film) {
    let grown = sparse();
    let size = [128, 128];
    let ribbons = drawn(&grown, &Settings { size, ..Settings::default() }).film;
    let scene = Geometry { guard: Some(&grown.guard), skin: Some(&grown.mesh), ..Geometry::default() };
    let rays = Rays::Perspective { view: scenes::view(&scenes::camera(0.35), size), supersampling: 8 };
    (ribbons, Caster::new(scene).render(&rays, DepthRange::ALL))
}

#[test]
fn ribbons_cover_what_rays_find() {
    let (ribbons, rays) = ribbons_and_rays();
    let mean = |film: &Film| film.guard.iter().map(|&g| f64::from(g)).sum::<f64>() / film.guard.len() as f64;
    let (a, b) = (mean(&ribbons), mean(&rays));
    // Ribbons lack the round ends of cones, and hairs are taken to lie independently within a pixel.
    assert!((a - b).abs() < 0.015 * b, "guard hair covers {a} by ribbons, {b} by rays");
    assert!((ribbons.coverage() - rays.coverage()).abs() < 0.01 * rays.coverage());
    let worst = worst_block(&ribbons, &rays);
    assert!(worst < 0.03, "{worst}");
}

#[test]
fn bands_do_not_show() {
    let grown = sparse();
    let whole = drawn(&grown, &Settings { size: [160, 160], ..Settings::default() });
    let banded = drawn(&grown, &Settings { size: [160, 160], band_bytes: 1 << 16, ..Settings::default() });
    assert!(banded.counts.strands > whole.counts.strands, "the small budget made no bands");
    assert_eq!(whole.film, banded.film);
}

#[test]
fn the_order_of_strands_does_not_show() {
    let mut grown = sparse();
    let settings = Settings { size: [128, 128], ..Settings::default() };
    let before = drawn(&grown, &settings).film;
    let (points, strands) = (grown.guard.points_per_strand, &mut grown.guard);
    let mut order: Vec<usize> = (0..strands.len()).collect();
    let mut random = Stream::new(9);
    order.sort_by_cached_key(|_| random.bits());
    let old = strands.clone();
    strands.points_m = order.iter().flat_map(|&i| &old.points_m[i * points..(i + 1) * points]).copied().collect();
    strands.roots = order.iter().map(|&i| old.roots[i]).collect();
    strands.root_radius_m = order.iter().map(|&i| old.root_radius_m[i]).collect();
    strands.tint = order.iter().map(|&i| old.tint[i]).collect();
    strands.id = order.iter().map(|&i| old.id[i]).collect();
    assert_eq!(drawn(&grown, &settings).film, before);
}
