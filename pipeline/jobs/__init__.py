"""The jobs: each reads as a story, one call a line."""
