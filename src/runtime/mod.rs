//! Floor 5: draws a coat as a game would, after skinning and morphing: skin, fins, shells inner to outer.
//!
//! [`DrawList`] says what to draw, [`Frame`] from where and in which light. A [`gpu::Renderer`] holds what
//! all poses share, [`gpu::Renderer::prepare`] uploads one, [`gpu::Prepared::draw`] draws it. The law of opacity at one pixel, in
//! plain steps, is [`crate::data::shell`].

mod borders;
mod casters;
mod draw_list;
pub mod gpu;
mod shadow_view;

pub use borders::away_from_borders;
pub use casters::{Bounds, Casters};
pub use draw_list::{CoatMesh, DrawList, Frame, MAX_LIGHTS, Picture, Show, SkinMesh};
pub use shadow_view::{ShadowView, TEXELS};
