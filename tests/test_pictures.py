"""Pictures, read back as pixels: true proportions, particles that tile, walls where they have moved to."""

import os
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

from shared.contract import BadInput, Frame
from shared.run.drawing import si_scale
from shared.run.pictures import draw_last_frame, draw_pictures
from shared.run.probe_plots import draw_probes
from shared.run.probes import ProbeTable
from shared.run.vtkhdf import FrameWriter
from shared.schema.scene import Scene

DX = 0.01


def scene(fluid=False, solid=False, walls=(), probes=(), references=(), average_from=0.0):
    """A scene with a 0.4 m × 0.2 m block of water, a 0.4 m × 0.1 m beam, or both."""
    data = {"schema": 1, "title": "Test", "end_time": 1.0, "gravity": [0.0, -9.81], "walls": list(walls)}
    data |= {"probes": list(probes), "references": list(references), "output": {"average_from": average_from}}
    if fluid:
        data["fluid"] = {
            "model": "wcsph",
            "dx": DX,
            "bodies": [{"name": "water", "rectangle": [0.0, 0.0, 0.4, 0.2]}],
        }
    if solid:
        data["solid"] = {
            "model": "total-lagrangian",
            "dx": DX,
            "density": 1000.0,
            "youngs_modulus": 1e6,
            "bodies": [{"name": "beam", "rectangle": [0.0, 0.0, 0.4, 0.1]}],
        }
    return Scene.model_validate(data)


def lattice(width, height):
    """Cell-centred points of a rectangle at the origin."""
    x, y = np.meshgrid(np.arange(DX / 2, width, DX), np.arange(DX / 2, height, DX))
    return np.column_stack([x.ravel(), y.ravel()])


def water(position, speed=1.0):
    velocity = np.column_stack([np.full(len(position), speed), np.zeros(len(position))])
    return Frame(position, {"velocity": velocity, "pressure": 1000.0 * 9.81 * (0.2 - position[:, 1])})


def write(run_dir, side, frame, time=0.5):
    with FrameWriter(run_dir / f"{side}.vtkhdf") as writer:
        writer.append(time, frame)


def pixels(path):
    return np.asarray(Image.open(path).convert("RGB")).astype(int)


def like(image, colour, tolerance=40):
    """Where the picture has about this colour."""
    return np.abs(image - np.array(colour)).max(axis=2) <= tolerance


def box(mask):
    """Rows and columns spanned by a mask: top, bottom, left, right."""
    rows, columns = np.nonzero(mask)
    return rows.min(), rows.max(), columns.min(), columns.max()


YELLOW = (253, 231, 37)  # the upper end of the fluid's colours: uniform speed
WALL = (38, 38, 38)


def test_water_tiles_and_keeps_its_proportions(tmp_path):
    write(tmp_path, "fluid", water(lattice(0.4, 0.2)))
    image = pixels(draw_last_frame(tmp_path, scene(fluid=True)))
    picture = like(image, YELLOW)[:, : int(0.89 * image.shape[1])]  # without the colour bar
    top, bottom, left, right = box(picture)
    assert (right - left) / (bottom - top) == pytest.approx(2.0, rel=0.03)
    assert picture[top : bottom + 1, left : right + 1].mean() > 0.98  # no white between the particles


def test_far_spray_does_not_shrink_the_picture(tmp_path):
    block = lattice(0.4, 0.2)
    write(tmp_path, "fluid", water(np.vstack([block, [[0.2, 30.0], [np.nan, np.nan]]])))
    image = pixels(draw_last_frame(tmp_path, scene(fluid=True)))
    top, bottom, left, right = box(like(image, YELLOW)[:, : int(0.89 * image.shape[1])])
    assert right - left > 0.6 * image.shape[1]
    assert (right - left) / (bottom - top) == pytest.approx(2.0, rel=0.06)


