"""Before a run: what a scene's numbers mean, and the smallest models that meet its goal. `check` is where to begin."""
