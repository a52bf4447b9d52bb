"""
Score forecasts of RGBlimp's real flights by inputs that were left out: `make rgblimp`.

Writes the tables of docs/discovery_flights.md between its marks. Minutes of one core.
"""

from collections.abc import Sequence
from pathlib import Path
import sys
import time
from typing import Final

from lta_analysis.discovery.foresight import Foresight
from lta_analysis.discovery.knobs import knobs
from lta_analysis.discovery.nominal import Nominal
from lta_analysis.discovery.transfer import left_out, Regime, warning
from lta_sim.vehicle import load_vehicle
import numpy as np
from numpy.typing import NDArray
from rgblimp_flights import begun, DATA, Flight, flights, regimes, REPEATS
from rgblimp_forecast import by_coasting, by_model, by_repeats, LIFT, Row, row
from rgblimp_naming import CANDIDATES, choose, Chosen, FREE, places, REFITTED, spreads, WIDE

Array = NDArray[np.float64]
FOLDS: Final = 5
PAGE: Final = Path(__file__).resolve().parents[2] / 'docs' / 'discovery_flights.md'
BEGIN, END = '<!-- rgblimp: begin -->', '<!-- rgblimp: end -->'
TUNED: Final = (
    'vehicle.mass', 'vehicle.roll', 'vehicle.pitch', 'vehicle.yaw', 'rotor_1.thrust',
    'rotor_2.thrust', 'hull_lift.all', 'cg_offset.x', 'cg_offset.y', 'cg_height.z',
)  # fmt: skip


def said(text: str) -> None:
    """Print progress."""
    print(f'{time.process_time():6.0f} s  {text}', file=sys.stderr, flush=True)


