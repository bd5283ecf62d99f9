"""Operation around a night: workspace, status, log, hooks, retention."""
