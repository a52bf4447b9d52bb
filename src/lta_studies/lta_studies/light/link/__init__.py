"""Link budget from a lamp to the photodiodes: illuminance and SNR by distance."""
