"""Values of single effects by hand, and what may be an effect."""

from lta_config.errors import BadInput
from lta_model import effects
from lta_model.effects.protocol import EffectParameter, WrenchEffect
from lta_model.effects.weight import WEIGHT_AND_BUOYANCY
import pytest
from tools.reference.effects import render_page

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
        (WrenchEffect('side-wind', (), WEIGHT_AND_BUOYANCY.wrench), 'underscores'),
        (
            WrenchEffect('tow', (POUNDS,), WEIGHT_AND_BUOYANCY.wrench),
            "tow.pull .* has the unit 'lbf'",
        ),
    ],
)
def test_installed_effects_are_checked(monkeypatch, effect, words):
    monkeypatch.setattr(effects, 'entry_points', lambda group: [Point(effect)])
    with pytest.raises(BadInput, match=words):
        effects.merge_installed_effects({'linear_drag': effects.EFFECTS['linear_drag']})


def test_what_others_install_is_not_of_the_library(monkeypatch):
    rope = WrenchEffect('not_shipped', (), WEIGHT_AND_BUOYANCY.wrench)
    before = render_page()
    monkeypatch.setitem(effects.EFFECTS, 'not_shipped', rope)
    assert effects.get_effect('not_shipped') is rope
    assert list(effects.select_built_in_effects()) == list(effects.BUILT_IN)
    assert render_page() == before
