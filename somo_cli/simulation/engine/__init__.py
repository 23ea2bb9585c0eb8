"""What a run needs of a physics engine: the interface, contacts and what was loaded."""
