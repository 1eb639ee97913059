"""`python -m app` is the same as the command `risorius`."""

from .cli import main

if __name__ == "__main__":
    main()
