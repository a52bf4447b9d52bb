"""
MuJoCo: a lighter-than-air vehicle as well as its own fluid model can have it, RK4, steps of 2 ms.

An ellipsoid hull of 1 m x 0.6 m in MuJoCo's ellipsoid fluid model (drag, lift, added mass),
buoyancy as a constant force at the hull's centre, a gondola below, four rotors with a first-order
lag, wind and a floor. Once more with MuJoCo's default integrator, Euler. The fluid model takes the
added mass for its velocity terms alone, not as inertia: from rest a force moves the hull as if
there were no air.
"""

from concurrent.futures import ThreadPoolExecutor
from functools import partial
import time

from added_mass import AIR_DENSITY, FORCE, HALF_HEIGHT, MASS, RADIUS
from bench import Figure, pace
from lta_config.machine import count_cores
import mujoco

STEPS = 20_000
CONTROL = (0.1, 0.1, 0.2, 0.2)
BUOYANCY = 3.49  # of a hull that is 2 g heavy [N]
AIR = f'density="{AIR_DENSITY}" viscosity="1.8e-5"'
# MuJoCo's defaults: blunt, slender and angular drag, Kutta and Magnus lift.
COEFFICIENTS = '0.5 0.25 1.5 1.0 1.0'
HULL = (
    f'<geom name="hull" type="ellipsoid" size="{RADIUS} {RADIUS} {HALF_HEIGHT}" mass="0" '
    f'fluidshape="ellipsoid" fluidcoef="{COEFFICIENTS}"/>'
)


def rotor(name: str, place: str, axis: str) -> tuple[str, str]:
    """Return a site and the actuator on it: thrust along an axis, behind a lag of 72 ms."""
    site = f'<site name="{name}" pos="{place}"/>'
    actuator = (
        f'<general site="{name}" gear="{axis} 0 0 0" dyntype="filterexact" dynprm="0.072" '
        'gainprm="0.16" ctrllimited="true" ctrlrange="0 1"/>'
    )
    return site, actuator


def vehicle(integrator: str) -> str:
    """Return the vehicle as MJCF."""
    sites, actuators = zip(
        rotor('up_left', '0 0.19 -0.1735', '0 0 1'),
        rotor('up_right', '0 -0.19 -0.1735', '0 0 1'),
        rotor('forward_left', '0 0.1 -0.23', '1 0 0'),
        rotor('forward_right', '0 -0.1 -0.23', '1 0 0'),
        strict=True,
    )
    return f"""
<mujoco>
  <option timestep="0.002" integrator="{integrator}" {AIR} wind="0.1 0 0"/>
  <worldbody>
    <geom type="plane" size="0 0 1"/>
    <body name="hull" pos="0 0 1">
      <freejoint/>
      <inertial pos="0 0 0" mass="0.19" diaginertia="0.01 0.01 0.017"/>
      {HULL}
      <body pos="0 0 -0.17">
        <inertial pos="0 0 0" mass="0.168" diaginertia="0.001 0.001 0.001"/>
        {''.join(sites)}
      </body>
    </body>
  </worldbody>
  <actuator>{''.join(actuators)}</actuator>
</mujoco>"""


def flight(model: mujoco.MjModel) -> mujoco.MjData:
    """Return a vehicle at rest in the air, its rotors commanded."""
    data = mujoco.MjData(model)
    data.ctrl[:] = CONTROL
    data.body('hull').xfrc_applied[2] = BUOYANCY
    return data


def single(integrator: str) -> float:
    """Return the pace of one vehicle, called in a loop inside MuJoCo. [1/s]"""
    model = mujoco.MjModel.from_xml_string(vehicle(integrator))
    data = flight(model)
    begin = time.process_time()
    mujoco.mj_step(model, data, STEPS)
    return STEPS / (time.process_time() - begin)


def batched(integrator: str) -> float:
    """Return the pace of one vehicle a core, together. [1/s]"""
    cores = count_cores()
    model = mujoco.MjModel.from_xml_string(vehicle(integrator))
    flights = [flight(model) for _ in range(cores)]
    with ThreadPoolExecutor(cores) as pool:
        begin = time.process_time()
        list(pool.map(lambda data: mujoco.mj_step(model, data, STEPS), flights))
        return pace(cores * STEPS, begin)


def heave() -> float:
    """Return how a neutral balloon starts to rise when a small force pulls it up. [m/s^2]"""
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option {AIR} gravity="0 0 0"/><worldbody>'
        '<body name="hull"><freejoint/>'
        f'<inertial pos="0 0 0" mass="{MASS}" diaginertia="0.015 0.015 0.018"/>{HULL}'
        '</body></worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    data.body('hull').xfrc_applied[2] = FORCE
    mujoco.mj_forward(model, data)
    return float(data.qacc[2])


def figures() -> list[Figure]:
    """Return what is measured here."""
    program = f'MuJoCo {mujoco.__version__}'
    found = [Figure('mujoco.heave', 'm/s2', heave, 1, of='kernel.heave', peer=program)]
    for suffix, integrator in (('', 'RK4'), ('_euler', 'Euler')):
        peer = f'{program}, {integrator}'
        one, many = partial(single, integrator), partial(batched, integrator)
        found += [
            Figure(f'mujoco.single{suffix}', 'steps/s', one, of='kernel.single', peer=peer),
            Figure(
                f'mujoco.batched{suffix}', 'vehicle-steps/s', many, of='kernel.batched', peer=peer
            ),
        ]
    return found
