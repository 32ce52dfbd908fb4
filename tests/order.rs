//! In which order a coat is drawn, and what of it: rays through furred spheres meet what is drawn from the first to the last.

use crate::{coats, runtime};
use furrier::data::coat::Tile;
use furrier::math::{Vec3, Vec4};
use furrier::runtime::{Before, Frame, Item, LevelSight, Order, Point, Show, Sighted, bends_per_m, outer_edge_m};

const LAYERS: u32 = 9;
const RADIUS_M: f32 = 0.05;
const HAIR_M: f32 = 0.02;

/// A furred sphere around `middle`, whose hair leans by half a radian; nothing is seen through `above` times its upper half.
fn sphere(middle: Vec3, above: f32) -> Sighted {
    let tile = Tile { height_m: HAIR_M, ..coats::tile(&coats::fox(), 0.008, LAYERS, 4, 1) };
    let furred = coats::sphere(RADIUS_M, 12, 0.5, &tile);
    let scene = furred.scene(std::slice::from_ref(&tile));
    let mesh = &scene.furs[0];
    let bends = bends_per_m(mesh);
    let point = |i: usize| Point {
        position_m: mesh.positions_m[i] + middle,
        offset_m: mesh.offsets_m[i],
        normal: mesh.normals[i],
        density: 1.0,
        bend_per_m: bends[i],
        away_m: f32::INFINITY,
    };
    let before = |layer: u32| Before { above_top: [if layer < LAYERS / 2 { above } else { 0.0 }; 9], scale: 0.25 };
    Sighted {
        points: (0..mesh.positions_m.len()).map(point).collect(),
        triangles: mesh.triangles.to_vec(),
        fins: vec![],
        height_m: tile.height_m,
        levels: vec![LevelSight {
            tops: tile.shells.slabs.tops().to_vec(),
            before: (0..LAYERS).map(before).collect(),
            looks: vec![0; LAYERS as usize],
            most_px: f32::INFINITY,
        }],
        edge_m: outer_edge_m(mesh),
        over_last: false,
    }
}

fn frame() -> Frame {
    runtime::look(Vec3::new(0.1, 0.15, 0.4), [64, 64])
}

/// Distance along the ray at which it meets the triangle (Möller and Trumbore 1997).
fn meets(eye: Vec3, ray: Vec3, [a, b, c]: [Vec3; 3]) -> Option<f32> {
    let (e1, e2) = (b - a, c - a);
    let p = ray.cross(e2);
    let determinant = e1.dot(p);
    let u = (eye - a).dot(p) / determinant;
    let q = (eye - a).cross(e1);
    let (v, t) = (ray.dot(q) / determinant, e2.dot(q) / determinant);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some(t)
}

/// What the ray meets of `items`: distance, coat and layer of each, in their order, as far as no skin is before it.
fn met(eye: Vec3, ray: Vec3, furs: &[&Sighted], order: &[(usize, Item)]) -> Vec<(f32, usize, u32)> {
    let slab = |fur: &Sighted, item: &Item| {
        let height = item.layer() as f32 / (LAYERS - 1) as f32;
        fur.triangles[item.index as usize].map(|v| {
            let p = fur.points[v as usize];
            p.position_m + p.offset_m * height
        })
    };
    let skin = |fur: &&Sighted| {
        let items = (0..fur.triangles.len()).map(|i| Item::slab(i, 0, false));
        items.filter_map(|item| meets(eye, ray, slab(fur, &item))).fold(f32::INFINITY, f32::min)
    };
    let skin_m = furs.iter().map(skin).fold(f32::INFINITY, f32::min);
    let here = |(fur, item): &(usize, Item)| Some((meets(eye, ray, slab(furs[*fur], item))?, *fur, item.layer()));
    order.iter().filter_map(here).filter(|&(t, ..)| t < skin_m).collect()
}

fn items(order: &Order) -> Vec<(usize, Item)> {
    let of = |run: &furrier::runtime::Run| {
        order.items[run.items.start as usize..run.items.end as usize]
            .iter()
            .map(|&item| (run.fur, item))
            .collect::<Vec<_>>()
    };
    order.pieces.iter().flatten().flat_map(of).collect()
}

/// Rays over the picture, towards both spheres and beside them.
fn rays() -> Vec<Vec3> {
    let eye = frame().eye.truncate();
    let at = |i: i32, j: i32| (Vec3::new(0.12 * i as f32 / 12.0, 0.12 * j as f32 / 12.0, 0.0) - eye).normalize();
    (-12..=12).flat_map(|i| (-12..=12).map(move |j| at(i, j))).collect()
}

