//! The key light's shadow in undercoat, stored by sub-element.

use super::columns::{SharedColumns, Site};
use super::volume::Volume;
use super::{MarchRay, Start, Stepping};
use crate::data::light::Light;
use crate::volume::mean::MeanShadow;
use crate::volume::shell::block;
use crate::volume::shell::lattice::{self, Lattice};
use crate::volume::shell::prism::ShellPoint;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Optical depth beyond which no light is left.
pub const DARK: f32 = 8.0;

/// The same beside an open border: what is seen there lies between the border, where there is no shadow, and the next
/// stored depth, which must not be cut short.
pub const DARK_AT_BORDERS: f32 = 15.0;

/// Steps towards the light. Long ones miss the beginnings of clumps that they step into: by those of four layers, a depth of
/// one, undercoat was 6 % too bright.
pub const TOWARDS_LIGHT: Stepping = Stepping { depth: 0.5, layers: 0.5 };

/// How much longer they become with each optical depth passed: what lies in deep shadow has little light to be wrong about.
pub const STEP_GROWTH: f32 = 0.25;

/// Optical depth of undercoat, and of guard hair in the mean, between the corners of sub-elements and the key light, filled
/// prism by prism when first needed.
#[derive(Debug)]
pub struct Shadows<'a> {
    /// What throws them.
    pub volume: &'a Volume<'a>,
    mean: Option<&'a MeanShadow<'a>>,
    key: Light,
    lattices: Vec<OnceLock<Lattice>>,
    columns: SharedColumns,
    /// Time spent filling, summed over threads, ns.
    spent_ns: AtomicU64,
}

impl<'a> Shadows<'a> {
    /// Of undercoat, each depth towards where `key` is seen from there, and of the other hair of the same scene in the mean;
    /// none filled yet.
    pub fn new(volume: &'a Volume<'a>, mean: Option<&'a MeanShadow<'a>>, key: Light) -> Self {
        let shell = volume.shell();
        let lattices = std::iter::repeat_with(OnceLock::new).take(shell.skin.triangles.len()).collect();
        Self { volume, mean, key, lattices, columns: SharedColumns::new(shell), spent_ns: AtomicU64::new(0) }
    }

    /// Bytes filled.
    pub fn bytes(&self) -> usize {
        self.lattices.iter().filter_map(OnceLock::get).map(Lattice::bytes).sum()
    }

    /// Time spent filling so far, summed over threads, ms.
    pub fn filling_ms(&self) -> f64 {
        self.spent_ns.load(Ordering::Relaxed) as f64 * 1e-6
    }

    /// Optical depths towards the light in a prism.
    #[inline]
    pub fn lattice(&self, triangle: u32) -> &Lattice {
        let cell = &self.lattices[triangle as usize];
        if let Some(lattice) = cell.get() {
            return lattice;
        }
        cell.get_or_init(|| {
            let start = Instant::now();
            let (lattice, other_ns) = self.fill(triangle);
            self.spent_ns.fetch_add((start.elapsed().as_nanos() as u64).saturating_sub(other_ns), Ordering::Relaxed);
            lattice
        })
    }

    /// The depths, and the time spent on densities and the mean shadow on the way, ns.
    fn fill(&self, triangle: u32) -> (Lattice, u64) {
        let Self { volume, mean, .. } = *self;
        let shell = volume.shell();
        let (d, last) = (volume.shadow_subdivisions(triangle), volume.layers());
        let levels = last as usize + 1;
        let sites: Vec<Site<'_>> = lattice::points(d).map(|b| self.columns.site(shell, triangle, b)).collect();
        let waiting: Vec<usize> = (0..sites.len()).filter(|&i| sites[i].stored().is_none()).collect();
        let t_of = |level: usize| level as f32 / last as f32;
        let march_ray = |site: &Site<'_>, level: usize| {
            let point = ShellPoint { b: [site.b.y, site.b.z], t: t_of(level) };
            let start = Start { at_m: 0.0, triangle: site.triangle, point };
            let origin_m = shell.prism(site.triangle).jacobian(&point).at_m;
            MarchRay { origin_m, direction: self.key.at(origin_m).to_light, start, far_m: f32::INFINITY }
        };
        let rays: Vec<MarchRay> = (0..levels)
            .flat_map(|level| waiting.iter().map(move |&i| (i, level)))
            .map(|(i, level)| march_ray(&sites[i], level))
            .collect();
        let enough = if shell.neighbours.at_border(triangle) { DARK_AT_BORDERS } else { DARK };
        let (depths, mut other_ns) = volume.depths_along(&rays, &TOWARDS_LIGHT, STEP_GROWTH, enough);
        let mut codes = vec![0; sites.len() * levels];
        for (site, codes) in sites.iter().zip(codes.chunks_exact_mut(levels)) {
            if let Some(stored) = site.stored() {
                codes.copy_from_slice(stored);
            }
        }
        for (k, &i) in waiting.iter().enumerate() {
            let (site, codes) = (&sites[i], &mut codes[i * levels..][..levels]);
            if let Some(mean) = mean {
                mean.fill_around(site.triangle, site.b, &mut other_ns);
            }
            for (level, code) in codes.iter_mut().enumerate() {
                let other = mean.map_or(0.0, |mean| mean.other_depth(site.triangle, site.b, t_of(level)));
                *code = block::code(depths[level * waiting.len() + k] + other);
            }
            if let Some(cell) = site.shared {
                // Whoever was first has found the same.
                let _ = cell.set((&*codes).into());
            }
        }
        (Lattice::of_codes(d, codes), other_ns)
    }
}
