"""PyBullet's CPU renderer: DIRECT, TinyRenderer, shadows on; a segmentation mask where ids are wanted.

Light stands as near as it does by default: its shadows, around the world's origin, then cost least.
"""

import sys
from importlib.metadata import version

import numpy as np
import pybullet as p

from stage import FAR_M, NEAR_M, Stage, serve

# Where light comes from: the bench's own lamps shine along the opposite.
LIGHT = [-0.24, 0.17, 1.0]


def build(stage):
    """One body an object, in the order of the stage: their ids are 0, 1, 2, ..."""
    p.connect(p.DIRECT)
    palette = p.loadTexture(str(stage.folder / "palette.png"))
    for mesh, *place in stage.objects:
        shape = p.createVisualShape(p.GEOM_MESH, fileName=str(stage.meshes[int(mesh)]), rgbaColor=[1, 1, 1, 1])
        body = p.createMultiBody(0, -1, shape, place[:3], place[3:])
        p.changeVisualShape(body, -1, textureUniqueId=palette)


def main():
    stage = Stage(sys.argv[1])
    build(stage)
    views = [p.computeViewMatrix(c.eye, c.eye + c.forward, c.up) for c in stage.cameras]

    def prepare(width, height, want_all):
        flags = 0 if want_all else p.ER_NO_SEGMENTATION_MASK
        aspect = width / height
        lenses = [p.computeProjectionMatrixFOV(c.fov_y_deg, aspect, NEAR_M, FAR_M) for c in stage.cameras]

        def draw(index):
            _, _, color, depth, bodies = p.getCameraImage(
                width,
                height,
                views[index],
                lenses[index],
                lightDirection=LIGHT,
                shadow=1,
                renderer=p.ER_TINY_RENDERER,
                flags=flags,
            )
            if not want_all:
                return color, None, None
            return color, np.float32(FAR_M * NEAR_M) / (np.float32(FAR_M) - np.float32(FAR_M - NEAR_M) * depth), bodies

        return draw

    serve(f"pybullet {version('pybullet')} (TinyRenderer)", stage, prepare)


if __name__ == "__main__":
    main()
