"""Format a challenge score for the terminal and as a Markdown page."""

from collections.abc import Iterable, Mapping, Sequence
import math
from typing import Any, Final

from lta_challenge.case_score import ScoredCase
from lta_challenge.other.unlisted import UNLISTED
from lta_challenge.outside import OUTSIDE
from lta_challenge.rows import KINDS, ROWS
from lta_challenge.score_statistics import (
    compute_score_figures,
    count_outcomes,
    finite_median,
    median_errors,
    ScoreFigure,
    ShareEstimate,
    shares_by_strength,
)

DASH: Final = '\N{EN DASH}'
METHOD: Final = """\
A case is a GT-MAB that deviates from its file within vehicle tolerances (thrust 3 %, each rotor
2 %, drag, added mass 5 %, inertia 4 %, mass 1 %, centre of gravity 3 mm, rotor toe 0.5 degrees,
rotor lag 6 ms, delay 5 ms; and in each flight lift 0.6 mN and the sensor biases). It has three
flights (train, confirm, holdout: laps, climbs, steps, random waypoints, with pilot excitation)
and hidden effects. The tracker loses the vehicle at times, reports outliers, and has its own
clock. Cases with the same seed, row and number share vehicle, courses and hidden effects, as
far as their kinds allow.

The flights share only the equations of the effects with the model under test. Rigid body
(rotation matrix and momenta in map axes), integrator (Dormand and Prince), weight, rotors and
their toe, command path, pilot, battery, sensors and noise are implemented separately
(`lta_challenge/truth_*.py`, `truth_sensors.py`). Without noise and tolerances, simulator and
model agree to 1e-4 with each effect (4e-3 with a toed rotor, which the model rotates to first
order only) (`test/unit/challenge/test_truth.py`). Flights of the row `other` share no equation:
`lta_challenge/other/` is a separate simulator with its own kinds outside the library, which
count as late kinds.

*Sigma* of a hidden effect is its size divided by its standard deviation, when all parameters
are fitted to the flights of the case with the true structure; the vehicle's tolerance of the
same parameter is included. Sizes are drawn from a forecast of sigma and counted by the achieved
sigma. *Exact*: all hidden effects were named and nothing else; names that such data cannot
distinguish count as one ([classes](discovery_classes.md)). *Outside* kinds are sized by the
force that they leave unexplained, 4 to 40 times the noise floor. Every second of these cases
has a *late kind*: its author had not seen how discovery works, and it was not used before
discovery was finished (`drying` has been examined since). The *oracle* knows the hidden
structure, not its size."""


def format_share(share: ShareEstimate) -> str:
    """Return a share with its interval."""
    if not share.of:
        return DASH
    ends = f'{100 * share.low:.0f} to {100 * share.high:.0f}'
    return f'{share.hits}/{share.of} = {100 * share.value:.0f} % ({ends})'


def format_target(figure: ScoreFigure) -> str:
    """Return the target range of a figure."""
    parts = []
    if not math.isnan(figure.least):
        parts.append(f'>= {100 * figure.least:.0f} %')
    if not math.isnan(figure.most):
        parts.append(f'<= {100 * figure.most:.0f} %')
    return ', '.join(parts)


def format_score_figures(cases: Sequence[ScoredCase]) -> list[list[str]]:
    """Return a row for each figure: name, share, target, and whether it is met."""
    return [
        [f.name, format_share(f.share), format_target(f), f.target_met]
        for f in compute_score_figures(cases)
    ]


def format_outcome_table(cases: Sequence[ScoredCase]) -> tuple[list[str], list[list[str]]]:
    """Return header and rows of the outcomes by kind."""
    found = count_outcomes(cases)
    columns = sorted({column for cells in found.values() for column in cells})
    lines = [
        [kind, *(str(found[kind].get(column, 0)) for column in columns)]
        for kind in KINDS
        if kind in found
    ]
    return ['hidden', *columns], lines


def format_strength_bands(cases: Sequence[ScoredCase]) -> list[list[str]]:
    """Return a line for each band of strength."""
    return [
        [
            f'{band.low:g} to {band.high:g}' if math.isfinite(band.high) else f'over {band.low:g}',
            *map(format_share, (band.exact, band.wrong, band.silent)),
        ]
        for band in shares_by_strength(cases)
    ]


OUTSIDE_HEADS: Final = (
    'kind', 'description', 'written', 'cases', 'unexplained force', 'an effect named',
)  # fmt: skip


def format_outside_kinds(cases: Sequence[ScoredCase]) -> list[list[str]]:
    """Return a line for each kind outside the library."""
    out = []
    kinds = {name: (kind.about, kind.late) for name, kind in OUTSIDE.items()}
    # The kinds of the independent simulator count as late
    kinds |= {name: (kind.about, True) for name, kind in UNLISTED.items()}
    for name, (about, late) in kinds.items():
        own = [one for one in cases if one.outside == name and one.kind == 'outside']
        if own:
            flagged = sum(one.flagged for one in own)
            wrong = sum(bool(one.wrong) for one in own)
            written = 'late' if late else 'early'
            counts = map(str, (len(own), flagged, wrong))
            out.append([name, about, written, *counts])
    return out


# Labels of the median errors, by key
MODELS: Final = {
    'coast': 'constant velocity',
    'before': 'vehicle file',
    'tuned': 'vehicle file with fitted tolerances',
    'after': 'model that discovery found',
    'oracle': 'oracle',
    'noise': 'measurement noise',
}