def test_water_at_rest_shows_its_pressure(tmp_path):
    write(tmp_path, "fluid", water(lattice(0.4, 0.2), speed=1e-3))
    image = pixels(draw_last_frame(tmp_path, scene(fluid=True)))
    middle = image[:, int(0.45 * image.shape[1])]
    painted = middle[np.ptp(middle, axis=1) > 25]  # coloured, not white, grey or black
    # From pale at the surface to dark at the bottom.
    assert painted[5].sum() > painted[-5].sum() + 150


def test_walls_stand_where_they_have_moved_to(tmp_path):
    """A wall that starts on the water's left face and ends on its right one."""
    motion = {"times": [0.0, 0.5], "translation": [[0.0, 0.0], [0.5, 0.0]]}
    fixed = {"name": "floor", "polyline": [[-0.1, 0.0], [0.6, 0.0]]}
    moving = {"name": "gate", "polyline": [[0.0, 0.3], [0.0, 0.0]], "motion": motion}
    write(tmp_path, "fluid", water(lattice(0.4, 0.2)), time=0.8)  # past the table's end: held
    image = pixels(draw_last_frame(tmp_path, scene(fluid=True, walls=[fixed, moving])))
    water_box = box(like(image, YELLOW)[:, : int(0.89 * image.shape[1])])
    dark = like(image, WALL, 20)
    per_metre = (water_box[3] - water_box[2]) / (0.4 + 0.45 * DX)
    column = round(water_box[2] + (0.5 + 0.225 * DX) * per_metre)
    above_water = slice(water_box[0] - round(0.06 * per_metre), water_box[0] - 5)
    assert dark[above_water, column - 4 : column + 5].any(axis=1).mean() > 0.9
    start = round(water_box[2])
    assert not dark[above_water, start - 4 : start + 5].any()


def test_tiny_deflection_is_magnified_alone_but_not_beside_water(tmp_path):
    reference = lattice(0.4, 0.1)
    sag = np.column_stack([np.zeros(len(reference)), -1e-6 * np.sin(np.pi * reference[:, 0] / 0.4)])
    fields = {"displacement": sag, "von_mises": np.full(len(reference), 1e3)}
    frame = Frame(reference + sag, fields)
    pale = (252, 255, 164)  # the upper end of the solid's colours
    heights = []
    for run, both in (("alone", False), ("both", True)):
        (tmp_path / run).mkdir()
        write(tmp_path / run, "solid", frame)
        if both:
            write(tmp_path / run, "fluid", water(lattice(0.4, 0.2) + [0.0, 0.1]))
        image = pixels(draw_last_frame(tmp_path / run, scene(fluid=both, solid=True)))
        without_bars = image[:, : int((0.8 if both else 0.89) * image.shape[1])]
        top, bottom, left, right = box(like(without_bars, pale, 6))  # not the rim of yellow on white
        heights.append((bottom - top) / (right - left))
    assert heights[0] > 1.15 * 0.25
    assert heights[1] == pytest.approx(0.25, rel=0.06)


def test_a_run_without_data_has_no_pictures(tmp_path):
    assert draw_pictures(tmp_path, scene(fluid=True)) == []
    with pytest.raises(BadInput, match="holds no frames"):
        draw_last_frame(tmp_path, scene(fluid=True))
    FrameWriter(tmp_path / "fluid.vtkhdf").close()  # failed before its first frame
    ProbeTable(tmp_path / "probes.csv", {"front": "m"}).close()
    assert draw_pictures(tmp_path, scene(fluid=True)) == []
    write(tmp_path, "fluid", water(lattice(0.0, 0.0)))  # everything has left the domain
    assert draw_pictures(tmp_path, scene(fluid=True)) == [tmp_path / "last_frame.png"]


PROBE = {"name": "tip", "quantity": "displacement-x", "body": "beam", "point": [0.2, 0.1]}
BLUE, FIRST = (11, 79, 138), (213, 94, 0)  # the run, the first reference


