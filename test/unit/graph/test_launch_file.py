"""Every construct of the launch files, with the values that ROS 2's own launch would give."""

from pathlib import Path

from lta_config.errors import BadInput
from lta_graph.launch_file import list_arguments, load_plan
from lta_graph.launch_node import format_ros_yaml
from lta_graph.launch_substitutions import expand_substitutions, LaunchContext, split_command_line
import pytest
import yaml


@pytest.fixture
def write(tmp_path):
    def write(text: str, name: str = 'a.launch.yaml') -> Path:
        path = tmp_path / name
        path.write_text(text, encoding='utf-8')
        return path

    return write


def plan_of(path: Path, **given: str):
    return load_plan(path, given).processes


def node_arguments(write, *lines: str, **given: str) -> tuple[str, ...]:
    """Return what follows --ros-args for a node with these further lines."""
    body = ''.join(f'      {line}\n' for line in lines)
    declared = ''.join(f'  - arg: {{name: {name}}}\n' for name in given)
    text = f'launch:\n{declared}  - node:\n      pkg: p\n      exec: e\n      name: n\n{body}'
    ((process,),) = (plan_of(write(text), **given),)
    assert process.arguments[:3] == ('--ros-args', '-r', '__node:=n')
    return process.arguments[3:]


def test_a_node_becomes_a_command_line_in_the_order_of_ros(write):
    path = write("""
launch:
- arg: {name: who, default: a b}
- push_ros_namespace: {namespace: lta1}
- node:
    pkg: lta_sim
    exec: simulator
    name: sim
    args: --verbose  $(dirname)/x $(var who)
    param:
    - {name: seed, value: 7}
    - {from: $(dirname)/a.launch.yaml}
    output: screen
    on_exit: shutdown
    sigterm_timeout: 2.5
""")
    (process,) = plan_of(path)
    assert (process.package, process.executable) == ('lta_sim', 'simulator')
    assert (process.name, process.namespace, process.on_exit_shutdown) == ('sim', '/lta1', True)
    assert process.sigterm_timeout == 2.5
    assert process.arguments == (
        *('--verbose', f'{path.parent}/x', 'a b'),
        *('--ros-args', '-r', '__node:=sim', '-r', '__ns:=/lta1'),
        *('-p', 'seed:=7', '--params-file', str(path)),
    )


def test_a_bare_node_gets_its_name_alone(write):
    (process,) = plan_of(write('launch: [node: {pkg: p, exec: e, name: n}]'))
    assert (process.name, process.namespace) == ('n', '/')
    assert process.arguments == ('--ros-args', '-r', '__node:=n')
    assert (process.on_exit_shutdown, process.planned) == (False, True)


def test_supervise_says_whose_end_is_planned_also_in_an_include(write):
    nodes = [f'node: {{pkg: p, exec: e, name: {name}}}' for name in ('sim', 'board', 'other')]
    write(f'launch: [supervise: {{planned: sim player}}, {nodes[0]}]', 'inner.launch.yaml')
    outer = write(
        'launch: [supervise: {planned: board}, '
        f'{nodes[1]}, {nodes[2]}, include: {{file: $(dirname)/inner.launch.yaml}}]'
    )
    assert {item.name: item.planned for item in plan_of(outer)} == {
        'board': True,
        'other': False,
        'sim': True,
    }


def test_one_process_runs_all_nodes_but_those_apart_and_gets_the_arguments(write):
    nodes = ', '.join(
        f'node: {{pkg: p, exec: e, name: {name}, on_exit: shutdown, sigterm_timeout: {wait}}}'
        for name, wait in (('sim', 1.0), ('bridge', 9.0), ('log', 3.0))
    )
    path = write(
        'launch: [arg: {name: n, default: many}, '
        f'supervise: {{planned: sim, processes: $(var n), apart: bridge}}, {nodes}]'
    )
    many, one = (load_plan(path, {'n': name}) for name in ('many', 'one'))
    assert [many.list_nodes(each) for each in many.started] == [['sim'], ['bridge'], ['log']]
    assert [one.list_nodes(each) for each in one.started] == [['sim', 'log'], ['bridge']]
    common = one.started[0]
    assert (common.package, common.executable) == ('lta_graph', 'one_process')
    assert common.arguments == (str(path), 'n:=one')
    assert (common.on_exit_shutdown, common.sigterm_timeout) == (True, 3.0)


