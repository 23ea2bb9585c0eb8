"""Monitors of a run: divergence, penetration, stop conditions, contact events."""
