"""
Measure other simulators (requirements-bench.txt), all in steps of 2 ms.

MuJoCo has a lighter-than-air vehicle as well as its fluid model can: an ellipsoid hull of 1 m x
0.6 m with drag, lift and added mass, buoyancy as a constant force, a gondola, four rotors with a
lag, wind and a floor.
"""

from functools import partial
import time

from campaigns.bench import Figure

STEP = 2e-3
STEPS = 20_000  # of MuJoCo
BUOYANCY = 3.49  # of a hull that is 2 g heavy [N]
ROTORS = {
    'up_left': ('0 0.19 -0.1735', '0 0 1'), 'up_right': ('0 -0.19 -0.1735', '0 0 1'),
    'forward_left': ('0 0.1 -0.23', '1 0 0'), 'forward_right': ('0 -0.1 -0.23', '1 0 0'),
}  # fmt: skip
SITES = ''.join(f'<site name="{name}" pos="{place}"/>' for name, (place, _) in ROTORS.items())
ACTUATORS = ''.join(
    f'<general site="{name}" gear="{axis} 0 0 0" dyntype="filterexact" dynprm="0.072" '
    'gainprm="0.16" ctrllimited="true" ctrlrange="0 1"/>'
    for name, (_, axis) in ROTORS.items()
)
VEHICLE = f"""
<mujoco>
  <option timestep="0.002" integrator="INTEGRATOR" density="1.2" viscosity="1.8e-5"
    wind="0.1 0 0"/>
  <worldbody>
    <geom type="plane" size="0 0 1"/>
    <body name="hull" pos="0 0 1">
      <freejoint/>
      <inertial pos="0 0 0" mass="0.19" diaginertia="0.01 0.01 0.017"/>
      <geom name="hull" type="ellipsoid" size="0.5 0.5 0.2995" mass="0" fluidshape="ellipsoid"
        fluidcoef="0.5 0.25 1.5 1.0 1.0"/>
      <body pos="0 0 -0.17">
        <inertial pos="0 0 0" mass="0.168" diaginertia="0.001 0.001 0.001"/>
        {SITES}
      </body>
    </body>
  </worldbody>
  <actuator>{ACTUATORS}</actuator>
</mujoco>"""


def step_balloon(integrator: str) -> float:
    """Return the pace of a balloon. [1/s]"""
    import mujoco

    model = mujoco.MjModel.from_xml_string(VEHICLE.replace('INTEGRATOR', integrator))
    data = mujoco.MjData(model)
    data.ctrl[:] = (0.1, 0.1, 0.2, 0.2)
    data.body('hull').xfrc_applied[2] = BUOYANCY
    begin = time.process_time()
    mujoco.mj_step(model, data, STEPS)
    return STEPS / (time.process_time() - begin)


def list_mujoco() -> list[Figure]:
    """Return the figures of MuJoCo."""
    import mujoco

    figures = []
    for integrator in ('RK4', 'Euler'):
        peer, name = f'MuJoCo {mujoco.__version__}, {integrator}', integrator.lower()
        figures += [
            Figure(f'mujoco.single_{name}', 'steps/s', partial(step_balloon, integrator),
                   of='kernel.single', peer=peer),
        ]  # fmt: skip
    return figures
