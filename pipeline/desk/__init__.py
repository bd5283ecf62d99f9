"""The desk: a web site for those who work without a command line; what they say goes where the commands put it."""
