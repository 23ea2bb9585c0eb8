"""Models for other programs: MJCF and SDF in SI."""
