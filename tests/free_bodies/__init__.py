"""Rigid bodies that spin, free and rolling, against closed forms: `python -m tests.free_bodies`."""
