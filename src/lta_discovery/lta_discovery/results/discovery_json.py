"""Write the result of a study as discovery.json."""

from collections.abc import Sequence
from typing import Any, Final

from lta_discovery.calibration.report import encode_calibration
from lta_discovery.conclusion import draw_conclusion
from lta_discovery.finding import ChannelErrors, NamedEffect, SCHEMA, StudyResult
from lta_discovery.flights.noisy_intervals import ExcludedInterval
from lta_discovery.page.law_section import list_law_sentences
from lta_discovery.page.verdict_text import format_advice, format_details, format_headline
from lta_report.json_value import to_json_value

NAME: Final = 'discovery.json'
WHAT: Final = 'position'  # channel of the overall prediction error
ERRORS: Final = (
    'before', 'tuned', 'after', 'coast', 'noise_floor', 'refitted', 'shrink', 'shrink_ci95',
    'added_ci95',
)  # fmt: skip


def to_dict(finding: StudyResult, cuts: Sequence[ExcludedInterval] = ()) -> dict[str, Any]:
    """Return a finding as JSON: SI units, None for numbers that are not finite."""
    content: dict[str, Any] = {
        'schema': SCHEMA,
        'verdict': draw_conclusion(finding).verdict,
        'conclusion': _encode_conclusion(finding),
        'vehicle': finding.vehicle,
        'effects': [_encode_effect(effect) for effect in finding.effects],
        'where': [place._asdict() for place in finding.where],
        'gap': select_overall_error(finding),
        'gaps': [_encode_channel_errors(each) for each in finding.gaps],
        'training': [_encode_channel_errors(each) for each in finding.training],
        'remains': [remainder._asdict() for remainder in finding.remains],
        'unexplained': list(finding.unexplained),
        'law': _encode_law(finding),
        'draught': _encode_draught(finding),
        'detectable': [each._asdict() for each in finding.detectable],
        'information': [
            {'knob': one.knob, 'remaining': one.remaining,
             'flights': {each.flight: each.share for each in one.flights}}
            for one in finding.information
        ],
        'ladder': [[rung._asdict() for rung in stage] for stage in finding.ladder],
        'warnings': list(finding.warnings),
        'next_flight': finding.next_flight,
        'left_out': [
            {'flight': cut.flight, 'channel': cut.channel, 'from_s': cut.from_s, 'to_s': cut.to_s,
             'reason': cut.reason}
            for cut in cuts
        ],
        'bags': {role: list(names) for role, names in finding.bags.items()},
        'carried': _encode_forecast_evidence(finding),
        'calibration': None
        if finding.calibration is None
        else encode_calibration(finding.calibration),
        'seed': finding.seed,
        'versions': dict(finding.versions),
    }  # fmt: skip
    plain: dict[str, Any] = to_json_value(content)
    return plain


def _encode_conclusion(finding: StudyResult) -> dict[str, Any]:
    """Return the conclusion and the advice."""
    conclusion = draw_conclusion(finding)
    return {
        'headline': format_headline(finding),
        'details': format_details(finding),
        'asserted': conclusion.asserted,
        'advice': conclusion.advice,
        'do': format_advice(finding),
        'gain': None if conclusion.gain is None else _encode_channel_errors(conclusion.gain),
        'refitted': None
        if conclusion.refitted is None
        else _encode_channel_errors(conclusion.refitted),
    }


def _encode_effect(effect: NamedEffect) -> dict[str, Any]:
    return {
        'name': effect.name,
        'parameters': {
            one.name: {
                'value': one.value,
                'unit': one.unit,
                'ci95': list(one.ci95),
                'before': one.before if one.in_file else None,
            }
            for one in effect.parameters
        },
        'log_evidence': effect.log_evidence,
        'confusable_with': list(effect.confusable_with),
        'assumed': {one.name: {'value': one.value, 'unit': one.unit} for one in effect.assumed},
        'knobs': list(effect.knobs),
    }


def _encode_draught(finding: StudyResult) -> dict[str, float] | None:
    """Return the draught; None if none was detected."""
    draught = finding.draught
    return None if draught is None else {'force': draught.force, 'speed': draught.speed}


def _encode_law(finding: StudyResult) -> dict[str, Any] | None:
    """Return the law, or why there is none; None if none was sought."""
    search = finding.law
    if search is None:
        return None
    law = search.law.model_dump(exclude_defaults=True) if search.law else None
    return {
        'proposed': search.law is not None,
        'words': list_law_sentences(finding),
        'reason': search.reason,
        'law': law,
        'errors': [_encode_channel_errors(one) for one in search.errors],
        'near': list(search.near),
        'tolerances': [one._asdict() for one in search.tolerances],
    }


def _encode_forecast_evidence(finding: StudyResult) -> dict[str, Any] | None:
    """Return the forecast evidence; None where the sensor readings identified the effects."""
    evidence = finding.carried
    if evidence is None:
        return None
    return {
        'names': [one._asdict() for one in evidence.names],
        'regimes': [one._asdict() for one in evidence.regimes],
        'interpolates': list(evidence.interpolates),
        'numbers_refitted': evidence.numbers,
        'rejected': list(evidence.rejected),
        'kinds': [one._asdict() for one in evidence.kinds],
    }


def _encode_channel_errors(one: ChannelErrors) -> dict[str, Any]:
    """Return the errors of one channel at one horizon."""
    figures = {key: getattr(one, key) for key in ERRORS}
    start = {'channel': one.channel, 'unit': one.unit, 'horizon_s': one.horizon_s}
    return {**start, **figures, 'pieces': one.pieces}


def common_horizon(gaps: Sequence[ChannelErrors]) -> float | None:
    """Return the longest horizon that most channels share, preferring the position's. [s]"""
    mine = {one.horizon_s for one in gaps if one.channel == WHAT} or {
        one.horizon_s for one in gaps
    }
    count = {at: sum(one.horizon_s == at for one in gaps) for at in mine}
    if not count:
        return None
    # The longest of the horizons with the most channels
    return max(at for at, number in count.items() if number == max(count.values()))


def select_overall_error(finding: StudyResult) -> dict[str, Any]:
    """Return the overall error: of the position, at the longest common horizon."""
    at = common_horizon(finding.gaps)
    here = {one.channel: one for one in finding.gaps if one.horizon_s == at}
    first = here.get(WHAT) or next(iter(here.values()), None)
    whole: dict[str, Any] = dict.fromkeys(ERRORS)
    if first is not None:
        whole = {key: getattr(first, key) for key in ERRORS}
    return {
        'horizon_s': at,
        'unit': first.unit if first else None,
        **whole,
        'per_channel': {name: _encode_channel_errors(one) for name, one in here.items()},
        'held_out': finding.held_out,
    }
