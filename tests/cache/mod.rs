//! What is kept from one bake to the next: the store, the stages that it keeps, and the command that looks after it.

mod command;
mod stages;
mod store;
