"""A law of a vehicle file: its forms by hand, its lag and its region, and flights with it."""

from lta_config.errors import BadInput
from lta_config.files import find_file, parse_yaml, validate_content
from lta_config.schema.vehicle_file import VehicleFile
from lta_config.schema.vehicle_law import (
    coefficient_unit,
    FORMS,
    HiddenState,
    Law,
    LawFactor,
    QUANTITIES,
)
from lta_config.vehicle_edit import set_yaml_values
from lta_model.effects import initial_memory
from lta_model.effects.law import list_law_parameters
from lta_model.law_arrays import evaluate_drive_fade, evaluate_law
from lta_model.law_text import describe_law, describe_term
from lta_model.model import VehicleModel
from lta_model.state import pack_state
from lta_sim.kernels import kernel
from lta_sim.kernels.kernel import LAYOUT
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from . import crowded, lamp_room
from . import flat_balloon as balloon

WIDE = [-1e3, 1e3]
WIND, VOLTAGE = (0.2, 0.1, -0.1), 3.8
AROUND = [*WIND, 0.0, 0.0, 0.0, 0.0, VOLTAGE]
VELOCITY, RATES = (0.5, -0.2, 0.1), (0.1, -0.3, 0.6)
PLACES = np.array([(0.1, 0.2, -0.3), (-0.1, 0.1, -0.2)])
DIRECTIONS = np.array([(1.0, 0.0, 0.0), (0.0, 0.6, 0.8)])
THRUSTS = np.array((0.05, 0.02))
MEMORY = slice(LAYOUT.remembers['law'], LAYOUT.remembers['law'] + 3)
TURN = Rotation.from_euler('ZYX', (2.1, 0.2, -0.4))


def law(*terms, hidden=None, **region):
    """Return a law of (axis, coefficient, factors), in a wide region unless another is given."""
    lag = HiddenState.model_validate(hidden) if hidden else None
    each = [
        *(factor for term in terms for factor in term[2]),
        *(hidden['drive'] if hidden else ()),
    ]
    return Law.model_validate(
        {
            'source': 'a test',
            'terms': [
                {
                    'axis': axis,
                    'coefficient': size,
                    'unit': coefficient_unit(axis, map(LawFactor.model_validate, factors), lag),
                    'factors': factors,
                }
                for axis, size, factors in terms
            ],
            'hidden': lag,
            'region': {one['quantity']: region.get(one['quantity'], WIDE) for one in each},
        }
    )


def model(one, **given):
    """Return a balloon with a law, whose rotors obey newtons."""
    return VehicleModel.build(
        {'law': list_law_parameters(one), **given},
        mass=balloon.MASS,
        cg=balloon.CG,
        inertia=balloon.INERTIA,
        rotors=list(zip(PLACES, DIRECTIONS, strict=True)),
    )


def state(hidden=0.0, time=0.0, rate=0.0):
    """Return a state with a law's memory."""
    out = pack_state((0.4, -0.7, 1.3), 0.0, VELOCITY, RATES, initial_memory())
    out[3:7] = TURN.as_quat()
    out[MEMORY] = hidden, rate, time
    return out


def wrench(one, start=None):
    """Return the wrench of a law by the compiled kernel."""
    start = state() if start is None else start
    return kernel.effect_wrenches(start, model(one), THRUSTS, AROUND)['law']


def quantities():
    """Return all quantities of `state(0.3, 7.0, 0.2)`, by numpy alone."""
    air = np.array(VELOCITY) - TURN.inv().apply(WIND)
    yaw, pitch, roll = TURN.as_euler('ZYX')
    force = THRUSTS[:, None] * DIRECTIONS
    total = [*force.sum(axis=0), *np.cross(PLACES, force).sum(axis=0)]
    numbers = (
        *air, np.linalg.norm(air), *RATES, np.linalg.norm(RATES), 0.4, -0.7, 1.3,
        roll, pitch, yaw, VOLTAGE, 7.0, 0.3, 0.2, *THRUSTS, *[0.0] * 6, *total,
    )  # fmt: skip
    return dict(zip(QUANTITIES, numbers, strict=True))


