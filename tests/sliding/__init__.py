"""Bodies that slide and bodies on soft ground: does heading or step matter, is energy made."""
