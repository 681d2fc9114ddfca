"""The numba decorator that every compiled function of Shearwater uses.

One set of flags everywhere: a callee without flags would keep those of its first caller. `fastmath` leaves out
`nnan` and `ninf`, so that checks for NaN and infinity work. Compiled code is cached in a folder named by a digest
of the sources that it can depend on: numba's cache looks only at the file of the function compiled, and would go on
running an old callee after an edit elsewhere.

Two things would lengthen the wait of a first run: an index of `prange` given to a callee as it is, which is compiled
once for each of the two types that numba gives the index on the way (`np.uint64(k)` is of one); and an array assigned
to another's slice, which compiles numba's words for unlike shapes, two seconds of them.
"""

from __future__ import annotations

import hashlib
import os
import re
import sys
import tempfile
from pathlib import Path

import numba
from numba.core.cgutils import create_struct_proxy
from numba.core.types import float64, int64
from numba.extending import intrinsic

FLAGS = {
    "error_model": "numpy",
    "fastmath": {"contract", "reassoc", "nsz", "arcp", "afn"},
    "nogil": True,
    "cache": True,
}
"""Compiler flags of every kernel."""


_PACKAGES = ("shared", "fluid_solver", "solid_solver")
_IMPORT = re.compile(rf"^\s*from ({'|'.join(_PACKAGES)})(?:\.([\w.]+))? import (.+)$", re.MULTILINE)


def source_digest(root: Path) -> str:
    """Digest of the Python sources below `root` that compiled code can depend on: those that compile, and all that they
    import."""
    texts = {path: path.read_text(encoding="utf-8") for package in _PACKAGES for path in (root / package).rglob("*.py")}
    waiting = [path for path, text in texts.items() if "from shared.jit import" in text or path.stem == "jit"]
    needed: set[Path] = set()
    while waiting:
        path = waiting.pop()
        if path not in needed:
            needed.add(path)
            for package, module, names in _IMPORT.findall(texts[path]):
                modules = [module] if module else re.findall(r"\w+", names)
                waiting += [p for p in (root / package / f"{m.replace('.', '/')}.py" for m in modules) if p in texts]
    digest = hashlib.sha256()
    for path in sorted(needed):
        digest.update(texts[path].encode())
    return digest.hexdigest()[:16]


def cache_folder(digest: str) -> Path:
    """Where code compiled of sources of this `digest` is kept. Where the user's own place cannot be written, numba
    would keep it among the sources, and look at each file's date alone, or refuse: then it is one for temporary files,
    told of and handed on to the processes that this one starts."""
    given = os.environ.get("NUMBA_CACHE_DIR")
    try:
        folder = Path(given or Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache", "shearwater", digest))
        _try_to_write(folder)
    except (OSError, RuntimeError) as error:  # the latter: a user without a home
        own = Path(tempfile.gettempdir(), f"shearwater-{os.getuid()}")
        own.mkdir(mode=0o700, exist_ok=True)
        if own.lstat().st_uid != os.getuid():  # what others have written there is not to be run
            raise PermissionError(f"{own} is another user's: NUMBA_CACHE_DIR names another place") from None
        folder = own / digest
        _try_to_write(folder)
        print(
            f"warning: compiled code is kept in {folder}, for its own place cannot be written ({error}); "
            "NUMBA_CACHE_DIR names another",
            file=sys.stderr,
        )
        os.environ["NUMBA_CACHE_DIR"] = str(folder)
    return folder


def _try_to_write(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryFile(dir=folder):
        pass


numba.config.CACHE_DIR = str(cache_folder(source_digest(Path(__file__).resolve().parent.parent)))
# OpenMP first. Threads that wait spin for some microseconds, the pause between two loops of a small scene, and then
# sleep: on a busy machine two that spin on are slower than one, up to 50 times, and an idle side of a coupled run would
# take a core from the other. 3000 rounds against none: 4,000 solid particles on two threads run 1.8 times as fast, and
# beside two busy processes 0.8 times; with 10,000 rounds 0.3 times. Read when OpenMP is loaded, at the first loop.
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")
os.environ.setdefault("GOMP_SPINCOUNT", "3000")
numba.config.THREADING_LAYER_PRIORITY = ["omp", "tbb", "workqueue"]

njit = numba.njit(**FLAGS)
"""Compile with the house flags."""

parallel_njit = numba.njit(parallel=True, **FLAGS)
"""Compile with the house flags and `prange`. Gather only: a result must not depend on the thread count."""

_ORDERED = FLAGS | {"fastmath": FLAGS["fastmath"] - {"reassoc"}}

ordered_njit = numba.njit(**_ORDERED)
"""Compile with sums in the order written, for long callees of a parallel loop, which inlining would make slow to
compile: without `reassoc` every copy of a callee rounds alike (see `inline_njit`). Loops that add side by side lose
nothing."""

ordered_parallel_njit = numba.njit(parallel=True, **_ORDERED)
"""As `parallel_njit`, for loops over callees compiled with `ordered_njit`."""

inline_njit = numba.njit(inline="always", **{k: v for k, v in FLAGS.items() if k != "cache"})
"""For pair terms and every other callee with arithmetic: inlined into the sweep that calls it, so that the sweep
vectorises, and so that a process that compiles runs the same instructions as one that loads from the cache (a callee
with a symbol of its own is bound to another copy then, and copies differ in their rounding)."""


def use_threads(count: int) -> None:
    """Parallel loops run on `count` threads from now on, or on as many as this process has cores for: the result is the
    same, and a run may go on where there are fewer."""
    numba.set_num_threads(min(count, numba.config.NUMBA_NUM_THREADS))


@intrinsic
def one_more(typing, counts, k):
    """counts[k] += 1, at once for all threads; returns what it was."""

    def generate(context, builder, signature, arguments):
        array = create_struct_proxy(signature.args[0])(context, builder, arguments[0])
        place = builder.gep(array.data, [arguments[1]])
        return builder.atomic_rmw("add", place, context.get_constant(int64, 1), "monotonic")

    return int64(counts, int64), generate


@intrinsic
def bits(typing, x):
    """The bits of a float64 as an int64."""
    return int64(float64), lambda context, builder, signature, arguments: _as(context, builder, int64, arguments[0])


@intrinsic
def float_of(typing, x):
    """The float64 that has the bits of an int64."""
    return float64(int64), lambda context, builder, signature, arguments: _as(context, builder, float64, arguments[0])


def _as(context, builder, kind, value):
    return builder.bitcast(value, context.get_value_type(kind))
