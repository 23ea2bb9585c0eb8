"""Results against theory and another simulator, in one table: `make truth`."""
