"""One flight as one self-contained HTML file."""

from collections.abc import Mapping
from html import escape
from pathlib import Path
import shlex
from typing import Final

from lta_config.typed import near, typed
from lta_data.bag.flight import Flight, open_flight
from lta_data.bag.folder import bag_files
from lta_flight.report.outcome import sentence, table, tiles
from lta_flight.report.panels.registry import Panel, PANELS
from lta_flight.report.results import Results, results_of
from lta_flight.report.track import track_of
from lta_flight.report.view import View
from lta_report.frame import framed, written
from lta_report.pieces import section, tile_html

FILES: Final = ('vehicle_file', 'scenario_file', 'gains_file')
CHOSEN: Final = ('vehicle', 'scenario', 'strategy', 'seed', 'time')
MOVED: Final = ('offset_x', 'offset_y')
SIMULATED: Final = (
    'A simulated flight. "Truth" is the state of the simulator, which no part of the drone ever '
    'sees; "estimate" is what the drone made of its simulated sensors.'
)
MEASURED: Final = (
    'The recording brings no scenario. "Truth" is its ground truth, from wherever that came; '
    '"estimate" is what the drone made of its sensors.'
)


def write_page(bag: Path, out: Path, robot: str | None = None) -> Results:
    """
    Write the page of a flight and return its results.

    Parameters
    ----------
    bag : Path
        rosbag2 folder or .mcap file.
    out : Path
        HTML file to write; replaced if it is there.
    robot : str, optional
        Namespace of the robot; needed only where the bag holds several.

    Raises
    ------
    BadInput
        If there is no recording, the robot is unknown or not the only one, or the page cannot be
        written.

    """
    flight = open_flight(bag, robot)
    view = View(flight)
    results = results_of(view)
    written(page(view, results, bag), out)
    return results


def page(view: View, results: Results, bag: Path) -> str:
    """Return the whole page of a flight in a bag."""
    sections = {panel.name: picture_of(panel, view) for panel in PANELS}
    return framed(
        'flight.html',
        title=f'{escape(sentence(results))}.',
        kicker=escape(kicker(view.provenance)),
        about=escape(origin(view)),
        tiles='\n'.join(tile_html(*tile) for tile in tiles(results)),
        track=track_of(view),
        table='\n'.join(row_html(*row) for row in table(results)),
        hero=sections.pop('path'),
        panels='\n'.join(sections.values()),
        facts=facts(view.flight),
        commands=commands(view, near(bag)),
        files={
            key.replace('_', ' ').capitalize(): view.provenance[key]
            for key in FILES
            if key in view.provenance
        },
    )


def picture_of(panel: Panel, view: View) -> str:
    """Return one picture with heading and caption, or a sentence on why there is none."""
    missing = [topic for topic in panel.needs if not view.has(topic)]
    names = ' and '.join(f'<code>{escape(topic)}</code>' for topic in missing)
    absent = f'<p class="absent">The recording has nothing on {names}.</p>'
    picture = absent if missing else panel.picture(view)
    return section(panel.name, panel.title, panel.caption, picture, timed=panel.timed)


def kicker(provenance: Mapping[str, str]) -> str:
    """Return the line above the title."""
    names = [provenance.get(key, '') for key in ('vehicle', 'scenario', 'strategy')]
    seed = provenance.get('seed')
    return ' · '.join([name for name in names if name] + ([f'seed {seed}'] if seed else []))


def origin(view: View) -> str:
    """Return what is simulated, what is estimated, and where the truth comes from."""
    if view.scene.scenario is None:
        return MEASURED
    return SIMULATED


def row_html(name: str, here: str, paper: str) -> str:
    """Return one line of the table."""
    return (
        f'<tr><th scope="row">{escape(name)}</th><td>{escape(here)}</td>'
        f'<td>{escape(paper)}</td></tr>'
    )


def facts(flight: Flight) -> dict[str, str]:
    """Return where the data come from."""
    found = {key: value for key, value in flight.provenance.items() if key not in FILES}
    return found | {
        'recording': 'complete' if flight.bag.complete else ' '.join(flight.bag.losses)
    }


def commands(view: View, bag: Path) -> dict[str, str]:
    """Return how to look further, and how to fly it again."""
    # A bag with a /clock brings the time itself; a second one would contradict it.
    clock = [] if '/clock' in view.flight.bag.topics else ['--clock']
    return {
        'List what was recorded': typed('bag', 'info', bag),
        # PlotJuggler opens files, not folders.
        'Plot any topic': shlex.join(['plotjuggler', '-d', str(bag_files(bag)[0])]),
        'Replay in ROS 2': shlex.join(['ros2', 'bag', 'play', str(bag), *clock]),
        'Look at every channel': typed('bag', 'plot', bag),
        'Decide again on what was sensed': typed('replay', bag, '--against'),
        'Fly it again': again(view.provenance),
    }


def again(provenance: Mapping[str, str]) -> str:
    """Return the command that makes a flight again; a moved start is an argument of the launch."""
    given = {key: provenance[key] for key in CHOSEN if key in provenance}
    moved = {key: provenance[key] for key in MOVED if key in provenance}
    if moved:
        return typed(
            'launch', 'fly', *(f'{key}:={value}' for key, value in (given | moved).items())
        )
    return typed('fly', *(word for key, value in given.items() for word in (f'--{key}', value)))
