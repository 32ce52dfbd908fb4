//! What varies over the skin: one value per vertex of a [`super::mesh::Mesh`].

use super::paint::Paint;
use super::parting::Parting;
use crate::math::Vec3;
use serde::{Serialize, Serializer};
use std::sync::Arc;

/// The groom's fields on a mesh. All arrays but the partings have one entry per vertex.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Fields {
    /// Hair length over the preset's, 0 for bare skin; with lengths painted, the longest around.
    pub length: Vec<f32>,
    /// Hair density over the preset's, 0 for bare skin.
    pub density: Vec<f32>,
    /// Comb direction: tangent unit vector in world axes, or zero where the hair has none.
    pub direction: Vec<Vec3>,
    /// Hair vector: root to tip of the mean guard hair at length 1, over its length; unit length, world axes. Holds
    /// the lean that comb and gravity give; the normal where there is none.
    pub lean: Vec<Vec3>,
    /// Clump strength over the preset's.
    pub clump: Vec<f32>,
    /// Hair colour under the root, linear RGB.
    pub tint: Vec<Vec3>,
    /// What is painted between the vertices; none where nothing is, or vertices hold it.
    #[serde(serialize_with = "behind")]
    pub paint: Option<Arc<Paint>>,
    /// Lines out of which roots of single hairs are moved; `density` and `direction` have them already. Not per vertex.
    pub partings: Vec<Parting>,
}

fn behind<S: Serializer>(paint: &Option<Arc<Paint>>, serializer: S) -> Result<S::Ok, S::Error> {
    paint.as_deref().serialize(serializer)
}
