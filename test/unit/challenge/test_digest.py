"""A score is known by the effects and the vehicle that it is about."""

from dataclasses import replace

from lta_challenge import digest
from lta_model.effects import EFFECTS
from lta_model.effects.drag import LINEAR_DRAG
import pytest


def test_a_changed_spread_or_equation_is_another_registry(monkeypatch: pytest.MonkeyPatch) -> None:
    before = digest.compute_registry_digest()
    assert before == digest.compute_registry_digest()
    effect = EFFECTS['linear_drag']
    wider = tuple(replace(p, spread=2.0 * p.spread) for p in effect.parameters)
    monkeypatch.setitem(EFFECTS, 'linear_drag', replace(effect, parameters=wider))
    assert digest.compute_registry_digest() != before
    monkeypatch.setitem(EFFECTS, 'linear_drag', replace(effect, wrench=still))
    assert digest.compute_registry_digest() != before
    other = tuple(replace(p, source='elsewhere') for p in effect.parameters)
    monkeypatch.setitem(EFFECTS, 'linear_drag', replace(LINEAR_DRAG, parameters=other))
    assert digest.compute_registry_digest() == before


def still(p, memory, motion, thrust):  # type: ignore[no-untyped-def]
    """Return nothing."""
    surge, sway, heave = p  # noqa: RUF059
    return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def test_a_renamed_function_is_the_same_registry() -> None:
    source = 'def {0}(x):\n    return 2.0 * x\n\ndef wrench(x):\n    return {0}(x) + {1}\n'
    texts = (source.format('twice', 1.0), source.format('doubled', 1.0), source.format('twice', 2))
    one, renamed, other = map(digest._normalize_source, texts)
    assert one == renamed
    assert one != other


def test_vehicles_differ() -> None:
    assert digest.vehicle_digest('gtmab') != digest.vehicle_digest('beavis')
