"""Plots of trajectories and of sweeps; matplotlib is an extra, and known here and in `picture`."""
