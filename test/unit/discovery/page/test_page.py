"""The page of a study says every number of its finding, whatever the verdict."""

from collections.abc import Iterator
from dataclasses import replace
from html import unescape
import json
import math
from pathlib import Path
import re

from lta_config.files import find_file
from lta_config.schema.vehicle_law import Law, LawFactor, LawTerm
from lta_discovery.conclusion import FAR
from lta_discovery.finding import (
    IdentifiedGroup,
    LawFinding,
    LeftOutRegime,
    ParameterEstimate,
    SearchCandidate,
    StudyResult,
    TransferEvidence,
)
from lta_discovery.fit.bounds import apply_parameters
from lta_discovery.fit.evidence import build_prior, FLOOR, PieceReducer, ReducedFlight
from lta_discovery.flights.usable_flights import UsableFlights
from lta_discovery.forecast.flight_prediction import best_start_residual, error_to_noise
from lta_discovery.laws.law_file import add_law_block, BaseFile, write_tolerance_file
from lta_discovery.laws.proposal import add_law
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.page import flight_views
from lta_discovery.page.error_tables import render_pose_errors
from lta_discovery.page.figures import _label_flights, average_pieces
from lta_discovery.page.flight_views import build_flight_views, build_overlay
from lta_discovery.page.formatting import (
    explain_decision,
    format_file_value,
    format_number,
    format_odds,
    format_parameter,
    format_percent,
    format_quantity,
    format_with_interval,
)
from lta_discovery.page.page import write_page
from lta_discovery.page.verdict_text import build_tiles, format_headline
from lta_discovery.page.whiteness import autocorrelation, residual_spectrum
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.replay.linearized_flight import (
    LinearizationPoint,
    unchanged_vehicle_point,
    zero_unknowns,
)
from lta_discovery.run import DiscoveryRequest, write_results
from lta_discovery.selection.candidate_acceptance import CandidateTrial, LARGER
from lta_discovery.selection.candidate_scan import CandidateScore, scan_candidates
from lta_discovery.selection.detection_limit import compute_detection_limits, DetectionLimit
from lta_discovery.study import DiscoveryStudy, ThreeModelComparison
from lta_discovery.unmodeled.draught import DraughtEstimate
from lta_discovery.unmodeled.unexplained_force import Remainder
from lta_model.effects import EFFECTS
from lta_model.effects.protocol import describe_effect
from lta_model.vehicle import load_vehicle
from lta_report.drawing import create_figure
from lta_report.script_libraries import embed_plotly, embed_three
import numpy as np
import pytest
from scipy import signal, stats

from ...security.page_reading import ALL, inert  # noqa: TID252 - `test` is Python's own
from ..hidden_cases import CASES  # noqa: TID252 - `test` is Python's own
from ..hidden_study import DRAG, study  # noqa: TID252 - `test` is Python's own

Known = tuple[NominalVehicle, list[FreeParameter]]
REMAINS = (
    Remainder('surge', 0.0072, 18.25, ('surge speed', 'yaw rate'), 0.81),
    Remainder('pitch', 0.00031, 4.2, (), 0.06),
)
SAID = ('an oscillation of q at 2.0 Hz, 0.02 rad/s',)
SEEN = (DetectionLimit('linear_drag.sway', 'N s/m', 0.0034, 0.01),)
FIGURE = re.compile(r'<script type="application/json" id="([^"]+)">(.*?)</script>', re.DOTALL)
TAG = re.compile(r'<(script|style)\b.*?</\1>|<[^>]+>', re.DOTALL)


@pytest.fixture(scope='session')
def found(gtmab: Known) -> DiscoveryStudy:
    """A study in which drag was missing."""
    return study(gtmab, CASES[DRAG])


@pytest.fixture(scope='module', autouse=True)
def _residuals_cached() -> Iterator[None]:
    """Compute the residuals of a study's flights once for all its pages, since they take long."""
    kept: dict[object, tuple[np.ndarray, object, object]] = {}

    def best(flight: FlightLinearizer, point: LinearizationPoint) -> np.ndarray:
        key = id(flight), id(point.nominal), point.values.tobytes()
        if key not in kept:
            left = best_start_residual(flight, point)
            left.flags.writeable = False
            kept[key] = left, flight, point.nominal  # kept alive, so that ids stay unique
        return kept[key][0]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(flight_views, 'best_start_residual', best)
        yield


