"""
Score the flights that are to decide: `make plan` (minutes), or `make plan ARGS='--cases 10'`.

Each case hides one effect, of 5 to 9 deviations, in two plain flights that can hardly tell it from
another: a hover, or the same thing over and over, seen by all sensors or by a tracker alone; the
vehicle is off by its tolerances besides. Where these flights name it all the same, and nothing
else, the case is left out. For the others the next flight is planned for the name and its rivals,
flown twice by the hidden vehicle, and all four flights are named anew. It counts as unique where
the true name, or one of its class, is the only one named and nothing outside the class is tied
with it. Rows are kept as they are judged, under a hash of the candidates and of this file.
"""

import argparse
from collections.abc import Iterator
import hashlib
import json
from pathlib import Path
import sys
import time
from typing import Any, NamedTuple

from lta_config.errors import BadInput
from lta_config.files import find_file
from lta_discovery.model.parameters import FreeParameter
from lta_discovery.planning.candidate_maneuvers import AltitudeRange, build_maneuver
from lta_discovery.planning.class_derivation import compute_registry_digest
from lta_discovery.planning.flight_choice import (
    format_hypothesis,
    NextFlightPlanner,
    ParameterHypothesis,
)
from lta_discovery.planning.rehearsal import (
    prepare_linearizer,
    Sensors,
    simulate_flight,
    with_course,
)
from lta_discovery.planning.separability import PairSeparability
from lta_discovery.replay.flight_linearizer import FlightLinearizer
from lta_discovery.selection.effect_search import EffectSearch, EffectSearchResult
from lta_discovery.selection.equivalence_classes import is_equivalent, Kind
from lta_flight.flight_spec import build_vehicle_scenario_stack, FlightSpec, load_spec
from lta_flight.sweep.statistics import wilson_interval
from lta_model.vehicle import Vehicle
import numpy as np
from rich.progress import track
import yaml

VEHICLE = 'gtmab'
PLAIN = (('hover', 'all'), ('hover', 'pose'), ('speeds', 'pose'), ('heights', 'pose'),
         ('yaws', 'all'), ('laps', 'pose'), ('hover', 'imu'))  # fmt: skip
LENGTH = 40.0  # s; of a plain flight in the air
CONFUSED = 1.0  # nats to expect, below which two names cannot be told apart
MOST = 3  # rivals that a flight is planned against


class Hidden(NamedTuple):
    """A case: what is hidden by how much, in which flights, and its rivals."""

    name: str
    value: float
    plain: str
    sensors: Sensors
    rivals: tuple[str, ...]


def flown(made: FlightSpec, vehicle: Vehicle, seed: int) -> Any:
    """Fly a vehicle; its pilot knows the file."""
    known, scenario, policy = build_vehicle_scenario_stack(made)
    return simulate_flight(vehicle, scenario, policy, seed, Vehicle(known.file)).streams


def plainly(made: FlightSpec, space: AltitudeRange, what: str) -> FlightSpec:
    """Return a plain flight."""
    one = build_maneuver(what, space, LENGTH, 0.0)
    return with_course(made, one.course, one.length)


def confusable(
    planner: NextFlightPlanner, made: FlightSpec, sensors: Sensors
) -> Iterator[tuple[str, float, tuple[str, ...]]]:
    """Yield names, a deviation of each, and those that a plain flight takes for it."""
    flight = prepare_linearizer(
        flown(made, planner.vehicle, 5), planner.vehicle, planner.knobs, sensors
    )
    reduced = planner.reduce_flight(flight, planner.nominal)
    pairs = PairSeparability([reduced, reduced], planner.knobs)
    seen = [
        k
        for k, knob in enumerate(planner.knobs)
        if knob.typical > 0.0 and pairs.detection_sigma(k) > 0.1
    ]
    kind: Kind = sensors if sensors != 'wrench' else 'wrench'
    for a in seen:
        knob = planner.knobs[a]
        one = knob.typical / pairs.detection_sigma(a)
        alike = [
            planner.knobs[b].name
            for b in seen
            if b != a
            and not is_equivalent(knob.name, planner.knobs[b].name, kind)
            and pairs.compare_pair(a, b).expected_log_bayes(6.0 * one) < CONFUSED
        ]
        if alike:
            yield knob.name, one, tuple(alike)


