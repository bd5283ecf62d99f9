"""Probabilities of harm: what is uncertain is drawn together (`draws`, `shaking`), run, and counted (`sampling`)."""
