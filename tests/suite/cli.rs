//! Verbs, exit codes, messages.
