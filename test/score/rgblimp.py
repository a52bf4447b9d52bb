"""
Score forecasts of RGBlimp's real flights by inputs that were left out: `make rgblimp`.

Writes the tables of docs/discovery_flights.md between its marks. Minutes of one core.
"""

from collections.abc import Sequence
from pathlib import Path
import sys
import time
from typing import Final, final, NamedTuple

from lta_discovery.forecast.forecast_fit import ForecastFit, ForecastFitter
from lta_discovery.model.nominal import NominalVehicle
from lta_discovery.model.parameters import list_free_parameters
from lta_discovery.transfer.candidate_groups import (
    list_candidate_groups,
    list_knobs,
    prior_deviations,
)
from lta_discovery.transfer.cross_validation import (
    cross_validate,
    format_interpolation_warning,
    RegimeForecastErrors,
)
from lta_discovery.transfer.forward_selection import GroupSelection, select_forward
from lta_discovery.transfer.other_kind import (
    CHANNELS,
    judge_by_kind,
    KindJudgement,
    OUTER,
    select_pieces,
    split_by_kind,
    TURN,
)
from lta_model.vehicle import load_vehicle
import numpy as np
from numpy.typing import NDArray
from rgblimp_flights import begun, DATA, Flight, flights, regimes, REPEATS
from rgblimp_forecast import by_coasting, by_model, by_repeats, LIFT, Row, row, SHOWN
from rgblimp_naming import every, LOOSELY, places, within

Array = NDArray[np.float64]
FOLDS: Final = 5
PAGE: Final = Path(__file__).resolve().parents[2] / 'docs' / 'discovery_flights.md'
TUNE, NAMED, ALL = (
    'tolerances tuned',
    'named effects',
    'plus everything else',
)
EVEN: Final = 1.7  # how much more a place counts than an attitude, where all is fitted
ROUNDS: Final = 20  # of the fit of everything
NAMING: Final = 6  # of the fit of named effects
AGAIN: Final = 2  # of each fold's, beside those that leave out its inputs
INERTIA: Final = ('added inertia', 'tracker misalignment')  # few parameters, to compare with
BEGIN, END = '<!-- rgblimp: begin -->', '<!-- rgblimp: end -->'
TUNED: Final = (
    'vehicle.mass', 'vehicle.roll', 'vehicle.pitch', 'vehicle.yaw', 'rotor_1.thrust',
    'rotor_2.thrust', 'hull_lift.all', 'cg_offset.x', 'cg_offset.y', 'cg_height.z',
)  # fmt: skip


def said(text: str) -> None:
    """Print progress."""
    sys.stderr.write(f'{time.process_time():6.0f} s  {text}\n')


