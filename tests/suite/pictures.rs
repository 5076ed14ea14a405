//! Files and metrics of pictures.
