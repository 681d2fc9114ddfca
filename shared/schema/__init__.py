"""The scene's vocabulary: which tables and keys there are, with unit, range, default and meaning."""
