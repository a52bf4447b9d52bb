"""The skeleton of an effect computes what its law does, and is an effect like any other."""

import ast
import importlib.util
import inspect
import textwrap

from lta_config.compilation.extract import SourceExtract
from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_config.schema.vehicle_law import Law
from lta_config.vehicle_edit import set_yaml_values
from lta_model.effects.law import compute_memory_rate, compute_wrench, list_law_parameters
from lta_model.effects.protocol import VehicleMotion
from lta_vehicle.effect_skeleton import load_law, write_skeleton
import numpy as np
import pytest
from scipy.spatial.transform import Rotation


def factor(quantity, form='linear', **numbers):
    return {'quantity': quantity, 'form': form, **numbers}


def build(terms, region, hidden=None):
    """Return a law of (axis, coefficient, unit, factors)."""
    keys = ('axis', 'coefficient', 'unit', 'factors')
    listed = [dict(zip(keys, term, strict=True)) for term in terms]
    content = {'source': 'a test', 'terms': listed, 'region': region}
    return Law.model_validate(content | ({'hidden': hidden} if hidden else {}))


NARROW = [-0.4, 0.4]
LAWS = {
    'forms': build(
        [
            ('surge', 0.1, 'N', [factor('u', 'above', threshold=0.1, scale=0.2)]),
            (
                'surge',
                0.2,
                'N',
                [factor('v', 'sign', scale=0.3), factor('height', 'decay', scale=2.0)],
            ),
            ('sway', -0.3, 'N s1.5/m1.5', [factor('w', 'power', exponent=1.5)]),
            ('yaw', 0.4, 'N s2', [factor('speed'), factor('r', 'modulus')]),
            ('yaw', 0.5, 'm', [factor('thrust_2', 'positive', threshold=-0.1)]),
        ],
        {'u': NARROW, 'v': NARROW, 'height': NARROW, 'w': NARROW, 'speed': [0.0, 2.0]}
        | {'r': NARROW, 'thrust_2': [-2.0, 2.0]},
    ),
    'places': build(
        [
            ('map_x', -0.6, '1/m', [factor('thrust_yaw', 'negative', threshold=0.1)]),
            ('map_z', -0.6, 'N/m', [factor('x'), factor('yaw', 'cos', phase=0.3)]),
            ('roll', 0.1, 'N m', [factor('roll', 'sin')]),
            ('pitch', 0.1, 'N m/V', [factor('pitch'), factor('voltage')]),
            ('heave', 1e-3, 'N/s', [factor('time')]),
        ],
        {'thrust_yaw': [-2.0, 2.0], 'x': NARROW, 'yaw': [2.0, 4.0], 'roll': NARROW}
        | {'pitch': NARROW, 'voltage': [3.0, 4.0], 'time': [0.0, 9.0]},
    ),
    'first': build(
        [('surge', 0.2, 'N s2', [factor('hidden', 'modulus'), factor('rate')])],
        {'q': NARROW, 'rate': [0.0, 1.0], 'hidden': NARROW, 'p': NARROW},
        {'drive': [factor('q'), factor('p', 'cos', scale=1.0)], 'time_constant': 3.0},
    ),
    'rate': build(
        [
            ('surge', 0.2, 'N s/m', [factor('hidden')]),
            ('surge', 0.1, 'N s2/m', [factor('hidden_rate')]),
        ],
        {'u': NARROW, 'hidden': NARROW, 'hidden_rate': NARROW},
        {'drive': [factor('u')], 'time_constant': 0.7},
    ),
    'second': build(
        [
            ('surge', 0.2, 'N s/m', [factor('hidden')]),
            ('surge', 0.1, 'N s2/m', [factor('hidden_rate')]),
        ],
        {'u': NARROW, 'hidden': NARROW, 'hidden_rate': NARROW},
        {'drive': [factor('u')], 'frequency': 3.0, 'damping': 0.2},
    ),
}


