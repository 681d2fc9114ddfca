"""`python -m solid_solver`, and the command `solid-solver`."""

from shared.start import end_quietly_while_loading
from shared.streams import open_streams


def main() -> None:
    """Entry point."""
    open_streams()
    end_quietly_while_loading()
    from solid_solver.cli import main as run  # loads for a second or two

    run()


if __name__ == "__main__":
    main()
