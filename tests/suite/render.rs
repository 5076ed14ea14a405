//! The path tracer against closed forms.
