"""One discovery, from the bags to the folder with everything that was found."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import final

from lta_analysis.discovery.bags import read_bags, Role
from lta_analysis.discovery.learned_file import learned_text
from lta_analysis.discovery.overlay import write_overlay
from lta_analysis.discovery.page.page import write_page
from lta_analysis.discovery.splitting import with_all_roles
from lta_analysis.discovery.study import Study, study
from lta_analysis.discovery.told import NAME, to_dict
from lta_analysis.discovery.trusted import Believed, believed
from lta_analysis.results_folder import keep_json
from lta_bridge.bag.storage import StorageFault
from lta_bridge.provenance import here
from lta_config.errors import BadInput
from lta_config.files import find
from lta_sim.vehicle import load_vehicle, Vehicle

VEHICLE = 'vehicle.yaml'
Tell = Callable[[str], None]


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

    """

    vehicle: str
    bags: Mapping[Role, Sequence[Path]]
    seed: int = 1
    robot: str | None = None


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
        Empty.
    tell : callable
        Told what is being done.

    Raises
    ------
    BadInput
        If the flights cannot give an honest answer, or the folder cannot be written.

    """
    vehicle = load_vehicle(asked.vehicle)
    tell('reading the flights')
    flights = read_bags(asked.bags, asked.robot, lambda name: tell(f'reading {name}'))
    tell('checking what of them can be believed')
    sound = believed(flights, vehicle)
    found = studied(asked, vehicle, sound, tell)
    tell('writing what was found')
    return written(asked, vehicle, found, sound, folder)


def studied(asked: Asked, vehicle: Vehicle, sound: Believed, tell: Tell) -> Study:
    """Return the study of flights that can be used, with what is to be said of them."""
    flights, words = with_all_roles(sound.flights)
    found = study(vehicle, flights, asked.seed, tell)
    finding = replace(
        found.finding,
        vehicle=asked.vehicle,
        warnings=(*sound.warnings, *words, *found.finding.warnings),
        versions={**here(), **found.finding.versions},
    )
    return replace(found, finding=finding)


def written(
    asked: Asked, vehicle: Vehicle, found: Study, sound: Believed, folder: Path
) -> Discovered:
    """Write the results of a study."""
    finding = found.finding
    try:
        if finding.effects:
            text = find('vehicle', asked.vehicle).read_text(encoding='utf-8')
            learned = learned_text(text, vehicle, found.nominal, found.learned, finding)
            (folder / VEHICLE).write_text(learned, encoding='utf-8')
        write_overlay(found.shown, folder, finding.versions)
    except OSError as error:
        raise BadInput(
            f"'{folder}' cannot be written ({error.strerror}); choose another folder with --out."
        ) from error
    except StorageFault as fault:
        raise BadInput(str(fault)) from None
    told = to_dict(finding, sound.cuts)
    keep_json(told, folder / NAME)
    return Discovered(found, told, write_page(found, folder))
