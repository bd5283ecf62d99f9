"""Pages for people: what was found becomes views, and views become HTML."""
