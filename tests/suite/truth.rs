//! Brute force against the exact records of the stiff catalogue.
