"""What watches a run: divergence, penetration, stop conditions, contact events."""
