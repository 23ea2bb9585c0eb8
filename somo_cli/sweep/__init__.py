"""Sweeps: a scene run for many sets of parameters, and one table of what came of each."""
