"""The stage that the bench wrote, and the conversation with it."""

import math
import sys
import time
from pathlib import Path

import numpy as np

NEAR_M, FAR_M = 0.03, 100.0
WARM_UP_FRAMES = 2


class Stage:
    """Meshes, what stands where, and cameras."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.meshes = sorted(self.folder.glob("*.obj"))
        # A row each: mesh, x, y, z, and the rotation as x, y, z, w.
        self.objects = np.loadtxt(self.folder / "objects.txt")
        # A row each: x, y, z, yaw, pitch, vertical field of view.
        self.cameras = [Camera(*row) for row in np.loadtxt(self.folder / "cameras.txt")]


class Camera:
    """Where one stands and which way it looks."""

    def __init__(self, x, y, z, yaw_rad, pitch_rad, fov_y_rad):
        self.eye = np.array([x, y, z])
        self.fov_y_deg = math.degrees(fov_y_rad)
        sin_yaw, cos_yaw = math.sin(yaw_rad), math.cos(yaw_rad)
        sin_pitch, cos_pitch = math.sin(pitch_rad), math.cos(pitch_rad)
        self.forward = np.array([cos_pitch * cos_yaw, cos_pitch * sin_yaw, sin_pitch])
        self.right = np.array([sin_yaw, -cos_yaw, 0.0])
        self.up = np.cross(self.right, self.forward)


def serve(name, stage, prepare):
    """Answers each line `WIDTH HEIGHT all|color [FOLDER]` with CPU ms and wall ms of a frame, camera by camera.

    `prepare(width, height, all)` gives a function from a camera's index to its picture: colour, depth in metres and
    each pixel's object, the last two only when all are wanted. Pictures are kept in the folder if there is one.
    """
    print("ready", name, flush=True)
    for line in sys.stdin:
        width, height, what, *folder = line.split(maxsplit=3)
        draw = prepare(int(width), int(height), what == "all")
        for index in range(WARM_UP_FRAMES):
            draw(index % len(stage.cameras))
        times = []
        for index in range(len(stage.cameras)):
            cpu, wall = time.process_time(), time.perf_counter()
            picture = draw(index)
            times += [time.process_time() - cpu, time.perf_counter() - wall]
            if folder:
                color, depth_m, objects = picture
                planes = color[:, :, :3].astype("u1"), depth_m.astype("<f4"), objects.astype("<i4")
                path = Path(folder[0].strip()) / f"{name.split()[0]}-{index}.raw"
                path.write_bytes(b"".join(plane.tobytes() for plane in planes))
        print("times", *(f"{seconds * 1e3:.4f}" for seconds in times), flush=True)