def off(
    planner: NextFlightPlanner, rng: np.random.Generator, knob: FreeParameter, value: float
) -> Vehicle:
    """Return the hidden vehicle: within its tolerances, but for one effect."""
    nominal = planner.nominal
    for one in planner.knobs:
        own = one.tolerance * float(rng.standard_normal())
        plain = '.' in one.name and not one.name.startswith(('vehicle.', 'rotor_'))
        if one.tolerance and plain and not one.name.endswith('.all') and not one.per_flight:
            nominal = one.apply_to(nominal, float(np.clip(own, one.low, one.high)))
    nominal = knob.apply_to(nominal, value)
    content = yaml.safe_load(format_hypothesis(planner.text, planner.vehicle, nominal))
    return build_vehicle_scenario_stack(planner.made.__class__(
        planner.made.names, planner.made.strategy, {**planner.made.contents, 'vehicle': content}
    ))[0]  # fmt: skip


def judged(
    number: int, planners: dict[Sensors, NextFlightPlanner], pool: list[Hidden]
) -> dict[str, Any]:
    """Return what came of a case."""
    rng = np.random.default_rng([number, 77])
    hidden = pool[int(rng.integers(len(pool)))]
    base = planners[hidden.sensors]
    knob = base.find_parameter(hidden.name)
    value = hidden.value * float(rng.uniform(5.0, 9.0)) * (1.0 if rng.random() < 0.5 else -1.0)
    if not knob.low <= value <= knob.high:
        value = -value
    row: dict[str, Any] = {**hidden._asdict(), 'value': value, 'said': ''}
    try:
        truth = off(base, rng, knob, value)
    except BadInput as error:
        return {**row, 'said': f'cannot be: {error}', 'skipped': True}
    return {**row, **flown_on(hidden, base, truth, ParameterHypothesis(knob, value), number)}


def flown_on(
    hidden: Hidden,
    base: NextFlightPlanner,
    truth: Vehicle,
    first: ParameterHypothesis,
    number: int,
) -> dict[str, Any]:
    """Return what came of the plain flights, and of the planned one."""
    knob, kind = first.knob, hidden.sensors
    start = time.process_time()
    plain = plainly(base.made, base.space, hidden.plain)
    flights = [ready(base, plain, truth, 100 * number + k) for k in (1, 2)]
    before = EffectSearch(base.nominal, ([flights[0]], [flights[1]])).run()
    row = {'before': before.names, 'tied': before.steps[0].tied}
    if unique(before, knob.name, hidden.sensors):
        return {**row, 'said': 'told apart already', 'skipped': True}
    found = [base.reduce_flight(flight, base.nominal) for flight in flights]
    planner = NextFlightPlanner(base.made, base.text, hidden.sensors, found)
    # Planned against is what a study has: the tied names, and those that look alike.
    alike = dict.fromkeys((*before.names, *before.steps[0].tied, *hidden.rivals))
    names = [name for name in alike if not is_equivalent(name, knob.name, kind)][:MOST]
    chosen = planner.choose_flight(
        first, [planner.fit_rival_value(first, planner.find_parameter(name)) for name in names]
    )
    if chosen is None:
        return {**row, 'said': 'no flight', 'unique': False, 'cpu': time.process_time() - start}
    more = [ready(base, chosen.flight_spec, truth, 100 * number + k) for k in (3, 4)]
    after = EffectSearch(base.nominal, ([flights[0], more[0]], [flights[1], more[1]])).run()
    return {
        **row, 'against': names, 'planned': chosen.manoeuvre.about, 'nats': chosen.nats,
        'length': chosen.manoeuvre.length, 'after': after.names, 'tied_after': after.steps[0].tied,
        'unique': unique(after, knob.name, kind), 'cpu': time.process_time() - start,
    }  # fmt: skip