@pytest.mark.parametrize(
    ('value', 'expected'),
    [
        ('7', 'x:=7'),
        ('7.0', 'x:=7.0'),
        ('1.0e-5', 'x:=1e-05'),
        ('true', 'x:=true'),
        ('.inf', 'x:=.inf'),
        ('-.inf', 'x:=-.inf'),
        ('bag', 'x:="bag"'),
        ('"7"', 'x:="7"'),  # text as written stays text ...
        ('"true"', 'x:="true"'),
        ('""', 'x:=""'),
        ('$(var n)', 'x:=7'),  # ... but what a substitution gives is read as YAML
        ('$(var f)', 'x:=0.5'),
        ('$(var b)', 'x:=true'),
        ('$(var t)', 'x:="a b"'),
        ('$(var n)$(var n)', 'x:=77'),
        ('n$(var n)', 'x:="n7"'),
        ('"[$(var n), 8]"', None),
    ],
)
def test_parameters_have_the_types_of_ros(write, value, expected):
    given = {'n': '7', 'f': '0.5', 'b': 'true', 't': 'a b'}

    def found():
        return node_arguments(write, 'param:', f'- {{name: x, value: {value}}}', **given)

    if expected is None:
        with pytest.raises(BadInput, match=r'The parameter x is \[7, 8\], but must be'):
            found()
    else:
        assert found() == ('-p', expected)


@pytest.mark.parametrize(
    ('kind', 'text', 'expected'),
    [('str', '7', '"7"'), ('float', '7', '7.0')],
)
def test_a_type_rules_what_a_substitution_gives(write, kind, text, expected):
    line = f'- {{name: x, value: $(var v), type: {kind}}}'
    assert node_arguments(write, 'param:', line, v=text) == ('-p', f'x:={expected}')


@pytest.mark.parametrize(
    ('kind', 'value'), [('float', 'fast'), ('str', '1'), ('float', '1'), ('float', '$(var v)')]
)
def test_a_value_of_another_type_is_refused(write, kind, value):
    line = f'- {{name: x, value: {value}, type: {kind}}}'
    with pytest.raises(BadInput, match=f'The parameter x is .* but must be of type {kind}'):
        node_arguments(write, 'param:', line, v='seven')


def test_nested_parameters_get_dotted_names(write):
    found = node_arguments(
        write,
        'param:',
        '- name: gains',
        '  param:',
        '  - {name: kp, value: 1.5}',
        '  - name: yaw',
        '    param: [{name: $(var v), value: 2}]',
        v='ki',
    )
    assert found == ('-p', 'gains.kp:=1.5', '-p', 'gains.yaw.ki:=2')


@pytest.mark.parametrize(
    'value',
    ['y', 'nan', 'a: b', '# no', '"q"', "it's", '\\', '{}', 'ä\n', ' ', '5', True, -3, 1e300, 0.1],
)
def test_yaml_for_ros_reads_back_as_it_was(value):
    read = yaml.safe_load(format_ros_yaml([value, value]))
    # PyYAML wants a dot in a float; ROS's parser and JSON do not.
    read = [float(item) if isinstance(value, float) else item for item in read]
    assert read == [value, value]
    assert type(read[0]) is type(value)