def _read(given: DiscoveryStudy, folder: Path) -> tuple[str, dict[str, object]]:
    """Return the words of a page and its data."""
    text = write_page(given, folder).read_text(encoding='utf-8')
    for library in (embed_plotly(), embed_three()):
        text = text.replace(library, '')
    data = {name: json.loads(content) for name, content in FIGURE.findall(text)}
    return ' '.join(unescape(TAG.sub(' ', text)).split()), data


def _with(given: DiscoveryStudy, **changes: object) -> DiscoveryStudy:
    return replace(given, finding=replace(given.finding, **changes))  # type: ignore[arg-type]


def _numbers(finding: StudyResult) -> list[str]:
    """Return every number of a finding as a person reads it."""
    out = [str(finding.seed)]
    for one in finding.effects:
        out.append(format_number(one.log_evidence))
        for each in one.parameters:
            out += [*format_with_interval(each.value, each.ci95), format_number(each.before)]
    for step in finding.ladder:
        for rung in step:
            out += [format_number(x) for x in (rung.train, rung.confirm, rung.carried, rung.apart)]
    for place in finding.where:
        out += [format_number(x) for x in (place.from_s, place.to_s, place.ratio_to_noise)]
    for gap in finding.gaps:
        five = (gap.before, gap.tuned, gap.after, gap.coast, gap.noise_floor)
        out += [format_quantity(x, gap.unit) for x in five]
        out += [format_percent(x) for x in (gap.shrink, *gap.shrink_ci95)]
        out += [f'{gap.horizon_s:g} s', str(gap.pieces)]
    for left in finding.remains:
        out += [format_number(left.size), format_number(left.floors), format_percent(left.carried)]
    return out


@pytest.mark.parametrize('evil', [ALL], ids=['all'])
def test_names_of_strangers_bags_are_words(
    found: DiscoveryStudy, tmp_path: Path, evil: str
) -> None:
    """Names of bags and regimes, and the vehicle as it was named; the rest is the library's."""
    named = [replace(one, name=f'{evil}{k}') for k, one in enumerate(found.flights)]
    shown = [
        replace(one, study_flight=replace(one.study_flight, name=evil))
        for one in found.comparisons * 2
    ]
    given = _with(
        replace(found, flights=named, comparisons=shown),
        where=tuple(one._replace(flight=evil, condition=evil) for one in found.finding.where),
        remains=REMAINS,
        warnings=(evil,),
        bags=dict.fromkeys(('train', 'confirm', 'holdout'), (evil,)),
        vehicle=evil,
        versions={evil: evil},
        unexplained=(evil,),
        next_flight=evil,
        carried=TransferEvidence(
            (IdentifiedGroup(evil, 0.5),), (LeftOutRegime(evil, 2, 0.7),), (evil,), 3
        ),
    )
    page = inert(write_page(given, tmp_path).read_text(encoding='utf-8'))
    assert evil in page.words


def test_every_number_and_name_of_the_finding_is_on_the_page(
    found: DiscoveryStudy, tmp_path: Path
) -> None:
    given = _with(
        found, remains=REMAINS, verdict='named+unexplained', unexplained=SAID, next_flight='Weigh.'
    )
    text, _ = _read(given, tmp_path)
    finding = given.finding
    assert [number for number in _numbers(finding) if number not in text] == []
    for step in finding.ladder:
        assert all(format_parameter(rung.knob) in text for rung in step)
    for words in (
        describe_effect(EFFECTS['linear_drag']),
        'quadratic drag (surge)',
        'airspeed above 0.21 m/s',
        'varies with surge speed and yaw rate',
        *finding.warnings,
        'An oscillation of q at 2.0 Hz, 0.02 rad/s.',
        finding.next_flight,
        *finding.versions.values(),
        '--train hidden_1 --confirm hidden_2 --holdout hidden_3 --seed 7',
    ):
        assert words in text
    assert re.search(r'\b(nan|inf|None)\b', text) is None


