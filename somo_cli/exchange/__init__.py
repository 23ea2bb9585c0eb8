"""Models for other programs, MJCF and SDF in SI, and definitions of models of others."""
