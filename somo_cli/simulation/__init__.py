"""Simulate a scene: plan, engine, law, monitors and recording, and the run that joins them."""
