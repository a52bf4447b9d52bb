"""The motion of a vehicle as compiled code: one vehicle, many on a CPU, many on a GPU."""
