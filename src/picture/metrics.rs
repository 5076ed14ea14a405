//! Distances between two pictures.
