"""Only the bag of a flight that never began is removed."""

from types import SimpleNamespace

from lta_bridge.bag.writer import BagWriter
from lta_config.command_line import format_lta_command
from lta_flight.flight import remove_unflown_bags, report_interrupted_flight
import pytest

EMPTY = bytes.fromhex('00010000') + bytes(64)


def write_bag(folder, **counts):
    with BagWriter(folder, {}) as bag:
        for name, kind in (
            ('/diagnostics', 'diagnostic_msgs/msg/DiagnosticArray'),
            ('/lta1/odom', 'nav_msgs/msg/Odometry'),
        ):
            bag.add_topic(name, kind, [])
            for k in range(counts.get(name.rpartition('/')[2], 0)):
                bag.write(name, EMPTY, k)
    return folder


@pytest.mark.parametrize(
    ('counts', 'stays'),
    [({}, False), ({'diagnostics': 3}, False), ({'odom': 1}, True)],
)
def test_a_bag_stays_if_a_robot_has_sent_a_message(counts, stays, tmp_path):
    bag = write_bag(tmp_path / 'bag', **counts)
    remove_unflown_bags([bag])
    assert bag.exists() == stays


def test_what_is_no_bag_stays_unless_it_is_an_empty_folder(tmp_path):
    file, folder, empty = tmp_path / 'file', tmp_path / 'folder', tmp_path / 'empty'
    file.touch()
    folder.mkdir()
    (folder / 'notes.txt').touch()
    empty.mkdir()
    remove_unflown_bags([file, folder, empty, tmp_path / 'missing'])
    assert sorted(path.name for path in tmp_path.iterdir()) == ['file', 'folder']


@pytest.mark.parametrize('new', [True, False])
def test_an_interrupted_flight_keeps_the_folder_of_the_user(new, tmp_path):
    """Before the flight has begun there is no bag, and nothing to show."""
    folder = tmp_path / 'flight'
    folder.mkdir()
    said = []
    report_interrupted_flight(folder, SimpleNamespace(show_message=said.append), new=new)
    assert folder.exists() != new
    assert said == []


def test_an_interrupted_flight_names_its_bag_and_the_command_for_its_page(tmp_path):
    bag, said = write_bag(tmp_path / 'bag', odom=1), []
    report_interrupted_flight(tmp_path, SimpleNamespace(show_message=said.append), new=True)
    assert said == [f'Bag  {bag}  (its page: {format_lta_command("report", bag)})']
    assert bag.exists()
