"""The part of LTA that knows rclpy, shared by all nodes."""
