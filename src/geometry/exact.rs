//! The last stage: signs, order and range decided in exact arithmetic.
