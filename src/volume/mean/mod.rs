//! The key light's shadow in hair as dense as it is in the mean: optical depth in columns over the skin, at heights up to the
//! tips, through the shell to its top or an open border, and through what other limbs' hair lies beyond
//! (`docs/steps/shade.md`).

mod columns;
mod faces;
mod kind;
mod walk;

use super::scene::Scene;
use super::shell::Shell;
use super::shell::prism::ShellPoint;
use crate::fur::undercoat::Undercoat;
use crate::math::Vec3;
use crate::math::lanes::{self, F32s, Isa, MOST, Scalar, U32s};
use columns::MeanColumns;
use faces::{Exit, Faces};
use kind::HairKind;
use rayon::prelude::*;
use std::cmp::Ordering::Equal;
use std::f32::consts::LN_2;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;
use walk::{Rays, ShadowRay, Walk};

/// Intervals of height up to the tips.
pub const LAYERS: usize = 24;

/// Optical depth beyond which no light is left.
const DARK: f32 = 15.0;

/// Optical depth that skin before the light counts for.
pub const BLOCKED: f32 = 30.0;

/// How far from its origin a ray may meet the first face, and how far apart the ends of hair are that count as one, in
/// heights of the tips.
const NEAR: f32 = 1e-4;
const SAME: f32 = 0.04;

/// The same, in ways from the ray's origin: flat faces at a slant to the ray lie farther from prisms' sides.
const MUCH: f32 = 4.0;

/// A part of a depth between two heights, from where that of the lower one is kept.
#[inline(always)]
fn between<I: Isa>(depths: &[f32], at: U32s<I>, along: F32s<I>) -> F32s<I> {
    let (from, to) = (at.gather(depths), at.plus_splat(PARTS as u32).gather(depths));
    from + (to - from) * along
}

/// Distance between columns, in heights of the tips, up to which what changes from one to the next is the edge of a shadow.
const NARROW: f32 = 0.2;

/// A ray to the light from a height of a column.
struct ColumnRay {
    /// Through the hair around the column.
    own: Option<ShadowRay>,
    /// Height of the tips, m.
    tips_m: f32,
    /// Where the ray ends, m from where it begins.
    far_m: f32,
    /// Where the ray leaves hair.
    exits: Vec<Exit>,
}

/// Hair that a ray passes besides what is around its column, by where the ray leaves it.
struct Other {
    /// Number of the height at which the ray begins.
    height: usize,
    far_m: f32,
    exit: Exit,
}

/// Parts of a depth: the undercoat that a march from prism to prism meets, guard hair beside it, and hair of other limbs.
pub const PARTS: usize = 3;

/// Optical depths towards the key light at heights from the skin to the tips, in parts.
pub type Depths = [[f32; PARTS]; LAYERS + 1];

/// Depths whose straight lines from height to height keep in the mean to what they are read from, which is hollow: each is
/// moved by a twelfth of its second difference. Undercoat's falls in a straight line already.
fn straightened(depths: &Depths) -> Depths {
    let mut moved = *depths;
    for (moved, around) in moved[1..].iter_mut().zip(depths.windows(3)) {
        for part in 1..PARTS {
            let [below, here, above] = [0, 1, 2].map(|i| around[i][part]);
            moved[part] = (here - (below - 2.0 * here + above) / 12.0).max(0.0);
        }
    }
    moved
}

/// Shadows by column, filled when first needed; each depends on nothing but where it stands.
#[derive(Debug)]
pub struct MeanShadow<'a> {
    shell: Shell<'a>,
    /// Height of the tallest hair over the shell's.
    tips: f32,
    kinds: [Option<HairKind>; 2],
    to_light: Vec3,
    faces: Faces,
    /// Twice the area of each triangle in the rest pose, m².
    twice_area_m2: Vec<f32>,
    columns: MeanColumns,
    /// Whether depths of the hair around go linearly from column to column, by triangle.
    linear: Vec<bool>,
    /// Triangles around each vertex's position class.
    around: Vec<Vec<u32>>,
    cells: Vec<OnceLock<Box<Depths>>>,
    /// Time spent filling, summed over threads, ns.
    spent_ns: AtomicU64,
}

