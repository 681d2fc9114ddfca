"""What to say where the machine refuses to write a file, or has no more memory, open files or processes to give, and
the way out."""

from __future__ import annotations

import errno
import os
from pathlib import Path

from shared.contract import ShearwaterError

_NO_THREAD = "can't start new thread"  # all that Python says of it
_LIMITS = {
    errno.ENOMEM: "a larger fluid.dx or solid.dx needs less, and there is more once other programs have ended.",
    errno.EAGAIN: "end other programs, or allow more processes and threads (ulimit -u, a container's limit of them).",
    **dict.fromkeys((errno.EMFILE, errno.ENFILE), "end other programs, or allow more open files (ulimit -n)."),
}
"""The way out by what there is no more of."""


def cannot_write(what: str, path: Path, error: Exception, instead: str = "") -> ShearwaterError:
    """The error that tells of `what` is in the file `path`; `instead`: another way out than space and place."""
    gone = [folder for folder in Path(path).absolute().parents if not folder.exists()]
    if limit := met_limit(error):
        return ShearwaterError(f"{what} {path} cannot be written: {limit}")
    if gone:
        why = f"{gone[-1]} is gone, removed or moved after the run began. Run again, and leave its folder where it is."
    elif getattr(error, "errno", None) in (errno.ENOENT, errno.ESTALE):
        why = "Another program has removed it or cut it short. To go on, move aside what is left of it."
    else:
        why = "The disk may be full or the folder not writable: free some space"
        why += f"{instead} or choose another place with --out DIR."
    return ShearwaterError(f"{what} {path} cannot be written ({error}). {why}")


def met_limit(error: BaseException) -> ShearwaterError | None:
    """The error that tells of memory, open files or processes of which there were no more; None where `error` came of
    something else."""
    number = errno.ENOMEM if isinstance(error, MemoryError) else getattr(error, "errno", None)
    if isinstance(error, RuntimeError) and str(error) == _NO_THREAD:
        number = errno.EAGAIN
    if number not in _LIMITS:
        return None
    refused, more = OSError(number, os.strerror(number)), f" ({error})" if str(error) else ""
    return ShearwaterError(f"{error if isinstance(error, OSError) else f'{refused}{more}'}: {_LIMITS[number]}")