def test_the_page_is_one_small_file_and_its_data_are_valid(
    found: DiscoveryStudy, tmp_path: Path
) -> None:
    page = write_page(found, tmp_path)
    assert page == tmp_path / 'report.html'
    assert page.stat().st_size < 5_000_000
    _, data = _read(found, tmp_path)
    figures = {name for name in data if name.startswith('figure-')}
    kinds = ('heat', 'conditions', 'above', 'overtime', 'white', 'power')
    assert figures == {f'figure-{kind}' for kind in kinds}
    assert 'NaN' not in json.dumps(data)


@pytest.mark.parametrize(
    ('verdict', 'says'),
    [
        ('none', 'These flights reveal no effect that the model lacks.'),
        ('unexplained', 'describes: a force along surge that varies with surge speed and yaw'),
        (
            'not_identifiable',
            'These flights do not show what, if anything, is missing from the model.',
        ),
    ],
)
def test_a_study_without_names_has_a_calm_page(
    found: DiscoveryStudy, tmp_path: Path, verdict: str, says: str
) -> None:
    remains = REMAINS if verdict == 'unexplained' else ()
    given = _with(
        found, verdict=verdict, effects=(), remains=remains, detectable=SEEN, where=(), ladder=()
    )
    gaps = tuple(replace(one, before=one.after, tuned=one.after) for one in found.finding.gaps)
    given = _with(given, gaps=gaps)
    text, data = _read(given, tmp_path)
    assert says in text
    assert 'linear drag (sway) 0.0034 N s/m' in text
    assert ('No unexplained force or moment exceeds' in text) == (remains == ())
    assert ('figure-latent' in data) == ('figure-follows' in data) == (remains != ())
    assert 'vehicle.yaml' not in text


@pytest.mark.parametrize(
    ('said', 'title'),
    [
        (
            SAID,
            'The model lacks something that no effect of the library describes: an oscillation',
        ),
        ((), 'The model lacks something that no effect of the library describes.'),
    ],
)
def test_what_no_axis_shows_has_a_title_as_well(
    found: DiscoveryStudy, said: tuple[str, ...], title: str
) -> None:
    given = _with(found, verdict='unexplained', effects=(), remains=(), unexplained=said)
    assert format_headline(given.finding).startswith(title)


def test_a_draught_is_on_the_page_and_nothing_is_missing_for_it(
    found: DiscoveryStudy, tmp_path: Path
) -> None:
    given = _with(
        found,
        verdict='none',
        effects=(),
        remains=(),
        where=(),
        draught=DraughtEstimate(1.1e-3, 2.6e-3),
    )
    text, _ = _read(given, tmp_path)
    for words in (
        'A draught pushed the vehicle with 1.1 mN rms.',
        'A draught: a random horizontal force of 1.1 mN, as from air moving at about 2.6',
        'a draught of 1.1 mN, and no other force or moment',
        'No other unexplained force or moment exceeds the noise floor on any axis.',
    ):
        assert words in text


def test_a_study_without_held_out_flights_says_so(found: DiscoveryStudy, tmp_path: Path) -> None:
    text, _ = _read(_with(found, held_out=False), tmp_path)
    assert 'No flight was held out' in text
    bare = replace(_with(found, gaps=(), ladder=(), warnings=(), versions={}), comparisons=())
    text, data = _read(bare, tmp_path)
    assert 'There was no flight to compute prediction errors on.' in text
    assert 'No candidate was promising enough for a full fit.' in text
    assert 'figure-above' not in data


def test_several_flights_can_be_chosen(found: DiscoveryStudy, tmp_path: Path) -> None:
    shown = [
        ThreeModelComparison(
            one,
            *(unchanged_vehicle_point(n, one.flight.knobs, one.flight.replay.cut) for n in
              (found.nominal, found.nominal, found.learned)),
        )
        for one in found.flights
    ]  # fmt: skip
    _, data = _read(replace(found, comparisons=shown), tmp_path)
    flights = data['flights']
    assert isinstance(flights, dict)
    assert list(flights) == ['1', '2']  # the first one is drawn already
    lines = flights['1']['lines']
    assert [len(line) for line in lines] == [4, 4, 4]


