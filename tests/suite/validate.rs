//! The validator passes what is right and fails what is tampered with.
