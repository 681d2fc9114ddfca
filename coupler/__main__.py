"""`python -m coupler`, and the command `coupler`."""

from shared.start import end_quietly_while_loading
from shared.streams import open_streams


def main() -> None:
    """Entry point."""
    open_streams()
    end_quietly_while_loading()
    from coupler.cli import main as run  # loads for a second or two

    run()


if __name__ == "__main__":
    main()
