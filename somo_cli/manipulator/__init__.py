"""What a definition means, and its URDF: pure functions from values to values."""
