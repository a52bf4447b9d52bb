"""Write the table of speeds of docs/validation.md from the stored figures of `make bench`."""

from collections.abc import Mapping
import json
from pathlib import Path
from typing import Any, Final

HERE = Path(__file__).resolve().parent
PAGE: Final = HERE.parents[1] / 'docs' / 'validation.md'
BEGIN: Final = '<!-- written by make bench-compare ARGS=--keep -->'
END: Final = '<!-- end -->'

# What a figure is, in the order of the page; figures that are not listed are left out
ABOUT: Final = {
    'kernel.single': "one vehicle on one core, RK4 in double precision, with GT-MAB's effects on",
    'kernel.single_composed': 'the same by a kernel of these effects only, as in a batch',
    'kernel.single_all': 'one vehicle with every effect on',
    'kernel.batched': 'many vehicles on all cores, RK4 in double precision; each equals a single '
    'run to the last bit',
    'kernel.batched_all': 'the same with every effect on',
    'kernel.cold': 'from the first import to the first step with an empty cache',
    'kernel.warm': 'the same with a filled cache',
    'loop.realtime': 'the closed loop in one process on one core: sensors, 8 x 10 kS/s light '
    'blocks with reflections, FFT, fit, estimator, control, energy',
    'vlc.realtime': 'from ADC block to lamp estimate: 8 diodes, one beacon',
    'vlc.realtime_16': 'the same with 16 diodes',
    'vlc.demodulation': 'demodulation of 16 diodes and two beacons, between bins, with tracking '
    'and fault detection; the peer gives whole bins and the SNR only',
    'supply.dark': 'loads, charger, cell and energy balance in a control step',
    'supply.lit': "the same after a change of light, with a search for the array's largest power",
    'fleet.closed': 'closed loops in a batch on all cores, with the statistics of the light '
    'instead of samples',
    'fleet.open': 'the same at constant duties',
    'graph.realtime': 'a whole flight of the graph in lockstep, seven processes; the peer is the '
    "same with Fast DDS's own settings",
    'graph.one_process': 'the same flight with `processes:=one`',
    'graph.share': 'processor time of this process in real time: all nodes, simulator and '
    'recorder',
    'spin.events': "a message to another process and back; the peer is rclpy's usual executor",
    'start.matched': 'seven nodes until each has found all others; the peer is the same with '
    "Fast DDS's own settings",
    'killed.silence': 'longest silence of a node while others are killed; the peer is the same '
    "with Fast DDS's own settings",
    'light_link.way': 'a light block from the last byte of the board to the message in another '
    'process',
    'recorder.realtime': 'the recorder in a real-time flight, all topics',
    'recorder.message': 'one message in the recorder; the peer only receives it',
    'reading.list': 'listing the content of a bag of 1 GB',
    'reading.memory': 'rise of the peak memory by listing and reading all of it',
    'reading.one_topic': 'reading one topic of it',
    'reading.rare_topic': 'reading a rare topic of it',
    'tables.one_topic': 'Odometry as columns',
    'discover.search_120': 'discovery: the search in two flights of 120 s, processor time',
    'command.help': '`lta --help`, processor time',
    'command.simulate': '`lta simulate`, a flight of 21 s with bag and page, processor time, warm '
    'cache',
    'command.simulate_cold': 'the same with an empty cache',
    'command.fly_one': '`lta fly --processes one`, the same flight by the graph',
    'command.fly': '`lta fly`, the same in seven processes',
    'gpu.batched': 'the batched kernel on a GPU',
    'gpu.closed': 'closed loops on a GPU',
}


def update_page(page: Path, reference: Path) -> None:
    """Write the table into a page, between its marks."""
    before, rest = page.read_text(encoding='utf-8').split(BEGIN)
    after = rest.split(END, 1)[1]
    table = format_table(reference)
    page.write_text(f'{before}{BEGIN}\n{table}{END}{after}', encoding='utf-8')


def format_table(reference: Path) -> str:
    """Return the table of the figures of a file in Markdown."""
    rows = {row['name']: row for row in json.loads(reference.read_text(encoding='utf-8'))['rows']}
    lines = [
        '| | measured | LTA / best peer | what | when, at which load |',
        '|---|---|---|---|---|',
        *(format_row(rows[name], about) for name, about in ABOUT.items() if name in rows),
    ]
    return '\n'.join(lines) + '\n'


def format_row(row: Mapping[str, Any], about: str) -> str:
    """Return one row of the table."""
    beside = '' if row['ratio'] is None else f'{row["ratio"]:.3g} ({row["peer"]})'
    low, high = (f'{value:.0f}' for value in sorted(row['load']))
    load = low if low == high else f'{low} to {high}'
    return (
        f'| `{row["name"]}` | {format_value(row["value"])} {row["unit"]} | {beside} | {about} | '
        f'{row["date"]}, {row["cores"]} cores, load {load} |'
    )


def format_value(value: float) -> str:
    """Return a value with three digits, millions in words."""
    if abs(value) >= 1e6:
        return f'{value / 1e6:.3g} million'
    return f'{float(f"{value:.3g}"):,.0f}' if abs(value) >= 100.0 else f'{value:.3g}'
