"""Self-measurement: stability at the extremes, error against cost."""
