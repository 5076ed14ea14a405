//! Scenes made by formula, seeded and reproducible.
