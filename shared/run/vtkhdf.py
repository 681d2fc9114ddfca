"""Frames as a VTKHDF time series: one file per side that ParaView opens directly.

Layout (VTKHDF 2.0, temporal PolyData): every particle is a point and a vertex cell. The arrays of all frames
stand one after the other; the group `Steps` says where each frame's part of them begins.

    VTKHDF            attributes Version, Type
      NumberOfPoints  (parts,)        a new part begins when the number of particles changes
      Points          (rows, 3)       rows of all frames
      Vertices        NumberOfCells, NumberOfConnectivityIds (parts,), Connectivity, Offsets: once per part
      Lines Strips Polygons           empty, but required
      PointData/NAME  (rows,) or (rows, 3)
      Steps           attribute NSteps; Values [s], PartOffsets, NumberOfParts, PointOffsets, CellOffsets, ...

Format: https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/vtkhdf_specifications.html

The default HDF5 format with a flush per frame leaves a readable file when the process is killed; the newer
format and single-writer mode do not. `NSteps` is written last: rows of a frame cut short lie beyond it and
are cut off when the file is opened again. HDF5 does not survive a failed write: the space for a frame is
reserved first, so that a full disk ends the run with its earlier frames intact.
"""

from __future__ import annotations

import errno
import os
from pathlib import Path

import h5py
import numpy as np

from shared.contract import BadInput, Frame, ShearwaterError
from shared.unwritable import cannot_write

_VERSION = (2, 0)
_TOPOLOGIES = ("Vertices", "Lines", "Strips", "Polygons")
_MAX_CHUNK_ROWS = 1 << 16
_METADATA_ROOM = 1 << 20  # bytes that a frame's headers and indices never reach


class FrameWriter:
    """Writes frames to the VTKHDF file `path`.

    A file that is already there is continued: frames at or after the time of the first frame appended are
    dropped, as a run that goes on from a checkpoint needs it. Raises ShearwaterError if it cannot be written.
    """

    def __init__(self, path: str | Path):
        self.path = Path(path)
        there = self.path.exists()
        try:
            # No lock: the file may be watched while it grows.
            self._file = h5py.File(self.path, "a", locking=False)
        except OSError as error:
            raise (_cannot_go_on if there else _cannot_write)(self.path, error) from error
        self._root = self._file.require_group("VTKHDF")
        self._fresh = True

    def append(self, time: float, frame: Frame) -> None:
        """Add a snapshot at `time` [s] and bring it to the disk; all frames carry the same fields."""
        try:
            if not self._fresh:
                _check_whole(self._file, self.path)
            _reserve(self._file, self.path, frame)
            if "Steps" not in self._root:
                _create(self._root, frame)
            if self._fresh:
                _truncate(self._root, time)
                self._fresh = False
            _append(self._root, time, frame)
            self._file.flush()
            # The frame counts only once all of it is on the disk.
            self._root["Steps"].attrs.modify("NSteps", np.int64(len(self._root["Steps/Values"])))
            self._file.flush()
            os.truncate(self.path, self._file.id.get_filesize())
        except OSError as error:
            raise _cannot_write(self.path, error) from error

    def close(self) -> None:
        """Close the file; harmless if it is closed already."""
        try:
            self._file.close()
        except (OSError, RuntimeError) as error:
            raise _cannot_write(self.path, error) from error

    def __enter__(self) -> FrameWriter:
        return self

    def __exit__(self, *_) -> None:
        self.close()


def read_frame(path: str | Path, index: int = -1) -> tuple[float, Frame]:
    """Time [s] and snapshot number `index` (negative: from the end) of a file written by `FrameWriter`.

    Raises BadInput if the file cannot be read or holds no such frame.
    """
    try:
        with h5py.File(path, "r", locking=False) as file:
            root = file["VTKHDF"]
            count = int(root["Steps"].attrs["NSteps"])
            if not -count <= index < count:
                raise BadInput(f"{path} holds {count} frames; there is no frame {index}.")
            step = range(count)[index]
            rows = _rows(root, step)
            fields = {name: _flat(data, rows) for name, data in root["PointData"].items()}
            return float(root["Steps/Values"][step]), Frame(root["Points"][rows][:, :2], fields)
    except (OSError, AttributeError, LookupError, RuntimeError, TypeError, ValueError) as error:
        raise BadInput(f"{path} is not a readable file of frames ({error}).") from error


