"""Rigid-body dynamics of chains of links, as arrays."""
