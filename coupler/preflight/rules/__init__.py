"""Verdicts: each rule looks at one number of the scene. `findings` holds the list of them."""
