"""From an object and the motions under it to its findings."""
