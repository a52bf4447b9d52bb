"""
Serialize messages to CDR again, by rosbags, with the bytes of `lta_graph.cdr_encoder`.

rosbags writes zeros as padding, where the middleware leaves uninitialized memory.
"""

from lta_bridge.bag.schemas import load_jazzy_types


def reencode_cdr(data: bytes, type_name: str) -> bytes:
    """
    Return CDR as `lta_graph.cdr_encoder.encode_cdr` writes it.

    Raises
    ------
    SerdeError
        If the data are no message of the type.

    """
    types = load_jazzy_types()
    message = types.deserialize_cdr(data, type_name)
    fresh = types.serialize_cdr(message, type_name, little_endian=True)
    return bytes(fresh) + bytes(-len(fresh) % 4)
