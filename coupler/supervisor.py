"""Starts the two solver processes, knows whether they live, and leaves none behind."""

from __future__ import annotations

import contextlib
import os
import shlex
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from coupler.remote import Remote, RemoteError
from shared.awake import Halt
from shared.contract import BadInput, ParticipantLost, SolverFailed
from shared.link_zenoh import ZenohLink, listening
from shared.run.words import word
from shared.unwritable import met_limit

PACKAGES = {"fluid": "fluid_solver", "solid": "solid_solver"}
"""Package of each side's solver."""
_CONNECT_WITHIN_S = 900.0  # a first run compiles, on a busy machine for minutes; a dead process is noticed at once
_PATIENCE_S = 5.0  # between asking a process to end and killing it
_TAIL_LINES = 12


@dataclass
class Solver:
    """A solver process and its log."""

    name: str
    process: subprocess.Popen
    log: Path
    ready: bool = False  # whether it has been asked anything yet

    def __post_init__(self) -> None:
        self._halt = Halt(self.process.pid)

    def alive(self) -> None:
        """Raises when the process has ended: its own error, or ParticipantLost with the end of its log, if any; and
        when it is stopped."""
        code = self.process.poll()
        if code is None:
            if words := self._halt.too_long():
                raise ParticipantLost(f"the {self.name} solver (process {self.process.pid}) {words}; it is ended")
            return
        text = self.log.read_text(errors="replace")
        if code in (BadInput.exit_code, SolverFailed.exit_code) and "error: " in text:
            raise RemoteError(text.rpartition("error: ")[2].strip(), code)
        how = f"was killed by signal {-code}" if code < 0 else f"ended with exit code {code}"
        kept = "what it had written is kept" if self.ready else "it had not begun yet"
        tail = "\n".join(text.splitlines()[-_TAIL_LINES:])
        last_words = f" End of its log {self.log}:\n{tail}" if tail else ""
        raise ParticipantLost(f"the {self.name} solver (process {self.process.pid}) {how}; {kept}.{last_words}")

    def stop(self) -> None:
        """Ask the process to end, also one that is stopped, then kill it."""
        self.process.terminate()
        self.process.send_signal(signal.SIGCONT)
        try:
            self.process.wait(_PATIENCE_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


def _command(program: Sequence[str], name: str, endpoint: str, run: str, run_dir: Path, threads: int) -> list[str]:
    options = {
        "--connect": endpoint,
        "--run": run,
        "--out": str(run_dir / f"{name}.vtkhdf"),
        "--threads": str(threads),
        "--parent": str(os.getpid()),
    }
    return [
        *program,
        "serve",
        word(run_dir / "case.toml"),
        *(part for pair in options.items() for part in pair),
    ]


@contextlib.contextmanager
def solver_processes(
    run: str,
    run_dir: Path,
    threads: dict[str, int],
    stall_after: float,
    claim: int,
    programs: Mapping[str, Sequence[str]] | None = None,
) -> Iterator[dict[str, Remote]]:
    """Both solvers as processes, connected over zenoh; they are gone when the context ends, however it ends.

    `claim`: descriptor of the file that keeps others from the run; it is held as long as a solver lives. `programs`:
    words of the command of a side that is not one of ours. Raises BadInput where one cannot be started.
    """
    log_dir = run_dir / "log"
    log_dir.mkdir(exist_ok=True)
    with listening(run) as (session, endpoint), contextlib.ExitStack() as stack:
        remotes, links, solvers = {}, [], []
        for name in PACKAGES:
            log = log_dir / f"{name}.txt"
            output = stack.enter_context(log.open("a"))
            program = (programs or {}).get(name) or [sys.executable, "-m", PACKAGES[name]]
            try:
                # A session of its own: Ctrl-C reaches the coupler alone, which ends the run in order.
                process = subprocess.Popen(
                    _command(program, name, endpoint, run, run_dir, threads[name]),
                    stdin=subprocess.DEVNULL,
                    stdout=output,
                    stderr=subprocess.STDOUT,
                    start_new_session=True,
                    pass_fds=(claim,),
                )
            except OSError as error:
                if met_limit(error):
                    raise
                how = f"The {name} side's command {shlex.join(program)} cannot be started: {error.strerror}."
                raise BadInput(how) from None
            solver = Solver(name, process, log)
            solvers.append(solver)
            stack.callback(solver.stop)
            links.append(ZenohLink(session, run, name, solver.alive, stall_after))
            remotes[name] = Remote(links[-1], run, name)
        for link in links:
            link.wait_connected(_CONNECT_WITHIN_S)
        for solver in solvers:
            solver.ready = True
        yield remotes
        for solver in solvers:  # they end by themselves after `finish`
            with contextlib.suppress(subprocess.TimeoutExpired):
                solver.process.wait(_PATIENCE_S)
