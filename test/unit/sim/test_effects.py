"""Values of single effects by hand, and what may be an effect."""

from lta_cli.reference.effects_page import render_page
from lta_config.errors import BadInput
from lta_model import effects
from lta_model.effects.contact import floor_contact
from lta_model.effects.protocol import EffectParameter, VehicleMotion, WrenchEffect
from lta_model.effects.regressors import compute_regressors
from lta_model.effects.rotors import motor_lag, rotor_thrust, thrust_curve
from lta_model.effects.weight import weight_and_buoyancy
from lta_model.state import BODY, COMMAND, DISPLACED, MASS, MASS_MOMENT, SURROUNDINGS
import numpy as np
import pytest

LEVEL = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
NO = (0.0, 0.0, 0.0)
# A quarter turn about y: the nose points down, body x is map -z and body z is map x.
NOSE_DOWN = (0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0)


def still(position=NO, rotation=LEVEL, velocity=NO, rates=NO):
    body = [0.0] * BODY
    body[MASS], body[MASS_MOMENT + 2], body[DISPLACED] = 0.4, -0.04, 0.3
    command, surroundings = (0.0,) * COMMAND, (0.0,) * SURROUNDINGS
    return VehicleMotion(
        position, rotation, velocity, rates, velocity, tuple(body), command, surroundings
    )


def foot(p, motion):
    return floor_contact.compute_wrench(p, (), motion, (0.0,) * 8)


def test_cg_below_the_hull_centre_rights():
    level = weight_and_buoyancy.compute_wrench((10.0,), (), still(), (0.0,) * 8)
    np.testing.assert_allclose(level, (0.0, 0.0, -1.0, 0.0, 0.0, 0.0), atol=1e-15)
    down = weight_and_buoyancy.compute_wrench((10.0,), (), still(rotation=NOSE_DOWN), (0.0,) * 8)
    # Weight 4 N along body x, 0.1 m below: -0.4 N m about y lifts the nose.
    np.testing.assert_allclose(down, (1.0, 0.0, 0.0, 0.0, -0.4, 0.0), atol=1e-15)


def test_thrust_curve():
    first = thrust_curve.compute_output((0.0915, 0.0677), (), 0.5, ())
    third = thrust_curve.compute_output((0.02, 0.03), (), -1.0, ())
    assert (first, third) == pytest.approx((0.0915 * 0.25 + 0.0677 * 0.5, -0.05), rel=1e-15)


def test_rotor_columns():
    first, third = 0.0567, -0.05
    p = [0.0] * 48
    p[16], p[18], p[34] = 1.0, 0.5, -0.4  # heave of the first and third, pitch of the third
    wrench = rotor_thrust.compute_wrench(
        tuple(p), (), still(), (first, 1.0, third, 1.0, *[0.0] * 4)
    )
    expected = (0.0, 0.0, first + 0.5 * third, 0.0, -0.4 * third, 0.0)
    np.testing.assert_allclose(wrench, expected, rtol=1e-15)


def test_lag_up_and_down():
    p = (0.1, 0.2)
    assert motor_lag.compute_memory_rate(p, (0.5,), 1.0, ()) == (5.0,)
    assert motor_lag.compute_memory_rate(p, (0.5,), 0.0, ()) == (-2.5,)
    assert motor_lag.compute_memory_rate(p, (-0.5,), -1.0, ()) == (-5.0,)
    assert motor_lag.compute_output(p, (0.5,), 1.0, ()) == 0.5


P = (100.0, 0.05, 0.5, 0.0, 0.0, -0.3)


def test_floor_holds_what_sinks_in():
    assert foot(P, still((0.0, 0.0, 0.3))) == (0.0,) * 6
    assert foot(P, still((1.0, 2.0, 0.29)))[2] == pytest.approx(1.0, rel=1e-12)
    sinking = foot(P, still((0.0, 0.0, 0.29), velocity=(0.0, 0.0, -0.2)))
    assert sinking[2] == pytest.approx(2.0, rel=1e-12)


def test_floor_never_pulls():
    rising = foot(P, still((0.0, 0.0, 0.29), velocity=(0.0, 0.0, 1.0)))
    np.testing.assert_array_equal(rising, np.zeros(6))


def test_friction_opposes_slip_at_the_foot():
    fast = foot(P, still((0.0, 0.0, 0.29), velocity=(5.0, 0.0, 0.0)))
    assert fast[0] == pytest.approx(-0.5, rel=1e-4)
    assert fast[4] == pytest.approx(0.15, rel=1e-4)
    # The hull rolls over its foot without slip: v = w x r, 0.3 m above.
    rolling = foot(P, still((0.0, 0.0, 0.29), velocity=(0.3, 0.0, 0.0), rates=(0.0, 1.0, 0.0)))
    assert rolling[0] == pytest.approx(0.0, abs=1e-12)


def test_basis_holds_the_other_parameters():
    effect = effects.EFFECTS['floor_contact']
    given = {'relaxation': 0.05, 'friction': 0.5, 'z': -0.3, 'stiffness': 7.0}
    column = compute_regressors(
        effect, given, still((0.0, 0.0, 0.29), velocity=(1.0, 0.0, -0.1)), (0.0,) * 8
    )
    assert column.shape == (6, 1)
    assert column[2, 0] == pytest.approx(0.015, rel=1e-12)


POUNDS = EffectParameter('pull', 'lbf', 0.0, 0.0, 1.0, 0.1, 'nobody: a unit that no file knows')


class Point:
    """An entry point that names `effect`."""

    def __init__(self, effect):
        self.name, self.value, self._effect = 'point', 'somewhere:EFFECT', effect

    def load(self):
        return self._effect


@pytest.mark.parametrize(
    ('effect', 'words'),
    [
        (effects.EFFECTS['linear_drag'], 'linear_drag of somewhere:EFFECT is already used'),
        ('wind', 'not an effect'),
        (WrenchEffect('side-wind', (), weight_and_buoyancy.compute_wrench), 'underscores'),
        (
            WrenchEffect('tow', (POUNDS,), weight_and_buoyancy.compute_wrench),
            "tow.pull .* has the unit 'lbf'",
        ),
    ],
)
def test_installed_effects_are_checked(monkeypatch, effect, words):
    monkeypatch.setattr(effects, 'entry_points', lambda group: [Point(effect)])
    with pytest.raises(BadInput, match=words):
        effects.merge_installed_effects({'linear_drag': effects.EFFECTS['linear_drag']})


def test_what_others_install_is_not_of_the_library(monkeypatch):
    rope = WrenchEffect('guide_rope', (), weight_and_buoyancy.compute_wrench)
    before = render_page()
    monkeypatch.setitem(effects.EFFECTS, 'guide_rope', rope)
    assert effects.get_effect('guide_rope') is rope
    assert list(effects.select_built_in_effects()) == list(effects.BUILT_IN)
    assert render_page() == before
