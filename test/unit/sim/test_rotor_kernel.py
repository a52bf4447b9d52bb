"""Rotor effects in the compiled model: what a fault, a low battery and a reversed rotor do."""

from lta_model.effects import initial_memory
from lta_model.model import VehicleModel
from lta_model.state import pack_state, SURROUNDINGS, VOLTAGE
from lta_sim.kernels.kernel import state_derivative
import numpy as np
import pytest

MASS, INERTIA = 0.36, np.array([0.02, 0.025, 0.03])
A, B = 0.0915, 0.0677
AXES = ('surge', 'sway', 'heave', 'roll', 'pitch', 'yaw')

# GT-MAB: wrench per newton of the upward and the forward rotors, left and right, from CFD.
COLUMNS = (
    (0.0, 0.013, 0.961, 0.188, 0.0, 0.0),
    (0.0, -0.013, 0.961, -0.188, 0.0, 0.0),
    (0.981, 0.011, -0.061, -0.002, -0.403, -0.100),
    (0.981, -0.011, -0.061, 0.002, -0.403, 0.100),
)
ROTORS = (
    ((0.0, 0.19, -0.3435), (0.0, 0.0, 1.0)),
    ((0.0, -0.19, -0.3435), (0.0, 0.0, 1.0)),
    ((0.0, 0.10, -0.40), (1.0, 0.0, 0.0)),
    ((0.0, -0.10, -0.40), (1.0, 0.0, 0.0)),
)
CURVE = {f'{name}_{i}': value for name, value in (('a', A), ('b', B)) for i in range(1, 9)}


def thrust(duty):
    return (A * abs(duty) + B) * duty


def wrench(duties, voltage=0.0, curve=CURVE, **more):
    """Return the wrench on a vehicle at rest that weighs nothing, by its acceleration."""
    allocation = {
        f'{axis}_{i + 1}': column[k]
        for i, column in enumerate(COLUMNS)
        for k, axis in enumerate(AXES)
    }
    model = VehicleModel.build(
        {'thrust_curve': curve, 'rotor_thrust': allocation, **more},
        mass=MASS,
        cg=(0.0, 0.0, 0.0),
        inertia=np.diag(INERTIA),
        rotors=ROTORS,
    )
    around = np.zeros(SURROUNDINGS)
    around[VOLTAGE] = voltage
    rate = state_derivative(pack_state(memory=initial_memory()), model, duties, around)
    return rate[7:13] * np.array([MASS, MASS, MASS, *INERTIA])


def by_hand(*newtons):
    return np.transpose(COLUMNS) @ newtons


DUTIES = (0.6, 0.6, 0.4, 0.4)
WHOLE = tuple(map(thrust, DUTIES))


def test_all_rotors_whole():
    np.testing.assert_allclose(wrench(DUTIES), by_hand(*WHOLE), atol=1e-15)
    assert wrench(DUTIES)[5] == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize(
    ('rotor', 'axis', 'moment'),
    [
        # The left upward rotor holds up the left side (roll > 0 is right side down): less of it
        # rolls to the left. The left forward rotor yaws to the right: less of it, to the left.
        (1, 3, -0.5 * thrust(0.6) * 0.188),
        (2, 3, 0.5 * thrust(0.6) * 0.188),
        (3, 5, 0.5 * thrust(0.4) * 0.100),
        (4, 5, -0.5 * thrust(0.4) * 0.100),
    ],
)
def test_a_fault_turns_the_vehicle_as_b_says(rotor, axis, moment):
    found = wrench(DUTIES, rotor_fault={f'lost_{rotor}': 0.5})
    left = [t * (0.5 if i + 1 == rotor else 1.0) for i, t in enumerate(WHOLE)]
    np.testing.assert_allclose(found, by_hand(*left), atol=1e-15)
    assert found[axis] == pytest.approx(moment, rel=1e-12)


def test_a_low_battery_weakens_all_rotors():
    nominal = wrench(DUTIES, 4.2, battery_sag={'voltage': 4.2})
    np.testing.assert_array_equal(nominal, wrench(DUTIES))
    low = wrench(DUTIES, 3.3, battery_sag={'voltage': 4.2})
    np.testing.assert_allclose(low, by_hand(*(thrust(d * 3.3 / 4.2) for d in DUTIES)), atol=1e-15)
    # (0.0915 * 0.4714 + 0.0677) 0.4714 over (0.0915 * 0.6 + 0.0677) 0.6.
    assert thrust(0.6 * 3.3 / 4.2) / thrust(0.6) == pytest.approx(0.7103, abs=5e-5)
    np.testing.assert_array_equal(wrench(DUTIES, 0.0, battery_sag={'voltage': 4.2}), nominal)


def test_the_cubic_takes_the_place_of_the_curve():
    cubic = {'c_0': -0.024765, 'c_1': 0.065238, 'c_2': -0.026793, 'c_3': 0.0067768}
    found = wrench(
        DUTIES,
        3.5,
        curve={},
        battery_sag={'voltage': 4.2},
        thrust_polynomial={'voltage': 4.2, 'linear_to': 0.774, **cubic},
    )
    newtons = [-0.024765 + 0.065238 * v - 0.026793 * v**2 + 0.0067768 * v**3 for v in (2.1, 1.4)]
    expected = by_hand(newtons[0], newtons[0], newtons[1], newtons[1])
    np.testing.assert_allclose(found, expected, atol=1e-14)


def test_deadband_scale_and_tilt():
    still = wrench((0.6, 0.6, 0.05, 0.05), motor_deadband={'threshold': 0.06})
    np.testing.assert_allclose(still, by_hand(*WHOLE[:2], 0.0, 0.0), atol=1e-15)
    scaled = wrench(DUTIES, thrust_scale={'factor': 1.1})
    np.testing.assert_allclose(scaled, 1.1 * by_hand(*WHOLE), atol=1e-15)
    # The left forward rotor toed out to the left by 0.02 rad, 0.1 m left of and 0.4 m below.
    toed = wrench(DUTIES, rotor_misalignment={'second_3': 0.02}) - wrench(DUTIES)
    side = 0.02 * WHOLE[2]
    np.testing.assert_allclose(toed, (0.0, side, 0.0, 0.4 * side, 0.0, 0.0), atol=1e-15)


def test_a_reversed_rotor_blows_against_the_hull():
    reverse = {'sway_1': -0.23 - 0.013, 'heave_1': 0.252 - 0.961, 'roll_1': 0.072 - 0.188}
    found = wrench((-0.6, 0.0, 0.0, 0.0), rotor_envelope_interaction=reverse)
    expected = thrust(0.6) * np.array([0.0, 0.23, -0.252, -0.072, 0.0, 0.0])
    np.testing.assert_allclose(found, expected, atol=1e-15)


def test_jets_together_lift_more():
    together = {'together_heave': 0.5, 'share_3': 1.0, 'share_4': 1.0}
    both = wrench((0.0, 0.0, 0.4, 0.3), rotor_envelope_interaction=together)
    expected = by_hand(0.0, 0.0, thrust(0.4), thrust(0.3))
    expected[2] += 0.5 * thrust(0.3)
    np.testing.assert_allclose(both, expected, atol=1e-15)