def folds(count: int) -> list[list[int]]:
    """Return the flights of each fold: every fifth input."""
    return [[f for f in range(count) if (f // REPEATS) % FOLDS == k] for k in range(FOLDS)]


def scored(known: list[Flight], taught: Foresight, sight: Foresight) -> tuple[list[Row], list]:
    """Return the rows of the table, and what was named in each fold."""
    groups, count = regimes(known), len(known)
    errors: dict[str, dict[int, Array]] = {
        name: {} for name in ('tuned', 'named', 'refitted', 'authors')
    }
    named = []
    tuned = places(taught.knobs, TUNED)
    tolerance = np.array([taught.knobs[k].tolerance for k in tuned])
    free = places(taught.knobs, REFITTED)
    zero = np.zeros(len(taught.knobs))
    for k, test in enumerate(folds(count)):
        train = [f for f in range(count) if f not in set(test)]
        values = taught.fit(tuned, tolerance, train, rounds=2).values
        errors['tuned'] |= by_model(sight, values, test, known)
        chosen = choose(taught, train, groups)
        named.append(chosen)
        said(f'fold {k + 1}: {", ".join(chosen.names)}')
        errors['named'] |= by_model(sight, chosen.values, test, known)
        wide = spreads(taught.knobs, free, FREE)
        values = taught.fit(free, wide, train, chosen.values, 4).values
        errors['refitted'] |= by_model(sight, values, test, known)
        errors['authors'] |= by_model(sight, zero, test, known)
    times = [begun(flight) for flight in known]
    sets = {
        'coast: body velocity and rates kept': ('0', [by_coasting(f) for f in known]),
        "authors' first-principles model": ('0', _listed(errors['authors'])),
        'its tolerances tuned': (str(len(tuned)), _listed(errors['tuned'])),
        'named, carrying over': (_counts(named), _listed(errors['named'])),
        'and every coefficient refitted': (str(len(free)), _listed(errors['refitted'])),
        'floor: the other repeats': ('-', [by_repeats(known, f) for f in range(count)]),
    }
    return [row(name, n, lefts, times) for name, (n, lefts) in sets.items()], named


def _listed(errors: dict[int, Array]) -> list[Array]:
    """Return errors in the order of the flights."""
    return [errors[f] for f in sorted(errors)]


def _counts(named: Sequence[Chosen]) -> str:
    """Return how many parameters were named, over the folds."""
    counts = [sum(len(CANDIDATES[name]) for name in each.names) for each in named]
    return f'{min(counts)}' if min(counts) == max(counts) else f'{min(counts)} to {max(counts)}'


def table(rows: Sequence[Row], which: str) -> list[str]:
    """Return a table of some pieces as Markdown."""
    out = [
        '| model | parameters | place 3 / 5 s [m] | ratio | attitude 3 / 5 s [deg] | ratio |'
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


def carried(named: Sequence[Chosen], taught: Foresight, known: list[Flight]) -> list[str]:
    """Return what names do to regimes that were left out, as Markdown."""
    groups = regimes(known)
    often = {name: sum(name in each.names for each in named) for name in CANDIDATES}
    kept = [name for name, times in often.items() if times > FOLDS // 2]
    out = ['| name | in how many folds |', '|---|---|']
    out += [f'| {name} | {times} of {FOLDS} |' for name, times in often.items() if times]
    which = places(taught.knobs, [knob for name in kept for knob in CANDIDATES[name]])
    found = left_out(taught, which, spreads(taught.knobs, which, WIDE), groups)
    whole = taught.fit(which, spreads(taught.knobs, which, WIDE), range(len(known)))
    free = places(taught.knobs, REFITTED)
    wide = spreads(taught.knobs, free, FREE)
    said('regimes, refitted')
    loose = left_out(taught, free, wide, groups, whole.values, 2)
    ratios = {one.name: one.ratio for one in loose}
    out += ['', *_values(taught, which, whole.values, np.linalg.inv(whole.precision))]
    out += ['', '| regime left out | flights | named | all refitted |', '|---|---|---|---|']
    out += [f'| {o.name} | {o.flights} | {o.ratio:.2f} | {ratios[o.name]:.2f} |' for o in found]
    out += ['', _sentence(kept, found, 'Named'), '', _sentence(['All refitted'], loose, '')]
    return out


def _values(taught: Foresight, which: Sequence[int], values: Array, covariance: Array) -> list[str]:
    """Return the values of what was named."""
    out = ['| knob | unit | change from the vehicle file | deviation |', '|---|---|---|---|']
    for k, deviation in zip(which, np.sqrt(np.diag(covariance)), strict=True):
        knob = taught.knobs[k]
        out.append(f'| {knob.name} | {knob.unit} | {values[k]:.4g} | {deviation:.1g} |')
    return out


def _sentence(names: Sequence[str], found: Sequence[Regime], what: str) -> str:
    """Return the warning, or that none is due."""
    better = sum(one.ratio < 1.0 for one in found)
    fine = f"{what}: better than the authors' model in {better} of {len(found)} regimes left out."
    return warning(names, found) or fine


def main() -> None:
    """Score, print and write."""
    if not DATA.is_dir():
        sys.exit(f'There is no {DATA}; set LTA_DATA to the folder that has rgblimp/.')
    vehicle = load_vehicle('rgblimp')
    nominal = Nominal.of(vehicle)
    turned = knobs(nominal)
    known = flights(vehicle, turned, nominal.value('thrust_curve', 'b_1'))
    taught = Foresight(nominal, [flight.taught for flight in known], LIFT)
    sight = Foresight(nominal, [flight.scored for flight in known], LIFT)
    said(f'{len(known)} flights, {sum(len(begun(f)) for f in known)} pieces')
    rows, named = scored(known, taught, sight)
    text = []
    for title, which in (
        ('All pieces', 'whole'),
        ('Transient: pieces that begin in the first 10 s', 'transient'),
        ('Steady: later ones', 'steady'),
    ):
        text += [f'**{title}**', '', *table(rows, which), '']
    print('\n'.join(text), flush=True)
    text += carried(named, taught, known)
    text += ['', f'CPU: {time.process_time():.0f} s.']
    print('\n'.join(text))
    write(text)


def write(text: Sequence[str]) -> None:
    """Put the tables between the marks of the page."""
    page = PAGE.read_text(encoding='utf-8')
    head, _, rest = page.partition(BEGIN)
    _, _, tail = rest.partition(END)
    PAGE.write_text(f'{head}{BEGIN}\n{chr(10).join(text)}\n{END}{tail}', encoding='utf-8')


if __name__ == '__main__':
    main()
