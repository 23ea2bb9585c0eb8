"""What a run says of its error, and what was expected of it, held against the true error."""
