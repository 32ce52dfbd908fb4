//! Floor 2: what a picture is taken with: projection, light, lens, tones, files. Every picture of the house, whoever draws it,
//! passes here, so that pictures of one asset lie over each other.

pub mod defocus;
pub mod environment;
pub mod exr;
pub mod projection;
pub mod tone;
