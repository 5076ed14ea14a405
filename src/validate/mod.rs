//! Rendered pictures against those of POV-Ray and Mitsuba in `reference/`.
