"""All effects in one kernel: each matters, and one at null changes nothing to the bit."""

from lta_model.effects import EFFECTS, initial_memory
from lta_model.effects.protocol import BodyEffect, MeasurementEffect
from lta_model.model import VehicleModel
from lta_model.state import pack_state, RIGID
from lta_sim.kernels import row
from lta_sim.kernels.compose import build_layout, render_kernel_source
from lta_sim.kernels.kernel import advance
from lta_sim.simulated_vehicle import LAYOUT
import numpy as np
import pytest


def as_python(effects):
    """Return the kernel of some effects as plain, slow Python."""
    source = render_kernel_source(effects).replace('from numba import njit', '')
    space = {'njit': lambda **_: lambda function: function}
    exec(source, space)
    return space['advance']


def usual(effect):
    """Return values one plausible deviation off those at which an effect changes nothing."""
    return {each.name: min(each.null + each.spread, each.high) for each in effect.parameters}


# Values of effects for which `usual` is too little, or not what is flown.
CHOSEN = {
    'weight_and_buoyancy': {'gravity': 9.8},
    'added_mass': {'surge': 0.14, 'sway': 0.15, 'heave': 0.37},
    'added_inertia': {'roll': 4e-3, 'pitch': 5e-3},
    'linear_drag': {'surge': 0.01},
    'quadratic_drag': {'surge': 0.09, 'sway': 0.09, 'heave': 0.36},
    'rotational_drag': {'roll': 7e-4, 'pitch': 6e-4, 'yaw': 3e-4, 'roll_2': 2e-3, 'yaw_2': 6e-4},
    'motor_lag': {'up': 0.07, 'down': 0.1},
    'thrust_curve': {'a_1': 0.09, 'b_1': 0.07, 'b_3': 0.1},
    'rotor_thrust': {'heave_1': 0.96, 'surge_3': 0.98},
    'battery_compensation': {'voltage': 4.2, 'full': 0.06, 'c_1': 0.0106, 'c_3': 0.0014},
    'battery_sag': {'voltage': 4.2, 'sensitivity': 0.8},
    'motor_deadband': {'threshold': 0.45},
    'thrust_polynomial': {'voltage': 4.2, 'linear_to': 0.8, 'c_1': 0.05, 'c_3': 0.002},
    'thrust_scale': {'factor': 1.1},
    'rotor_fault': {'lost_1': 0.2},
    'rotor_misalignment': {'first_1': 0.05, 'second_3': -0.03},
    'rotor_envelope_interaction': {
        'heave_2': -0.7,
        'together_yaw': 0.3,
        'share_1': 1.0,
        'share_3': 1.0,
    },
    'net_lift': {'force': 0.02},
    'helium_leak': {'rate': 1e-3},
    'superheat': {'warming': 0.02, 'lag': 60.0, 'slack': 1.0},
    'moving_mass': {'mass': 0.05, 'x': 0.07, 'z': -0.24, 'lag': 0.3, 'speed': 0.2},
    'strip_damping': {'z_1': -0.35, 'half_y_1': 0.16, 'surge_1': 0.01, 'sway_1': 0.004},
    'steady_wind': {'x': 0.5, 'z': 0.1},
    'wind_profile': {'x': 2.0, 'y': -1.0, 'roughness': 0.03, 'half_height': 0.3},
    'wind_gradient': {'x_y': 0.1, 'z_x': -0.2},
    'turbulence': dict.fromkeys(('along', 'across', 'up'), 0.1)
    | dict.fromkeys(('along_length', 'across_length', 'up_length'), 1.0)
    | {'mean': 3.0, 'height': 3.0},
    'gusts': {'x': 0.5, 'y': 0.2, 'begin': 0.1, 'length': 1.0},
    'cross_flow': {'horizontal': 1.0, 'total': 0.5, 'sway': 0.09},
    'munk_moment': {'lost': 0.3},
    'oblique_lift': {'lift': 0.6, 'stall': 4.0},
    'hull_lift': {
        'density': 1.2,
        'area': 0.25,
        'drag': 0.24,
        'side_beta': -2.1,
        'lift_alpha': 2.9,
        'pitch': 0.06,
        'yaw_beta': -0.09,
        'roll_rate': 0.05,
    },
    'ground_effect': {'gain': 1.0, 'radius': 0.0235},
    'ceiling_effect': {'gain': 1.0, 'radius': 0.0235, 'height': 2.2},
    'walls': {
        'x_low': -3.0,
        'x_high': 1.45,
        'y_low': -3.0,
        'y_high': 2.48,
        'ceiling': 2.5,
        'radius': 0.5,
        'half_height': 0.3,
        'stiffness': 100.0,
        'relaxation': 0.05,
        'friction': 0.3,
    },
    'floor_contact': {'stiffness': 100.0, 'relaxation': 0.05, 'friction': 0.5, 'z': -0.36},
}
OUTSIDE = BodyEffect | MeasurementEffect  # not in the kernel, nor in what surrounds it
GIVEN = {
    name: CHOSEN.get(name) or usual(effect)
    for name, effect in EFFECTS.items()
    if not isinstance(effect, OUTSIDE)
}
ROTORS = [((0.0, 0.2, -0.3), (0.0, 0.0, 1.0)), ((0.1, 0.0, -0.3), (1.0, 0.0, 0.0))] * 2
COMMANDED = [0.4, -0.2, 0.6, 0.1, 0.0, 0.0, 0.0, 0.0, 0.02, 0.01, -0.3]
AROUND = [0.2, 0.1, 0.0, 3.0, -2.0, 1.0, 400.0, 3.6, 0.1, -0.2, 0.05]
REMEMBERED = 0.3


