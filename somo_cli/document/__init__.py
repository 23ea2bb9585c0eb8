"""A file as it was written: plain values and the position of each."""
