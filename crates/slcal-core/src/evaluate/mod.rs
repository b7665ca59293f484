//! How well a cloud fits a plane or a sphere.
