//! The article's own forms.