def test_flights_of_one_name_keep_their_columns(found: DiscoveryStudy, tmp_path: Path) -> None:
    flights = [replace(one, name='bag') for one in found.flights]
    _, data = _read(replace(found, flights=flights), tmp_path)
    heat = data['figure-heat']
    assert isinstance(heat, dict)
    columns = heat['data'][0]['x']
    assert len(set(columns)) == len(columns) == sum(len(f.flight.replay.first) for f in flights)


def test_numbers_that_nobody_knows_are_dashes(found: DiscoveryStudy, tmp_path: Path) -> None:
    nan = math.nan
    gaps = tuple(
        replace(one, coast=nan, noise_floor=nan, shrink_ci95=(nan, nan))
        for one in found.finding.gaps
    )
    text, data = _read(_with(found, gaps=gaps), tmp_path)
    assert 'nan' not in text
    assert 'NaN' not in json.dumps(data)


def test_the_model_that_learned_leaves_noise(found: DiscoveryStudy) -> None:
    one = build_flight_views(found)[2]
    before, after = (error_to_noise(left)[:, :2].mean() for left in one.left)
    assert before > 4.0 * after
    assert after < 1.6


def test_a_true_model_leaves_what_was_measured_as_noise(
    gtmab: Known, clean: FlightLinearizer
) -> None:
    nominal, knobs = gtmab
    left = best_start_residual(clean, unchanged_vehicle_point(nominal, knobs, clean.replay.cut))
    assert np.nanstd(left[..., :6]) == pytest.approx(1.0, abs=0.12)


def test_overlays_begin_where_the_pieces_do(found: DiscoveryStudy) -> None:
    one = build_flight_views(found)[2]
    drawn = build_overlay(one)
    truth, before, after = drawn.lines
    away = [np.linalg.norm(line[:, :3] - truth[:, :3], axis=1) for line in (before, after)]
    assert np.nanmax(away[0]) > 3.0 * np.nanmax(away[1])
    flight = one.study_flight.flight
    first = flight.replay.cut.first[1]
    index = round(first / round(drawn.period / 0.04))
    assert away[0][index] < 0.02
    assert np.isnan(away[0][index - 1])  # nothing is drawn across
    assert drawn.begin == flight.replay.flight.time[0]


def test_white_noise_is_white_and_a_walk_is_not() -> None:
    rng = np.random.default_rng(3)
    noise = rng.standard_normal((40, 150, 3))
    lags, alike, band = autocorrelation([noise])
    assert lags[1] == pytest.approx(0.04)
    assert alike[0] == 1.0
    assert np.mean(np.abs(alike[1:]) < band) > 0.9
    frequency, power = residual_spectrum([noise])
    assert power.mean() == pytest.approx(1.0, abs=0.05)
    theirs = signal.periodogram(noise, 25.0, 'hann', axis=1, detrend=False)
    assert frequency == pytest.approx(theirs[0][1:])
    # One-sided and by hertz there; the windows differ by a sample at the end.
    assert power[5:-5] == pytest.approx(theirs[1].mean(axis=(0, 2))[6:-5] * 12.5, rel=0.1)
    walk = np.cumsum(noise, axis=1)
    assert autocorrelation([walk])[1][25] > 0.5


def test_gaps_are_left_out_of_the_autocorrelation() -> None:
    noise = np.random.default_rng(4).standard_normal((30, 150, 2))
    noise[:, 100:] = np.nan
    known = autocorrelation([noise[:, :100]], 1.0)
    assert autocorrelation([noise], 1.0)[1] == pytest.approx(known[1])
    assert autocorrelation([np.full((2, 150, 3), np.nan)])[1] == pytest.approx(np.zeros(51))
    assert len(residual_spectrum([noise])[0]) == 0


def test_pieces_share_a_column_by_their_mean_square() -> None:
    errors = np.full((3, 14), 3.0)
    errors[1] = 4.0
    errors[:, 5] = np.nan
    shared = average_pieces(errors, 2)
    assert shared.shape == (2, 14)
    assert shared[:, 0] == pytest.approx([math.sqrt(12.5), 3.0])
    assert np.isnan(shared[:, 5]).all()


