"""One discovery, from the bags to the folder with everything that was found."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import final

from lta_bridge.bag.storage import StorageFault
from lta_bridge.provenance import here
from lta_config.errors import BadInput
from lta_config.files import find
from lta_discovery.carrying.regimes import interpolation
from lta_discovery.carrying.route import by_forecasts
from lta_discovery.flights.bags import read_bags, Role
from lta_discovery.flights.trusted import Believed, believed
from lta_discovery.forecast.cautions import cautions
from lta_discovery.page.page import NAME as PAGE
from lta_discovery.page.page import page
from lta_discovery.planning.next_flight import doubted, hint, Next, of_study
from lta_discovery.replay.linear import origin
from lta_discovery.results.discovery_json import NAME, to_dict
from lta_discovery.results.learned_file import learned_text
from lta_discovery.results.overlay import write_overlay
from lta_discovery.study import Study, study
from lta_discovery.where.places import places, Seen
from lta_model.vehicle import load_vehicle, Vehicle
from lta_report.frame import written as kept
from lta_report.results_folder import all_at_once, keep_json

VEHICLE = 'vehicle.yaml'
REFITTED = 'refitted.yaml'
Tell = Callable[[str, float | None], None]


@final
@dataclass(frozen=True, slots=True)
class Asked:
    """
    What to study.

    Attributes
    ----------
    vehicle : str
        Name or file.
    bags : mapping of role to paths
        'train', 'confirm', 'holdout'.
    seed : int
        Of all chance.
    robot : str, optional
        Whose data, where a bag holds several robots.
    plan : bool
        Whether to plan the next flight.

    """

    vehicle: str
    bags: Mapping[Role, Sequence[Path]]
    seed: int = 1
    robot: str | None = None
    plan: bool = False


@final
@dataclass(frozen=True, slots=True)
class Discovered:
    """
    What came of it.

    Attributes
    ----------
    study : Study
        What was found.
    told : mapping
        As discovery.json has it.
    page : Path
        The page.

    """

    study: Study
    told: Mapping[str, object]
    page: Path


def discover(asked: Asked, folder: Path, tell: Tell) -> Discovered:
    """
    Study flights and write everything into a folder.

    Parameters
    ----------
    asked : Asked
        What to study.
    folder : Path
        Empty, or not there yet.
    tell : callable
        Told what is being done.

    Raises
    ------
    BadInput
        If the flights cannot give an honest answer, or the folder cannot be written.

    """
    vehicle = load_vehicle(asked.vehicle)
    flights = read_bags(asked.bags, asked.robot, lambda name: tell(f'reading {name}', None))
    tell('checking what can be believed', None)
    sound = believed(flights, vehicle)
    found = doubted(studied(asked, vehicle, sound, tell))
    next_one = of_study(found, asked.vehicle, tell) if asked.plan else Next(hint(found))
    finding = replace(found.finding, next_flight=next_one.text)
    tell('writing what was found', None)
    try:
        with all_at_once(folder, NAME) as part:
            next_one.write(part)
            return written(asked, vehicle, replace(found, finding=finding), sound, folder, part)
    except OSError as error:
        raise BadInput(
            f"'{folder}' cannot be written ({error.strerror}); choose another folder with --out."
        ) from error
    except StorageFault as fault:
        raise BadInput(str(fault)) from None


def studied(asked: Asked, vehicle: Vehicle, sound: Believed, tell: Tell) -> Study:
    """Return the study of flights that can be used, with what is to be said of them."""
    found = by_forecasts(study(vehicle, sound.flights, asked.seed, tell), tell)
    only = interpolation(found)
    told = [*cautions(found.finding.gaps), *([only] if only else [])]
    finding = replace(
        found.finding,
        where=places(_seen(found, sound), asked.seed),
        vehicle=asked.vehicle,
        warnings=(*sound.warnings, *found.finding.warnings, *told),
        versions={**here(), **found.finding.versions},
    )
    return replace(found, finding=finding)


def _seen(found: Study, sound: Believed) -> list[Seen]:
    """Return the flights that taught and confirmed as the model of the vehicle file sees them."""
    taught = [one for role in ('train', 'confirm') for one in found.flights if one.role == role]
    out = []
    for one, fit in zip(taught, found.bare, strict=True):
        before = origin(found.nominal, one.flight.knobs, one.flight.replay.cut)
        out.append(Seen(one.name, one.flight, before, fit, sound.light.get(one.name)))
    return out


def written(
    asked: Asked, vehicle: Vehicle, found: Study, sound: Believed, folder: Path, part: Path
) -> Discovered:
    """Write the results of a study into `part`, whence they go into their folder."""
    finding = found.finding
    if finding.effects:
        text = find('vehicle', asked.vehicle).read_text(encoding='utf-8')
        learned = learned_text(text, vehicle, found.nominal, found.learned, finding)
        (part / VEHICLE).write_text(learned, encoding='utf-8')
    if found.refitted is not None:
        text = find('vehicle', asked.vehicle).read_text(encoding='utf-8')
        # A drag below that of the parts has no place in the file: it is a forecast, no vehicle.
        with suppress(BadInput):
            whole = learned_text(text, vehicle, found.nominal, found.refitted, finding)
            (part / REFITTED).write_text(whole, encoding='utf-8')
    write_overlay(found.shown, part, finding.versions)
    told = to_dict(finding, sound.cuts)
    keep_json(told, part / NAME)
    bags: dict[str, Sequence[Path | str]] = {role: list(asked.bags[role]) for role in asked.bags}
    kept(page(found, folder, bags), part / PAGE)
    return Discovered(found, told, folder / PAGE)
