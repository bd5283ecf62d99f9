"""Where records come from: delimited text, spreadsheets, LIDO, databases; each gives the same rows of texts."""
