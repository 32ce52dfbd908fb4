//! Floor 4: what rays walk through, whoever follows them: skin with its hair and lights, the prismatic shell over it, the
//! undercoat that fills the shell, and the key light's shadow in both.
//!
//! [`scene`] says what is there. [`shell`] is its geometry, [`mean`] the shadow of hair as dense as it is in the mean, [`march`] the
//! way of rays from prism to prism; [`medium`] is the same undercoat over a flat square.

pub mod bins;
pub mod lighting;
pub mod march;
pub mod mean;
pub mod medium;
pub mod scene;
pub mod shell;
