"""What goes on around a night: workspace, status, log, hooks, retention."""
