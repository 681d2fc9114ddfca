"""How far off a run's figure may be, cause by cause. `error.error_bound` is their sum, and the place to begin."""