def flight(effects, kernel, given):
    """Return the state a few steps on, with the memory that these effects have."""
    model = VehicleModel.build(
        given,
        mass=0.36,
        cg=(0.01, 0.0, -0.08),
        inertia=np.diag([0.02, 0.02, 0.03]),
        displaced=0.35,
        rotors=ROTORS,
    )
    layout = build_layout(effects)
    places, _ = LAYOUT.find_effect_indices(layout.effects)
    on = [int(model.on[LAYOUT.flag_index(name)]) for name in layout.effects]
    start = begin([REMEMBERED] * (layout.size - RIGID)).tolist()
    where = row.row_slices(layout)
    numbers = [0.0] * where['wind'].stop
    for name, values in {
        'state': start,
        'parameters': model.parameters[places].tolist(),
        'body': model.body.tolist(),
        'inverse': model.inverse.tolist(),
        'command': COMMANDED,
        'surroundings': AROUND,
    }.items():
        numbers[where[name]] = values
    kernel(numbers, on, 2e-3, 10)
    return model, start, numbers[where['state']]


def begin(memory):
    return pack_state((1.0, 2.0, 0.33), 0.3, (0.3, -0.2, -0.1), (0.4, 0.5, -0.6), memory)


def test_values_are_chosen_for_effects_that_there_are():
    assert set(CHOSEN) <= set(GIVEN)


@pytest.mark.parametrize('absent', EFFECTS)
def test_null_changes_nothing_to_the_bit(absent):
    """A kernel without the effect and the compiled kernel with it at null are equal."""
    others = {name: effect for name, effect in EFFECTS.items() if name != absent}
    given = {name: values for name, values in GIVEN.items() if name != absent}
    model, _, without = flight(others, as_python(others), given)
    start = begin([REMEMBERED] * len(initial_memory()))
    at_null = advance(start, model, COMMANDED, AROUND, 2e-3, 10)
    np.testing.assert_array_equal(at_null[:RIGID], without[:RIGID])


def test_the_compiled_kernel_equals_its_text_to_the_bit():
    model, start, python = flight(EFFECTS, as_python(EFFECTS), GIVEN)
    compiled = advance(np.array(start), model, COMMANDED, AROUND, 2e-3, 10)
    np.testing.assert_array_equal(compiled, python)


def test_each_effect_of_that_flight_matters():
    kernel = as_python(EFFECTS)
    _, _, everything = flight(EFFECTS, kernel, GIVEN)
    for absent in GIVEN:
        given = {name: values for name, values in GIVEN.items() if name != absent}
        _, _, without = flight(EFFECTS, kernel, given)
        assert np.max(abs(np.subtract(everything, without)[:RIGID])) > 1e-9, (
            f'{absent} changes nothing at {GIVEN[absent]}; give it other values in CHOSEN'
        )
