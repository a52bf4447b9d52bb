"""The shipped gains say everything, and a wrong file is refused in one sentence."""

from lta_config.errors import BadInput
from lta_config.files import find_file, load_yaml
from lta_control.cascade import CascadeGains
from lta_control.gains_file import load_gains
from lta_control.pid import PidGains
import pytest
import yaml

HEAD = '/**/controller'


def written(path, gains):
    path.write_text(yaml.safe_dump({HEAD: {'ros__parameters': {'gains': gains}}}))
    return str(path)


@pytest.fixture
def shipped():
    return load_yaml(find_file('gains', 'gtmab'))[HEAD]['ros__parameters']['gains']


def refused(name):
    with pytest.raises(BadInput) as caught:
        load_gains(name)
    return str(caught.value)


def test_no_gain_of_gtmab_is_silently_a_default(shipped):
    assert set(shipped) == set(CascadeGains.model_fields)
    for loop in ('climb', 'yaw_rate', 'speed'):
        assert set(shipped[loop]) == set(PidGains.model_fields)


def test_the_numbers_arrive(shipped):
    gains = load_gains('gtmab')
    assert gains.model_dump() == shipped
    assert gains.yaw_rate == PidGains(kp=0.08, ki=0.02, kd=0.0, limit=0.008)


def test_an_unknown_gain_is_refused(tmp_path, shipped):
    path = written(tmp_path / 'g.yaml', shipped | {'altitude_ki': 0.1})
    assert refused(path) == (
        f"{path}: the key 'altitude_ki' is not known; remove it or correct its spelling."
    )
    path = written(tmp_path / 'g.yaml', shipped | {'climb': shipped['climb'] | {'kq': 0.1}})
    assert refused(path) == (
        f"{path}: the key 'climb.kq' is not known; remove it or correct its spelling."
    )


@pytest.mark.parametrize(
    ('key', 'value', 'message'),
    [
        ('altitude_kp', -1.0, 'altitude_kp is -1.0, but must be at least 0.'),
        ('climb_limit', 9.0, 'climb_limit is 9.0, but must be at most 2.'),
        ('drift_limit', 'wide', "drift_limit is 'wide', but must be a number"),
        ('altitude_kp', '0.6', "altitude_kp is '0.6', but must be a number."),
        ('altitude_kp', True, 'altitude_kp is True, but must be a number.'),
        ('turn_first', float('nan'), 'turn_first is nan, but must be'),
        ('altitude_kp', float('inf'), 'altitude_kp is inf, but must be at most'),
        ('turn_first', float('inf'), 'turn_first is inf, but must be'),
    ],
)
def test_a_wrong_gain_is_refused(tmp_path, shipped, key, value, message):
    path = written(tmp_path / 'g.yaml', shipped | {key: value})
    assert refused(path).startswith(f'{path}: {message}')


@pytest.mark.parametrize(
    'text', [f'{HEAD}:\n  ros__parameters: {{}}\n', 'gains: {}\n', '[1, 2]\n', 'null\n', '{}\n']
)
def test_a_file_of_something_else_is_refused(tmp_path, text):
    path = tmp_path / 'g.yaml'
    path.write_text(text)
    assert refused(str(path)) == (
        f'{path} has no gains under {HEAD}, ros__parameters, gains; compare it with a file in '
        'config/control.'
    )