def _with_effect(side: ReducedFlight, k: int, size: float) -> ReducedFlight:
    """Return what flights would say if one knob stood at a size, and nothing else were off."""
    products = side.products.copy()
    products[:-1, -1] = products[-1, :-1] = size * products[:-1, k]
    products[-1, -1] = size**2 * products[k, k]
    return ReducedFlight(products, side.constant)


def test_what_could_have_been_seen_is_what_naming_accepts(
    gtmab: Known, clean: FlightLinearizer
) -> None:
    """With a margin for chance: 1.645 of the deviation with which the flights tell the knob."""
    nominal, knobs = gtmab
    side = PieceReducer(
        clean.linearize(unchanged_vehicle_point(nominal, knobs, clean.replay.cut))
    ).eliminate_unknowns(1.3 * FLOOR)
    prior, names = build_prior(knobs), [knob.name for knob in knobs]
    both = ReducedFlight(2.0 * side.products, 0.0)
    for one in compute_detection_limits([side, side], prior, knobs):
        k = names.index(one.knob)

        def glance(flights: ReducedFlight, size: float, k: int = k) -> CandidateScore:
            told = scan_candidates(
                _with_effect(flights, k, size), np.zeros(len(prior.mean)), prior, knobs
            )
            return next(each for each in told if each.name == names[k])

        deviation = one.size / glance(both, one.size).sigma
        least = one.size - 1.645 * deviation
        if least < 0.05 * one.typical:
            continue  # what is smaller is not worth a name
        accepted = []
        for size in (0.98 * least, 1.02 * least):
            alone, together = glance(side, size).gain, glance(both, size).gain
            # The estimate may also be that of a tolerance 1.5 times as large, at odds of 1 to 2
            widths = np.sqrt(deviation**2 + np.array([0.0, 1.25 * prior.covariance[k, k]]))
            plain, wide = stats.norm.logpdf(size, scale=widths)
            accepted.append(
                CandidateTrial('', alone, alone, together - alone, 0.0, 0.0).is_accepted
                and together - max(wide - math.log(2.0) - plain, 0.0) > LARGER
            )
        assert accepted == [False, True], one


def test_numbers_are_written_as_people_read_them() -> None:
    assert format_number(1e-4) == '0.0001'
    assert format_number(-3.25) == '\N{MINUS SIGN}3.25'
    assert format_number(100.0, 2) == '100'
    assert format_quantity(0.0048, 'm') == '4.8 mm'
    assert format_quantity(0.193, 'm') == '19.3 cm'
    assert format_quantity(math.pi / 180.0, 'rad') == '1\N{DEGREE SIGN}'
    assert format_with_interval(0.02973, (0.0292, 0.0302)) == ('0.0297', '0.0292', '0.0302')
    assert format_odds(math.log(1000.0)) == 'odds of 10\N{SUPERSCRIPT THREE} to 1'
    assert format_parameter(DRAG) == 'linear drag (surge)'
    assert format_parameter('net_lift.force') == 'net lift'


def why(*numbers: float, beaten: bool = False) -> str:
    """Return what is said of a candidate without a name."""
    return explain_decision(SearchCandidate('a', *numbers, False), beaten)


def test_a_candidate_says_why_it_has_no_name() -> None:
    assert why(9.0, 1.0, 0.0, 0.0) == 'too little evidence'
    assert 'disagree' in why(9.0, 9.0, 9.0, 7.0)
    assert 'better' in why(9.0, 9.0, 9.0, 1.0, beaten=True)
    assert 'do not confirm' in why(20.0, 0.0, -9.0, 1.0)


def test_a_candidate_that_both_flights_confirm_is_not_said_to_fail_there() -> None:
    """It was, where a force without a name took its place."""
    for confirm, carried in ((8.0, -11.0), (-2.0, 2.0)):
        said = why(40.0, confirm, carried, 1.0)
        assert said == 'an unexplained force explains the flights better'


def test_a_name_that_all_flights_together_do_not_keep_is_given_up(
    found: DiscoveryStudy, tmp_path: Path
) -> None:
    """The round said that it is named, beside a headline that nothing is missing."""
    rung = SearchCandidate('net_lift.force', 12.0, 7.0, 7.0, 0.3, True)
    text, _ = _read(_with(found, verdict='none', effects=(), ladder=((rung,),)), tmp_path)
    assert 'Round 1: net lift is named, but dropped at the end' in text
    assert 'all flights together do not support it' in text


