//! Guard hair, undercoat and skin of one pixel into one colour (Andersen et al. 2016 §3.3, `docs/steps/blend.md`).

use super::strands::Fragment;
use crate::data::film::Layers;
use crate::math::Vec3;
use crate::math::fast::exp_negative;

/// Transmittance of fragments behind which further ones are left out, over that which counts as opaque: room for rounding.
pub const HIDDEN: f32 = 0.9;

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

/// A virtual fragment: an interval of a ray through undercoat.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VirtualFragment {
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
pub struct Appearance {
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
enum FragmentKind {
    Guard,
    Undercoat,
    Skin,
}

/// What is in front so far; of `ALL` layers, or of radiance and alpha alone.
struct Front<const ALL: bool> {
    pixel: Pixel,
    through: f32,
}

impl<const ALL: bool> Front<ALL> {
    #[inline(always)]
    fn add(&mut self, alpha: f32, face: &Appearance, kind: FragmentKind) {
        let weight = self.through * alpha;
        self.pixel.radiance += weight * face.radiance;
        self.through -= weight;
        if ALL {
            self.pixel.albedo += weight * face.albedo;
            self.pixel.tangent += weight * face.tangent;
            self.pixel.normal += weight * face.normal;
            self.pixel.z_m += weight * face.z_m;
            match kind {
                FragmentKind::Guard => self.pixel.guard += weight,
                FragmentKind::Undercoat => self.pixel.undercoat += weight,
                FragmentKind::Skin => {}
            }
        }
    }

    /// Lets what is in front stand for what little is seen through it.
    fn fill(&mut self) {
        let scale = 1.0 / (1.0 - self.through);
        let pixel = &mut self.pixel;
        for value in [&mut pixel.radiance, &mut pixel.albedo, &mut pixel.tangent, &mut pixel.normal] {
            *value *= scale;
        }
        for value in [&mut pixel.z_m, &mut pixel.guard, &mut pixel.undercoat] {
            *value *= scale;
        }
        self.through = 0.0;
    }