@pytest.mark.parametrize('name', QUANTITIES)
def test_a_term_is_linear_in_each_quantity(name):
    lag = {'drive': [{'quantity': 'u'}], 'frequency': 1.0, 'damping': 0.1}
    hidden = lag if name.startswith('hidden') else None
    one = law(('sway', 0.7, [{'quantity': name}]), hidden=hidden)
    expected = 0.7 * quantities()[name]
    assert wrench(one, state(0.3, 7.0, 0.2)) == pytest.approx([0, expected, 0, 0, 0, 0], rel=1e-12)


BY_HAND = {
    'linear': ({}, lambda x: x),
    'modulus': ({'exponent': 1.7}, lambda x: np.abs(x) ** 1.7),
    'power': ({'exponent': 0.5}, lambda x: np.sign(x) * np.sqrt(np.abs(x))),
    'positive': ({'threshold': -0.4}, lambda x: np.where(x > -0.4, x + 0.4, 0.0)),
    'negative': ({'threshold': 0.2}, lambda x: np.where(x < 0.2, 0.2 - x, 0.0)),
    'above': (
        {'threshold': 0.1, 'scale': 0.2},
        lambda x: 1.0 / (1.0 + np.exp(-2.0 * (x - 0.1) / 0.2)),
    ),
    'sign': ({'scale': 0.3}, lambda x: 2.0 / (1.0 + np.exp(-2.0 * x / 0.3)) - 1.0),
    'decay': ({'scale': 0.6}, lambda x: np.exp(-x / 0.6)),
    'sin': ({'scale': 0.9, 'phase': 0.4}, lambda x: np.imag(np.exp(2j * np.pi * x / 0.9 - 0.4j))),
    'cos': ({'scale': 0.9, 'phase': 0.4}, lambda x: np.real(np.exp(2j * np.pi * x / 0.9 - 0.4j))),
}


@pytest.mark.parametrize('form', FORMS)
def test_each_form_by_hand(form):
    numbers, expected = BY_HAND[form]
    one = law(('yaw', 2.0, [{'quantity': 'v', 'form': form, **numbers}]))
    speeds = np.array((-0.9, -0.3, 0.0, 0.15, 0.8))
    assert evaluate_law(one, {'v': speeds}, np.eye(3))[:, 5] == pytest.approx(
        2.0 * expected(speeds), rel=1e-12, abs=1e-15
    )
    v = quantities()['v']
    assert wrench(one)[5] == pytest.approx(2.0 * expected(v), rel=1e-12)


def test_terms_are_sums_of_products_also_along_the_axes_of_the_map():
    turning = {'quantity': 'yaw', 'form': 'cos'}
    one = law(
        ('map_x', 0.3, [{'quantity': 'x'}, {'quantity': 'r', 'form': 'modulus'}, turning]),
        ('map_z', 0.1, []),
        ('pitch', 0.2, [{'quantity': 'q'}]),
        ('pitch', -0.5, []),
    )
    east = 0.3 * 0.4 * 0.6 * np.cos(quantities()['yaw'])
    expected = [*TURN.inv().apply((east, 0.0, 0.1)), 0.0, 0.2 * -0.3 - 0.5, 0.0]
    assert wrench(one) == pytest.approx(expected, rel=1e-12, abs=1e-16)


@pytest.mark.parametrize(
    ('name', 'value', 'region', 'share'),
    [
        ('height', 1.3, (0.0, 2.0), 1.0),
        ('height', 1.3, (0.0, 1.3), 1.0),
        # A quarter, a half and all of the half width outside
        (
            'height',
            1.3,
            (0.1, 1.0666666666666667),
            1.0 - 3.0 * 0.482758620689655**2 + 2.0 * 0.482758620689655**3,
        ),
        ('height', 1.3, (0.3, 0.9666666666666667), 0.0),
        ('height', 1.3, (2.8, 4.8), 0.0),
        ('height', 1.3, (1.8, 3.8), 0.5),
        # The heading of 2.1 rad is 1 rad outside of a range about the back, over -pi
        ('yaw', 2.1, (-5.183185307179586, -3.183185307179586), 1.0),
        ('yaw', 2.1, (-3.683185307179586, -1.683185307179586), 0.5),
    ],
)
def test_it_fades_outside_of_its_region(name, value, region, share):
    one = law(('heave', 1.0, [{'quantity': name, 'form': 'modulus'}]), **{name: list(region)})
    assert quantities()[name] == pytest.approx(value)
    assert wrench(one)[2] == pytest.approx(share * value, rel=1e-9, abs=1e-12)
    assert evaluate_law(one, {name: np.array([value])}, np.eye(3))[:, 2] == pytest.approx(
        share * value, rel=1e-9, abs=1e-12
    )


