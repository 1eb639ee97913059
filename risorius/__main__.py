"""`python -m risorius` is the same as the command `risorius`."""

from risorius.app.stopping import listen


def run() -> None:
    """Run the command; whoever stops it is heard before anything else is loaded."""
    listen()
    from risorius.app.cli import main

    main()


if __name__ == "__main__":
    run()
