"""`python -m app` is the same as the command `risorius`."""

from .stopping import listen


def run() -> None:
    """Run the command; whoever stops it is heard before anything else is loaded."""
    listen()
    from .cli import main

    main()


if __name__ == "__main__":
    run()
