"""Accuracy and cost of a scene: error against run time, stability, conditioning."""