def probe_image(tmp_path, references=(), average_from=0.0):
    with ProbeTable(tmp_path / "probes.csv", {"tip": "m"}) as table:
        for time in np.linspace(0.0, 1.0, 201):
            table.append(time, {"tip": 0.04 * time})
    described = scene(solid=True, probes=[PROBE], references=references, average_from=average_from)
    (path,) = draw_probes(tmp_path, described)
    assert path.name == "probe-tip.png"
    return pixels(path)


def test_probe_and_reference_share_axes(tmp_path):
    """A level of half the run's last value crosses the run in the middle of the picture."""
    reference = {"probe": "tip", "name": "half", "value": 0.02, "statistic": "final"}
    image = probe_image(tmp_path, [reference])
    plot = image[100:-130, 400:]  # clear of legend and labels
    rows, columns = np.nonzero(like(plot, BLUE, 25))
    level = np.median(np.nonzero(like(plot, FIRST, 25))[0])
    where = columns[np.abs(rows - level) < 3].mean() + 400
    assert where == pytest.approx((0.8 + 0.5 * 5.55) * 200, abs=8)  # middle of the axes [px]


def test_probe_curve_is_scaled_and_clipped(tmp_path):
    """A curve in mm of the same ramp, running on ten times as long, lies on the run and stretches nothing."""
    curve = tmp_path / "curve.csv"
    curve.write_text("\n".join(f"{t},{40.0 * t}" for t in np.linspace(0.0, 10.0, 401)))
    reference = {"probe": "tip", "name": "curve", "curve": str(curve), "scale": [1.0, 1e-3]}
    image = probe_image(tmp_path, [reference])[100:-130, 500:]
    top, bottom, *_ = box(like(image, BLUE, 25))
    assert bottom - top > 0.5 * len(image)
    dots = np.argwhere(like(image, FIRST, 25))
    assert len(dots) > 20
    blue = np.argwhere(like(image, BLUE, 25))
    distance = np.abs(dots[:, None, :] - blue[None, ::5, :]).max(axis=2).min(axis=1)
    assert distance.max() < 12


def test_window_of_the_mean_is_shaded(tmp_path):
    grey = (240, 240, 240)
    assert like(probe_image(tmp_path, average_from=0.5), grey, 2).sum() > 50_000
    assert like(probe_image(tmp_path), grey, 2).sum() < 5_000


def test_si_prefixes():
    assert si_scale(0.045, "m") == (1e-3, "mm")
    assert si_scale(0.7, "s") == (1.0, "s")
    assert si_scale(5.986e-5, "m") == (1e-6, "µm")
    assert si_scale(2864.0, "Pa") == (1e3, "kPa")
    assert si_scale(1500.0, "m") == (1.0, "m")
    assert si_scale(12.0, "particles") == (1.0, "particles")
    assert si_scale(0.0, "m") == (1.0, "m")


def test_drawing_leaves_no_global_state():
    """pyplot would keep figures alive and pick a window system."""
    code = "import sys, shared.run.pictures; sys.exit('matplotlib.pyplot' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], timeout=60).returncode == 0


_DRAWS = """
import sys
from pathlib import Path
from shared.commands import new_app, run_app
app = new_app("Draws.")
@app.command()
def draw(out: Path) -> None:
    from shared.run.drawing import axes_at, new_figure, save
    figure = new_figure(2.0, 2.0)
    axes_at(figure, 0.5, 0.5, 1.0, 1.0).set_xlabel("x")
    save(figure, out)
run_app(app)
"""


def test_what_a_user_wants_of_other_pictures_spoils_none(tmp_path):
    (tmp_path / "matplotlibrc").write_text("text.usetex: True\nsavefig.bbox: tight\n")
    wants = {"MPLBACKEND": "module://not_installed.backend", "MATPLOTLIBRC": str(tmp_path), "PATH": "/nowhere"}
    subprocess.run([sys.executable, "-c", _DRAWS, tmp_path / "x.png"], env=os.environ | wants, check=True)
    assert Image.open(tmp_path / "x.png").size == (400, 400)
