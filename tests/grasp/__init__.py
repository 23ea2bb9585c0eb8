"""Grasps: fingers that hold, lift, release, slide along and hand over objects, over steps."""
