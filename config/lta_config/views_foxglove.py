"""Write the views as a Foxglove layout, in the format that its app exports and imports."""

from collections.abc import Callable, Sequence
import json
from typing import Any

from lta_config.views import list_series, SeriesPath, ViewPanel, Views

# Truth, estimate and setpoint have the same colours as on our own pages
COLOURS = {'truth': '#7f7f7f', 'estimate': '#1f77b4', 'setpoint': '#d62728'}
OTHERS = ('#1f77b4', '#ff7f0e', '#2ca02c', '#d62728', '#9467bd', '#8c564b')
WINDOW = 60.0  # s shown by a plot during a live flight
# Distances in m, angles in degrees, as Foxglove has them
CAMERA = {
    'perspective': True,
    'distance': 11.0,
    'phi': 55.0,
    'thetaOffset': 0.0,
    'targetOffset': [0.0, 0.0, 0.8],
    'target': [0.0, 0.0, 0.0],
    'targetOrientation': [0.0, 0.0, 0.0, 1.0],
    'fovy': 45.0,
    'near': 0.05,
    'far': 5000.0,
}
Config = dict[str, Any]


def message_path(views: Views, place: SeriesPath) -> str:
    """Return a series as a Foxglove message path."""
    if place.topic.message == 'DiagnosticArray':
        return _diagnostic_path(views, place)
    # An actuator's value is addressed by its index, in the order of the rotors
    if place.steps[-1] in views.actuators:
        *fields, name = place.steps
        return f'{place.absolute}.{".".join(fields)}[{views.actuators.index(name)}]'
    if place.angle:
        quaternion = '.'.join(place.steps[:-1])
        # @rpy and @degrees are Foxglove's conversion functions
        return f'{place.absolute}.{quaternion}.@rpy.{place.angle}.@degrees'
    return '.'.join((place.absolute, *place.steps))


def _diagnostic_path(views: Views, place: SeriesPath) -> str:
    """Return the path of one value of a diagnostic array."""
    status, key = place.steps
    # /diagnostics carries all robots, so select by hardware_id
    own = f'{{hardware_id=="{views.robot}"}}' if place.name.startswith('/') else ''
    return f'{place.absolute}.status[:]{own}{{name=="{status}"}}.values[:]{{key=="{key}"}}.value'


def _build_series(views: Views, panel: ViewPanel) -> list[Config]:
    return [
        _build_path(k, label, message_path(views, place))
        for k, (label, place) in enumerate(list_series(views, panel))
    ]


def _build_path(index: int, label: str, path: str) -> Config:
    return {
        'value': path,
        'label': label,
        'enabled': True,
        'timestampMethod': 'receiveTime',
        'color': COLOURS.get(label, OTHERS[index % len(OTHERS)]),
        'showLine': True,
        'lineSize': 1.5,
    }


def _build_plot(views: Views, panel: ViewPanel) -> Config:
    return {
        'paths': _build_series(views, panel),
        'isSynced': True,
        'xAxisVal': 'timestamp',
        'showLegend': True,
        'legendDisplay': 'floating',
        'showPlotValuesInLegend': False,
        'showXAxisLabels': True,
        'showYAxisLabels': True,
        'timeWindowMode': 'automatic',
        'followingViewWidth': WINDOW,
    }


def _build_states(views: Views, panel: ViewPanel) -> Config:
    keys = ('value', 'label', 'enabled', 'timestampMethod')
    paths = [{key: item[key] for key in keys} for item in _build_series(views, panel)]
    return {'isSynced': True, 'paths': paths}


def _build_scene(views: Views, panel: ViewPanel) -> Config:
    return {
        'cameraState': CAMERA,
        'followMode': 'follow-none',
        'followTf': panel.scene,
        'scene': {'transforms': {'showLabel': False, 'axisSize': 0.2, 'lineWidth': 0.0}},
        # In a bag the markers of the room; of a live view the whole scene, in a message of its own
        'topics': {views.absolute_topic('scene'): {'visible': True}},
        'layers': {'grid': _build_grid(str(panel.scene), 10.0), 'urdf': _build_urdf(views)},
    }


def _build_grid(frame: str, size: float) -> Config:
    return {
        'visible': True,
        'layerId': 'foxglove.Grid',
        'instanceId': 'grid',
        'label': 'Grid',
        'frameId': frame,
        'size': size,
        'divisions': size,
        'lineWidth': 1.0,
        'color': '#7f7f7f55',  # the last two digits are the opacity
        'position': [0.0, 0.0, 0.0],
        'rotation': [0.0, 0.0, 0.0],
    }


def _build_urdf(views: Views) -> Config:
    """Return the drone of a bag; Foxglove finds only a topic without namespace by itself."""
    return {
        'visible': True,
        'layerId': 'foxglove.Urdf',
        'instanceId': 'urdf',
        'label': 'Drone',
        'sourceType': 'topic',
        'topic': views.absolute_topic('robot_description'),
        'framePrefix': '',
    }


def _build_block(views: Views, panel: ViewPanel) -> Config:
    """Return a plot of all counts of the newest block over their place in it."""
    config = _build_plot(views, panel)
    path = f'{views.absolute_topic(str(panel.block))}.counts[:]'
    return config | {'paths': [_build_path(0, 'counts', path)], 'xAxisVal': 'index'}


def _build_health(views: Views, panel: ViewPanel) -> Config:
    return {
        'topicToRender': views.absolute_topic(str(panel.health)),
        'minLevel': 0,
        'pinnedIds': [],
        'hardwareIdFilter': views.robot,
        'sortByLevel': True,
    }


PANELS: dict[str, tuple[str, Callable[[Views, ViewPanel], Config]]] = {  # by kind: Foxglove's type
    'plot': ('Plot', _build_plot),
    'states': ('StateTransitions', _build_states),
    'scene': ('3D', _build_scene),
    'block': ('Plot', _build_block),
    'health': ('DiagnosticSummary', _build_health),
}


def split_layout(direction: str, items: Sequence[tuple[Any, float]]) -> Any:  # noqa: ANN401 - JSON
    """Return a nested split of items, each with its share of the space."""
    (first, share), *rest = items
    if not rest:
        return first
    return {
        'direction': direction,
        'first': first,
        'second': split_layout(direction, rest),
        # Foxglove splits in two only, so the rest is nested in the second part
        'splitPercentage': round(100.0 * share / sum(part for _, part in items), 3),
    }


def build_foxglove_layout(views: Views) -> str:
    """Return the layout as JSON text."""
    configs: dict[str, Config] = {}
    tabs = []
    for tab, columns in views.tabs.items():
        parts = []
        for i, column in enumerate(columns):
            pile = []
            for k, panel in enumerate(column):
                kind, configured = PANELS[panel.kind]
                # Foxglove's ids have the form TYPE!ID
                name = f'{kind}!{tab.lower()}{i}{k}'
                title = {'foxglovePanelTitle': panel.title}
                configs[name] = title | configured(views, panel)
                pile.append((name, panel.share))
            parts.append((split_layout('column', pile), 1.0))
        tabs.append({'title': tab, 'layout': split_layout('row', parts)})
    configs['Tab!lta'] = {'activeTabIdx': 0, 'tabs': tabs}
    whole = {
        'configById': configs,
        'globalVariables': {},
        'userNodes': {},
        'playbackConfig': {'speed': 1},
        'layout': 'Tab!lta',
    }
    return json.dumps(whole, indent=1) + '\n'
