//! Counter-based random numbers: a sample does not depend on threads, tiles or accelerator.