impl<'a> MeanShadow<'a> {
    /// Of a scene, in columns over its vertices and, where those are farther apart than `span` heights of the tips, between
    /// them; none where nothing grows.
    pub fn new(scene: &Scene<'a>, to_light: Vec3, span: f32) -> Option<Self> {
        let guard = scene.guard.map(|(_, fibre)| fibre);
        let of_shell = Undercoat::new(scene.undercoat.or(guard)?, None);
        let shell_m = of_shell.height_m;
        if shell_m <= 0.0 {
            return None;
        }
        let tips = guard.map_or(1.0, |fibre| (fibre.height_m() / shell_m).max(1.0));
        let mut around = vec![Vec::new(); scene.skin.positions_m.len()];
        for (t, triangle) in scene.skin.triangles.iter().enumerate() {
            for &v in triangle {
                around[scene.skin.position_class[v as usize] as usize].push(t as u32);
            }
        }
        let shell = Shell::new(scene.skin, scene.fields, of_shell);
        let tips_m = shell_m * tips;
        let columns = MeanColumns::new(&shell, span * tips_m);
        let goes_linearly = |t: u32| {
            let apart_m = shell.skin.mean_edge_m(t as usize) / (1_u32 << columns.lattice(t).1) as f32;
            shell.neighbours.at_border(t) || apart_m > NARROW * tips_m
        };
        Some(Self {
            faces: Faces::new(&shell, tips, to_light),
            linear: (0..scene.skin.triangles.len() as u32).map(goes_linearly).collect(),
            shell,
            tips,
            kinds: [scene.undercoat, guard].map(|fibre| fibre.map(|fibre| HairKind::new(fibre, shell_m, tips))),
            to_light,
            twice_area_m2: (0..scene.skin.triangles.len()).map(|t| 2.0 * scene.skin.rest_area_m2(t)).collect(),
            cells: std::iter::repeat_with(OnceLock::new).take(columns.count()).collect(),
            columns,
            around,
            spent_ns: AtomicU64::new(0),
        })
    }

    /// Time spent filling so far, summed over threads, ms.
    pub fn filling_ms(&self) -> f64 {
        self.spent_ns.load(Ordering::Relaxed) as f64 * 1e-6
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let filled = self.cells.iter().filter(|cell| cell.get().is_some()).count() * size_of::<Depths>();
        self.shell.bytes() + self.faces.bytes() + self.columns.bytes() + size_of_val(&self.cells[..]) + filled
    }

    /// Optical depths in the column over a point of the skin, at heights given as shares of the tips': of the undercoat that a march
    /// meets, and of all other hair. What hair lets through is linear from column to column, as the edges of shadows lie anywhere
    /// between; but of the hair around depth is, where it grows with the distance from an open border or where columns stand far
    /// apart for their hair ([`Self::is_linear`]).
    #[inline(always)]
    pub fn at<I: Isa>(&self, triangle: u32, b: Vec3, share: F32s<I>) -> [F32s<I>; 2] {
        let at = share.within(0.0, 1.0) * LAYERS as f32;
        let low = at.floor().min(F32s::splat((LAYERS - 1) as f32));
        let (first, along) = ((low * PARTS as f32).to_whole(), at - low);
        let around = if self.linear[triangle as usize] { 0.0 } else { 1.0 };
        let mut linear = [F32s::splat(0.0); 2];
        let mut through = [F32s::splat(f32::MIN_POSITIVE); 2];
        let (columns, weights) = self.columns.around(triangle, b);
        for (column, b) in columns.into_iter().zip(weights.to_array()) {
            let depths = self.cell(column).as_flattened();
            let undercoat = between(depths, first, along);
            let guard = between(depths, first.plus_splat(1), along);
            let limbs = between(depths, first.plus_splat(2), along);
            linear = [linear[0] + undercoat * b, linear[1] + guard * b];
            let other = limbs + guard * around;
            through[0] = through[0] + (-(other + undercoat * around)).exp_negative() * b;
            through[1] = through[1] + (-other).exp_negative() * b;
        }
        let (all, other) = (-through[0].log2() * LN_2, -through[1].log2() * LN_2);
        let rest = 1.0 - around;
        [linear[0] * rest + (all - other), linear[1] * rest + other]
    }

    /// Whether in a triangle the depth of the hair around goes linearly from column to column, rather than what that lets
    /// through.
    pub fn is_linear(&self, triangle: u32) -> bool {
        self.linear[triangle as usize]
    }

    /// How often a triangle is split, and where the columns over its lattice's corners begin in [`Self::numbers`].
    pub fn lattice(&self, triangle: u32) -> (u32, u32) {
        self.columns.lattice(triangle)
    }

    /// Numbers of columns by triangle and corner of its lattice ([`super::shell::lattice::points`]).
    pub fn numbers(&self) -> &[u32] {
        self.columns.numbers()
    }

