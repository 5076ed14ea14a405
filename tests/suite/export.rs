//! Exported scenes say what the scene says.
