"""What to say where the machine refuses to write a file or has no memory left, and the way out."""

from __future__ import annotations

import errno
import os
from pathlib import Path

from shared.contract import ShearwaterError


def cannot_write(what: str, path: Path, error: Exception, instead: str = "") -> ShearwaterError:
    """The error that tells of `what` is in the file `path`; `instead`: another way out than space and place."""
    gone = [folder for folder in Path(path).absolute().parents if not folder.exists()]
    if gone:
        why = f"{gone[-1]} is gone, removed or moved after the run began. Run again, and leave its folder where it is."
    else:
        why = "The disk may be full or the folder not writable: free some space"
        why += f"{instead} or choose another place with --out DIR."
    return ShearwaterError(f"{what} {path} cannot be written ({error}). {why}")


def out_of_memory(error: MemoryError) -> ShearwaterError:
    """The error that tells of memory that was not there."""
    refused, more = OSError(errno.ENOMEM, os.strerror(errno.ENOMEM)), f" ({error})" if str(error) else ""
    return ShearwaterError(
        f"{refused}{more}: a larger fluid.dx or solid.dx needs less, and there is more once other programs have ended."
    )