def format_median_errors(cases: Sequence[ScoredCase]) -> str:
    """Return the median position errors, from the vehicle file to the oracle."""
    # A median without cases is NaN
    known = {name: value for name, value in median_errors(cases).items() if math.isfinite(value)}
    steps = ', '.join(f'{MODELS[name]} {1e3 * value:.1f}' for name, value in known.items())
    return f'Median position error after 3 s on held-out flights [mm]: {steps or DASH}.'


def format_error_and_time(cases: Sequence[ScoredCase]) -> str:
    """Return the median parameter error and computing time."""
    error = finite_median(each.error for one in cases for each in one.intervals)
    seconds = finite_median(one.seconds for one in cases)
    off = DASH if math.isnan(error) else f'{100 * error:.0f} % of the hidden change'
    return f'Median parameter error: {off}; median processor time per case: {seconds:.1f} s.'


def format_wrong_cases(cases: Sequence[ScoredCase]) -> list[list[str]]:
    """Return each case with a wrong name."""
    return [
        [
            str(one.number), one.row, one.kind,
            ', '.join(f'{k} ({one.sigma.get(k, math.nan):.1f})' for k in one.hidden)
            or one.outside or 'nothing',
            ', '.join(one.named),
        ]
        for one in cases
        if one.wrong
    ]  # fmt: skip


def format_table(heads: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    rows = [list(heads), ['---'] * len(heads), *map(list, lines)]
    return '\n'.join(f'| {" | ".join(cells)} |' for cells in rows)


def render_markdown(scores: Sequence[tuple[dict[str, Any], Sequence[ScoredCase]]]) -> str:
    """
    Return the Markdown page of several challenges.

    Parameters
    ----------
    scores : sequence of (about, cases)
        One pair for each challenge.

    """
    first = scores[0][0]
    parts = [
        '# Scores of discovery on hidden effects',
        'Generated by `lta challenge score ... --markdown docs/discovery_scores.md`, which '
        'overwrites edits. Only the paragraph `**Stale:** ...` below the heading is written by '
        'hand: it lists changes since the scores were computed. '
        'For the hidden effects, see `lta challenge --help`.',
        f'Scored: effects `{first["registry"]}`, vehicle `{first["vehicle"]}` '
        f'`{first["vehicle_digest"]}`, commit {_format_commits(about for about, _ in scores)}.',
        METHOD,
    ]
    by_row: dict[str, list[ScoredCase]] = {}
    seeds: dict[str, list[str]] = {}
    for about, cases in scores:
        by_row.setdefault(about['row'], []).extend(cases)
        length = ' to '.join(f'{each:.0f}' for each in about['seconds'])
        name = (
            f'{about["scored"]} {about["kind"] or "of all kinds"} '
            f'(seed {about["seed"]}, flights of {length} s)'
        )
        seeds.setdefault(about['row'], []).append(name)
    # In the order of `ROWS`, whatever the order of the folders
    rows = {name: by_row[name] for name in ROWS if name in by_row}
    if len(rows) > 1:
        parts += ['## All rows', _format_overview(rows)]
    for name, cases in rows.items():
        parts += _format_challenge_row(name, cases, seeds[name])
    return '\n\n'.join(parts) + '\n'


def _format_commits(abouts: Iterable[dict[str, Any]]) -> str:
    """Return the commits at which the cases were analysed."""
    # A resumed score may have several commits, joined by commas
    known = {one: None for about in abouts for one in about['commit'].split(', ')}
    return ', '.join(f'`{one}`' for one in known)


def _format_overview(rows: Mapping[str, Sequence[ScoredCase]]) -> str:
    """Return a table of the figures by row, without their intervals."""
    found = [compute_score_figures(cases) for cases in rows.values()]
    lines = [
        [each[0].name, format_target(each[0]), *(_format_brief_share(one.share) for one in each)]
        for each in zip(*found, strict=True)
    ]
    cases = ['cases', '', *(str(len(cases)) for cases in rows.values())]
    return format_table(['figure', 'target', *rows], [cases, *lines])


def _format_brief_share(share: ShareEstimate) -> str:
    """Return a share without its interval."""
    return f'{share.hits}/{share.of} = {100 * share.value:.0f} %' if share.of else DASH


def _format_challenge_row(
    name: str, cases: Sequence[ScoredCase], seeds: Sequence[str]
) -> list[str]:
    """Return the Markdown blocks of one row."""
    heads, lines = format_outcome_table(cases)
    bands = ['sigma', 'exact', 'wrong', 'silent']
    parts = [
        f'## {name.capitalize()}: {ROWS[name].about}',
        f'{len(cases)} cases: {", ".join(seeds)}.',
        format_table(
            ['figure', 'share (95 %, Wilson)', 'target', 'met'], format_score_figures(cases)
        ),
        format_table(heads, lines),
        format_table(bands, format_strength_bands(cases)),
        f'{format_median_errors(cases)} {format_error_and_time(cases)}',
    ]
    if found := format_outside_kinds(cases):
        parts.append(format_table(OUTSIDE_HEADS, found))
    if found := format_wrong_cases(cases):
        parts.append(format_table(['case', 'row', 'kind', 'hidden (sigma)', 'named'], found))
    return parts
