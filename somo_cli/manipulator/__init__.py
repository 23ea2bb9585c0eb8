"""Definitions to chains of links and joints, and to URDF: pure functions from values to values."""
