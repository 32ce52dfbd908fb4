//! Floor 3: the model of the coat: how hair is shaped, where it grows, how dense its undercoat is.

pub mod field;
pub mod groom;
pub mod grow;
pub mod patch;
pub mod undercoat;
