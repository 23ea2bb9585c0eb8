"""Checks of a scene: one file for each part of a scene that can have errors."""
