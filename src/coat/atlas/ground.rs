//! Undercoat of the skin, laid into a chart: it stands over its roots there, whatever its lean and length.

use super::chart_region::{ChartRegion, ChartTriangle};
use super::flatten::axes;
use crate::coat::shells::deposit::Voxels;
use crate::coat::shells::undercoat::Profile;
use crate::data::fields::Fields;
use crate::data::mesh::Mesh;
use crate::fur::groom::clump::Nearby;
use crate::fur::undercoat::Undercoat;
use crate::math::lanes::{self, F32s, Isa, Row, Vec3Row, Vec3s};
use crate::math::{Vec2, Vec3};

/// Heights between which crowding is taken as the nearest's.
const LAYERS: usize = 16;
/// Most places along a texel's edge that are looked at.
const MOST_PLACES: f32 = 4.0;

/// A skin that undercoat grows on.
pub struct Ground<'a> {
    mesh: &'a Mesh,
    fields: &'a Fields,
    normals: Vec<Vec3>,
    undercoat: Undercoat,
}

/// What stands on a place.
#[derive(Clone, Copy)]
struct Stand {
    texel: usize,
    /// Hairs per area of the chart over the preset's density, without crowding.
    density: f32,
    tint: Vec3,
    root_m: Vec3,
    normal: Vec3,
    clump: f32,
    /// Length over that of the offset.
    share: f32,
}

/// Sums over a texel's places.
#[derive(Clone, Copy, Default)]
struct Sum {
    count: f32,
    density: f32,
    tint: Vec3,
    /// Density with crowding, by height.
    by_height: [f32; LAYERS],
}

impl<'a> Ground<'a> {
    /// Of a skin and its undercoat.
    pub fn new(mesh: &'a Mesh, fields: &'a Fields, undercoat: Undercoat) -> Self {
        Self { mesh, fields, normals: mesh.smooth_normals(), undercoat }
    }

    /// Adds the undercoat over a region's texels, each the mean over what of it is skin.
    pub fn add(&self, region: &ChartRegion, profile: &Profile, voxels: &mut Voxels, ends: &mut [f32]) {
        let layout = voxels.layout.clone();
        let width = layout.size[0];
        let across = (2.0 * layout.texel_m / self.undercoat.detail_m()).ceil().clamp(1.0, MOST_PLACES) as usize;
        for y in 0..layout.size[1] {
            let place = |i: usize| {
                let (texel, within) = (i / (across * across), i % (across * across));
                let within = Vec2::new((within % across) as f32, (within / across) as f32) + 0.5;
                let at = Vec2::new(texel as f32, y as f32) + within / across as f32;
                self.stand(texel, &region.placed[region.at(at)?], at, layout.texel_m)
            };
            let stands: Vec<Stand> = (0..width * across * across).filter_map(place).collect();
            let sums = lanes::run(Crowd { undercoat: &self.undercoat, stands: &stands, width });
            for (x, sum) in sums.into_iter().enumerate().filter(|(_, sum)| sum.density > 0.0) {
                profile.fill(voxels, ends, y * width + x, sum.tint / sum.density, |part| {
                    sum.by_height[((part.t * LAYERS as f32) as usize).min(LAYERS - 1)] / sum.count
                });
            }
        }
    }

    /// What stands at a point of a placed triangle, in texels of its region.
    fn stand(&self, texel: usize, placed: &ChartTriangle, at: Vec2, texel_m: f32) -> Option<Stand> {
        let Self { mesh, fields, .. } = self;
        let corners_m = mesh.corners_m(placed.triangle);
        let [x, y] = axes(corners_m, placed.corners.map(|p| p * texel_m))?;
        let [p, q, r] = placed.corners;
        let twice_area = (q - p).perp_dot(r - p);
        let (b, c) = ((at - p).perp_dot(r - p) / twice_area, (q - p).perp_dot(at - p) / twice_area);
        let share = Vec3::new(1.0 - b - c, b, c);
        let corners = mesh.triangles[placed.triangle].map(|v| v as usize);
        let mix3 = |of: [Vec3; 3]| of[0] * share.x + of[1] * share.y + of[2] * share.z;
        let mix = |values: &[f32]| share.dot(Vec3::from(corners.map(|v| values[v])));
        if mix(&fields.length) <= 0.0 {
            return None;
        }
        let normal = mix3(corners.map(|v| self.normals[v])).normalize_or(Vec3::Y);
        let stand = Stand {
            texel,
            density: mix(&fields.density) * x.cross(y).length(),
            tint: mix3(corners.map(|v| fields.tint[v])),
            root_m: mix3(corners_m),
            normal,
            clump: mix(&fields.clump),
            share: 1.0,
        };
        let Some(paint) = &fields.paint else { return Some(stand) };
        let point = paint.at(mesh, placed.triangle, share);
        let longest = paint.share_of_longest(mesh, placed.triangle, share, &point);
        (longest > 0.0).then_some(Stand {
            density: point.density * x.cross(y).length(),
            tint: point.tint,
            clump: point.clump,
            share: longest,
            ..stand
        })
    }
}

/// Sums up a row of texels.
struct Crowd<'a> {
    undercoat: &'a Undercoat,
    stands: &'a [Stand],
    width: usize,
}

impl Crowd<'_> {
    /// Hairs that reach a height of their own over those that a stack of full length has at height `t`.
    fn left(&self, t: f32, own: f32) -> f32 {
        self.undercoat.reaching(own) / self.undercoat.reaching(t).max(1e-3)
    }
}

impl lanes::Work for Crowd<'_> {
    type Output = Vec<Sum>;

    #[inline(always)]
    fn run<I: Isa>(self) -> Vec<Sum> {
        let mut sums = vec![Sum::default(); self.width];
        let mut nearby = Nearby::default();
        for some in self.stands.chunks(I::LANES) {
            let (mut root_m, mut normal, mut clump) = (Vec3Row::default(), Vec3Row::default(), Row::default());
            for (lane, stand) in some.iter().enumerate() {
                root_m.set(lane, stand.root_m);
                normal.set(lane, stand.normal);
                clump.0[lane] = stand.clump;
                let sum = &mut sums[stand.texel];
                sum.count += 1.0;
                sum.density += stand.density;
                sum.tint += stand.density * stand.tint;
            }
            let (root_m, normal) = (Vec3s::<I>::of(&root_m), Vec3s::of(&normal));
            let columns = self.undercoat.columns(&mut nearby, root_m, normal, F32s::of(&clump));
            let mut share = Row::default();
            some.iter().zip(&mut share.0).for_each(|(stand, share)| *share = stand.share);
            let squeeze = F32s::splat(1.0) / F32s::of(&share);
            for layer in 0..LAYERS {
                // Shorter hair has the same crowding lower down, and ends there.
                let t = (layer as f32 + 0.5) / LAYERS as f32;
                let own = (squeeze * t).min(F32s::splat(1.0));
                let crowding = columns.crowdings(own).row();
                for (stand, crowding) in some.iter().zip(crowding.0) {
                    let left = if stand.share < 1.0 { self.left(t, t / stand.share) } else { 1.0 };
                    sums[stand.texel].by_height[layer] += stand.density * crowding * left;
                }
            }
        }
        sums
    }
}
