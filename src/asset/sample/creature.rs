//! A made animal.
use super::super::document::Document;
pub fn document() -> Document {
    super::document("sphere").unwrap()
}
