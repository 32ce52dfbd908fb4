//! Rays from the eye through undercoat, gathered into virtual fragments.

use super::gather::Gathered;
use crate::data::film::Layers;
use crate::hybrid::resolve::VirtualFragment;
use crate::hybrid::strands::Fragment;
use crate::hybrid::undercoat_light::UndercoatShader;
use crate::math::Vec3;
use crate::math::lanes::{self, F32s, Isa, MOST, Mask, Row, Vec3Row, Vec3s, Work};
use crate::volume::march::shadows::Shadows;
use crate::volume::march::{MOST_STEP_GROWTH, MarchRay, MarchSteps, MarchVisitor, Stepping, march};
use crate::volume::shell::lattice::Lattices;
use crate::volume::shell::prisms::Prisms;

/// A ray of a pixel, and where its depths are measured along the optical axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct PixelRay {
    /// Pixel of the tile.
    pub(super) pixel: u32,
    /// Depth along the optical axis per distance along the ray.
    pub(super) z_per_m: f32,
    pub(super) march_ray: MarchRay,
}

/// Follows the rays of a tile; gives the number of steps.
pub(super) struct EyeRays<'a> {
    pub(super) shadows: &'a Shadows<'a>,
    pub(super) shader: &'a UndercoatShader<'a>,
    pub(super) stepping: &'a Stepping,
    /// Most virtual fragments per ray.
    pub(super) fragments: u32,
    /// Transmittance below which what is behind is not looked at.
    pub(super) opaque: f32,
    pub(super) rays: &'a [PixelRay],
    /// Guard hair, where what it hides is to be left out.
    pub(super) veiled: Option<&'a Gathered>,
    /// Virtual fragments by pixel.
    pub(super) virtual_fragments: &'a mut [Vec<VirtualFragment>],
    /// By pixel, depth from which on no undercoat is seen, m.
    pub(super) opaque_m: &'a mut [f32],
    /// What virtual fragments are to tell; of [`Layers::Light`], colour and direction are left out.
    pub(super) layers: Layers,
}

impl Work for EyeRays<'_> {
    type Output = u64;

    #[inline(always)]
    fn run<I: Isa>(self) -> u64 {
        match self.layers {
            Layers::Light => self.follow::<I, false>(),
            Layers::LightAndDepth | Layers::All => self.follow::<I, true>(),
        }
    }
}

impl EyeRays<'_> {
    #[inline(always)]
    fn follow<I: Isa, const ALL: bool>(self) -> u64 {
        let Some(&first) = self.rays.first() else { return 0 };
        let (volume, stepping) = (self.shadows.volume, self.stepping);
        let mut walk = EyeWalk::<ALL> {
            shadows: Lattices::new(volume.layers()),
            fragments: self.fragments.clamp(1, 64) as f32,
            next: 0,
            current: [first; MOST],
            through: Row::default(),
            veil: Row::default(),
            hairs: [(&[], &[]); MOST],
            groups: Groups::default(),
            step_count: 0,
            rays: self,
        };
        march::<I, _>(volume, stepping, &mut walk);
        walk.step_count
    }
}

/// What rays from the eye have gathered; of `ALL` layers, or of light alone.
struct EyeWalk<'a, const ALL: bool> {
    rays: EyeRays<'a>,
    next: usize,
    current: [PixelRay; MOST],
    shadows: Lattices<'a>,
    fragments: f32,
    through: Row,
    /// Transmittance of the guard hair passed so far.
    veil: Row,
    /// Guard hair not yet passed, and its transmittances.
    hairs: [(&'a [Fragment], &'a [f32]); MOST],
    groups: Groups,
    step_count: u64,
}

/// Steps on their way to become one virtual fragment, in each lane.
#[derive(Clone, Copy, Debug, Default)]
struct Groups {
    from_m: Row,
    to_m: Row,
    depth: Row,
    weight: Row,
    radiance: Vec3Row,
    albedo: Vec3Row,
    tangent: Vec3Row,
}

