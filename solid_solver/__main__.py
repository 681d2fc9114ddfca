"""`python -m solid_solver`, and the command `solid-solver`."""

from shared.start import loading
from shared.streams import open_streams


def main() -> None:
    """Entry point."""
    open_streams()
    with loading():
        from solid_solver.cli import main as run  # loads for a second or two

    run()


if __name__ == "__main__":
    main()
