"""Reading recordings: bags as they are on the disk, and flights as aligned arrays."""

from lta_data.bag.flight import Flight, open_flight
from lta_data.bag.info import bag_info, BagInfo
from lta_data.bag.reader import Bag, read_bag

__all__ = ['Bag', 'BagInfo', 'Flight', 'bag_info', 'open_flight', 'read_bag']
