"""ROS nodes of lta_control."""

from lta_graph.interrupts import exit_at_once_on_interrupt

exit_at_once_on_interrupt(__name__)
