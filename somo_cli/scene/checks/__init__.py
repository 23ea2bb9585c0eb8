"""What can be wrong with a scene, one file for each part of it."""
