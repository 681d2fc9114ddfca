"""`coupler chart`: error against cost over the variants of a study. `study` is where to begin."""
