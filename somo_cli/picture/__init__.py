"""Pictures of results; matplotlib is an extra and known only here."""
