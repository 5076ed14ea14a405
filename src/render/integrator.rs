//! What a ray brings back.
