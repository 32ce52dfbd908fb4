//! Where skin that should be furred is seen with too little hair over it (`docs/steps/runtime.md`, "Bald skin").

use crate::math::{Vec3, Vec4};
use crate::runtime::{CoatMesh, DrawList, Picture, away_from_borders};
use std::borrow::Cow;

/// Less than this share of the hair that the model grows there is bald.
const BALD: f32 = 0.5;
/// Optical depth beyond which skin is not seen, and more hair changes nothing.
const UNSEEN: f32 = 4.0;
/// Share of a pixel's samples that must show furred skin, so that outlines do not count.
const WHOLE: f32 = 0.99;
/// Skin over which the model grows next to nothing is bare, not bald.
const LEAST: f32 = 0.05;

/// Colours of a picture of it: bald skin, skin with as much hair as there should be, everything else.
const COLOURS: [Vec3; 3] = [Vec3::new(0.8, 0.02, 0.02), Vec3::new(0.2, 0.45, 0.2), Vec3::splat(0.3)];

/// How much furred skin is seen, and how much of it is bald.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Baldness {
    /// Pixels of furred skin.
    pub furred: u64,
    /// Those of them with less than half of the hair over them that the model grows there.
    pub bald: u64,
}

impl Baldness {
    /// Counts in a picture of [`hair_over_skin`](crate::runtime::gpu::Prepared::hair_over_skin).
    pub fn of(hair: &Picture) -> Self {
        let mut count = Self::default();
        for share in hair.pixels.iter().filter_map(|pixel| share(*pixel)) {
            count.furred += 1;
            count.bald += u64::from(share < BALD);
        }
        count
    }

    /// Bald share of the furred skin, 0 where there is none.
    pub fn share(&self) -> f64 {
        self.bald as f64 / self.furred.max(1) as f64
    }
}

/// Hair over what there should be at a pixel; none where no furred skin is.
fn share([found, expected, furred, _]: [f32; 4]) -> Option<f32> {
    let expected = expected.min(UNSEEN);
    (furred > WHOLE && expected > LEAST).then(|| found / expected)
}

/// A picture of it: red where bald, the greener the more hair there is.
pub fn picture(hair: &Picture, alpha: &Picture) -> Picture {
    let colour = |(&pixel, shown): (&[f32; 4], &[f32; 4])| {
        let colour = match share(pixel) {
            Some(share) if share < BALD => COLOURS[0],
            Some(share) => COLOURS[2].lerp(COLOURS[1], (share - BALD).min(1.0)),
            None => COLOURS[2] * 0.5,
        };
        (colour * shown[3]).extend(shown[3]).to_array()
    };
    let pixels = hair.pixels.iter().zip(&alpha.pixels).map(colour).collect();
    Picture { size: hair.size, pixels, depth_m: alpha.depth_m.clone() }
}

/// `scene` with skin beside borders of the coat marked, as far as hair leans: it is left out, as hair that leans away from a
/// border leaves it as free as the model does.
pub fn marked<'a>(scene: &DrawList<'a>) -> DrawList<'a> {
    let away_m = away_from_borders(&scene.furs);
    let mark = |(fur, away_m): (&CoatMesh<'a>, Vec<f32>)| {
        let root = |(v, away_m): (usize, f32)| {
            let own = fur.root.get(v).copied().unwrap_or(Vec4::ZERO);
            let leans_m = fur.offsets_m[v].reject_from(fur.normals[v]).length();
            let near = 1.0 - away_m / leans_m.max(f32::MIN_POSITIVE);
            Vec4::new(near.clamp(-1e3, 1.0), 0.0, own.z, own.w)
        };
        let root: Vec<Vec4> = away_m.into_iter().enumerate().map(root).collect();
        CoatMesh { colour: None, root: Cow::from(root), ..fur.clone() }
    };
    DrawList { furs: scene.furs.iter().zip(away_m).map(mark).collect(), ..scene.clone() }
}
