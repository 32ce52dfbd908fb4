//! Floor 5: draws a coat as a game would, after skinning and morphing: skin, fins, shells inner to outer.
//!
//! [`DrawList`] says what to draw, [`Frame`] from where and in which light. A [`gpu::Renderer`] holds what
//! all poses share, [`gpu::Renderer::prepare`] uploads one, [`gpu::Prepared::draw`] draws it. The law of opacity at one pixel, in
//! plain steps, is [`crate::data::shell`].

mod bends;
mod borders;
mod casters;
mod detail;
mod draw_list;
pub mod gpu;
mod motion;
mod order;
mod shadow_view;
mod sight;

pub use bends::{bends_per_m, outer_edge_m, outer_normals};
pub use borders::away_from_borders;
pub use casters::{Bounds, Casters};
pub use detail::Detail;
pub use draw_list::{Blending, CoatMesh, DrawList, Frame, MAX_LIGHTS, Picture, Show, SkinMesh};
pub use motion::{Motion, Spring, Wind};
pub use order::{Item, Order, Run};
pub use shadow_view::{ShadowView, TEXELS};
pub use sight::{Before, Eye, LevelSight, OUTLINE, Point, Seen, Sighted, TOLD_APART};
