"""Sources of records: delimited text, spreadsheets, LIDO, databases; each gives the same rows of texts."""
