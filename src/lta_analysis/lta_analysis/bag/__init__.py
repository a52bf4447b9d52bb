"""Reading recordings: bags as they are on the disk, and flights as aligned arrays."""

from lta_analysis.bag.flight import Flight, open_flight
from lta_analysis.bag.info import bag_info, BagInfo
from lta_analysis.bag.reader import Bag, read_bag

__all__ = ['Bag', 'BagInfo', 'Flight', 'bag_info', 'open_flight', 'read_bag']