    /// Depths by column, height and part, for the devices that look them up themselves.
    pub fn of_columns(&self) -> Vec<f32> {
        let columns = 0..self.columns.count() as u32;
        const NOTHING: Depths = [[0.0; PARTS]; LAYERS + 1];
        // Of vertices at one point, only one has a column.
        let is_used = |column: u32| self.around.get(column as usize).is_none_or(|around| !around.is_empty());
        let depths = |column: u32| if is_used(column) { self.cell(column) } else { &NOTHING };
        columns.into_par_iter().flat_map_iter(|column| depths(column).as_flattened().iter().copied()).collect()
    }

    /// Optical depth of all hair, as [`Self::at`].
    pub fn depth(&self, triangle: u32, b: Vec3, share: f32) -> f32 {
        let [undercoat, other] = self.at(triangle, b, F32s::<Scalar>::splat(share));
        (undercoat + other).row().0[0]
    }

    /// Fills the columns around a point of the skin; the time this takes is added to `filling_ns`.
    pub fn fill_around(&self, triangle: u32, b: Vec3, filling_ns: &mut u64) {
        for column in self.columns.around(triangle, b).0 {
            self.cell_timed(column, filling_ns);
        }
    }

    /// Depth of all but the undercoat that a march meets, at a point of undercoat's shell.
    pub fn other_depth(&self, triangle: u32, b: Vec3, t: f32) -> f32 {
        self.at(triangle, b, F32s::<Scalar>::splat(t / self.tips))[1].row().0[0]
    }

    /// Height in a column, as a share of the tips', of hair `height_m` above skin whose hair is `length` times as long as
    /// the preset's.
    pub fn share(&self, height_m: f32, length: f32) -> f32 {
        height_m / (self.shell.undercoat.height_m * self.tips * length.max(1e-3))
    }

    fn cell(&self, column: u32) -> &Depths {
        self.cell_timed(column, &mut 0)
    }

    fn cell_timed(&self, column: u32, filling_ns: &mut u64) -> &Depths {
        let cell = &self.cells[column as usize];
        if let Some(depths) = cell.get() {
            return depths;
        }
        cell.get_or_init(|| {
            let start = Instant::now();
            let depths = Box::new(self.fill(column));
            let ns = start.elapsed().as_nanos() as u64;
            self.spent_ns.fetch_add(ns, Ordering::Relaxed);
            *filling_ns += ns;
            depths
        })
    }

    fn fill(&self, column: u32) -> Depths {
        let mut depths = Depths::default();
        let mut others = Vec::new();
        let (mut own, mut end) = ([0.0; 2], LAYERS + 1);
        while end > 0 {
            // Below where no light is left there is none.
            if own[0] + own[1] >= DARK {
                depths[..end].fill([own[0], own[1], 0.0]);
                break;
            }
            let begin = end.saturating_sub(MOST);
            let column_rays: Vec<ColumnRay> = (begin..end).map(|i| self.column_ray(column, i)).collect();
            let mut rays = Rays::default();
            rays.iter_mut().zip(&column_rays).for_each(|(ray, column_ray)| *ray = column_ray.own);
            let found = lanes::run(Walk { mean: self, rays: &rays });
            for ((i, column_ray), found) in (begin..end).zip(column_rays).zip(found).rev() {
                if own[0] + own[1] < DARK {
                    own = found.depths;
                }
                let blocked = if column_ray.far_m.is_finite() { BLOCKED } else { 0.0 };
                depths[i] = [own[0], own[1], blocked];
                let ColumnRay { own: ray, tips_m, far_m, mut exits } = column_ray;
                // Where it leaves hair that it has been followed through.
                let end_m = found.end_m.filter(|_| ray.is_some_and(|ray| ray.onwards)).unwrap_or(f32::NAN);
                let off = |exit: &Exit| (exit.at_m - end_m).abs();
                let nearest = (0..exits.len()).min_by(|&a, &b| off(&exits[a]).total_cmp(&off(&exits[b])));
                if let Some(same) = nearest.filter(|&i| off(&exits[i]) < MUCH * end_m + SAME * tips_m) {
                    exits.remove(same);
                }
                others.extend(exits.into_iter().map(|exit| Other { height: i, far_m, exit }));
            }
            end = begin;
        }
        self.add_others(&others, &mut depths);
        straightened(&depths)
    }

