//! Hair by height: where a stack's slabs end, and in which colour each is seen.

use super::deposit::{VoxelLayout, Voxels};
use super::undercoat::Profile;
use crate::coat::hair::TileHair;
use crate::data::shell::Slabs;
use crate::math::{Vec2, Vec3};

/// Heights at which hair is looked at.
const BINS: usize = 64;
/// Radius of the round skin whose outline is kept, stack heights.
const RADIUS: f32 = 3.0;
/// Least height of a stack, and halvings that find it.
const LEAST: f32 = 0.25;
const HALVINGS: usize = 20;
/// Optical depth of light and eye's ray together, per hair area above: each straight down on a slant of 45°.
const SEEN: f32 = 1.5;

/// A tile's hair by height, in [`BINS`] parts of the stack's.
pub struct ByHeight {
    even: Slabs,
    /// Hair area per skin area.
    areas: Vec<f32>,
    /// Its colour times its area.
    colours: Vec<Vec3>,
}

impl ByHeight {
    /// Looks at all hair of a tile.
    pub fn new(hair: &TileHair) -> Self {
        let layout = VoxelLayout::tile(1, Slabs::even(BINS), hair.edge_m, hair.height_m);
        let mut voxels = Voxels::deposited(&layout, &hair.guard, &[Vec2::ZERO; BINS]);
        if let Some(medium) = &hair.undercoat {
            Profile::new(medium, &layout).fill(&mut voxels, &mut [0.0; BINS], 0, Vec3::ONE, |_| 1.0);
        }
        let part_m = hair.height_m / BINS as f32;
        Self {
            areas: voxels.extinction.iter().map(|extinction| extinction * part_m).collect(),
            colours: voxels.colour.iter().map(|&colour| colour * part_m).collect(),
            even: layout.slabs,
        }
    }

    /// Cuts the stack into `count` slabs of equal height, of which the last ends where the coat keeps its outline: below the tips, which
    /// are too few to fill it.
    pub fn cut(&self, count: usize) -> Slabs {
        let up_to = |top: f32| {
            let tops = (0..=count).map(|i| top * i as f32 / count as f32).collect();
            Slabs::with_tops(tops).unwrap_or_else(|| Slabs::even(count))
        };
        let wanted = outline(&self.even, &self.areas);
        let (mut low, mut high) = (LEAST, 1.0);
        for _ in 0..HALVINGS {
            let slabs = up_to(0.5 * (low + high));
            let areas: Vec<f32> = (0..count).map(|slab| self.held(&slabs, slab).map(|(_, area)| area).sum()).collect();
            *(if outline(&slabs, &areas) > wanted { &mut high } else { &mut low }) = 0.5 * (low + high);
        }
        up_to(high)
    }

    /// Per slab, the colour that is seen of it from outside over its mean: of a high one the upper part counts for most.
    pub fn seen_over_mean(&self, slabs: &Slabs) -> Vec<Vec3> {
        let of = |slab: usize| {
            let (mut mean, mut seen, mut areas, mut weights, mut above) = (Vec3::ZERO, Vec3::ZERO, 0.0, 0.0, 0.0);
            for (bin, area) in self.held(slabs, slab).collect::<Vec<_>>().into_iter().rev() {
                if area <= 0.0 {
                    continue;
                }
                let colour = self.colours[bin] / self.areas[bin];
                let weight = area * libm::expf(-SEEN * (above + 0.5 * area));
                mean += area * colour;
                seen += weight * colour;
                areas += area;
                weights += weight;
                above += area;
            }
            let ratio = seen / f32::max(weights, f32::MIN_POSITIVE) * areas / mean.max(Vec3::splat(1e-6));
            if areas > 0.0 && ratio.is_finite() { ratio } else { Vec3::ONE }
        };
        (0..slabs.count()).map(of).collect()
    }

    /// What of the hair at each height a slab holds, per skin area, from below. What stands out above the last belongs to it.
    fn held(&self, slabs: &Slabs, slab: usize) -> impl Iterator<Item = (usize, f32)> {
        let [bottom, top] = slabs.span(slab);
        let top = if slab + 1 == slabs.count() { 1.0 } else { top };
        self.areas.iter().enumerate().map(move |(bin, area)| {
            let [low, high] = [bin, bin + 1].map(|bin| bin as f32 / BINS as f32);
            (bin, area * ((top.min(high) - bottom.max(low)) * BINS as f32).max(0.0))
        })
    }
}

/// How far slabs with these hair areas hide what is behind a round skin's outline, over the stack's height: the mean opacity of rays that
/// pass it at heights from 0 to 1. At height z a ray runs √(R/2) du/√(u − z) through what lies between u and u + du, before its
/// nearest point and behind it, R being the radius.
fn outline(slabs: &Slabs, areas: &[f32]) -> f32 {
    let opacity = |z: f32| {
        let way = |slab: usize| {
            let [bottom, top] = slabs.span(slab).map(|height| (height - z).max(0.0).sqrt());
            (top - bottom) / slabs.thickness(slab)
        };
        let depth: f32 = areas.iter().enumerate().map(|(slab, area)| area * way(slab)).sum();
        -libm::expm1f(-4.0 * (0.5 * RADIUS).sqrt() * depth)
    };
    (0..BINS).map(|i| opacity((i as f32 + 0.5) / BINS as f32)).sum::<f32>() / BINS as f32
}
