"""Compile definitions to chains of links and joints, and to URDF; all functions are pure."""
