"""Write the plots of the views as a PlotJuggler layout, named as its ROS parser names them."""

from collections.abc import Sequence
import xml.etree.ElementTree as ET

from lta_config.views import list_series, SeriesPath, ViewPanel, Views
from lta_config.views_foxglove import COLOURS, OTHERS


def curve_name(views: Views, place: SeriesPath) -> str:
    """
    Return the name of a series in PlotJuggler.

    Its ROS parsers put the name of a joint before the field, index other arrays, split a
    diagnostic array by robot, status and key, and add the angles of the first quaternion in
    degrees.
    """
    steps = list(place.steps)
    if steps[-1] in views.actuators:
        *fields, name = steps
        joint = place.topic.message == 'JointState'
        index = views.actuators.index(name)
        steps = [name, *fields] if joint else [*fields[:-1], f'{fields[-1]}[{index}]']
    elif place.topic.message == 'DiagnosticArray' and place.name.startswith('/'):
        steps = [views.robot, *steps]
    elif place.angle:
        steps[-1] += '_deg'
    return '/'.join((place.absolute, *steps))


def _add_splitter(parent: ET.Element, upright: bool, shares: Sequence[float]) -> ET.Element:
    """Add a splitter: '-' stacks vertically, '|' places side by side."""
    total = sum(shares)
    return ET.SubElement(
        parent,
        'DockSplitter',
        orientation='-' if upright else '|',
        count=str(len(shares)),
        sizes=';'.join(f'{share / total:.6g}' for share in shares),
    )


def _add_plot(parent: ET.Element, views: Views, panel: ViewPanel) -> None:
    area = ET.SubElement(parent, 'DockArea', name=panel.title)
    plot = ET.SubElement(area, 'plot', style='Lines', mode='TimeSeries')
    plot.attrib |= {'flip_x': 'false', 'flip_y': 'false'}
    ET.SubElement(plot, 'range', left='0', right='60', bottom='0', top='1')
    ET.SubElement(plot, 'limitY')
    for k, (label, place) in enumerate(list_series(views, panel)):
        colour = COLOURS.get(label, OTHERS[k % len(OTHERS)])
        ET.SubElement(plot, 'curve', name=curve_name(views, place), color=colour)


def build_plotjuggler_layout(views: Views) -> str:
    """Return the layout as XML text."""
    root = ET.Element('root')
    named = {'name': 'Main Window', 'parent': 'main_window'}
    widget = ET.SubElement(root, 'tabbed_widget', named)
    for tab, columns in views.tabs.items():
        page = ET.SubElement(widget, 'Tab', tab_name=tab, containers='1')
        container = ET.SubElement(page, 'Container')
        # PlotJuggler shows only curves, so leave out all other panels
        piles = [[panel for panel in column if panel.plot] for column in columns]
        piles = [pile for pile in piles if pile]
        row = _add_splitter(container, upright=False, shares=[1.0] * len(piles))
        for pile in piles:
            column = _add_splitter(row, upright=True, shares=[panel.share for panel in pile])
            for panel in pile:
                _add_plot(column, views, panel)
    ET.SubElement(widget, 'currentTabIndex', index='0')
    ET.SubElement(root, 'use_relative_time_offset', enabled='1')
    # Empty, as in the layouts that PlotJuggler itself saves
    ET.SubElement(root, 'Plugins')
    ET.SubElement(root, 'customMathEquations')
    ET.SubElement(root, 'snippets')
    ET.indent(root, ' ')
    text = ET.tostring(root, encoding='unicode')
    return f"<?xml version='1.0' encoding='UTF-8'?>\n{text}\n"
