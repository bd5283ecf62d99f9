"""What a guess of a mapping is made from: names of columns, heads, encodings, long forms and a database's joins."""