def test_arguments_have_defaults_and_choices(write):
    path = write("""
launch:
- arg: {name: world, description: Where to fly.}
- arg: {name: strategy, default: bag, choice: [{value: bag}, {value: des}]}
- arg: {name: robot, default: "$(var world)_$(var strategy)"}
- node: {pkg: p, exec: e, name: $(var robot)}
""")
    found = list_arguments(path)
    assert [(item.name, item.description, item.default, item.choices) for item in found] == [
        ('world', 'Where to fly.', None, ()),
        ('strategy', '', 'bag', ('bag', 'des')),
        ('robot', '', '$(var world)_$(var strategy)', ()),
    ]
    assert plan_of(path, world='room')[0].name == 'room_bag'
    assert plan_of(path, world='room', strategy='des')[0].name == 'room_des'
    assert plan_of(path, world='room', robot='lta2')[0].name == 'lta2'
    for given, message in [
        ({}, r"'world' \(Where to fly\) is missing; give world:=VALUE\."),
        ({'world': 'a', 'strategy': 'up'}, r"'strategy' is 'up', but must be one of bag, des\."),
        ({'world': 'a', 'strateg': 'bag'}, r"Unknown launch argument 'strateg'; known: robot, s"),
    ]:
        with pytest.raises(BadInput, match=message) as caught:
            load_plan(path, given)
        assert str(caught.value).startswith(f'{path}: ')


def test_scopes_end_with_their_group(write):
    path = write("""
launch:
- let: {name: n, value: a}
- group:
  - push_ros_namespace: {namespace: r1}
  - let: {name: n, value: b}
  - node: {pkg: p, exec: e, name: $(var n)}
  - group:
    - push_ros_namespace: {namespace: sub}
    - node: {pkg: p, exec: e, name: c}
    - push_ros_namespace: {namespace: /absolute}
    - node: {pkg: p, exec: e, name: d}
- node: {pkg: p, exec: e, name: $(var n)}
""")
    found = [(item.name, item.namespace) for item in plan_of(path)]
    assert found == [('b', '/r1'), ('c', '/r1/sub'), ('d', '/absolute'), ('a', '/')]
    assert '__ns:=/r1/sub' in plan_of(path)[1].arguments


def test_of_several_namespaces_a_process_is_called_by_its_own(write):
    first, second = (f'node: {{pkg: p, exec: x, name: {name}}}' for name in 'ef')
    scoped = f'group: [push_ros_namespace: {{namespace: r1/sub}}, {second}]'
    both = load_plan(write(f'launch: [{first}, {scoped}]'), {})
    assert both.namespaces == ['', 'r1/sub']
    assert [both.label(process) for process in both.processes] == ['e', 'r1/sub/f']
    one = load_plan(write(f'launch: [{scoped}]'), {})
    assert [one.label(process) for process in one.processes] == ['f']


@pytest.mark.parametrize('word', ['true', 'True', '1', 'false', 'FALSE', '0'])
def test_conditions(write, word):
    path = write("""
launch:
- arg: {name: fly}
- let: {name: n, value: unset}
- let: {name: n, value: set, if: $(var fly)}
- node: {pkg: p, exec: e, name: yes_node, if: $(var fly)}
- node: {pkg: p, exec: e, name: no_node, unless: $(var fly)}
- node: {pkg: p, exec: e, name: $(var n)}
""")
    names = [item.name for item in plan_of(path, fly=word)]
    if word.lower() in ('true', '1'):
        assert names == ['yes_node', 'set']
    else:
        assert names == ['no_node', 'unset']


def test_a_condition_must_be_a_truth_value(write):
    path = write('launch: [arg: {name: fly}, node: {pkg: p, exec: e, name: n, if: $(var fly)}]')
    with pytest.raises(BadInput, match=r"'\$\(var fly\)' is 'maybe', but must be true or false"):
        plan_of(path, fly='maybe')
    with pytest.raises(BadInput, match='has both "if" and "unless"'):
        plan_of(write('launch: [node: {pkg: p, exec: e, name: n, if: "1", unless: "0"}]'))


