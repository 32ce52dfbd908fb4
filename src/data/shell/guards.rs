//! Guards of the law, by the names that the extension's page gives them ("Between stored values, and guards"). Shaders
//! import them by these names too.

/// Hair that lies flat: least |det M| over |X × Y| |O|, M's columns. Hair 3° above the skin.
pub const LEAST_VOLUME: f32 = 0.05;
/// Least |det M| after that, where hair has no length at all.
pub const LEAST_BULK: f32 = 1e-12;
/// Least |d_z|/|d|, cos 87°: past it a slab is no plane.
pub const LEAST_COSINE: f32 = 0.052;
/// Least n·O, in the bend of curved skin alone.
pub const LEAST_RISE: f32 = 0.05;
/// What is let through at least, before its logarithm.
pub const LEAST_CLEAR: f32 = 1e-3;
/// Least extinction, 1/m, where something is divided by it.
pub const LEAST_EXTINCTION: f32 = 1e-3;
/// Lengths of the filtered A·m up to which it tells no direction, 1/m.
pub const LEAST_DIRECTION: f32 = 0.0;
/// A coat's axis counts as missing where less of it lies along the skin.
pub const LEAST_AXIS: f32 = 1e-3;
/// Triangles with less area in the texture are not drawn, m².
pub const LEAST_UV_AREA: f32 = 1e-30;
/// How much wider or narrower than at its root a tile may become.
pub const MOST_SPREAD: f32 = 10.0;
/// Length over the stack's height below which hair fades.
pub const FADE_BELOW: f32 = 0.01;
/// Opacity that no eight-bit picture shows; writing depth for it would hide hair behind it.
pub const INVISIBLE: f32 = 0.002;
/// Taps of the longest fetch, as graphics hardware has them.
pub const MOST_TAPS: f32 = 16.0;
/// Fins and smooth normals count in full where edges stand closer than half a hair's length, by the skin's area per length of
/// edges; less where facets are larger.
pub const APART: f32 = 2.0;
