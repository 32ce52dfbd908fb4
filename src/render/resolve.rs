//! Guard hair, undercoat and skin of one pixel into one colour (Andersen et al. 2016 §3.3, `docs/steps/blend.md`).

use super::strands::Fragment;
use crate::math::Vec3;
use crate::math::fast::exp_negative;

/// Transmittance below which nothing behind can be seen.
pub const OPAQUE: f32 = 1e-3;

/// How undercoat and guard hair are put into one order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Blending {
    /// Each march through undercoat is kept as up to this many virtual fragments, 1 to 64, each with its extent in depth: a
    /// hair inside one is attenuated by the part in front of it.
    Virtual {
        /// Most virtual fragments per march.
        fragments: u32,
    },
    /// One fragment where the ray enters, less opaque the closer guard hairs lie behind it (equation (4)).
    Simplified {
        /// The attenuation a, 1/m.
        attenuation_per_m: f32,
    },
}

/// A stretch of a ray through undercoat: a virtual fragment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stretch {
    /// Depth where it begins, m.
    pub from_m: f32,
    /// Depth where it ends, m.
    pub to_m: f32,
    /// Optical depth.
    pub depth: f32,
    /// Mean radiance, weighted by what is seen, linear RGB.
    pub radiance: Vec3,
    /// Mean colour.
    pub albedo: Vec3,
    /// Mean hair direction.
    pub tangent: Vec3,
}

/// What a thing of full opacity looks like.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Face {
    /// Depth along the optical axis, m.
    pub z_m: f32,
    /// Radiance, linear RGB.
    pub radiance: Vec3,
    /// Diffuse colour.
    pub albedo: Vec3,
    /// Direction of the hair, or zero.
    pub tangent: Vec3,
    /// Normal of the skin, or zero.
    pub normal: Vec3,
}

/// What one pixel shows; all but `alpha` is premultiplied.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pixel {
    /// Radiance, linear RGB.
    pub radiance: Vec3,
    /// Diffuse colour.
    pub albedo: Vec3,
    /// Hair direction.
    pub tangent: Vec3,
    /// Skin normal.
    pub normal: Vec3,
    /// 1 − transmittance.
    pub alpha: f32,
    /// Depth, m.
    pub z_m: f32,
    /// Part of alpha from guard hair.
    pub guard: f32,
    /// Part of alpha from undercoat.
    pub undercoat: f32,
}

/// Which layer a contribution belongs to.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Guard,
    Undercoat,
    Skin,
}

struct Front {
    pixel: Pixel,
    through: f32,
}

impl Front {
    fn add(&mut self, alpha: f32, face: &Face, kind: Kind) {
        let weight = self.through * alpha;
        self.pixel.radiance += weight * face.radiance;
        self.pixel.albedo += weight * face.albedo;
        self.pixel.tangent += weight * face.tangent;
        self.pixel.normal += weight * face.normal;
        self.pixel.z_m += weight * face.z_m;
        match kind {
            Kind::Guard => self.pixel.guard += weight,
            Kind::Undercoat => self.pixel.undercoat += weight,
            Kind::Skin => {}
        }
        self.through -= weight;
    }

    /// The part of a stretch between two depths.
    fn add_part(&mut self, stretch: &Stretch, from_m: f32, to_m: f32) {
        let extent = stretch.to_m - stretch.from_m;
        let share = if extent > 0.0 { (to_m - from_m) / extent } else { 1.0 };
        let alpha = 1.0 - exp_negative(-stretch.depth * share);
        let face = Face {
            z_m: 0.5 * (from_m + to_m),
            radiance: stretch.radiance,
            albedo: stretch.albedo,
            tangent: stretch.tangent,
            normal: Vec3::ZERO,
        };
        self.add(alpha, &face, Kind::Undercoat);
    }
}