def test_an_include_has_its_own_folder_and_shares_variables_as_in_ros(write, tmp_path):
    (tmp_path / 'sub').mkdir()
    inner = """
launch:
- arg: {name: robot}
- arg: {name: speed, default: "1"}
- let: {name: left, value: behind}
- node: {pkg: p, exec: e, name: $(var robot), args: $(dirname) $(var speed)}
"""
    write(inner, 'sub/inner.launch.yaml')
    outer = """
launch:
- let: {name: speed, value: "2"}
- group:
  - include: {file: $(dirname)/sub/inner.launch.yaml, arg: [{name: robot, value: one}]}
- include: {file: $(dirname)/sub/inner.launch.yaml, arg: [{name: robot, value: two}]}
- node: {pkg: p, exec: e, name: $(var left), args: $(dirname)}
"""
    first, second, third = plan_of(write(outer))
    assert first.name == 'one'
    assert second.name == 'two'
    assert first.arguments[:2] == (f'{tmp_path}/sub', '2')
    assert third.name == 'behind'
    assert third.arguments[0] == str(tmp_path)


def test_errors_in_includes_name_both_ends(write, tmp_path):
    inner = write('launch: [node: {pkg: p, exe: e}]', 'inner.launch.yaml')
    outer = write(f'launch: [include: {{file: {inner}}}]')
    with pytest.raises(BadInput, match=r"inner\.launch\.yaml: node: the key 'exec' is missing"):
        plan_of(outer)
    write('launch: [arg: {name: x}, arg: {name: y, default: "1"}]', 'inner.launch.yaml')
    with pytest.raises(BadInput, match=r"inner\.launch\.yaml: The launch argument 'x' is missing"):
        plan_of(outer)
    outer = write(f'launch: [include: {{file: {inner}, arg: [{{name: z, value: "1"}}]}}]')
    with pytest.raises(BadInput, match=r"Unknown launch argument 'z'; known: x, y\."):
        plan_of(outer)
    with pytest.raises(BadInput, match=r'a\.launch\.yaml: There is no launch file /no/x\.launch'):
        plan_of(write('launch: [include: {file: /no/x.launch.yaml}]'))
    with pytest.raises(BadInput, match=r'includes itself; remove the include\.$'):
        plan_of(write('launch: [include: {file: $(dirname)/a.launch.yaml}]'))


