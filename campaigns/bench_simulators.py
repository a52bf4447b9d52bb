"""
Measure other simulators (requirements-bench.txt), all in steps of 2 ms.

MuJoCo has a lighter-than-air vehicle as well as its fluid model can: an ellipsoid hull of 1 m x
0.6 m with drag, lift and added mass, buoyancy as a constant force, a gondola, four rotors with a
lag, wind and a floor. crazyflow has many Crazyflies side by side in single precision, with rotor
speeds as states, thrust and linear drag; no hull, no added mass, no wind. It runs in a process of
its own, as JAX has threads.
"""

from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import redirect_stdout
from functools import cache, partial
from importlib.metadata import version
import io
from multiprocessing import get_context
import time
from typing import Any
import warnings

from lta_config.machine import count_cores

from campaigns.bench import Figure, measure_pace

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
WORLDS, WORLD_STEPS = 10_000, 100  # of crazyflow
ROTOR_SPEED = 20_000.0  # above hover, so that they fly and do not lie on the floor [1/min]


def step_balloons(integrator: str, cores: int) -> float:
    """Return the pace of so many balloons together, each on a core. [1/s]"""
    import mujoco

    model = mujoco.MjModel.from_xml_string(VEHICLE.replace('INTEGRATOR', integrator))
    flights = [mujoco.MjData(model) for _ in range(cores)]
    for data in flights:
        data.ctrl[:] = (0.1, 0.1, 0.2, 0.2)
        data.body('hull').xfrc_applied[2] = BUOYANCY
    begin = time.process_time()
    if cores == 1:
        mujoco.mj_step(model, flights[0], STEPS)
        return STEPS / (time.process_time() - begin)
    with ThreadPoolExecutor(cores) as pool:
        list(pool.map(lambda data: mujoco.mj_step(model, data, STEPS), flights))
    return measure_pace(cores * STEPS, begin)


def list_mujoco() -> list[Figure]:
    """Return the figures of MuJoCo."""
    import mujoco

    figures = []
    for integrator in ('RK4', 'Euler'):
        peer, name = f'MuJoCo {mujoco.__version__}, {integrator}', integrator.lower()
        figures += [
            Figure(f'mujoco.single_{name}', 'steps/s', partial(step_balloons, integrator, 1),
                   of='kernel.single', peer=peer),
            Figure(f'mujoco.batched_{name}', 'vehicle-steps/s',
                   partial(step_balloons, integrator, count_cores()), of='kernel.batched',
                   peer=peer),
        ]  # fmt: skip
    return figures


@cache
def build_worlds(integrator: str) -> Any:
    """Return crazyflow's vehicles, their rotors commanded; made once, as each compiles."""
    with redirect_stdout(io.StringIO()), warnings.catch_warnings():
        warnings.simplefilter('ignore')
        from crazyflow.control import Control
        from crazyflow.sim import Sim
        from crazyflow.sim.sim import Dynamics
        import jax.numpy as jnp
        import mujoco

        mujoco.set_mju_user_warning(lambda text: None)
        sim = Sim(
            n_worlds=WORLDS, dynamics=Dynamics.first_principles, integrator=integrator,
            control=Control.rotor_vel, freq=round(1.0 / STEP), device='cpu',
        )  # fmt: skip
    sim.rotor_vel_control(jnp.full((WORLDS, 1, 4), ROTOR_SPEED))
    return sim


def step_worlds(integrator: str) -> float:
    """Return the pace of all Crazyflies together. [1/s]"""
    sim = build_worlds(integrator)
    begin = time.process_time()
    sim.step(WORLD_STEPS)
    sim.data.states.pos.block_until_ready()
    return measure_pace(WORLDS * WORLD_STEPS, begin)


@cache
def start_process() -> ProcessPoolExecutor:
    """Return the process, kept to the end: one let go of earlier may be in the way of exit."""
    return ProcessPoolExecutor(1, mp_context=get_context('spawn'))


def list_crazyflow() -> list[Figure]:
    """Return the figures of crazyflow."""
    program = f'crazyflow {version("crazyflow")}'
    return [
        Figure(f'crazyflow.batched_{integrator}', 'vehicle-steps/s',
               lambda name=integrator: start_process().submit(step_worlds, name).result(),
               of='kernel.batched', peer=f'{program}, {integrator}, fp32')
        for integrator in ('euler', 'rk4')
    ]  # fmt: skip
