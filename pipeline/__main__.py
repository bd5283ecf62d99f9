"""`python -m kouros`: the command, where its folder is not on the path."""

from pipeline.cli import main

if __name__ == "__main__":
    main()
