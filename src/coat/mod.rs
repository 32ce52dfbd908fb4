//! Floor 6: the product. Shells and fins are baked by asking [`crate::cast`] and judged by the law that draws them
//! ([`crate::data::shell`]).

pub mod atlas;
pub mod axes;
pub mod fins;
pub mod hair;
pub mod judge;
pub mod measures;
pub mod primitive;
pub mod seams;
pub mod shells;
pub mod summary;
pub mod tile;
