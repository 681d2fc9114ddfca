"""The frame files: what is written is what is read, by h5py and by VTK's own reader, also after a kill."""

import os
import signal
import subprocess
import sys
import time

import h5py
import numpy as np
import pytest

from shared.contract import BadInput, Frame, ShearwaterError
from shared.run.vtkhdf import FrameWriter, read_frame


def cloud(count, seed):
    """A random frame with a scalar, a vector and an integer field."""
    rng = np.random.default_rng(seed)
    fields = {
        "pressure": rng.normal(size=count),
        "velocity": rng.normal(size=(count, 2)),
        "body": rng.integers(0, 3, count),
    }
    return Frame(rng.normal(size=(count, 2)), fields)


# Particles leave between the second and third frame, come back, and are all gone at the end.
FRAMES = [(0.1 * i, cloud(count, i)) for i, count in enumerate((7, 7, 5, 5, 8, 8, 0))]


def write(path, frames):
    with FrameWriter(path) as writer:
        for instant, frame in frames:
            writer.append(instant, frame)
    return path


def assert_same(frame, other):
    np.testing.assert_array_equal(frame.position, other.position)
    assert set(frame.fields) == set(other.fields)
    for name, values in frame.fields.items():
        np.testing.assert_array_equal(values, other.fields[name])


def test_every_frame_comes_back_bit_for_bit(tmp_path):
    path = write(tmp_path / "fluid.vtkhdf", FRAMES)
    for index, (instant, frame) in enumerate(FRAMES):
        found, other = read_frame(path, index)
        assert found == instant
        assert_same(frame, other)
    assert read_frame(path)[0] == FRAMES[-1][0]
    with pytest.raises(BadInput, match="holds 7 frames"):
        read_frame(path, 7)


def test_structure_is_temporal_polydata(tmp_path):
    with h5py.File(write(tmp_path / "fluid.vtkhdf", FRAMES)) as file:
        root = file["VTKHDF"]
        assert root.attrs["Type"] == b"PolyData"
        assert list(root.attrs["Version"]) == [2, 0]
        steps = root["Steps"]
        assert steps.attrs["NSteps"] == len(FRAMES)
        np.testing.assert_array_equal(steps["Values"], [t for t, _ in FRAMES])
        # One part, and one set of vertices, per run of frames with equal counts.
        np.testing.assert_array_equal(root["NumberOfPoints"], [7, 5, 8, 0])
        np.testing.assert_array_equal(steps["PartOffsets"], [0, 0, 1, 1, 2, 2, 3])
        np.testing.assert_array_equal(steps["CellOffsets"][:, 0], [0, 0, 7, 7, 12, 12, 20])
        np.testing.assert_array_equal(steps["PointOffsets"], [0, 7, 14, 19, 24, 32, 40])
        assert len(root["Vertices/Connectivity"]) == 7 + 5 + 8
        assert len(root["Vertices/Offsets"]) == 7 + 5 + 8 + 4
        assert root["Points"].shape == (40, 3)
        assert not root["Points"][:, 2].any()
        assert not root["PointData/velocity"][:, 2].any()
        for empty in ("Lines", "Strips", "Polygons"):
            np.testing.assert_array_equal(root[empty]["NumberOfCells"], [0, 0, 0, 0])


def test_vtk_reads_the_time_series(tmp_path):
    pytest.importorskip("vtk")
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader = vtkHDFReader()
    reader.SetFileName(str(write(tmp_path / "fluid.vtkhdf", FRAMES)))
    reader.UpdateInformation()
    assert reader.GetNumberOfSteps() == len(FRAMES)
    # Backwards too: a reader that jumps must not see another frame's vertices.
    for index in (*range(len(FRAMES)), 2, 0, 5):
        instant, frame = FRAMES[index]
        reader.SetStep(index)
        reader.Update()
        assert reader.GetTimeValue() == instant
        data = reader.GetOutput()
        count = len(frame.position)
        assert data.GetNumberOfPoints() == data.GetNumberOfVerts() == data.GetNumberOfCells() == count
        if count == 0:
            continue
        np.testing.assert_array_equal(vtk_to_numpy(data.GetPoints().GetData())[:, :2], frame.position)
        np.testing.assert_array_equal(vtk_to_numpy(data.GetVerts().GetConnectivityArray()), np.arange(count))
        np.testing.assert_array_equal(vtk_to_numpy(data.GetVerts().GetOffsetsArray()), np.arange(count + 1))
        for name, values in frame.fields.items():
            found = vtk_to_numpy(data.GetPointData().GetArray(name))
            np.testing.assert_array_equal(found if values.ndim == 1 else found[:, :2], values)


