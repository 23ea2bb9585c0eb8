"""From the states of a run to columns, rows and CSV."""
