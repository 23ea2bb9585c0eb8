"""The model of a scene in SI units, read from a checked document."""
