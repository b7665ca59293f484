//! Values between Python and the core.

pub(crate) mod array;
pub(crate) mod columns;
pub(crate) mod image;
pub(crate) mod object;
pub(crate) mod option;
pub(crate) mod report;
