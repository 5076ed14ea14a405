//! EXR, PNG and PFM in and out.
