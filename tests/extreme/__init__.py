"""Stiff and extreme cases: which integrator holds, and whether that was predicted."""
