//! Shells with one opacity for all views: what plain glTF can hold.

use crate::data::coat::ShellStack;
use crate::data::image::{Image8, linear_from_srgb, srgb_from_linear, unorm8};
use crate::data::shell::{HairMedium, depth_of_byte, gain_at, unorm};
use crate::math::Vec3;

/// The view, from the skin's normal, whose opacity is kept: about the mean over what faces a viewer.
const VIEW_DEG: f32 = 30.0;

/// Azimuths averaged over.
const AZIMUTHS: u32 = 4;

/// At most `count` images, inner to outer, each of several slabs in one: straight colour in sRGB coding and opacity. Before each the
/// height that it belongs at, over the stack's.
pub fn shells(stack: &ShellStack, height_m: f32, count: u32) -> Vec<(f32, Image8)> {
    let slabs = stack.layers - 1;
    let count = count.clamp(1, slabs);
    let of_shell = |shell: u32| {
        let (first, last) = (shell * slabs / count + 1, (shell + 1) * slabs / count);
        let mut image = Image8::new(stack.size, stack.size, 4);
        for texel in 0..(stack.size * stack.size) as usize {
            let colour = composite(stack, (first..=last).rev(), texel, height_m);
            image.pixels[4 * texel..][..4].copy_from_slice(&colour);
        }
        let [bottom, top] = [first as usize - 1, last as usize].map(|slab| stack.slabs.tops()[slab]);
        (0.5 * (bottom + top), image)
    };
    (0..count).map(of_shell).collect()
}

/// Slabs from the outermost, over one another.
fn composite(stack: &ShellStack, slabs: impl Iterator<Item = u32>, texel: usize, height_m: f32) -> [u8; 4] {
    let (mut colour, mut plain, mut clear, mut n) = (Vec3::ZERO, Vec3::ZERO, 1.0, 0.0);
    for slab in slabs {
        let albedo = &stack.albedo[0][slab as usize].pixels[4 * texel..][..3];
        let albedo = Vec3::from_array([0, 1, 2].map(|i| linear_from_srgb(unorm(albedo[i]))));
        let thickness_m = stack.slabs.thickness(slab as usize - 1) * height_m;
        let alpha = opacity(stack, slab as usize, texel, thickness_m);
        colour += clear * alpha * albedo;
        clear *= 1.0 - alpha;
        plain += albedo;
        n += 1.0;
    }
    let alpha = 1.0 - clear;
    let straight = if alpha > 1e-4 { colour / alpha } else { plain / n };
    let c = straight.to_array().map(|c| unorm8(srgb_from_linear(c.clamp(0.0, 1.0))));
    [c[0], c[1], c[2], unorm8(alpha)]
}

/// A slab's opacity by the coat's law at [`VIEW_DEG`], its mean over azimuths.
fn opacity(stack: &ShellStack, slab: usize, texel: usize, thickness_m: f32) -> f32 {
    let gain = gain_at(&stack.gains[0][slab], VIEW_DEG);
    let bytes = &stack.medium[0][slab].pixels[4 * texel..][..4];
    let medium = HairMedium::decode(bytes, stack.extinction_scales_per_m[0]);
    let kappa = depth_of_byte(stack.ends[0][slab].pixels[texel]);
    let angle = VIEW_DEG.to_radians();
    let clear: f32 = (0..AZIMUTHS)
        .map(|i| {
            let azimuth = std::f32::consts::TAU * i as f32 / AZIMUTHS as f32;
            let flat = libm::sinf(angle);
            let ray = Vec3::new(flat * libm::cosf(azimuth), flat * libm::sinf(azimuth), libm::cosf(angle));
            libm::expf(-gain * (medium.upright(ray) * thickness_m / ray.z + kappa))
        })
        .sum();
    1.0 - clear / AZIMUTHS as f32
}