/// Orders a pixel's fragments by (depth, id) and joins neighbouring pieces of one hair: together they cover it once.
pub fn order(fragments: &mut Vec<Fragment>) {
    fragments.sort_unstable_by_key(Fragment::order);
    fragments.dedup_by(|next, kept| {
        let same = next.id() == kept.id();
        if same {
            kept.coverage = (kept.coverage + next.coverage).min(1.0);
        }
        same
    });
}

/// Orders a pixel's fragments and leaves out those that lie behind an opaque front; returns the depth from which on
/// everything does, infinite where there is none. What is left out could not be seen whatever else comes in front.
pub fn trim(fragments: &mut Vec<Fragment>, opacity: impl Fn(&Fragment) -> f32) -> f32 {
    fragments.sort_unstable_by_key(Fragment::order);
    let mut through = 1.0;
    let seen = fragments.iter().position(|fragment| {
        through *= 1.0 - fragment.coverage * opacity(fragment);
        through < 0.1 * OPAQUE
    });
    match seen {
        Some(last) => {
            fragments.truncate(last + 1);
            fragments[last].z_m()
        }
        None => f32::INFINITY,
    }
}

/// Composites front to back. `fragments` are ordered by [`order`], `stretches` by where they begin; `face` says what a
/// fragment's hair looks like and how opaque it is itself; `skin` lies behind all.
pub fn composite(
    fragments: &[Fragment],
    stretches: &[Stretch],
    blending: Blending,
    skin: Option<&Face>,
    face: impl Fn(&Fragment) -> (Face, f32),
) -> Pixel {
    let mut front = Front { pixel: Pixel::default(), through: 1.0 };
    let mut next = 0;
    let hair = |front: &mut Front, fragment: &Fragment| {
        let (look, opacity) = face(fragment);
        front.add(fragment.coverage * opacity, &look, Kind::Guard);
    };
    for stretch in stretches {
        if front.through < OPAQUE {
            break;
        }
        while next < fragments.len() && fragments[next].z_m() <= stretch.from_m && front.through >= OPAQUE {
            hair(&mut front, &fragments[next]);
            next += 1;
        }
        match blending {
            Blending::Virtual { .. } => {
                let mut from_m = stretch.from_m;
                while next < fragments.len() && fragments[next].z_m() < stretch.to_m && front.through >= OPAQUE {
                    let to_m = fragments[next].z_m().max(from_m);
                    front.add_part(stretch, from_m, to_m);
                    hair(&mut front, &fragments[next]);
                    from_m = to_m;
                    next += 1;
                }
                if stretch.to_m > from_m || stretch.from_m == stretch.to_m {
                    front.add_part(stretch, from_m, stretch.to_m);
                }
            }
            Blending::Simplified { attenuation_per_m } => {
                let mut alpha = 1.0 - exp_negative(-stretch.depth);
                let mut unoccluded = 1.0;
                for fragment in &fragments[next..] {
                    if unoccluded < OPAQUE || alpha <= 0.0 {
                        break;
                    }
                    // Weighted by the fragment's own opacity, so that a hair's thinner share of a pixel takes less.
                    let own = fragment.coverage * face(fragment).1 * unoccluded;
                    alpha -= own * exp_negative(-attenuation_per_m * (fragment.z_m() - stretch.from_m));
                    unoccluded -= own;
                }
                let look = Face {
                    z_m: stretch.from_m,
                    radiance: stretch.radiance,
                    albedo: stretch.albedo,
                    tangent: stretch.tangent,
                    normal: Vec3::ZERO,
                };
                front.add(alpha.max(0.0), &look, Kind::Undercoat);
            }
        }
    }
    for fragment in &fragments[next..] {
        if front.through < OPAQUE {
            break;
        }
        hair(&mut front, fragment);
    }
    if let Some(skin) = skin {
        front.add(1.0, skin, Kind::Skin);
    }
    if front.through < OPAQUE {
        front.through = 0.0;
    }
    front.pixel.alpha = 1.0 - front.through;
    front.pixel
}
