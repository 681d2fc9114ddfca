"""`coupler stability`: maps of where methods fail. `boundaries` is where to begin."""