def test_an_effect_with_an_equal_rival_is_told_as_either(found: DiscoveryStudy) -> None:
    """And the gain is that of the name whose value it is."""
    said = format_headline(found.finding)
    assert said.startswith(
        'Linear drag (surge) or quadratic drag (surge) is missing from the model: '
    )
    assert 'the position error' in said
    assert said.endswith('with linear drag (surge).')
    assert 'alternatives' in build_tiles(found.finding)[1].note


def test_no_gain_is_told_where_the_file_should_be_kept(found: DiscoveryStudy) -> None:
    worse = replace(found.finding.gaps[3], shrink=-0.1, shrink_ci95=(-0.3, -0.05))
    kept = replace(found.finding, gaps=(*found.finding.gaps[:3], worse, *found.finding.gaps[4:]))
    assert 'falls from' not in format_headline(kept)
    better = replace(found.finding.gaps[3], tuned=0.01, after=0.0111)
    assert 'falls from' not in format_headline(replace(found.finding, gaps=(better,)))


def test_what_the_file_lacks_has_no_value_before() -> None:
    """A factor that the file does not have was told as 1 before."""
    lacking = ParameterEstimate('factor', '1', 1.0, 1.2, (1.1, 1.3), in_file=False)
    assert format_file_value(lacking) == 'not in the vehicle file'
    assert format_file_value(lacking._replace(in_file=True)) == 'vehicle file: 1'


def test_a_file_that_tolerances_make_much_better_is_said_to_be(found: DiscoveryStudy) -> None:
    gap = replace(found.finding.gaps[3], before=0.28, tuned=0.016, after=0.016)
    said = format_headline(replace(found.finding, verdict='none', effects=(), gaps=(gap,)))
    assert said.endswith('reduces the position error after 5 s from 28 cm to 1.6 cm.')
    gap = replace(gap, coast=0.01)
    said = format_headline(
        replace(found.finding, verdict='not_identifiable', effects=(), gaps=(gap,))
    )
    assert 'ignores the commands is better' in said


def test_an_effect_that_predicts_no_better_than_tolerances_is_said_to(
    found: DiscoveryStudy,
) -> None:
    gap = replace(found.finding.gaps[3], tuned=0.015, after=0.015)
    said = format_headline(replace(found.finding, gaps=(gap,)))
    assert 'may be missing from the model, but no forecast shows it. Fitting the' in said
    assert 'tolerances reduces the position error after 5 s' in said


def test_the_errors_of_a_refitted_file_have_a_column_of_their_own(found: DiscoveryStudy) -> None:
    gap = next(one for one in found.finding.gaps if one.channel == 'position')
    without = render_pose_errors(replace(found.finding, gaps=(gap,)))
    assert 'refitted' not in without.lower()
    table = render_pose_errors(replace(found.finding, gaps=(replace(gap, refitted=0.0777),)))
    heads = re.findall(r'<th scope="col">(.*?)</th>', table)
    cells = re.findall(r'<td>(.*?)</td>', table)
    assert [one for one in heads if one in ('after', 'refitted', 'coast')] == [
        'after', 'refitted', 'coast',
    ]  # fmt: skip
    # The horizon is the head of the row
    assert cells[heads.index('refitted') - 1] == '7.77 cm'
    assert table.count('class="dot refitted"') == 1
    assert 'as in refitted.yaml' in table


def test_the_headline_says_what_is_missing_and_how_much_better(found: DiscoveryStudy) -> None:
    alone = replace(found.finding.effects[0], confusable_with=())
    said = format_headline(replace(found.finding, effects=(alone,)))
    gap = found.finding.gaps[3]
    start = 'Linear drag (surge) is missing from the model: the position error after 5 s'
    assert said.startswith(start)
    assert said.endswith(f'to {format_quantity(gap.after, "m", 2)} with it.')
    # What fitting alone gains is not the effect's
    half = replace(gap, before=0.27, tuned=0.028, after=0.013)
    said = format_headline(replace(found.finding, effects=(alone,), gaps=(half,)))
    assert said.endswith(
        'falls from 27 cm to 2.8 cm by fitting the vehicle file within its tolerances, and to '
        '1.3 cm with it.'
    )
    two = replace(
        found.finding.effects[0], name='net_lift', knobs=('net_lift.force',),
        parameters=(ParameterEstimate('force', 'N', 0.0, -0.008, (-0.009, -0.007)),),
    )  # fmt: skip
    two = replace(two, confusable_with=())
    both = replace(found.finding, effects=(alone, two), gaps=())
    assert format_headline(both) == (
        'Linear drag (surge) and net lift may be missing from the model, but no forecast shows '
        'them.'
    )


