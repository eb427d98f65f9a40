"""Numbers for the browser: a head in JSON that says where each array lies in the bytes behind it.

Layout: length of the head as a 32-bit number, the head, then the arrays, all little-endian; each
begins at a multiple of eight bytes from the start, so that typed arrays of JavaScript can lie on
them without a copy.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

_ALIGNED = 8  # [byte]
_LENGTH_BYTES = 4
_KINDS = {"f4": "Float32Array", "f8": "Float64Array", "u4": "Uint32Array", "u1": "Uint8Array"}


def pack(head: Mapping[str, Any], arrays: Mapping[str, npt.NDArray[Any]]) -> bytes:
    """Put a head and arrays (of float32, float64, uint32 or uint8) into one message."""
    parts: list[bytes] = []
    places: dict[str, tuple[str, int, int]] = {}
    offset = 0
    for name, values in arrays.items():
        flat = np.ascontiguousarray(values).ravel()
        data = flat.astype(flat.dtype.newbyteorder("<"), copy=False).tobytes()
        places[name] = (_KINDS[flat.dtype.str[1:]], offset, flat.size)
        data += bytes(-len(data) % _ALIGNED)
        parts.append(data)
        offset += len(data)
    text = json.dumps({**head, "arrays": places}, allow_nan=False).encode()
    text += b" " * (-(_LENGTH_BYTES + len(text)) % _ALIGNED)
    return b"".join((len(text).to_bytes(_LENGTH_BYTES, "little"), text, *parts))
