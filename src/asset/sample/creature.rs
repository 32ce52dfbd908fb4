//! A made animal.
use super::super::document::Document;
pub fn document() -> Document {
    Document::made("sample:creature")
}