def test_the_vehicle_file_holds_effects_and_law(found: DiscoveryStudy, tmp_path: Path) -> None:
    """It loads with both, and no further law is sought for it."""
    factors = [LawFactor(quantity='speed'), LawFactor(quantity='r')]
    term = LawTerm(
        axis='pitch', coefficient=-0.00031, unit='N s2', factors=factors,
        interval=[-0.00034, -0.00028], evidence=41.0,
    )  # fmt: skip
    law = Law(source='two flights', terms=[term], region={'speed': [0.0, 0.6], 'r': [-1.0, 1.0]})
    errors = tuple(one for one in found.finding.gaps if one.horizon_s == FAR)
    vehicle, text = load_vehicle('gtmab'), find_file('vehicle', 'gtmab').read_text('utf-8')
    knobs = found.flights[0].flight.knobs
    moved = {'linear_drag.surge': 0.01, 'vehicle.mass': 0.01, 'vehicle.yaw': -0.05,
             'rotor_2.thrust': 0.03, 'cg_height.z': 0.002}  # fmt: skip
    values = np.array([moved.get(knob.name, 0.0) for knob in knobs])
    file = write_tolerance_file(BaseFile(text, vehicle), found, values)
    given = _with(
        found, verdict='named+unexplained',
        law=LawFinding(law, '', errors, file=add_law_block(file.text, law)),
    )  # fmt: skip
    request = DiscoveryRequest('gtmab', {role: [Path(role)] for role in ('train', 'confirm')})
    write_results(request, vehicle, given, UsableFlights((), (), ()), tmp_path, tmp_path)
    written = load_vehicle(str(tmp_path / 'vehicle.yaml'))
    assert written.file.law == law
    nominal = NominalVehicle.from_vehicle(written)
    fitted = apply_parameters(found.nominal, knobs, values)[0]
    assert nominal.mass == pytest.approx(1.01005 * found.nominal.mass, rel=1e-5)
    for name in ('linear_drag.surge', 'cg_height.z'):
        known = name.split('.')
        assert nominal.parameter_value(*known) == pytest.approx(fitted.parameter_value(*known))
    # The thrust of a rotor is in its curve or its column: what counts is the forecast
    flight = found.flights[0].flight
    paths = [
        flight.simulate_forecast(
            LinearizationPoint(each, np.zeros(len(values)), zero_unknowns(flight.replay.cut))
        )[:, 150, :3]
        for each in (file.nominal, fitted, found.nominal)
    ]
    assert np.abs(paths[0] - paths[1]).max() < 1e-6 < np.abs(paths[0] - paths[2]).max()
    source = written.file.measured.mass.source if written.file.measured else ''
    assert 'fitted together with the law by lta discover' in source
    aero = written.file.aero.linear_drag
    named = aero.force.source if aero is not None and aero.force is not None else ''
    assert named.startswith('surge ')
    assert 'lta discover from' in named
    assert 'together with the law' not in named
    again = replace(_with(given, law=None), nominal=nominal)
    refused = add_law(again, BaseFile(text, vehicle), lambda _what, _part: None).finding.law
    assert refused is not None
    assert 'has a law already' in refused.reason


def test_a_map_of_many_flights_labels_some_of_them():
    figure = create_figure(2)
    begun = [np.arange(7.0)] * 28
    _label_flights(figure, [f'{k}' for k in range(28)], begun)
    assert [one.text for one in figure.layout.annotations] == [f'{k}' for k in range(0, 28, 4)]
    assert not figure.layout.xaxis2.ticktext
