"""First files of a user's own: commented definitions, scenes and studies that pass every check."""
