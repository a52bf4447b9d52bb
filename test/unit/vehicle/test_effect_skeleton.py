"""The skeleton of an effect is an effect like any other."""

import importlib.util

from lta_config.compilation.extract import SourceExtract
from lta_config.errors import BadInput
from lta_model.effects.protocol import VehicleMotion
from lta_vehicle.effect_skeleton import write_skeleton
import pytest

STILL = (0.0, 0.0, 0.0)
FORWARD = VehicleMotion(STILL, (1.0, 0.0, 0.0) * 3, STILL, STILL, (0.5, 0.2, 0.1), (), (), ())


def test_it_is_an_effect_like_any_other(tmp_path):
    path, project = write_skeleton('found', tmp_path / 'found')
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    effect = module.EFFECT
    assert '=' in effect.wrench.__doc__
    assert effect.wrench((0.2,), (), FORWARD, (0.0,) * 8) == (-0.1, 0.0, 0.0, 0.0, 0.0, 0.0)
    # The kernel can take it
    assert SourceExtract().add_function(effect.wrench, 'found') == 'found_compute_wrench'
    assert 'found = "found:EFFECT"' in project.read_text(encoding='utf-8')


@pytest.mark.parametrize(
    ('name', 'complaint'),
    [
        ('linear_drag', r'There is an effect linear_drag already; choose another name'),
        ('Own-effect', r"'Own-effect' cannot name an effect; use small letters and digits"),
        ('_own', r"'_own' cannot name an effect; use small letters"),
        *(
            (name, rf"'{name}' cannot name an effect, as Python has a keyword or module")
            for name in ('class', 'math')
        ),
    ],
)
def test_what_cannot_be_an_effect_is_refused_and_leaves_nothing(tmp_path, name, complaint):
    with pytest.raises(BadInput, match=complaint):
        write_skeleton(name, tmp_path / 'new')
    assert not (tmp_path / 'new').exists()
    with pytest.raises(BadInput, match=r'exists already; give another folder with --out'):
        write_skeleton('found', tmp_path)
