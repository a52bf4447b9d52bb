"""What no flight shows by itself is named by all together, if each leans that way."""

from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.selection import interval
from lta_discovery.selection.candidate_scan import CandidateScore
from lta_discovery.selection.effect_search import EffectSearch
from lta_discovery.selection.effect_verification import EffectVerification, VerifiedEffects
from lta_discovery.selection.weak_effects import choose_candidate, GAIN, WeakCandidate
import pytest

from ..hidden_flight import flown, prepared  # noqa: TID252 - `test` is Python's own

Known = tuple[NominalVehicle, list[FreeParameter]]
DRAG, SIZE = 'linear_drag.heave', 0.011  # N s/m; 2 or 3 deviations of each flight
FAINT = {'vehicle.aero.linear_drag.force': {'value': [0.0, 0.0, SIZE], 'unit': 'N s/m'}}


def _hint(name: str, gain: float, first: float = 3.0, second: float = 2.5) -> WeakCandidate:
    """Return a candidate; each side tells its value to 1."""
    one, other = (
        CandidateScore(name, 2.0, score, score, 1.0, abs(score)) for score in (first, second)
    )
    return WeakCandidate(name, gain, (one, other))


def test_the_best_is_chosen_where_nothing_else_comes_near() -> None:
    best, next_one = _hint('a', 7.0), _hint('b', 3.9)
    assert choose_candidate([best, next_one]) is best
    assert choose_candidate([best, _hint('b', 4.1)]) is None
    assert choose_candidate([best, _hint('b', 6.9), next_one], alike=['b']) is best
    assert choose_candidate([_hint('a', GAIN - 0.1)]) is None
    assert choose_candidate([best._replace(least=7.1), next_one]) is None
    assert choose_candidate([]) is None


def test_both_sides_have_to_lean_the_same_way_by_as_much() -> None:
    assert _hint('a', 7.0, -3.0, -1.1).is_consistent
    assert not _hint('a', 7.0, 4.2, 0.9).is_consistent  # one of them says nothing
    assert not _hint('a', 7.0, 3.0, -2.0).is_consistent
    assert not _hint('a', 7.0, 6.0, 1.5).is_consistent  # 4.5 by a deviation of 2 ** 0.5: 3.2
    assert choose_candidate([_hint('a', 9.0, 4.2, 0.9)]) is None
    strong = _hint('a', 26.0, 15.0, -0.9)
    assert not strong.is_consistent
    assert choose_candidate([strong]) is None  # apart by 11
    unseen = strong._replace(sides=(strong.sides[0], strong.sides[1]._replace(deviation=14.0)))
    assert choose_candidate([unseen]) is unseen
    assert not unseen.is_consistent


def test_evidence_adds_up_over_the_sides() -> None:
    trial = _hint('a', 7.0, 3.0, 2.5).trial
    assert trial.joint_evidence == pytest.approx(7.0)
    assert trial.held_out == pytest.approx(5.0)  # 7 less what the first wins alone
    assert trial.apart == pytest.approx(0.5 / 2**0.5)
    assert trial.part == pytest.approx(0.5 / 3.0)


def _proven(known: Known, changes: dict[str, object]) -> tuple[tuple[str, ...], VerifiedEffects]:
    nominal, knobs = known
    flights = [prepared(flown(changes, seed, 32.0), knobs) for seed in (80, 81)]
    named = EffectSearch(nominal, (flights[:1], flights[1:])).run()
    return named.names, EffectVerification(nominal, flights).run(named)


@pytest.mark.long
def test_a_drag_too_small_for_one_flight_is_named_by_two(gtmab: Known) -> None:
    alone, found = _proven(gtmab, FAINT)
    assert alone == ()
    assert found.names == (DRAG,)
    assert found.steps[0].named == DRAG
    assert found.costs[DRAG] == pytest.approx(found.steps[0].trials[0].joint_evidence)
    k = found.full.group.linears[0].names.index(DRAG)
    value, spread = found.full.fitted.mean[k], found.full.fitted.covariance[k, k] ** 0.5
    assert abs(value - SIZE) < 3.0 * spread


@pytest.mark.long
def test_what_may_be_nothing_by_its_interval_is_not_named(
    gtmab: Known, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(interval, 'LEAST', {DRAG: SIZE})
    assert _proven(gtmab, FAINT)[1].names == ()


@pytest.mark.long
def test_flights_without_it_name_nothing(gtmab: Known) -> None:
    alone, found = _proven(gtmab, {})
    assert alone == found.names == ()
    assert [step.named for step in found.steps] == ['']
    assert found.full is found.bare
