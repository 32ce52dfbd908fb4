//! What pictures cost (`docs/steps/runtime.md`, "What a picture costs").

use crate::math::Vec3;
use crate::runtime::Picture;

/// Reads at which the scale of colours ends.
pub const MOST_READS: f32 = 120.0;
/// Colours from no reads to that many, evenly apart.
const COLOURS: [Vec3; 5] = [
    Vec3::new(0.02, 0.03, 0.12),
    Vec3::new(0.05, 0.2, 0.55),
    Vec3::new(0.1, 0.5, 0.25),
    Vec3::new(0.85, 0.6, 0.05),
    Vec3::new(0.9, 0.05, 0.02),
];

/// Fragments and reads of texels of pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Pixels that show anything.
    pub covered: u64,
    /// Fragments that were run.
    pub fragments: f64,
    /// Texels that they read, as [`cost`](crate::runtime::gpu::Prepared::cost) counts.
    pub reads: f64,
}

impl Cost {
    /// Adds `counted`, what the picture with these alphas cost.
    pub fn add(&mut self, counted: &Picture, picture: &Picture) {
        self.covered += picture.pixels.iter().filter(|pixel| pixel[3] > 0.0).count() as u64;
        for &[fragments, reads, ..] in &counted.pixels {
            self.fragments += f64::from(fragments);
            self.reads += f64::from(reads);
        }
    }

    /// Fragments and reads for each pixel that shows anything; 0 where none does.
    pub fn per_covered_pixel(&self) -> [f64; 2] {
        [self.fragments, self.reads].map(|all| all / self.covered.max(1) as f64)
    }
}

/// A picture of the reads, clear where there are none.
pub fn picture(counted: &Picture) -> Picture {
    let colour = |&[_, reads, ..]: &[f32; 4]| {
        if reads <= 0.0 {
            return [0.0; 4];
        }
        let at = (reads / MOST_READS).min(1.0) * (COLOURS.len() - 1) as f32;
        let below = (at as usize).min(COLOURS.len() - 2);
        COLOURS[below].lerp(COLOURS[below + 1], at - below as f32).extend(1.0).to_array()
    };
    Picture { pixels: counted.pixels.iter().map(colour).collect(), ..counted.clone() }
}
