"""Self-measurement: stability at the extremes, error against cost, and validation against experiments."""