@pytest.mark.parametrize(
    ('text', 'message'),
    [
        ('launch: [', 'is not valid YAML'),
        ('nodes: []', "its only key must be 'launch:'"),
        ('launch: {node: {pkg: p, exec: e}}', 'actions must be a list'),
        ('launch: [node]', "the action 'node' must have exactly one name"),
        (
            'launch: [{node: {pkg: p, exec: e}, let: {name: a, value: b}}]',
            'must have exactly one name',
        ),
        ('launch: [executable: {cmd: ls}]', "The action 'executable' is unknown to lta launch"),
        ('launch: [node: {pkg: p, name: n}]', "node: the key 'exec' is missing; add it"),
        (
            'launch: [node: {pkg: p, exec: e, name: n, cwd: /}]',
            "node: The key 'cwd' is unknown to lta launch; .*if ROS 2 has it",
        ),
        ('launch: [node: {pkg: p, exec: e, name: n, respawn: true}]', "The key 'respawn' is unkn"),
        ('launch: [group: {if: "0", children: []}]', 'group: children must be a list'),
        ('launch: [node: {pkg: p, exec: e, name: n, on_exit: restart}]', "on_exit is 'restart'"),
        ('launch: [node: {pkg: p, exec: e, name: a-b}]', "'a-b' is not a valid node name"),
        ('launch: [push_ros_namespace: {namespace: 1a}]', "'/1a' is not a valid namespace"),
        (
            'launch: [node: {pkg: p, exec: e, name: n, param: []}]',
            'param must have 1 or more entries',
        ),
        (
            'launch: [node: {pkg: p, exec: e, name: n, param: [{name: x}]}]',
            r'either "from" \(a parameter',
        ),
        ('launch: [node: {pkg: p, exec: e, name: n, param: [{value: 1}]}]', 'needs either "from"'),
        ('launch: [node: {pkg: p, exec: e, name: n, param: [{name: x, value: [1]}]}]', 'value'),
        (
            'launch: [node: {pkg: p, exec: e, name: n, param: [{from: /no/x}]}]',
            'no parameter file /no/x',
        ),
        (
            'launch: [node: {pkg: p, exec: e, name: n, args: "a \'b\'"}]',
            'has a quote, which lta launch',
        ),
        ('launch: [arg: {name: x, default: 5}]', "default is 5 without quotes.*write '5'"),
        ('launch: [let: {name: x, value: true}]', 'value is True without quotes'),
        (
            'launch: [arg: {name: x, default: a, choice: [{value: b}]}]',
            "'x' is 'a', but must be one of b",
        ),
        ('launch: [group: [arg: {name: x}]]', "an 'arg' is in a group"),
        ('launch: [group: [nod: {}]]', "The action 'nod' is unknown"),
        (
            'launch: [let: {name: x, value: $(var y)}]',
            r"Unknown launch variable 'y'; known: none\.",
        ),
        (
            'launch: [let: {name: x, value: $(eval 1)}]',
            r"'\$\(eval 1\)' has a substitution or a b",
        ),
        ('launch: [let: {name: x, value: "$(var y"}]', 'that lta launch does not support'),
        ('launch: [let: {name: x, value: $(var $(var y))}]', 'that lta launch does not support'),
        ('launch: [let: {name: x, value: a\\b}]', 'that lta launch does not support'),
        ('launch: [let: {name: x, value: "$(find-pkg-share nope)"}]', "ackage 'nope'"),
        ('launch: [let: {name: x, name: y, value: z}]', "the key 'name' appears twice"),
    ],
)
def test_bad_files_get_one_sentence(write, text, message):
    path = write(text)
    with pytest.raises(BadInput, match=message) as caught:
        plan_of(path)
    sentence = str(caught.value)
    assert sentence.startswith(str(path))
    assert '\n' not in sentence
    assert sentence.endswith('.')


def test_files_that_are_no_launch_files(write, tmp_path):
    with pytest.raises(BadInput, match=r'^There is no launch file .*none\.launch\.yaml; check'):
        load_plan(tmp_path / 'none.launch.yaml', {})
    with pytest.raises(BadInput, match='lta runs only YAML launch files'):
        load_plan(write('', 'fly.launch.py'), {})


def test_substitutions(monkeypatch, tmp_path):
    markers = tmp_path / 'share/ament_index/resource_index/packages'
    markers.mkdir(parents=True)
    (markers / 'lta_config').touch()
    monkeypatch.setenv('AMENT_PREFIX_PATH', f'/nowhere:{tmp_path}')
    context = LaunchContext(tmp_path, {'p': '$(var q)', 'q': r'\\', 's': 'two words'})

    def made(text: str) -> str:
        return expand_substitutions(text, context)

    assert made('$(find-pkg-share lta_config)/x') == f'{tmp_path}/share/lta_config/x'
    # What a variable holds is not read again
    assert made('a$(var p)b$(var q)') == r'a$(var q)b\\'
    assert made('$(dirname)/y') == f'{tmp_path}/y'
    assert made("it's 5 $ and (x)") == "it's 5 $ and (x)"
    assert split_command_line(' a  $(var s)/b ', context) == ['a', 'two words/b']
    assert split_command_line('', context) == []


@pytest.mark.parametrize('value', ['2024-13-45', '[' * 200_000, '!!int ""', 'a: [', '*x', ''])
def test_what_a_launch_argument_makes_no_value_of_stays_a_text(write, value):
    given = {'given': value}
    if not value:
        with pytest.raises(BadInput, match='must be a number, true, false or text'):
            node_arguments(write, 'param: [{name: x, value: $(var given)}]', **given)
        return
    words = node_arguments(write, 'param: [{name: x, value: $(var given)}]', **given)
    assert words == ('-p', f'x:={format_ros_yaml(value)}')
