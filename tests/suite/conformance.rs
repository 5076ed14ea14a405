//! Every registered accelerator against brute force, to the bit.
