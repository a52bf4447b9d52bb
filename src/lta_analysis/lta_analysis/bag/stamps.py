"""When a message was measured, as it says itself."""


def stamp_of(message: object) -> int | None:
    """
    Return the stamp of a message. [ns]

    Parameters
    ----------
    message : object
        Decoded message.

    Returns
    -------
    int or None
        From its header, its first transform or its clock; None where it has none, or where
        nobody filled it in (zero).

    """
    transforms = getattr(message, 'transforms', None)
    stamped = transforms[0] if transforms else message
    header = getattr(stamped, 'header', None)
    time = getattr(stamped, 'clock', None) if header is None else header.stamp
    if time is None:
        return None
    nanoseconds = int(time.sec) * 1_000_000_000 + int(time.nanosec)
    return nanoseconds or None