def load(path):
    """Return the module of a file."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def motions(seed):
    """Return random inputs of an effect: motion, memory and rotor thrusts."""
    draw = np.random.default_rng(seed)
    vectors = [tuple(draw.uniform(-0.8, 0.8, 3).tolist()) for _ in range(4)]
    turn = Rotation.from_euler('ZYX', draw.uniform((-3.1, -0.6, -0.6), (3.1, 0.6, 0.6)))
    body, around = draw.uniform(-1.0, 1.0, 65), draw.uniform(3.0, 4.0, 11)
    motion = VehicleMotion(
        vectors[0],
        tuple(turn.as_matrix().ravel().tolist()),
        *vectors[1:],
        tuple(body.tolist()),
        (),
        tuple(around.tolist()),
    )
    memory = tuple(draw.uniform(-0.5, 0.5, 3).tolist())
    return motion, memory, tuple(draw.uniform(-0.5, 0.5, 8).tolist())


@pytest.mark.parametrize('name', LAWS)
def test_it_computes_what_the_law_does(tmp_path, name):
    law = LAWS[name]
    path, _ = write_skeleton('found', law, tmp_path / 'found')
    module = load(path)
    effect = module.EFFECT
    axes = [term.axis for term in law.terms]
    given = [term.coefficient for term in law.terms]
    assert [known.name for known in effect.parameters[: len(axes)]] == [
        f'{axis}_{axes[: k + 1].count(axis)}' for k, axis in enumerate(axes)
    ]
    if law.hidden:
        lags = law.hidden.model_dump(exclude_none=True)
        given += [value for key, value in lags.items() if key != 'drive']
    numbers = tuple(list_law_parameters(law).values())
    moved = 0
    for seed in range(200):
        motion, memory, thrust = motions(seed)
        expected = compute_wrench(numbers, memory, motion, thrust)
        own = memory if effect.memory else ()
        assert effect.wrench(tuple(given), own, motion, thrust) == pytest.approx(
            expected, rel=1e-12, abs=1e-15
        )
        moved += any(expected)
        if effect.memory:
            rates = compute_memory_rate(numbers, memory, motion, thrust)
            assert effect.rate(tuple(given), own, motion) == pytest.approx(rates, rel=1e-12)
            nothing = (0.0,) * len(given)
            assert effect.rate(nothing, own, motion) == (0.0, 0.0, 0.0)
    # The motions reach from within the region to far outside
    assert moved > 20


@pytest.mark.parametrize('law', [None, *LAWS.values()], ids=['example', *LAWS])
def test_it_is_an_effect_like_any_other(tmp_path, law):
    path, project = write_skeleton('found', law, tmp_path / 'found')
    module = load(path)
    effect = module.EFFECT
    assert '=' in effect.wrench.__doc__
    extract = SourceExtract()
    for function in (effect.wrench, *([effect.rate] if effect.memory else [])):
        # The kernel can take it, and the order of its parameters is the declared one
        extract.add_function(function, 'found')
        tree = ast.parse(textwrap.dedent(inspect.getsource(function))).body[0]
        unpack = next(node for node in tree.body if isinstance(node, ast.Assign))
        assert [item.id for item in unpack.targets[0].elts] == [
            known.name for known in effect.parameters
        ]
    assert (
        effect.wrench((0.0,) * len(effect.parameters), (0.0,) * 3, *motions(1)[::2]) == (0.0,) * 6
    )
    assert 'found = "found:EFFECT"' in project.read_text(encoding='utf-8')


def test_the_law_comes_from_a_vehicle_file_or_a_run(tmp_path):
    text = find_file('vehicle', 'gtmab').read_text(encoding='utf-8')
    law = LAWS['first']
    (tmp_path / 'vehicle.yaml').write_text(
        set_yaml_values(text, {'law': law.model_dump(exclude_defaults=True)}), encoding='utf-8'
    )
    assert load_law(str(tmp_path / 'vehicle.yaml')) == law
    assert load_law(str(tmp_path)) == law
    with pytest.raises(BadInput, match=r'The vehicle file of gtmab has no law; give one'):
        load_law('gtmab')


def test_what_cannot_be_an_effect_is_refused_and_leaves_nothing(tmp_path):
    pushed = build(
        [('surge', 0.2, '1', [factor('hidden')])],
        {'thrust_1': NARROW, 'hidden': NARROW},
        {'drive': [factor('thrust_1')], 'time_constant': 3.0},
    )
    for name, law, complaint in (
        ('found', pushed, r'depends on thrust_1, which the rate of an effect does not get'),
        ('linear_drag', None, r'There is an effect linear_drag already; choose another name'),
        ('Own-effect', None, r"'Own-effect' cannot name an effect; use small letters and digits"),
        ('_own', None, r"'_own' cannot name an effect; use small letters"),
        ('own_', None, r"'own_' cannot name an effect; use small letters"),
        *(
            (name, None, rf"'{name}' cannot name an effect, as Python has a keyword or module")
            for name in ('class', 'math', 'sys', 'numpy')
        ),
    ):
        with pytest.raises(BadInput, match=complaint):
            write_skeleton(name, law, tmp_path / 'new')
        assert not (tmp_path / 'new').exists()
    with pytest.raises(BadInput, match=r'exists already; give another folder with --out'):
        write_skeleton('found', None, tmp_path)
