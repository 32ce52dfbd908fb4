//! How the extension is told by its name.

use super::json::At;
use serde_json::json;

/// Name of the extension.
pub const NAME: &str = "FURRIER_mesh_fur";

/// Whether a mesh is the fallback of another's coat.
pub fn is_fallback(mesh: &At<'_>) -> bool {
    mesh.get("extensions").and_then(|e| e.get(NAME)?.get("fallback")).is_some_and(|f| f.value == &json!(true))
}
