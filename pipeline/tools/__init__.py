"""Tools behind the other verbs: decisions, doctor, explanations, the seismologist's verbs."""