    /// The ray to the light from height number `i` of a column.
    fn column_ray(&self, column: u32, i: usize) -> ColumnRay {
        let t = self.tips * i as f32 / LAYERS as f32;
        let between = self.columns.between(column);
        let (foot_m, offset_m) = match between {
            Some((triangle, b)) => {
                let prism = self.shell.prism(triangle);
                let mix = |[p, q, r]: [Vec3; 3]| p * b.x + q * b.y + r * b.z;
                (mix(prism.foot_m), mix(prism.offset_m))
            }
            None => (self.shell.skin.positions_m[column as usize], self.shell.offsets_m[column as usize]),
        };
        let tips_m = self.tips * offset_m.length();
        let mut exits = Vec::new();
        let near_m = NEAR * tips_m;
        let far_m = self.faces.exits(foot_m + offset_m * t, near_m, &mut exits);
        // An edge is met in both of its faces. Of these, the one that lies first in space.
        let order = |exit: &Exit| self.shell.skin.order_in_space(exit.triangle as usize);
        exits.sort_by(|a, b| a.at_m.total_cmp(&b.at_m).then_with(|| order(a).partial_cmp(&order(b)).unwrap_or(Equal)));
        exits.dedup_by(|next, kept| next.at_m - kept.at_m < near_m);
        let own = match between {
            Some((triangle, b)) => Some(self.ray(triangle, ShellPoint { b: [b.y, b.z], t }, far_m)),
            None => self.start(column, t, far_m),
        };
        ColumnRay { own, tips_m, far_m, exits }
    }

    /// Adds the hair that rays from some heights have passed where they leave it, followed back from there.
    fn add_others(&self, others: &[Other], depths: &mut Depths) {
        for others in others.chunks(MOST) {
            let mut rays = Rays::default();
            for (ray, other) in rays.iter_mut().zip(others) {
                let Exit { at_m, triangle, point } = other.exit;
                // Faces are flat and prisms' sides are not: the ray is moved to where its point is.
                let origin_m = self.shell.prism(triangle).jacobian(&point).at_m - self.to_light * at_m;
                *ray = Some(ShadowRay { triangle, point, origin_m, far_m: other.far_m, onwards: false });
            }
            let found = lanes::run(Walk { mean: self, rays: &rays });
            for (other, found) in others.iter().zip(found) {
                depths[other.height][2] += found.depths.iter().sum::<f32>();
            }
        }
    }

    /// From a point in the prism over a triangle.
    fn ray(&self, triangle: u32, point: ShellPoint, far_m: f32) -> ShadowRay {
        let jacobian = self.shell.prism(triangle).jacobian(&point);
        ShadowRay { triangle, point, origin_m: jacobian.at_m, far_m, onwards: jacobian.determinant > 0.0 }
    }

    /// Where a ray begins above a vertex: in the prism around it into which the light's direction leads.
    fn start(&self, class: u32, t: f32, far_m: f32) -> Option<ShadowRay> {
        let mut best: Option<(f32, ShadowRay)> = None;
        for &triangle in &self.around[class as usize] {
            let corners = self.shell.skin.triangles[triangle as usize];
            let Some(corner) = corners.iter().position(|&v| self.shell.skin.position_class[v as usize] == class) else {
                continue;
            };
            let point = ShellPoint { b: [f32::from(u8::from(corner == 1)), f32::from(u8::from(corner == 2))], t };
            let jacobian = self.shell.prism(triangle).jacobian(&point);
            let rates = jacobian.rates(self.to_light);
            let rates = [-rates.x - rates.y, rates.x, rates.y];
            let least = rates[(corner + 1) % 3].min(rates[(corner + 2) % 3]);
            // Of equals, the one that lies first in space.
            let order = |t: u32| self.shell.skin.order_in_space(t as usize);
            let leads = |&(most, ref ray): &(f32, ShadowRay)| {
                least > most || least == most && order(triangle) < order(ray.triangle)
            };
            if best.as_ref().is_none_or(leads) {
                best = Some((least, self.ray(triangle, point, far_m)));
            }
        }
        // Where no prism lies that way, the light comes over an open border.
        let (least, ray) = best?;
        (least > -1e-3 / self.shell.undercoat.height_m).then_some(ray)
    }

    /// The prism beyond the side opposite to a corner, and its own corner opposite to that side.
    fn beyond(&self, triangle: u32, corner: usize) -> Option<(u32, usize)> {
        let beyond = self.shell.neighbours.beyond(triangle, (corner < 3).then_some(corner)?)?;
        Some((beyond.triangle, usize::from(beyond.corner)))
    }
}
