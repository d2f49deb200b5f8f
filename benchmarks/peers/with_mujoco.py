"""Falls and slides in MuJoCo with stiff contacts; runs in MuJoCo's own environment.

Reads scenes from standard input, as JSON, and writes the last states to standard output.
"""

import json
import sys
from typing import Any

import mujoco

STEP = 0.025
"""The step as a share of the contacts' time constant."""

WORLD = """
<mujoco>
  <option timestep="{step}" gravity="0 0 {gravity}" cone="elliptic" impratio="100"
          integrator="implicitfast" iterations="200" tolerance="1e-12"/>
  <default>
    <geom friction="{friction} 0 0" condim="3" solref="{solref} 1" solimp="0.99 0.999 0.0001"/>
  </default>
  <worldbody>
    <geom type="plane" size="50 50 1"/>
    <body>
      <joint type="slide" axis="1 0 0"/>
      <joint type="slide" axis="0 0 1"/>
      <joint type="hinge" axis="0 -1 0"/>
      <inertial pos="0 0 0" mass="{mass}" diaginertia="{inertia} {inertia} {inertia}"/>
      {points}
    </body>
  </worldbody>
</mujoco>
"""

POINT = '<geom type="sphere" size="{radius}" pos="{x} 0 {y}"/>'
RADIUS = 1e-3  # m: MuJoCo has no contact points


def run(scene: dict[str, Any]) -> list[float]:
    """The last x, y, angle and their speeds."""
    points = "".join(POINT.format(radius=RADIUS, x=x, y=y + RADIUS) for x, y in scene["points"])
    step = STEP * scene["numbers"]["solref"]
    text = WORLD.format(step=step, points=points, **scene["numbers"])
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = scene["initial"][:3], scene["initial"][3:]
    for _ in range(round(scene["duration"] / step)):
        mujoco.mj_step(model, data)
    return [*data.qpos.tolist(), *data.qvel.tolist()]


if __name__ == "__main__":
    json.dump([run(scene) for scene in json.load(sys.stdin)], sys.stdout)
