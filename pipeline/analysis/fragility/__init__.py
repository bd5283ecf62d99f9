"""Fragility curves (`objects`, `scaling`, `curve`), annual rates of failure (`hazard`), and published medians."""
