"""`python -m solid_solver`, and the command `solid-solver`."""

from shared.start import end_quietly_while_loading


def main() -> None:
    """Entry point."""
    end_quietly_while_loading()
    from solid_solver.cli import main as run  # loads for a second or two

    run()


if __name__ == "__main__":
    main()