def check_frames(path: Path) -> None:
    """See that `FrameWriter` can go on with a file. Raises BadInput."""
    try:
        read_frame(path)
    except BadInput as error:
        raise _cannot_go_on(path, error) from None


def _check_whole(file: h5py.File, path: Path) -> None:
    """See that the file is as long as the last frame left it; OSError if not: HDF5 would fill the hole with zeros."""
    left, written = path.stat().st_size, file.id.get_filesize()
    if left < written:
        raise OSError(errno.ESTALE, f"{left} of its {written} bytes are left")


def _reserve(file: h5py.File, path: Path, frame: Frame) -> None:
    """Claim disk space for `frame` behind the end of the file; OSError if there is not enough.

    Beyond its own rows each array may begin one more chunk.
    """
    fields = [np.asarray(values) for values in (frame.position, *frame.fields.values())]
    row = sum(values.itemsize * (3 if values.ndim == 2 else 1) for values in fields)
    row += 2 * np.dtype(np.int64).itemsize  # the vertex and its offset
    count = len(frame.position)
    chunk = file["VTKHDF/Points"].chunks[0] if "Points" in file["VTKHDF"] else count
    room = row * (count + chunk) + _METADATA_ROOM
    if not hasattr(os, "posix_fallocate"):  # macOS
        return
    descriptor = os.open(path, os.O_WRONLY)
    try:
        os.posix_fallocate(descriptor, file.id.get_filesize(), room)
    finally:
        os.close(descriptor)


def _create(root: h5py.Group, frame: Frame) -> None:
    """The empty time series for frames with the fields of `frame`."""
    root.attrs["Version"] = np.array(_VERSION, dtype=np.int64)
    # The reader wants a fixed-length ASCII string.
    root.attrs.create("Type", b"PolyData", dtype=h5py.string_dtype("ascii", len("PolyData")))
    rows = min(max(len(frame.position), 1), _MAX_CHUNK_ROWS)
    _growing(root, "NumberOfPoints")
    _growing(root, "Points", (3,), np.float64, rows)
    for topology in _TOPOLOGIES:
        cells = root.create_group(topology)
        for name in ("NumberOfCells", "NumberOfConnectivityIds"):
            _growing(cells, name)
        for name in ("Connectivity", "Offsets"):
            _growing(cells, name, chunk=rows)
    data = root.create_group("PointData")
    for name, values in frame.fields.items():
        _growing(data, name, np.shape(_padded(values))[1:], _stored_type(values), rows)
    steps = root.create_group("Steps")
    steps.attrs["NSteps"] = np.int64(0)
    _growing(steps, "Values", dtype=np.float64)
    for name in ("PartOffsets", "NumberOfParts", "PointOffsets"):
        _growing(steps, name)
    for name in ("CellOffsets", "ConnectivityIdOffsets"):
        _growing(steps, name, (len(_TOPOLOGIES),))
    offsets = steps.create_group("PointDataOffsets")
    for name in frame.fields:
        _growing(offsets, name)


def _append(root: h5py.Group, time: float, frame: Frame) -> None:
    """Write one frame's rows and then its line of `Steps`."""
    if set(frame.fields) != set(root["PointData"]):
        raise ShearwaterError(
            f"{root.file.filename}: a frame with the fields {sorted(frame.fields)} does not fit the "
            f"file, which holds {sorted(root['PointData'])}; write it to a new run directory."
        )
    count = len(frame.position)
    first = len(root["Points"])
    if len(root["NumberOfPoints"]) == 0 or root["NumberOfPoints"][-1] != count:
        _append_part(root, count)
    part = len(root["NumberOfPoints"]) - 1
    _extend(root["Points"], _padded(frame.position))
    for name, values in frame.fields.items():
        _extend(root["PointData"][name], _padded(values))
    steps = root["Steps"]
    vertices = root["Vertices"]
    none = [0] * (len(_TOPOLOGIES) - 1)
    for name, value in (("PartOffsets", part), ("NumberOfParts", 1), ("PointOffsets", first)):
        _extend(steps[name], [value])
    _extend(steps["CellOffsets"], [[vertices["NumberOfCells"][:part].sum(), *none]])
    _extend(steps["ConnectivityIdOffsets"], [[vertices["NumberOfConnectivityIds"][:part].sum(), *none]])
    for name in frame.fields:
        _extend(steps["PointDataOffsets"][name], [first])
    _extend(steps["Values"], [time])


