"""`python -m coupler`, and the command `coupler`."""

from shared.start import loading
from shared.streams import open_streams


def main() -> None:
    """Entry point."""
    open_streams()
    with loading():
        from coupler.cli import main as run  # loads for a second or two

    run()


if __name__ == "__main__":
    main()