def folds(count: int) -> list[list[int]]:
    """Return the flights of each fold: every fifth input."""
    return [[f for f in range(count) if (f // REPEATS) % FOLDS == k] for k in range(FOLDS)]


def named(
    taught: ForecastFitter, parts: dict[str, list[int]]
) -> tuple[list[GroupSelection], list[str]]:
    """
    Return what the first two repeats of each input name, what the others do, and both.

    Names that were given to the command, with commas between, are taken as they are.
    """
    whole = range(len(taught.flights))
    if given := ' '.join(sys.argv[1:]):
        return [], [name.strip() for name in given.split(',')]
    halves = [
        [f for f in whole if (f % REPEATS < REPEATS // 2) == first] for first in (True, False)
    ]
    found = []
    for half in halves:
        found.append(select_forward(taught, half, parts))
        said(f'named: {", ".join(found[-1].names)}')
    return found, [name for name in found[0].names if name in found[1].names]


def judged_by_kind(
    nominal: NominalVehicle, taught: ForecastFitter, names: Sequence[str]
) -> KindJudgement:
    """Return which names make no forecast in flight of another kind worse."""
    groups = [group for group in list_candidate_groups(taught.knobs) if group.name in names]
    which = list_knobs(groups)
    whole = taught.fit(
        which, prior_deviations(taught.knobs, which), range(len(taught.flights)), rounds=NAMING
    )
    splits = split_by_kind(nominal, taught.flights, LIFT)
    out = judge_by_kind(taught, groups, whole.values, splits)
    said(f'rejected in flight of another kind: {[one.name for one in out.rejected]}')
    return out


def kinds(judged: KindJudgement) -> list[str]:
    """Return what names do to flight of another kind, as Markdown."""
    out = [
        '| pieces left out | position: error ratio | attitude: error ratio |',
        '|---|---|---|',
        *(f'| {o.name} | {o.position:.2f} | {o.attitude:.2f} |' for o in judged.kinds),
    ]
    return [*out, *(line for one in judged.rejected for line in ('', f'{one.sentence}.'))]


@final
class Fit(NamedTuple):
    """Knobs, how far they may be off, and what was fitted to all flights by which forecasts."""

    taught: ForecastFitter
    which: list[int]
    spread: Array
    whole: ForecastFit


def scored(known: list[Flight], sight: ForecastFitter, fits: dict[str, Fit]) -> list[Row]:
    """Return the rows of the table; a fit to all flights never scores itself."""
    count = len(known)
    errors: dict[str, dict[int, Array]] = {name: {} for name in (*fits, 'authors')}
    for test in folds(count):
        train = [f for f in range(count) if f not in set(test)]
        errors['authors'] |= by_model(sight, np.zeros(len(sight.knobs)), test, known)
        for name, (taught, which, spread, whole) in fits.items():
            values = taught.leave_out_flights(whole, which, spread, test)
            if name != TUNE:
                values = taught.fit(which, spread, train, values, AGAIN, relinearize=False).values
            errors[name] |= by_model(sight, values, test, known)
        said('a fold')
    times = [begun(flight) for flight in known]
    sets = {
        'coast: constant body velocity and rates': (0, [by_coasting(f) for f in known]),
        "authors' first-principles model": (0, _listed(errors['authors'])),
        **{name: (len(fit.which), _listed(errors[name])) for name, fit in fits.items()},
        'other repeats (noise floor)': ('-', [by_repeats(known, f) for f in range(count)]),
    }
    return [row(name, str(n), lefts, times) for name, (n, lefts) in sets.items()]


def _listed(errors: dict[int, Array]) -> list[Array]:
    """Return errors in the order of the flights."""
    return [errors[f] for f in sorted(errors)]


def table(rows: Sequence[Row], which: str) -> list[str]:
    """Return a table of some pieces as Markdown."""
    out = [
        '| model | parameters | position 3 / 5 s [m] | ratio | attitude 3 / 5 s [deg] | ratio |'
        ' medians [m], [deg] |',
        '|---|---|---|---|---|---|---|',
    ]
    base = next(getattr(each, which)[0] for each in rows if each.name.startswith('authors'))
    for each in rows:
        mean, median = getattr(each, which)
        ratio = mean / base
        turn, middle = np.degrees(mean[2:]), np.degrees(median[2:])
        out.append(
            f'| {each.name} | {each.parameters} | {mean[0]:.3f} / {mean[1]:.3f} | '
            f'{ratio[0]:.2f} / {ratio[1]:.2f} | {turn[0]:.1f} / {turn[1]:.1f} | '
            f'{ratio[2]:.2f} / {ratio[3]:.2f} | {median[0]:.3f} / {median[1]:.3f}, '
            f'{middle[0]:.1f} / {middle[1]:.1f} |'
        )
    return out


def carried(
    found: list[GroupSelection], kept: list[str], known: list[Flight], fits: dict[str, Fit]
) -> list[str]:
    """Return what names do to regimes that were left out, as Markdown."""
    parts = regimes(known)
    out = [f'Named: {", ".join(kept)}.']
    out += ['', '| name | by repeats 1, 2 | by repeats 3, 4 |', '|---|---|---|'] if found else []
    for name in [group.name for group in list_candidate_groups(fits[NAMED].taught.knobs)]:
        worths = [
            f'{100 * dict(zip(each.names, each.worth, strict=True))[name]:.0f} %'
            if name in each.names
            else '-'
            for each in found
        ]
        if any(worth != '-' for worth in worths):
            out.append(f'| {name} | {worths[0]} | {worths[1]} |')
    taught, which, _, whole = fits[NAMED]
    out += ['', *_values(taught, which, whole.values, np.linalg.inv(whole.precision))]
    told = {
        name: cross_validate(fit.taught, fit.whole, fit.which, fit.spread, parts, is_quick=False)
        for name, fit in fits.items()
        if name in (NAMED, ALL)
    }
    ratios = {one.name: one.ratio for one in told[ALL]}
    out += [
        '',
        '| regime left out | flights | error ratio: named | everything |',
        '|---|---|---|---|',
    ]
    out += [
        f'| {o.name} | {o.flights} | {o.ratio:.2f} | {ratios[o.name]:.2f} |' for o in told[NAMED]
    ]
    out += ['', _sentence(kept, told[NAMED], 'Named')]
    return [*out, '', _sentence(['Everything'], told[ALL], 'Everything')]


def _values(
    taught: ForecastFitter, which: Sequence[int], values: Array, covariance: Array
) -> list[str]:
    """Return the values of what was named."""
    out = [
        '| parameter | unit | change from the vehicle file | standard deviation |',
        '|---|---|---|---|',
    ]
    for k, deviation in zip(which, np.sqrt(np.diag(covariance)), strict=True):
        knob = taught.knobs[k]
        out.append(f'| {knob.name} | {knob.unit} | {values[k]:.4g} | {deviation:.1g} |')
    return out


def _sentence(names: Sequence[str], found: Sequence[RegimeForecastErrors], what: str) -> str:
    """Return the warning, or that none is due."""
    better = sum(one.ratio < 1.0 for one in found)
    fine = f"{what}: better than the authors' model in {better} of {len(found)} regimes left out."
    return format_interpolation_warning(names, found) or fine


def extrapolated(
    nominal: NominalVehicle,
    known: list[Flight],
    sight: ForecastFitter,
    models: Sequence[Sequence[str]],
) -> list[str]:
    """
    Return errors near straight flight after a fit to tight turns alone, as Markdown.

    The fit uses the pieces that turn faster than their median, without the first of each flight.
    """
    turns = [np.abs(flight.taught.replay.cut.start[:, TURN]) for flight in known]
    middle = np.median(np.concatenate(turns))
    tight = [(turn > middle) & (np.arange(len(turn)) > 0) for turn in turns]
    pairs = zip(known, tight, strict=True)
    some = [select_pieces(flight.taught, which) for flight, which in pairs if which.any()]
    taught = ForecastFitter(nominal, some, LIFT)
    slowly = [np.abs(flight.scored.replay.cut.start[:, TURN]) for flight in known]
    least = np.quantile(np.concatenate(slowly), OUTER)
    chosen = {
        f'turns below {least:.2g} rad/s': [turn < least for turn in slowly],
        'first of each flight': [np.arange(len(turn)) < 1 for turn in slowly],
    }
    zero = np.zeros(len(sight.knobs))
    before = by_model(sight, zero, range(len(known)), known)
    out = [
        f'| fit to turns above {middle:.2g} rad/s | pieces | position 3 / 5 s: error ratio |'
        ' attitude 3 / 5 s: error ratio |',
        '|---|---|---|---|',
    ]
    for names in models:
        groups = [one for one in list_candidate_groups(sight.knobs) if one.name in names]
        which = list_knobs(groups)
        spread = prior_deviations(sight.knobs, which)
        fit = taught.fit(which, spread, range(len(some)), rounds=NAMING, relinearize=False)
        after = by_model(sight, fit.values, range(len(known)), known)
        for pieces, masks in chosen.items():
            ratio = _channel_errors(after, masks) / _channel_errors(before, masks)
            cells = ' | '.join(f'{near:.2f} / {far:.2f}' for near, far in ratio)
            out.append(f'| {", ".join(names)} | {pieces} | {cells} |')
    return out


def _channel_errors(errors: dict[int, Array], masks: Sequence[NDArray[np.bool_]]) -> Array:
    """Return the RMS of position and attitude of some pieces at 3 and 5 s, shape (2, 2)."""
    left = np.concatenate([errors[f][mask] for f, mask in enumerate(masks)])[:, list(SHOWN)]
    squared = [np.sum(left[..., part] ** 2, axis=-1) for part in CHANNELS.values()]
    rms: Array = np.sqrt(np.nanmean(squared, axis=1))
    return rms


def fitted(
    nominal: NominalVehicle, known: list[Flight], taught: ForecastFitter, kept: list[str]
) -> dict[str, Fit]:
    """Return what is fitted to all flights, each from where the one before it ended."""
    even = ForecastFitter(nominal, [flight.taught for flight in known], LIFT, EVEN)
    turned = taught.knobs
    names = list_candidate_groups(turned)
    tuned, whole_of = places(turned, TUNED), every(turned, names)
    called = list_knobs([group for group in names if group.name in kept])
    out: dict[str, Fit] = {}
    begin = np.zeros(len(turned))
    for name, by, which, spread, rounds in (
        (TUNE, taught, tuned, np.array([turned[k].tolerance for k in tuned]), 2),
        (NAMED, taught, called, prior_deviations(turned, called), NAMING),
        (ALL, even, whole_of, within(turned, whole_of, LOOSELY), ROUNDS),
    ):
        whole = by.fit(which, spread, range(len(known)), begin, rounds)
        out[name] = Fit(by, which, spread, whole)
        said(f'{name}: {sum(one.cost for one in whole.equations):.0f}')
        begin = begin if name == TUNE else whole.values
    return out


def main() -> None:
    """Score, print and write."""
    if not DATA.is_dir():
        sys.exit(f'There is no {DATA}; set LTA_DATA to the folder that has rgblimp/.')
    vehicle = load_vehicle('rgblimp')
    nominal = NominalVehicle.from_vehicle(vehicle)
    turned = list_free_parameters(nominal)
    known = flights(vehicle, turned, nominal.parameter_value('thrust_curve', 'b_1'))
    taught = ForecastFitter(nominal, [flight.taught for flight in known], LIFT)
    sight = ForecastFitter(nominal, [flight.scored for flight in known], LIFT)
    said(f'{len(known)} flights, {sum(len(begun(f)) for f in known)} pieces')
    found, kept = named(taught, regimes(known))
    judged = judged_by_kind(nominal, taught, kept)
    kept = [group.name for group in judged.accepted]
    fits = fitted(nominal, known, taught, kept)
    rows = scored(known, sight, fits)
    text = []
    for title, which in (
        ('All pieces', 'whole'),
        ('Transient: pieces that begin in the first 10 s', 'transient'),
        ('Steady: later pieces', 'steady'),
    ):
        text += [f'**{title}**', '', *table(rows, which), '']
    sys.stdout.write('\n'.join(text) + '\n')
    sys.stdout.flush()
    text += [*carried(found, kept, known, fits), '', *kinds(judged)]
    text += ['', *extrapolated(nominal, known, sight, (kept, INERTIA))]
    text += ['', f'CPU: {time.process_time():.0f} s.']
    sys.stdout.write('\n'.join(text) + '\n')
    write(text)


def write(text: Sequence[str]) -> None:
    """Put the tables between the marks of the page."""
    page = PAGE.read_text(encoding='utf-8')
    head, _, rest = page.partition(BEGIN)
    _, _, tail = rest.partition(END)
    PAGE.write_text(f'{head}{BEGIN}\n{chr(10).join(text)}\n{END}{tail}', encoding='utf-8')


if __name__ == '__main__':
    main()
