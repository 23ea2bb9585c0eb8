"""Everything decided before an engine starts, in the engine's units."""
