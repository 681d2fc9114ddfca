"""What a run leaves behind and goes on from: frames, probes, pictures, checkpoints, recordings, result.json."""