def test_continuing_replaces_frames_past_the_checkpoint(tmp_path):
    whole = write(tmp_path / "whole.vtkhdf", FRAMES)
    path = write(tmp_path / "resumed.vtkhdf", [*FRAMES[:4], (0.35, cloud(3, 99)), (0.45, cloud(3, 98))])
    write(path, FRAMES[4:])
    with h5py.File(whole) as a, h5py.File(path) as b:
        names = []
        a.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
        assert len(names) > 20
        # The stray frame at 0.35 s stays, being earlier than the next one; that at 0.45 s is gone.
        assert b["VTKHDF/Steps"].attrs["NSteps"] == len(FRAMES) + 1
    path = write(tmp_path / "resumed2.vtkhdf", FRAMES)
    write(path, FRAMES[2:])
    with h5py.File(whole) as a, h5py.File(path) as b:
        for name in names:
            np.testing.assert_array_equal(a[name], b[name], err_msg=name)


def test_frame_cut_short_is_ignored_and_overwritten(tmp_path):
    """As a kill between the rows and the count of frames leaves it."""
    path = write(tmp_path / "fluid.vtkhdf", FRAMES[:3])
    with h5py.File(path, "a") as file:
        for name in ("Points", "Steps/Values", "Steps/PointOffsets", "PointData/pressure", "NumberOfPoints"):
            data = file["VTKHDF"][name]
            data.resize(len(data) + 1, axis=0)
    assert read_frame(path)[0] == FRAMES[2][0]
    assert_same(read_frame(path)[1], FRAMES[2][1])
    write(path, FRAMES[3:])
    for index, (_, frame) in enumerate(FRAMES):
        assert_same(frame, read_frame(path, index)[1])


WRITE_FOREVER = """
import sys, numpy as np
from shared.contract import Frame
from shared.run.vtkhdf import FrameWriter
rng = np.random.default_rng(1)
with FrameWriter(sys.argv[1]) as writer:
    for i in range(100000):
        n = 5000 - i % 7
        writer.append(float(i), Frame(np.full((n, 2), i), {"speed": np.full(n, i)}))
        print(i, flush=True)
"""


def test_file_is_readable_after_kill(tmp_path):
    path = tmp_path / "fluid.vtkhdf"
    command = [sys.executable, "-c", WRITE_FOREVER, str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as writer:
        written = [int(writer.stdout.readline()) for _ in range(10)][-1]
        time.sleep(0.05)
        writer.send_signal(signal.SIGKILL)
    instant, frame = read_frame(path)
    assert instant >= written
    np.testing.assert_array_equal(frame.position, np.full((5000 - int(instant) % 7, 2), instant))
    np.testing.assert_array_equal(frame.fields["speed"], instant)


WRITE_UNTIL_FULL = f"""
import resource, signal, sys
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (4_000_000, 4_000_000))
from shared.contract import ShearwaterError
try:
    {WRITE_FOREVER.strip().replace(chr(10), chr(10) + "    ")}
except ShearwaterError as error:
    print("REFUSED", error)
    sys.exit(error.exit_code)
"""


def test_full_disk_is_explained_and_leaves_earlier_frames(tmp_path):
    path = tmp_path / "fluid.vtkhdf"
    run = subprocess.run(
        [sys.executable, "-c", WRITE_UNTIL_FULL, str(path)], capture_output=True, text=True, timeout=60
    )
    lines = run.stdout.splitlines()
    assert run.returncode == ShearwaterError.exit_code, run.stderr
    assert "Traceback" not in run.stderr
    assert "REFUSED" in lines[-1]
    assert "disk may be full" in lines[-1]
    assert str(path) in lines[-1]
    written = int(lines[-2])
    instant, frame = read_frame(path)
    assert instant == written
    np.testing.assert_array_equal(frame.fields["speed"], instant)


@pytest.mark.parametrize("harm", [lambda path: path.unlink(), lambda path: os.truncate(path, 100)])
def test_frames_that_another_program_took_end_the_run(tmp_path, harm):
    """The next frame filled the hole with zeros: the run had finished, with a file that nothing could read."""
    path = tmp_path / "fluid.vtkhdf"
    points = Frame(np.zeros((3, 2)), {})
    with FrameWriter(path) as writer:
        writer.append(0.0, points)
        writer.append(1.0, points)
        harm(path)
        with pytest.raises(ShearwaterError, match=r"fluid\.vtkhdf .*\[Errno .* Another program has removed it or cut"):
            writer.append(2.0, points)


def test_refusals(tmp_path):
    with pytest.raises(ShearwaterError, match="cannot be written"):
        FrameWriter(tmp_path / "missing" / "fluid.vtkhdf")
    path = write(tmp_path / "fluid.vtkhdf", FRAMES[:1])
    with FrameWriter(path) as writer, pytest.raises(ShearwaterError, match="does not fit the file"):
        writer.append(1.0, Frame(np.zeros((2, 2)), {"pressure": np.zeros(2)}))
    (tmp_path / "text.vtkhdf").write_text("not HDF5")
    with pytest.raises(BadInput, match="not a readable file"):
        read_frame(tmp_path / "text.vtkhdf")
    with pytest.raises(BadInput, match="not a readable file"):
        read_frame(tmp_path / "absent.vtkhdf")
