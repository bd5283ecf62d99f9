"""The plan: what is advised becomes errands with hours and cost, and those are chosen that avoid the most loss."""
