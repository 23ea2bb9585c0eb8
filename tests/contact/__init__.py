"""What contact is worth: candidate laws, cases and steps against converged references."""