LAGS = {
    'first': ({'time_constant': 0.8}, lambda t: 1.0 - np.exp(-t / 0.8)),
    'second': (
        {'frequency': 3.0, 'damping': 0.2},
        lambda t: (
            1.0
            - np.exp(-0.6 * t)
            * (
                np.cos(3.0 * np.sqrt(0.96) * t)
                + 0.2 / np.sqrt(0.96) * np.sin(3.0 * np.sqrt(0.96) * t)
            )
        ),
    ),
}


@pytest.mark.parametrize('order', LAGS)
def test_the_hidden_state_answers_a_step(order):
    numbers, response = LAGS[order]
    hidden = {'drive': [{'quantity': 'voltage'}], **numbers}
    one = law(('surge', 1e-3, [{'quantity': 'hidden'}]), hidden=hidden)
    for steps in (1, 100, 1000):
        later = kernel.advance(state(), model(one), THRUSTS, AROUND, 2e-3, steps)
        expected = VOLTAGE * response(2e-3 * steps)
        assert later[MEMORY.start] == pytest.approx(expected, rel=1e-7, abs=1e-10)
        assert later[MEMORY.stop - 1] == pytest.approx(2e-3 * steps)


@pytest.mark.parametrize('order', LAGS)
def test_the_hidden_state_begins_at_its_start(order):
    """It begins there at rest, and a rate of first order follows from state and drive."""
    numbers, response = LAGS[order]
    hidden = {'drive': [{'quantity': 'voltage'}], **numbers, 'start': 3.0}
    one = law(
        ('surge', 1e-3, [{'quantity': 'hidden'}]),
        ('sway', 1e-3, [{'quantity': 'hidden_rate'}]),
        hidden=hidden,
    )
    off = VOLTAGE - 3.0
    rate = off / 0.8 if order == 'first' else 0.0
    assert wrench(one)[:2] == pytest.approx([3e-3, 1e-3 * rate], rel=1e-9, abs=1e-15)
    later = kernel.advance(state(), model(one), THRUSTS, AROUND, 2e-3, 300)
    expected = 3.0 + off * response(0.6)
    assert wrench(one, later)[0] == pytest.approx(1e-3 * expected, rel=1e-7)
    if order == 'first':
        assert wrench(one, later)[1] == pytest.approx(1e-3 * (VOLTAGE - expected) / 0.8, rel=1e-6)
    assert list(describe_law(one))[2].endswith(', from 3 V')


def test_a_hidden_state_reaches_its_range_from_outside():
    """From 0, far below its range, its own range does not stop it; the law fades there."""
    hidden = {'drive': [{'quantity': 'voltage'}], 'time_constant': 0.8}
    one = law(('surge', 1.0, [{'quantity': 'hidden'}]), hidden=hidden, voltage=[3.0, 3.7])
    one = one.model_copy(update={'region': {**one.region, 'hidden': [3.0, 3.7]}})
    share = 1.0 - 3.0 * (0.1 / 0.35) ** 2 + 2.0 * (0.1 / 0.35) ** 3
    assert wrench(one, state(1.0))[0] == 0.0
    t = 2e-3 * np.arange(2001)
    expected = share * VOLTAGE * (1.0 - np.exp(-t / 0.8))
    later = kernel.advance(state(), model(one), THRUSTS, AROUND, 2e-3, 2000)
    assert later[MEMORY.start] == pytest.approx(expected[-1], rel=1e-9)
    assert 3.0 < expected[-1] < 3.7
    assert wrench(one, later)[0] == pytest.approx(share * expected[-1], rel=1e-9)
    ends = {'voltage': np.full(2, VOLTAGE), 'hidden': expected[[0, -1]]}
    assert evaluate_drive_fade(one, ends) == pytest.approx(share, rel=1e-9)
    forces = evaluate_law(one, ends, np.eye(3))[:, 0]
    assert forces == pytest.approx([0.0, share * expected[-1]], rel=1e-9)


