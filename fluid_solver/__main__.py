"""`python -m fluid_solver`, and the command `fluid-solver`."""

from shared.start import loading
from shared.streams import open_streams


def main() -> None:
    """Entry point."""
    open_streams()
    with loading():
        from fluid_solver.cli import main as run  # loads for a second or two

    run()


if __name__ == "__main__":
    main()
