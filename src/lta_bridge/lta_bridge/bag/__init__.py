"""Writing recordings: rosbag2 folders with MCAP that stay readable whatever happens."""

from lta_bridge.bag.qos import offered_qos, Profile
from lta_bridge.bag.storage import free_space, StorageFault
from lta_bridge.bag.writer import BagWriter

__all__ = ['BagWriter', 'Profile', 'StorageFault', 'free_space', 'offered_qos']