def test_a_law_that_is_a_named_effect_flies_as_it_does():
    damping = law(('yaw', -5e-4, [{'quantity': 'r'}]), ('surge', -0.02, [{'quantity': 'u'}]))
    named = {'rotational_drag': {'yaw': 5e-4}, 'linear_drag': {'surge': 0.02}}
    flown = [
        kernel.advance(state(), one, THRUSTS, AROUND, 2e-3, 2000)
        for one in (model(damping), model(law(('yaw', 0.0, [])), **named))
    ]
    # The law's clock has run in both
    assert flown[0] == pytest.approx(flown[1], rel=1e-12, abs=1e-14)
    alone = kernel.advance(state(), model(law(('yaw', 0.0, []))), THRUSTS, AROUND, 2e-3, 2000)
    assert abs(alone[12] - flown[0][12]) > 1e-3


def test_arrays_and_kernel_agree_on_a_law_with_everything():
    start = state(0.3)
    seen = {name: np.array([value]) for name, value in (quantities() | {'hidden': 0.3}).items()}
    expected = evaluate_law(crowded.LAW, seen, TURN.as_matrix())[0]
    assert wrench(crowded.LAW, start) == pytest.approx(expected, rel=1e-12, abs=1e-16)


def test_it_is_written_to_a_vehicle_file_and_read_back():
    text = find_file('vehicle', 'gtmab').read_text(encoding='utf-8')
    block = crowded.LAW.model_dump(exclude_defaults=True)
    written = set_yaml_values(text, {'law': block})
    assert written.startswith(text)
    assert set_yaml_values(written, {'law': block}) == written
    file = validate_content(VehicleFile, parse_yaml(written, 'a test'), 'a test')
    assert file.law == crowded.LAW


U = {'quantity': 'u'}


@pytest.mark.parametrize(
    ('change', 'complaint'),
    [
        (
            {'quantity': 'airspeed'},
            r"quantity is 'airspeed', which is no quantity; known: u, v, w",
        ),
        ({'form': 'cubic'}, r"form is 'cubic', which is no form; known: linear, modulus, power"),
        ({'form': 'above', 'scale': 0.1}, r'form above, .* without threshold; add it'),
        ({'scale': 1.0}, r'form linear, x, and scale, which that form does not use; remove it'),
        ({'form': 'sin'}, r'form sin of u, which is no angle, without scale; add its period'),
        ({'form': 'power', 'exponent': 9.0}, r'exponent is 9.0, but must be at most 4'),
        ({'form': 'sign', 'scale': 0.0}, r'scale is 0.0, but must be above 0'),
        ({'sale': 1.0}, r"the key '.*sale' is not known"),
    ],
)
def test_a_wrong_factor_is_refused(change, complaint):
    refuse({'terms': [term(factors=[U | change])]}, complaint)


def term(**change):
    return {'axis': 'yaw', 'coefficient': 1.0, 'unit': 'N s', 'factors': [U]} | change


def refuse(change, complaint):
    content = {'source': 'a test', 'terms': [term()], 'region': {'u': [0.0, 1.0]}} | change
    with pytest.raises(BadInput, match=complaint):
        validate_content(Law, content, 'a test')


