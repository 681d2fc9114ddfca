"""From a TOML file to a checked scene: reading, `--set`, checks, messages, warnings, and the document of all keys."""
