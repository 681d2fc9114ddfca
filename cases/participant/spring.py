"""A structure of one's own: one mass on a spring that moves in x, as a program that needs nothing of Shearwater.

    coupler run piston --solid-command "python cases/participant/spring.py"

The messages and verbs are in shared/wire.py, the zenoh keys in shared/link_zenoh.py. Under a constant mean force the
motion within a window is exact, whatever the window. Its interface points are the four corners of the body.
"""

import argparse
import os
import threading
import time
import tomllib

import msgpack
import numpy as np
import zenoh

parser = argparse.ArgumentParser()
parser.add_argument("verb", choices=["serve"])
parser.add_argument("case")
for option in ("--connect", "--run", "--out", "--threads", "--parent"):
    parser.add_argument(option)
given = parser.parse_args()

with open(given.case, "rb") as file:
    scene = tomllib.load(file)
solid = scene["solid"]
x0, y0, x1, y1 = solid["bodies"][0]["rectangle"]
corners = np.array([[x0, y0], [x1, y0], [x0, y1], [x1, y1]])
mass, stiffness = solid["density"] * (x1 - x0) * (y1 - y0), solid["spring"]["stiffness"][0]  # kg/m, N/m per metre
omega, push = np.sqrt(stiffness / mass), sum(mass * load["acceleration"][0] for load in solid["loads"])
own = [p["name"] for p in scene["probes"] if p.get("body") and p["quantity"] == "displacement-x"]
start = now = (0.0, 0.0)  # displacement [m] and speed [m/s] at the window's start, and now
accepted = steps = 0


def move(force, dt):
    """Over a window of `dt` [s] under `force` [N/m]: the motion of the selected points."""
    global now, steps
    (u0, v0), rest, c, s = start, force / stiffness, np.cos(omega * dt), np.sin(omega * dt)
    now = rest + (u0 - rest) * c + v0 / omega * s, v0 * c - (u0 - rest) * omega * s
    steps += 1
    return motion(now, (force - stiffness * now[0]) / mass, (now[0] - u0) / dt, (now[1] - v0) / dt)


def motion(state, acceleration, mean_velocity, mean_acceleration):
    along = lambda value: packed(np.tile([value, 0.0], (len(selection), 1)))  # noqa: E731
    fields = {"position": packed(corners[selection] + [state[0], 0.0]), "velocity": along(state[1])}
    means = {"velocity_mean": along(mean_velocity), "acceleration_mean": along(mean_acceleration)}
    return fields | {"acceleration": along(acceleration)} | means


def packed(array, dtype="<f8"):
    return {"dtype": dtype, "shape": list(array.shape), "data": np.ascontiguousarray(array, dtype).tobytes()}


def unpacked(field):
    return np.frombuffer(field["data"], field["dtype"]).reshape(field["shape"])


def probes():
    return {"probes": {name: float(now[0]) for name in own}}


def accept():
    """The window is final; the probes, if one of the run's `probe_rows` times is in it."""
    global start, accepted
    start, accepted = now, accepted + 1
    due = accepted * order["probe_rows"] // order["windows"] > (accepted - 1) * order["probe_rows"] // order["windows"]
    return probes() if due else {}


def answer(request):
    """Info and fields of the reply."""
    global start, now, accepted, selection, order
    verb, info, fields = request["verb"], request["info"], request["fields"]
    if verb == "describe":
        numbers = {"density": solid["density"], "thickness": x1 - x0}
        lengths = {"stable_step": scene["end_time"], "spacing": max(x1 - x0, y1 - y0)}
        areas, bodies = np.full(4, 0.25 * (x1 - x0) * (y1 - y0)), np.zeros(4)
        points = {"position": packed(corners), "volume": packed(areas), "body": packed(bodies, "<i8")}
        return {"name": "solid", "role": "structure", "model": "one-mass", "numbers": numbers, **lengths}, points
    if verb == "start":
        order, selection = info, unpacked(fields["selection"])
        return probes(), motion(now, push / mass, 0.0, push / mass)
    if verb == "advance":
        force = push + unpacked(fields["force"])[:, 0].sum()
        moved = move(force, request["t1"] - request["t0"])
        return accept() if info.get("final") else {}, moved
    if verb == "accept":
        return accept(), {}
    if verb == "rollback":
        now = start
    elif verb == "save":
        with open(info["path"], "wb") as file:
            file.write(msgpack.packb([*map(float, now), accepted]))
    elif verb == "load":
        with open(info["path"], "rb") as file:
            u, v, accepted = msgpack.unpackb(file.read())
        start = now = (u, v)
    return {"cost": {"core_s": time.process_time(), "steps": steps}} if verb == "finish" else {}, {}


config = zenoh.Config()
config.insert_json5("mode", '"client"')
config.insert_json5("connect/endpoints", f'["{given.connect}"]')
session, key = zenoh.open(config), f"shearwater/{given.run}/solid"
requests = session.declare_subscriber(f"{key}/request", zenoh.handlers.FifoChannel(4))
replies = session.declare_publisher(f"{key}/reply", congestion_control=zenoh.CongestionControl.BLOCK, express=True)


def beat():
    """Tell the steps done once a second; end with the coupler."""
    while given.parent is None or os.getppid() == int(given.parent):
        session.put(f"{key}/heartbeat", str(steps))
        time.sleep(1.0)
    os._exit(4)


threading.Thread(target=beat, daemon=True).start()
token = session.liveliness().declare_token(f"{key}/alive")
verb = ""
while verb != "finish":
    request = msgpack.unpackb(requests.recv().payload.to_bytes())
    verb, parts = request["verb"], {"sender": "solid"}
    try:
        parts["info"], parts["fields"] = answer(request)
    except Exception as error:
        parts |= {"verb": "error", "info": {"text": f"spring: {error!r}", "exit_code": 3}, "fields": {}}
    replies.put(msgpack.packb(request | parts))
session.close()
