"""Probabilities of harm: joint samples of all that is uncertain (`draws`), as shaking (`shaking`), counted (`sampling`)."""