def unique(found: EffectSearchResult, name: str, kind: Kind) -> bool:
    """Tell whether a name, or one of its class, is the only one named, and nothing is tied."""
    tied = [one for one in found.steps[0].tied if not is_equivalent(one, name, kind)]
    return len(found.names) == 1 and is_equivalent(found.names[0], name, kind) and not tied


def ready(
    planner: NextFlightPlanner, made: FlightSpec, truth: Vehicle, seed: int
) -> FlightLinearizer:
    """Return a flight of the hidden vehicle as it is studied."""
    return prepare_linearizer(
        flown(made, truth, seed), planner.vehicle, planner.knobs, planner.sensors
    )


def table(count: int, rows: list[dict[str, Any]]) -> list[str]:
    """Return the lines of the table."""
    lines = [f'{count} names in plain flights that take them for another']
    lines += [
        f'{row["number"]:>4} {row["name"]:<28} {row["plain"]}/{row["sensors"]:<5} '
        f'{"unique" if row["unique"] else "not unique"}: {row.get("planned", row["said"])}; '
        f'before {row["before"]} tied {row["tied"]}, after {row.get("after")}'
        for row in rows
    ]
    hit = sum(row['unique'] for row in rows)
    found = wilson_interval(hit, len(rows))
    wrong = sum(
        any(not is_equivalent(name, row['name'], row['sensors']) for name in row.get('after', ()))
        for row in rows
    )
    lines.append(
        f'unique after the planned flight {hit}/{len(rows)}, '
        f'{100 * found.low:.0f}..{100 * found.high:.0f} %; another name in {wrong}'
    )
    return lines


def begun(out: Path, known: list[FreeParameter]) -> tuple[Path, dict[int, dict[str, Any]]]:
    """Return where rows are kept, and those that are there by number."""
    told = hashlib.sha256(Path(__file__).read_bytes()).hexdigest()[:8]
    out.mkdir(parents=True, exist_ok=True)
    kept = out / f'{compute_registry_digest(known)}-{told}.jsonl'
    done = {}
    if kept.exists():
        rows = [json.loads(line) for line in kept.read_text(encoding='utf-8').splitlines()]
        done = {row['number']: row for row in rows}
    return kept, done


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description='Score the flights that are to decide.')
    parser.add_argument('--cases', type=int, default=50, help='drawn, not all confusable')
    parser.add_argument('--first', type=int, default=1, help='number of the first one')
    parser.add_argument('--out', type=Path, default=Path('runs') / 'plan')
    asked = parser.parse_args()
    made = load_spec(VEHICLE, 'hall', 'bag', '')
    text = find_file('vehicle', VEHICLE).read_text(encoding='utf-8')
    planners: dict[Sensors, NextFlightPlanner] = {
        sensors: NextFlightPlanner(made, text, sensors) for sensors in ('all', 'imu', 'pose')
    }
    pool = [
        Hidden(name, one, what, sensors, rivals)
        for what, sensors in PLAIN
        for name, one, rivals in confusable(
            planners[sensors], plainly(made, planners[sensors].space, what), sensors
        )
    ]
    kept, done = begun(asked.out, planners['all'].knobs)
    numbers = range(asked.first, asked.first + asked.cases)
    with kept.open('a', encoding='utf-8') as file:
        for number in track(numbers, 'judging', disable=not sys.stderr.isatty()):
            if number not in done:
                done[number] = {'number': number, **judged(number, planners, pool)}
                file.write(json.dumps(done[number], default=float) + '\n')
                file.flush()
    rows = [done[number] for number in numbers if not done[number].get('skipped')]
    lines = table(len(pool), rows)
    sys.stdout.write('\n'.join(lines) + f'\nrows in {kept}\n')


if __name__ == '__main__':
    main()
