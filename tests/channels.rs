//! Channels of a picture beside the coat itself: what each shows is what there is.

use crate::coats;
use crate::viewer::dressed;
use furrier::asset::{self, Asset};
use furrier::data::coat::{Coat, Level};
use furrier::data::shell::{MOST_ABOVE, above_of};
use furrier::math::Vec3;
use furrier::stage::camera::{Orbit, Viewpoint};
use furrier::stage::options;
use furrier::viewer::{self, CHANNELS, Channel, Chart, Shot, Shown, ViewOptions, parse_show};

const SIZE: u32 = 96;

fn ball() -> (Asset, Coat) {
    let asset = asset::load("sample:sphere").unwrap();
    let coat = dressed(&asset, coats::tile(&coats::fox()[..1], 0.008, 4, 32, 1));
    (asset, coat)
}

fn shot(asset: &Asset, coat: &Coat, show: Shown, level: Option<usize>) -> Shot {
    let viewpoint = Viewpoint::Orbit(Orbit { azimuth_deg: 20.0, elevation_deg: 10.0, distance: 1.0 });
    let stage = options::Options { size: [SIZE; 2], viewpoint, ..options::Options::default() };
    viewer::screenshot(asset, coat, &ViewOptions { stage, show, level, ..ViewOptions::default() }).unwrap()
}

fn channel(asset: &Asset, coat: &Coat, channel: Channel) -> Shot {
    shot(asset, coat, Shown::Channel(channel), None)
}

/// `coat` as dense as said.
fn thinned(coat: &Coat, density: f32) -> Coat {
    let mut coat = coat.clone();
    coat.primitives.iter_mut().flat_map(|worn| &mut worn.tint).for_each(|tint| tint.w = density);
    coat
}

/// Pixels well within the ball: the middle ninth.
fn middle(shot: &Shot) -> impl Iterator<Item = [f32; 4]> {
    let third = (SIZE / 3) as usize;
    let rows = shot.picture.pixels.chunks_exact(SIZE as usize).skip(third).take(third);
    rows.flat_map(move |row| row[third..2 * third].to_vec())
}

#[test]
fn every_channel_has_a_name_and_what_is_measured_a_legend() {
    let (asset, coat) = ball();
    for (name, shown) in CHANNELS {
        assert_eq!(parse_show(name).unwrap(), shown);
        if !matches!(shown, Shown::Coat(_)) {
            assert!(!shot(&asset, &coat, shown, None).legend.is_empty(), "{name}");
            assert!(parse_show(&format!("skin,{name}")).unwrap_err().expected.unwrap().contains("alone"), "{name}");
        }
    }
    assert!(parse_show("bones").unwrap_err().expected.unwrap().contains("transmittance"));
}

#[test]
fn colours_of_tangents_are_where_hair_points() {
    let (asset, mut coat) = ball();
    for (towards, wanted) in [(Vec3::Y, [0.5, 1.0, 0.5]), (Vec3::new(-0.6, 0.0, 0.8), [0.2, 0.5, 0.9])] {
        for worn in &mut coat.primitives {
            let part =
                asset.parts.iter().find(|part| (part.mesh, part.primitive) == (worn.mesh, worn.primitive)).unwrap();
            for (offset, &v) in worn.offset.iter_mut().zip(&worn.base_vertex) {
                *offset = part.local_offset(v as usize, towards * 0.01, 1.0);
            }
        }
        let shot = shot(&asset, &coat, Shown::Chart(Chart::Tangents), None);
        for pixel in middle(&shot) {
            let far = (0..3).map(|i| (pixel[i] - wanted[i]).abs()).fold(0.0, f32::max);
            assert!(far < 2e-3, "{pixel:?}, not {wanted:?}");
        }
    }
}

#[test]
fn opacity_is_what_hair_hides() {
    let (asset, coat) = ball();
    let [none, thin, twice] =
        [0.0, 0.05, 0.1].map(|density| channel(&asset, &thinned(&coat, density), Channel::Opacity));
    assert!(middle(&none).all(|pixel| pixel == [0.0, 0.0, 0.0, 1.0]));
    assert!(none.legend[0].contains("hides 0.0 %"), "{:?}", none.legend);
    // Depths add up: twice as much hair lets through the square of what half of it does.
    for (thin, twice) in middle(&thin).zip(middle(&twice)) {
        assert!((twice[0] - (1.0 - (1.0 - thin[0]).powi(2))).abs() < 0.02, "{thin:?} {twice:?}");
    }
    let mean = |shot: &Shot| middle(shot).map(|pixel| pixel[0]).sum::<f32>() / middle(shot).count() as f32;
    assert!(mean(&thin) > 0.02 && mean(&twice) < 0.95, "{} {}", mean(&thin), mean(&twice));
}

