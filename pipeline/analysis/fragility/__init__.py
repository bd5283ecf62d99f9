"""From what shaking on objects fail (`objects`, `scaling`, `curve`), how often (`hazard`), and what others found."""