@pytest.mark.parametrize(
    ('change', 'complaint'),
    [
        ({'terms': [term(axis='x')]}, r"axis is 'x', which is no axis; known: surge, sway"),
        ({'terms': [term(unit='N')]}, r'unit "N" in term 1, but .* give "N s"; write that unit'),
        ({'terms': [term(interval=[2.0, 3.0])]}, r'coefficient 1 outside of its interval 2 to 3'),
        ({'terms': []}, r'terms must have 1 or more entries'),
        ({'terms': [term()] * 7}, r'terms must have 6 or fewer entries'),
        ({'terms': [term(factors=[U] * 4)]}, r'factors must have 3 or fewer entries'),
        ({'region': {}}, r'uses u without a range in "region"; add the lowest and highest value'),
        ({'region': {'u': [1.0, 1.0]}}, r'has an empty range of u in "region"'),
        ({'region': {'u': [0.0, 1.0], 'v': [0.0, 1.0]}}, r'of v, which no term uses; remove it'),
        ({'hidden': {'drive': [U], 'time_constant': 1.0}}, r'block "hidden" that no term uses'),
        ({'hidden': {'drive': [U], 'damping': 1.0}}, r'needs either time_constant, .* or freq'),
        ({'terms': [term(factors=[{'quantity': 'hidden'}])]}, r'but has no block "hidden"; add'),
    ],
)
def test_a_wrong_law_is_refused(change, complaint):
    refuse(change, complaint)


def test_units_and_formulas():
    speed = [{'quantity': 'speed'}, {'quantity': 'r'}]
    one = law(
        ('yaw', -3.1e-4, speed),
        ('yaw', 2e-3, [{'quantity': 'hidden', 'form': 'positive', 'threshold': 0.5}]),
        hidden={'drive': [{'quantity': 'thrust_1', 'form': 'modulus'}], 'time_constant': 4.0},
        speed=[0.0, 0.6],
        r=[-1.0, 1.0],
        hidden_=[0.0, 1.0],
    )
    assert [each.unit for each in one.terms] == ['N s2', 'm']
    assert list(describe_law(one)) == [
        'yaw moment [N m] = -0.00031 speed r + 0.002 max(hidden - 0.5 N, 0)',
        'with 4 s d/dt hidden = |thrust_1| - hidden',
        'for speed 0 to 0.6 m/s, r -1 to 1 rad/s, hidden -1000 to 1000 N, '
        'thrust_1 -1000 to 1000 N; outside, it fades to zero',
    ]
    assert describe_term(one.terms[0]) == (
        'a yaw moment of -0.00031 N m per (m/s)(rad/s) of airspeed times yaw rate'
    )
    turning = law(
        ('map_x', 0.01, [{'quantity': 'yaw', 'form': 'sin', 'phase': -0.5}]),
        ('map_y', 0.02, [{'quantity': 'x', 'form': 'cos', 'scale': 2.0, 'phase': 0.5}]),
        ('heave', 0.03, [{'quantity': 'u', 'form': 'positive', 'threshold': -0.1}]),
    )
    assert list(describe_law(turning))[:3] == [
        'force along map x [N] = 0.01 sin(yaw + 0.5)',
        'force along map y [N] = 0.02 cos(2 pi x / (2 m) - 0.5)',
        'heave force [N] = 0.03 max(u + 0.1 m/s, 0)',
    ]
    assert describe_term(law(('map_x', 0.01, [])).terms[0]) == 'a force along map x of 0.01 N'
    power = law(('surge', 1.0, [{'quantity': 'w', 'form': 'power', 'exponent': 1.7}]))
    assert power.terms[0].unit == 'N s1.7/m1.7'


def test_a_flight_says_once_what_left_the_region():
    floor = lamp_room.build().state[2]
    sentences = []
    for top in (floor - 0.1, floor + 5.0):
        one = law(('roll', 1e-6, [{'quantity': 'height'}]), height=[0.0, float(top)])
        world = lamp_room.build(vehicle={'law': one.model_dump(exclude_defaults=True)})
        lamp_room.fly(world, 2)
        sentences.append(world.law_warning)
        lamp_room.fly(world, 3, lamp_room.HOVER)
        assert world.law_warning == sentences[-1]
    assert sentences[0] == (
        f'The law of vehicle gtmab is valid for height 0 to {floor - 0.1:.3g} m, and fades to '
        f'zero outside: here, height reached {floor:.3g} m.'
    )
    assert sentences[1] == ''
    assert lamp_room.build().law_warning == ''
