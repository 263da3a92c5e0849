"""MuJoCo's renderer on a software driver: colour and depth in one pass, segmentation in a second; shadows on.

Nothing is asked for that costs more: no multisampling, no reflections, shadows as coarse as this project's own. The
ceilings throw shadows too, so that rooms lie in ambient light; without ceilings a frame costs as much.
"""

import sys

import mujoco
import numpy as np
from OpenGL import GL

from stage import FAR_M, NEAR_M, Stage, serve

SHADOW_TEXELS = 1024
MOST_GEOMS = 2000


def numbers(values):
    return " ".join(f"{value:.6g}" for value in values)


def build(stage):
    """One geom an object, in the order of the stage."""
    meshes = "".join(f'<mesh name="{m.stem}" file="{m}" inertia="shell"/>' for m in stage.meshes)
    geoms = "".join(
        f'<geom type="mesh" mesh="{stage.meshes[int(mesh)].stem}" pos="{numbers(place[:3])}" '
        f'quat="{numbers([place[6], *place[3:6]])}" material="palette" contype="0" conaffinity="0"/>'
        for mesh, *place in stage.objects
    )
    cameras = "".join(
        f'<camera pos="{numbers(c.eye)}" xyaxes="{numbers([*c.right, *c.up])}" fovy="{c.fov_y_deg:.6g}"/>'
        for c in stage.cameras
    )
    middle = np.mean([c.eye for c in stage.cameras], axis=0)
    reach_m = max(np.abs(stage.objects[:, 1:3] - middle[:2]).max(), 1.0) + 2.0
    return mujoco.MjModel.from_xml_string(f"""
    <mujoco>
      <statistic extent="1" center="{numbers(middle)}"/>
      <visual>
        <global offwidth="64" offheight="64"/>
        <quality shadowsize="{SHADOW_TEXELS}" offsamples="0"/>
        <map znear="{NEAR_M}" zfar="{FAR_M}" shadowclip="{reach_m:.6g}"/>
        <headlight ambient="0.45 0.45 0.45" diffuse="0.1 0.1 0.1" specular="0 0 0"/>
      </visual>
      <asset>
        <texture name="palette" type="2d" file="{stage.folder}/palette.png"/>
        <material name="palette" texture="palette" specular="0"/>
        {meshes}
      </asset>
      <worldbody>
        <light directional="true" castshadow="true" pos="{numbers([*middle[:2], 12])}" dir="0.24 -0.17 -1"
               diffuse="0.5 0.5 0.5" specular="0 0 0"/>
        {cameras}
        {geoms}
      </worldbody>
    </mujoco>""")


def main():
    stage = Stage(sys.argv[1])
    model = build(stage)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    gl = mujoco.GLContext(64, 64)
    gl.make_current()
    context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
    mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, context)
    scene = mujoco.MjvScene(model, maxgeom=MOST_GEOMS)
    camera = mujoco.MjvCamera()
    camera.type, camera.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, 0
    option = mujoco.MjvOption()
    mujoco.mjv_updateScene(model, data, option, None, camera, mujoco.mjtCatBit.mjCAT_ALL.value, scene)
    flag = mujoco.mjtRndFlag

    def prepare(width, height, want_all):
        mujoco.mjr_resizeOffscreen(width, height, context)
        rect = mujoco.MjrRect(0, 0, width, height)
        color, coded = np.empty((2, height, width, 3), np.uint8)
        depth = np.empty((height, width), np.float32) if want_all else None

        def draw(index):
            camera.fixedcamid = index
            mujoco.mjv_updateCamera(model, data, camera, scene)
            scene.flags[flag.mjRND_SHADOW] = True
            scene.flags[flag.mjRND_SEGMENT] = scene.flags[flag.mjRND_IDCOLOR] = False
            mujoco.mjr_render(rect, scene, context)
            mujoco.mjr_readPixels(color, depth, rect, context)
            if not want_all:
                return color[::-1], None, None
            scene.flags[flag.mjRND_SHADOW] = False
            scene.flags[flag.mjRND_SEGMENT] = scene.flags[flag.mjRND_IDCOLOR] = True
            mujoco.mjr_render(rect, scene, context)
            mujoco.mjr_readPixels(coded, None, rect, context)
            depth_m = np.float32(FAR_M * NEAR_M) / (np.float32(FAR_M) - np.float32(FAR_M - NEAR_M) * depth)
            return color[::-1], depth_m[::-1], (coded @ np.array([1, 1 << 8, 1 << 16]))[::-1] - 1

        return draw

    driver, release = (GL.glGetString(what).decode() for what in (GL.GL_RENDERER, GL.GL_VERSION))
    serve(f"mujoco {mujoco.__version__} ({driver.split()[0]}, {release.split(') ')[-1]})", stage, prepare)


if __name__ == "__main__":
    main()