#[test]
fn transmittance_is_that_of_the_tile() {
    let (asset, coat) = ball();
    let [bare, thin, twice] =
        [0.0, 0.5, 1.0].map(|density| channel(&asset, &thinned(&coat, density), Channel::Transmittance));
    assert!(middle(&bare).all(|pixel| pixel == [1.0; 4]));
    // What the tile says of the skin, layer 0: its least and its most.
    let alphas = || coat.tiles[0].shells.albedo[0][0].pixels.chunks_exact(4).map(|texel| above_of(texel[3]));
    let (least, most) = (alphas().fold(f32::INFINITY, f32::min), alphas().fold(0.0, f32::max));
    assert!(most > 0.5, "{most}");
    for (thin, twice) in middle(&thin).zip(middle(&twice)) {
        let [a, b] = [thin[0], twice[0]].map(|grey| (1.0 - grey) * MOST_ABOVE);
        assert!((2.0 * a - b).abs() < 0.02 * b + 0.02, "{a} {b}");
        assert!(a > 0.5 * least - 0.02 && a < 0.5 * most + 0.02, "{a}, of {least} to {most}");
    }
    println!("{:?}", thin.legend);
}

#[test]
fn colours_of_levels_are_those_that_are_drawn() {
    let (asset, mut coat) = ball();
    let tile = &mut coat.tiles[0];
    let coarse = |most_px| Level { shells: tile.shells.clone(), undercoat_share: Vec::new(), most_px };
    tile.levels = vec![coarse(1e6), coarse(1e-3)];
    let redness = |shot: &Shot| {
        let all = middle(shot).map(|pixel| pixel[0] / pixel[1]);
        all.fold([f32::INFINITY, 0.0], |[low, high], x| [low.min(x), high.max(x)])
    };
    // Red, yellow, green; what shines is whiter.
    let [finest, by_size, coarsest] =
        [Some(0), None, Some(2)].map(|level| shot(&asset, &coat, Shown::Channel(Channel::Levels), level));
    assert!(redness(&finest)[0] > 3.0, "{:?}", redness(&finest));
    assert!(redness(&by_size)[0] > 1.0 && redness(&by_size)[1] < 2.0, "{:?}", redness(&by_size));
    assert!(redness(&coarsest)[1] < 0.9, "{:?}", redness(&coarsest));
    assert_eq!(by_size.legend[0], "levels of detail, the finest first: 0 red, 1 yellow, 2 green");
    assert!(by_size.legend[1].contains("level 1.00"), "{:?}", by_size.legend);
}

#[test]
fn lines_of_the_mesh_are_over_the_picture_where_nothing_hides_them() {
    let (asset, mut coat) = ball();
    let plain = shot(&asset, &coat, Shown::default(), None);
    let lined = channel(&asset, &coat, Channel::Wireframe);
    let count = |shot: &Shot, wanted: fn(&[f32; 4]) -> bool| shot.picture.pixels.iter().filter(|p| wanted(p)).count();
    let light_blue = |pixel: &[f32; 4]| pixel[2] > 0.6 && pixel[0] < 0.3;
    let dark_blue = |pixel: &[f32; 4]| pixel[2] > 2.0 * pixel[0] && pixel[2] < 0.35 && pixel[3] > 0.9;
    assert_eq!(count(&plain, light_blue) + count(&plain, dark_blue), 0);
    assert!(count(&lined, light_blue) > 100, "{:?}", lined.legend);
    let same = plain.picture.pixels.iter().zip(&lined.picture.pixels).filter(|(a, b)| a == b).count();
    assert!(same > 500, "all is lines");
    // A shell inside the body shows its other half, behind the skin.
    coat.primitives.iter_mut().flat_map(|worn| &mut worn.offset).for_each(|offset| *offset *= -1.0);
    let inside = channel(&asset, &coat, Channel::Wireframe);
    assert!(!inside.legend[0].contains(" 0 of the coat's"), "{:?}", inside.legend);
    assert_eq!(count(&inside, light_blue), 0);
    assert!(count(&inside, dark_blue) > 50, "{}", count(&inside, dark_blue));
}