impl<const ALL: bool> EyeWalk<'_, ALL> {
    /// Takes account of the guard hairs that the ray in a lane has passed.
    #[inline(always)]
    fn pass_hairs(&mut self, lane: usize) {
        let z_m = self.groups.to_m.0[lane] * self.current[lane].z_per_m;
        let (fragments, veil) = self.hairs[lane];
        let mut passed = 0;
        while passed < fragments.len() && fragments[passed].z_m() < z_m {
            passed += 1;
        }
        if passed > 0 {
            self.veil.0[lane] = veil[passed - 1];
            self.hairs[lane] = (&fragments[passed..], &veil[passed..]);
        }
    }

    /// Closes the virtual fragment of a lane.
    fn close(&mut self, lane: usize) {
        let groups = &mut self.groups;
        let scale = 1.0 / groups.weight.0[lane];
        let PixelRay { pixel, z_per_m, .. } = self.current[lane];
        if groups.depth.0[lane] > 0.0 && scale.is_finite() {
            self.rays.virtual_fragments[pixel as usize].push(VirtualFragment {
                from_m: groups.from_m.0[lane] * z_per_m,
                to_m: groups.to_m.0[lane] * z_per_m,
                depth: groups.depth.0[lane],
                radiance: groups.radiance.lane(lane) * scale,
                albedo: if ALL { groups.albedo.lane(lane) * scale } else { Vec3::ZERO },
                tangent: if ALL { groups.tangent.lane(lane) * scale } else { Vec3::ZERO },
            });
        }
        groups.depth.0[lane] = 0.0;
        groups.weight.0[lane] = 0.0;
        groups.radiance.set(lane, Vec3::ZERO);
        if ALL {
            groups.albedo.set(lane, Vec3::ZERO);
            groups.tangent.set(lane, Vec3::ZERO);
        }
    }
}

impl<I: Isa, const ALL: bool> MarchVisitor<I> for EyeWalk<'_, ALL> {
    #[inline(always)]
    fn next(&mut self, lane: usize) -> Option<MarchRay> {
        let current = *self.rays.rays.get(self.next)?;
        self.next += 1;
        self.current[lane] = current;
        self.through.0[lane] = 1.0;
        self.veil.0[lane] = 1.0;
        if let Some(guard) = self.rays.veiled {
            let pixel = current.pixel as usize;
            self.hairs[lane] = (guard.of(pixel), guard.veil(pixel));
            // Asked for after a step or more.
            guard.of(pixel).iter().step_by(4).for_each(lanes::prefetch);
            guard.veil(pixel).iter().step_by(16).for_each(lanes::prefetch);
        }
        Some(current.march_ray)
    }

    #[inline(always)]
    fn step_scale(&self) -> F32s<I> {
        // A step's error grows as the square of its depth, and counts as what is left of the ray.
        (F32s::splat(1.0) / F32s::of(&self.through)).sqrt().within(1.0, MOST_STEP_GROWTH)
    }

    #[inline(always)]
    fn enter(&mut self, lane: usize, triangle: u32) {
        self.shadows.set(lane, self.rays.shadows.lattice(triangle));
    }

    #[inline(always)]
    fn visit(&mut self, prisms: &Prisms, steps: &MarchSteps<I>, on: Mask<I>) -> Mask<I> {
        let one = F32s::splat(1.0);
        let content = self.rays.shadows.volume.content;
        let shadow = self.shadows.at(steps.b, content.level(steps.t));
        let (albedo, radiance) = self.rays.shader.shade(content, prisms, steps, shadow);
        let through = F32s::of(&self.through);
        let left = through * on.select((-steps.depth).exp_negative(), one);
        let weight = through - left;
        let groups = &mut self.groups;
        let depth = F32s::of(&groups.depth);
        let first = on & !depth.gt(F32s::splat(0.0));
        groups.from_m = first.select(steps.from_m, F32s::of(&groups.from_m)).row();
        groups.to_m = on.select(steps.from_m + steps.length_m, F32s::of(&groups.to_m)).row();
        groups.depth = (depth + on.keep(steps.depth)).row();
        groups.weight = (F32s::of(&groups.weight) + on.keep(weight)).row();
        groups.radiance = (Vec3s::of(&groups.radiance) + (radiance * weight).keep(on)).rows();
        if ALL {
            groups.albedo = (Vec3s::of(&groups.albedo) + (albedo * weight).keep(on)).rows();
            groups.tangent = (Vec3s::of(&groups.tangent) + (steps.hair * weight).keep(on)).rows();
        }
        // A new virtual fragment at equal parts of what the ray loses in the end.
        let part_after = ((one - left) * self.fragments).floor();
        let part_before = ((one - through) * self.fragments).floor();
        let full = (on & part_after.gt(part_before)).bits();
        self.through = left.row();
        self.step_count += u64::from(on.bits().count_ones());
        for lane in 0..I::LANES {
            if full >> lane & 1 != 0 {
                self.close(lane);
            }
        }
        if self.rays.veiled.is_some() {
            let on = on.bits();
            for lane in 0..I::LANES {
                if on >> lane & 1 != 0 {
                    self.pass_hairs(lane);
                }
            }
        }
        (left * F32s::of(&self.veil)).gt(F32s::splat(self.rays.opaque))
    }

    fn end(&mut self, lane: usize) {
        self.close(lane);
        let PixelRay { pixel, z_per_m, .. } = self.current[lane];
        if self.through.0[lane] * self.veil.0[lane] <= self.rays.opaque {
            let opaque_m = &mut self.rays.opaque_m[pixel as usize];
            *opaque_m = opaque_m.min(self.groups.to_m.0[lane] * z_per_m);
        }
    }
}
