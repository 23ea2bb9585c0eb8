"""What a scene says: its model in SI units, read from a checked document."""
