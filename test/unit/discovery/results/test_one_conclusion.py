"""Page, terminal, JSON and files draw one conclusion, whatever it is."""

from dataclasses import replace
from io import StringIO
import json
from pathlib import Path

from lta_challenge.contradictions import find_contradictions
from lta_config.errors import BadInput
from lta_discovery.finding import ChannelErrors, StudyResult
from lta_discovery.flights.usable_flights import UsableFlights
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.page.verdict_text import list_learned_file_commands
from lta_discovery.results.terminal import format_named_parameters, print_finding
from lta_discovery.run import discover_effects, DiscoveryRequest, write_results
from lta_discovery.study import DiscoveryStudy
from lta_discovery.unmodeled.unexplained_force import Remainder
from lta_model.vehicle import load_vehicle
import pytest
from rich.console import Console

from ..hidden_cases import CASES  # noqa: TID252 - `test` is Python's own
from ..hidden_study import DRAG, study  # noqa: TID252 - `test` is Python's own

# The error falls from 0.3 to 0.28 by fitted tolerances, and to 0.1 with the effect
GAP = ChannelErrors(
    'position', 'm', 3.0, 0.3, 0.28, 0.1, 1.0, 0.002, 0.67, (0.6, 0.7), 9, added_ci95=(0.4, 0.8)
)
VAIN = replace(GAP, after=0.28, added_ci95=(-0.1, 0.1))
FORCE = (Remainder('pitch', 4e-4, 10.0, ('yaw rate',), 0.6),)
# Kind: search verdict, whether effects were found, errors, forces that remain; verdict, headline
KINDS = {
    'named': ('named', True, GAP, (), 'named', 'is missing from the model'),
    'named by another channel than the position': (
        'named', True, replace(GAP, channel='attitude'), (), 'named', 'is missing from the model',
    ),
    'may be missing, and the file forecasts better': (
        'named', True, replace(VAIN, after=0.5, shrink_ci95=(-0.9, -0.5)), (),
        'possible', 'no forecast shows it',
    ),
    'may be missing': ('named', True, VAIN, (), 'possible', 'no forecast shows it'),
    'may be missing, with tolerances that suffice': (
        'named', True, replace(VAIN, tuned=0.1, after=0.1), (), 'possible', 'no forecast shows it',
    ),
    'nothing': ('none', False, replace(VAIN, tuned=0.3, after=0.3), (), 'none', 'no effect that'),
    'refused': ('not_identifiable', False, VAIN, (), 'not_identifiable', 'do not show what'),
    'refused, with a guess': (
        'not_identifiable', True, VAIN, (), 'not_identifiable', 'cannot distinguish',
    ),
    'outside the library': (
        'unexplained', False, VAIN, FORCE, 'unexplained', 'no effect of the library describes',
    ),
    'named, and outside the library': (
        'named+unexplained', True, GAP, FORCE, 'named+unexplained', 'is missing from the model',
    ),
    'may be missing, and outside the library': (
        'named+unexplained', True, VAIN, FORCE, 'possible+unexplained', 'no forecast shows it',
    ),
}  # fmt: skip


@pytest.fixture(scope='module')
def found(gtmab: tuple[NominalVehicle, list[FreeParameter]]) -> DiscoveryStudy:
    """A study of short flights; what it found is replaced."""
    return study(gtmab, CASES[DRAG], length=14.0)


@pytest.mark.parametrize('kind', KINDS)
def test_all_outputs_draw_the_same_conclusion(
    found: DiscoveryStudy, tmp_path: Path, kind: str
) -> None:
    searched, has_effects, gap, remains, verdict, words = KINDS[kind]
    effects, ladder = found.finding.effects, found.finding.ladder
    finding = replace(
        found.finding, verdict=searched, gaps=(gap,), remains=remains, warnings=(),
        effects=effects if has_effects else (), ladder=ladder if has_effects else (),
    )  # fmt: skip
    assert find_contradictions(finding) == []
    is_named = verdict.startswith('named')
    page, told, said = _write(replace(found, finding=finding), tmp_path)
    conclusion = told['conclusion']
    assert told['verdict'] == verdict
    assert conclusion['asserted'] == is_named
    assert words in conclusion['headline']
    assert conclusion['headline'] in page
    assert conclusion['headline'] in said
    assert ('linear drag (surge) is named' in page) == is_named
    assert ('linear drag (surge) is possible' in page) == (has_effects and not is_named)
    assert ('with the named effects' in said) == is_named
    assert (tmp_path / 'vehicle.yaml').exists() == is_named
    assert any('vehicle.yaml' in one for one in _list_commands(finding)) == is_named
    assert ('possible, not named' in format_named_parameters(finding)) == (
        has_effects and not is_named
    )


def test_a_refused_study_leaves_nothing(tmp_path: Path) -> None:
    """One sentence, and no file that could be read as a result."""
    request = DiscoveryRequest('gtmab', {'train': [tmp_path / 'none']})
    with pytest.raises(BadInput, match='none'):
        discover_effects(request, tmp_path / 'out', lambda _what, _part: None)
    assert list(tmp_path.iterdir()) == []


def _write(given: DiscoveryStudy, folder: Path) -> tuple[str, dict[str, dict[str, str]], str]:
    """Return the page, the JSON and the terminal's text of a study."""
    request = DiscoveryRequest('gtmab', {role: [Path(role)] for role in ('train', 'confirm')})
    vehicle = load_vehicle('gtmab')
    result = write_results(request, vehicle, given, UsableFlights((), (), ()), folder, folder)
    out = StringIO()
    print_finding(given.finding, Console(file=out, width=100))
    told = json.loads((folder / 'discovery.json').read_text(encoding='utf-8'))
    return result.page.read_text(encoding='utf-8'), told, out.getvalue()


def _list_commands(finding: StudyResult) -> list[str]:
    """Return the commands that an output offers to continue with."""
    return list(list_learned_file_commands(finding, Path('found')).values())
