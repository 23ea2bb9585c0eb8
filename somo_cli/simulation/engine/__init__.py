"""The interface of a physics engine: bodies, objects, contacts, and a check of what it loaded."""
