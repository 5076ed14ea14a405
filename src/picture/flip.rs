//! FLIP: the perceived difference of two pictures.
