//! What to bake, and what came of it.

use super::steps::Cached;
use super::units::Units;
use crate::asset::Reading;
use crate::asset::coat::Fallback;
use crate::cache::Store;
use crate::coat::judge::CoverageRow;
use crate::coat::measures::Measures;
use crate::data::coat::Coat;
use crate::fur::field::Singularity;
use crate::metrics::timing;
use crate::preset::Preset;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// How to choose texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Lapped patches.
    Lapped,
    /// Charts with texels of their own, hair sampled on the skin.
    Atlas {
        /// Texels along the edge of the square that holds them; none for four times the preset's tile.
        texels: Option<u32>,
    },
    /// The asset's own set.
    Uv(usize),
}

/// What to bake.
#[derive(Clone, Debug)]
pub struct Request {
    /// A file, or `sample:NAME`.
    pub input: String,
    /// How it is read.
    pub reading: Reading,
    /// Where the result goes.
    pub out: PathBuf,
    /// Preset of all materials without one of their own.
    pub preset: Preset,
    /// Presets of single materials, by name.
    pub presets: Vec<(String, Preset)>,
    /// Materials to fur; empty for all that are not by name bare.
    pub materials: Vec<String>,
    /// What a unit of the file means.
    pub units: Units,
    /// Texture coordinates.
    pub method: Method,
    /// Decides all that is random.
    pub seed: u64,
    /// What viewers without the extension see.
    pub fallback: Fallback,
    /// Whether to measure the result against its strands.
    pub judge: bool,
    /// Where stages are kept from one bake to the next; none to do all of it. The result is the same.
    pub cache: Option<Store>,
    /// Whether it is to look at until a better one is there: fibres that are not known are not solved
    /// ([`HairScattering::draft`](crate::volume::scene::HairScattering::draft)).
    pub draft: bool,
}

/// What was baked.
#[derive(Clone, Debug)]
pub struct Baked {
    /// The coat.
    pub coat: Coat,
    /// What was decided for the user, one sentence each.
    pub notes: Vec<String>,
    /// What may not be as the user expects, one sentence each.
    pub warnings: Vec<String>,
    /// Materials that got fur.
    pub materials: Vec<String>,
    /// Bounding diagonal of what is furred, which lengths refer to, m.
    pub diagonal_m: f64,
    /// Comb and parameterisation of what was laid out together.
    pub laid: Vec<Laid>,
    /// Coverage of each tile against its strands, when asked for.
    pub accuracy: Vec<Vec<CoverageRow>>,
    /// Time per step, in order; a step whose result came from the cache is not among them.
    pub steps: timing::Steps,
    /// What came from the cache; none where there is none.
    pub cached: Option<Cached>,
}

/// How hair lies on the parts that were laid out together.
#[derive(Clone, Debug)]
pub struct Laid {
    /// Their materials, with commas between.
    pub material: String,
    /// Where its comb has no direction.
    pub singularities: Vec<Singularity>,
    /// How well the texture lies; its seams where the bake is judged.
    pub measures: Measures,
    /// Wall time of laying it out, ms.
    pub ms: f64,
}
