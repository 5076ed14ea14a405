//! Exports a scene to Mitsuba 3.
