"""An earthquake that has just happened: its messages, the shaking at the site, and what that does to each object."""
