"""What a scene's numbers are: its water, its plate, how that is held, swings and floats. `numbers` gathers them."""