def _append_part(root: h5py.Group, count: int) -> None:
    """Vertex cells for `count` particles, used by all frames that follow until the count changes."""
    for topology in _TOPOLOGIES:
        cells = root[topology]
        vertices = count if topology == "Vertices" else 0
        _extend(cells["NumberOfCells"], [vertices])
        _extend(cells["NumberOfConnectivityIds"], [vertices])
        _extend(cells["Connectivity"], np.arange(vertices))
        _extend(cells["Offsets"], np.arange(vertices + 1))
    _extend(root["NumberOfPoints"], [count])


def _truncate(root: h5py.Group, time: float) -> None:
    """Cut every array to the complete frames before `time` [s]."""
    steps = root["Steps"]
    complete = int(steps.attrs["NSteps"])
    kept = int(np.searchsorted(steps["Values"][:complete], time))
    # First the count: a file cut off between these lines must not promise frames that are gone.
    steps.attrs.modify("NSteps", np.int64(kept))
    rows = _rows(root, kept - 1).stop if kept else 0
    parts = int(steps["PartOffsets"][kept - 1]) + 1 if kept else 0
    for data in (root["Points"], *root["PointData"].values()):
        data.resize(rows, axis=0)
    for topology in _TOPOLOGIES:
        cells = root[topology]
        number = int(cells["NumberOfCells"][:parts].sum())
        lengths = {"NumberOfCells": parts, "NumberOfConnectivityIds": parts}
        for name, length in {**lengths, "Connectivity": number, "Offsets": number + parts}.items():
            cells[name].resize(length, axis=0)
    root["NumberOfPoints"].resize(parts, axis=0)
    for data in (*steps.values(), *steps["PointDataOffsets"].values()):
        if isinstance(data, h5py.Dataset):
            data.resize(kept, axis=0)


def _rows(root: h5py.Group, step: int) -> slice:
    """The rows of `Points` and of the fields that belong to frame `step`."""
    first = int(root["Steps/PointOffsets"][step])
    return slice(first, first + int(root["NumberOfPoints"][root["Steps/PartOffsets"][step]]))


def _growing(group, name: str, row: tuple[int, ...] = (), dtype=np.int64, chunk: int = 256) -> None:
    """An empty dataset that grows along its first axis."""
    group.create_dataset(name, (0, *row), dtype, maxshape=(None, *row), chunks=(chunk, *row))


def _extend(data: h5py.Dataset, rows) -> None:
    rows = np.asarray(rows)
    end = len(data)
    data.resize(end + len(rows), axis=0)
    data[end:] = rows


def _padded(values: np.ndarray) -> np.ndarray:
    """Vectors (n, 2) as (n, 3) with z = 0; scalars as they are."""
    values = np.asarray(values)
    if values.ndim == 1:
        return values
    return np.column_stack([values, np.zeros(len(values), dtype=values.dtype)])


def _flat(data: h5py.Dataset, rows: slice) -> np.ndarray:
    """The inverse of `_padded`."""
    return data[rows] if data.ndim == 1 else data[rows][:, :2]


def _stored_type(values: np.ndarray) -> np.dtype:
    """HDF5's booleans are an enumeration that VTK does not read: bytes instead."""
    dtype = np.asarray(values).dtype
    return np.dtype(np.uint8) if dtype == np.bool_ else dtype


def _cannot_go_on(path: Path, error: Exception) -> BadInput:
    return BadInput(
        f"Frames cannot be added to {path}, for it is damaged or must not be written to ({error}). Move it away to go "
        "on without the frames that it holds."
    )


def _cannot_write(path: Path, error: Exception) -> ShearwaterError:
    return cannot_write("The file of frames", path, error, ", ask for fewer frames (--set output.frames=10)")
