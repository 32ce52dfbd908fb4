//! Counter-based random numbers: a value depends on its key alone, never on the order of calls.

/// Mixes a 64-bit key into 64 well-distributed bits (the finaliser of SplitMix64, Steele et al. 2014).
pub fn mix(mut key: u64) -> u64 {
    key = key.wrapping_add(0x9E37_79B9_7F4A_7C15);
    key = (key ^ (key >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    key = (key ^ (key >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    key ^ (key >> 31)
}

/// Folds `value` into `seed`, so that (seed, a, b) and (seed, b, a) differ.
pub fn combine(seed: u64, value: u64) -> u64 {
    mix(seed ^ mix(value))
}

/// A hash of bytes in their order: tells whether they changed, not who changed them.
pub fn bytes(bytes: &[u8]) -> u64 {
    let word = |chunk: &[u8]| chunk.iter().rev().fold(0, |word, &byte| (word << 8) | u64::from(byte));
    bytes.chunks(8).fold(mix(bytes.len() as u64), |state, chunk| mix(state ^ word(chunk)))
}

/// Uniform in [0, 1) from the upper 24 bits of a hash.
pub fn unit_f32(hash: u64) -> f32 {
    (hash >> 40) as f32 * (1.0 / 16_777_216.0)
}

/// Uniform in [0, 1) from the upper 53 bits of a hash.
pub fn unit_f64(hash: u64) -> f64 {
    (hash >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
}

/// A stream of numbers under one key.
#[derive(Clone, Debug)]
pub struct Stream {
    key: u64,
    next: u64,
}

impl Stream {
    /// The stream of `key`; equal keys give equal streams.
    pub fn new(key: u64) -> Self {
        Self { key, next: 0 }
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.next += 1;
        combine(self.key, self.next)
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f32 {
        unit_f32(self.bits())
    }

    /// Standard normal (Box and Muller 1958), cut at 5.8 standard deviations by the 24-bit uniform.
    pub fn normal(&mut self) -> f32 {
        let radius = libm::sqrtf(-2.0 * libm::logf(1.0 - self.unit()));
        radius * libm::cosf(std::f32::consts::TAU * self.unit())
    }
}