    /// The part of a virtual fragment between two depths.
    #[inline(always)]
    fn add_part(&mut self, virtual_fragment: &VirtualFragment, from_m: f32, to_m: f32) {
        let extent = virtual_fragment.to_m - virtual_fragment.from_m;
        let share = if extent > 0.0 { (to_m - from_m) / extent } else { 1.0 };
        let alpha = 1.0 - exp_negative(-virtual_fragment.depth * share);
        let face = Appearance {
            z_m: 0.5 * (from_m + to_m),
            radiance: virtual_fragment.radiance,
            albedo: virtual_fragment.albedo,
            tangent: virtual_fragment.tangent,
            normal: Vec3::ZERO,
        };
        self.add(alpha, &face, FragmentKind::Undercoat);
    }
}

/// Orders a pixel's fragments by (depth, id), joins neighbouring segments of one hair, since together they cover it once, and
/// leaves out what lies behind a front of transmittance `hidden`: it could not be seen whatever else comes before it.
///
/// Returns how many are left. `veil` receives the transmittance up to and with each of them.
pub fn settle(fragments: &mut [Fragment], veil: &mut [f32], hidden: f32) -> usize {
    sort(fragments);
    let (mut count, mut before, mut through) = (0, 1.0, 1.0);
    for i in 0..fragments.len() {
        let fragment = fragments[i];
        if count > 0 && fragments[count - 1].id() == fragment.id() {
            fragments[count - 1].join(&fragment);
        } else {
            if through < hidden {
                break;
            }
            fragments[count] = fragment;
            count += 1;
            before = through;
        }
        through = before * (1.0 - fragments[count - 1].alpha());
        veil[count - 1] = through;
    }
    count
}

/// By [`Fragment::order`]. Few that are nearly in order, as most pixels have them, are best moved one by one.
fn sort(fragments: &mut [Fragment]) {
    const FEW: usize = 96;
    if fragments.len() > FEW {
        fragments.sort_unstable_by_key(Fragment::order);
        return;
    }
    for i in 1..fragments.len() {
        let fragment = fragments[i];
        let mut at = i;
        // Those of one place are in the order of drawing.
        while at > 0 && fragments[at - 1].order().0 > fragment.order().0 {
            fragments[at] = fragments[at - 1];
            at -= 1;
        }
        fragments[at] = fragment;
    }
}

/// Composites front to back. `fragments` are ordered by [`settle`], `virtual_fragments` by where they begin; `face` says what a
/// fragment's hair looks like, `skin` what lies behind all. Behind a front that lets through less than `opaque` nothing is looked at:
/// the front stands for it. [`Layers::Light`] leaves out what it does not hold.
#[inline(always)]
pub fn composite(
    layers: Layers,
    fragments: &[Fragment],
    virtual_fragments: &[VirtualFragment],
    blending: Blending,
    opaque: f32,
    skin: impl FnOnce() -> Option<Appearance>,
    face: impl Fn(&Fragment) -> Appearance,
) -> Pixel {
    match layers {
        Layers::Light => blend::<false>(fragments, virtual_fragments, blending, opaque, skin, face),
        Layers::LightAndDepth | Layers::All => {
            blend::<true>(fragments, virtual_fragments, blending, opaque, skin, face)
        }
    }
}

#[inline(always)]
fn blend<const ALL: bool>(
    fragments: &[Fragment],
    virtual_fragments: &[VirtualFragment],
    blending: Blending,
    opaque: f32,
    skin: impl FnOnce() -> Option<Appearance>,
    face: impl Fn(&Fragment) -> Appearance,
) -> Pixel {
    let mut front = Front::<ALL> { pixel: Pixel::default(), through: 1.0 };
    let mut next = 0;
    let hair = |front: &mut Front<ALL>, fragment: &Fragment| {
        front.add(fragment.alpha(), &face(fragment), FragmentKind::Guard);
    };
    for virtual_fragment in virtual_fragments {
        if front.through < opaque {
            break;
        }
        while next < fragments.len() && fragments[next].z_m() <= virtual_fragment.from_m && front.through >= opaque {
            hair(&mut front, &fragments[next]);
            next += 1;
        }
        match blending {
            Blending::Virtual { .. } => {
                let mut from_m = virtual_fragment.from_m;
                while next < fragments.len() && fragments[next].z_m() < virtual_fragment.to_m && front.through >= opaque
                {
                    let to_m = fragments[next].z_m().max(from_m);
                    front.add_part(virtual_fragment, from_m, to_m);
                    hair(&mut front, &fragments[next]);
                    from_m = to_m;
                    next += 1;
                }
                if virtual_fragment.to_m > from_m || virtual_fragment.from_m == virtual_fragment.to_m {
                    front.add_part(virtual_fragment, from_m, virtual_fragment.to_m);
                }
            }
            Blending::Simplified { attenuation_per_m } => {
                let mut alpha = 1.0 - exp_negative(-virtual_fragment.depth);
                let mut unoccluded = 1.0;
                for fragment in &fragments[next..] {
                    if unoccluded < opaque || alpha <= 0.0 {
                        break;
                    }
                    // Weighted by the fragment's own opacity, so that a hair's thinner share of a pixel takes less.
                    let own = fragment.alpha() * unoccluded;
                    alpha -= own * exp_negative(-attenuation_per_m * (fragment.z_m() - virtual_fragment.from_m));
                    unoccluded -= own;
                }
                let appearance = Appearance {
                    z_m: virtual_fragment.from_m,
                    radiance: virtual_fragment.radiance,
                    albedo: virtual_fragment.albedo,
                    tangent: virtual_fragment.tangent,
                    normal: Vec3::ZERO,
                };
                front.add(alpha.max(0.0), &appearance, FragmentKind::Undercoat);
            }
        }
    }
    for fragment in &fragments[next..] {
        if front.through < opaque {
            break;
        }
        hair(&mut front, fragment);
    }
    if front.through < opaque {
        front.fill();
    } else if let Some(skin) = skin() {
        front.add(1.0, &skin, FragmentKind::Skin);
    }
    front.pixel.alpha = 1.0 - front.through;
    front.pixel
}
