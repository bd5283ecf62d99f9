"""The night: from the museum's records to a published report."""