/// Pairs of neighbours on rays that come from back to front, of all pairs.
fn wrong(furs: &[&Sighted], order: &[(usize, Item)]) -> (usize, usize) {
    let eye = frame().eye.truncate();
    let (mut wrong, mut all) = (0, 0);
    for ray in rays() {
        let met = met(eye, ray, furs, order);
        all += met.len().saturating_sub(1);
        wrong += met.windows(2).filter(|pair| pair[1].0 < pair[0].0 - 1e-4).count();
    }
    (wrong, all)
}

#[test]
fn a_coat_is_drawn_from_front_to_back() {
    let ball = sphere(Vec3::ZERO, 0.0);
    let order = Order::of(&[&ball], &frame(), 1, Show::default());
    let (backward, all) = wrong(&[&ball], &items(&order));
    println!("{backward} of {all} pairs come from back to front");
    assert!(all > 1000 && backward * 100 <= all, "{backward} of {all}");
    // The planted fault: shells of the near side from the innermost on.
    let mut planted = items(&order);
    planted.reverse();
    assert!(wrong(&[&ball], &planted).0 * 2 > all);
}

#[test]
fn a_near_limb_comes_before_what_is_behind_it() {
    // Along the view, a whole sphere apart.
    let to_eye = frame().eye.truncate().normalize();
    let (near, far) = (sphere(to_eye * 0.1, 0.0), sphere(to_eye * -0.1 + Vec3::X * 0.03, 0.0));
    let furs = [&near, &far];
    let order = items(&Order::of(&furs, &frame(), 1, Show::default()));
    let (mut both, mut over) = (0, 0);
    for ray in rays() {
        let met = met(frame().eye.truncate(), ray, &furs, &order);
        let pairs = met.windows(2).filter(|pair| pair[0].1 != pair[1].1);
        for pair in pairs {
            both += 1;
            over += usize::from(pair[0].1 == 0);
        }
    }
    println!("{over} of {both} times the near one comes first");
    assert!(both > 10 && over * 10 >= both * 9, "{over} of {both}");
}

#[test]
fn only_what_is_surely_hidden_is_left_out() {
    let (clear, dense) = (sphere(Vec3::ZERO, 0.0), sphere(Vec3::ZERO, 50.0));
    let [all, through, behind] = [
        items(&Order::all(&[&clear], &frame(), 1, false)),
        items(&Order::of(&[&clear], &frame(), 1, Show::default())),
        items(&Order::of(&[&dense], &frame(), 1, Show::default())),
    ];
    println!("{} face the eye, {} drawn, {} where hair is dense", all.len(), through.len(), behind.len());
    // Every near slab that rays meet before the skin is drawn.
    let eye = frame().eye.truncate();
    for ray in rays() {
        let near = |order: &[(usize, Item)]| {
            let mut met =
                met(eye, ray, &[&clear], &order.iter().copied().filter(|(_, item)| !item.far()).collect::<Vec<_>>());
            met.sort_by(|a, b| a.0.total_cmp(&b.0));
            met
        };
        assert_eq!(near(&all), near(&through));
    }
    // Of the far side, what shows beyond the outline.
    let far = through.iter().filter(|(_, item)| item.far()).count();
    assert!(far * 2 < through.len(), "{far} of {}", through.len());
    // Under dense hair, what lies deep and faces the eye is not drawn.
    let straight = |(_, item): &(usize, Item)| item.layer() < LAYERS / 2 && !item.far();
    let [deep, kept] = [&through, &behind].map(|order| order.iter().filter(|item| straight(item)).count());
    assert!(kept * 2 < deep, "{kept} of {deep}");
}

#[test]
fn parallel_rays_see_the_same() {
    let ball = sphere(Vec3::ZERO, 0.0);
    let perspective = frame();
    let to_eye = perspective.eye.truncate().normalize();
    let parallel = Frame { eye: Vec4::from((to_eye, 0.0)), ..frame() };
    let far_away = Frame { eye: Vec4::from((to_eye * 500.0, 1.0)), ..frame() };
    let drawn = |frame: &Frame| {
        let mut items = Order::of(&[&ball], frame, 1, Show::default()).items;
        items.sort();
        items
    };
    let [parallel, far_away] = [drawn(&parallel).len(), drawn(&far_away).len()];
    assert!(parallel.abs_diff(far_away) <= 10, "{parallel} and {far_away}");
}
