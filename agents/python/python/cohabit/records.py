"""The state as structured arrays: one row a record, as it was published, without a copy."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import _native

NONE = 0xFFFF_FFFF
"""Stands for "no object" and "no body" in records."""

DTYPES: dict[str, np.dtype[Any]] = {
    "bodies": np.dtype(
        [
            ("body", "<u4"),
            ("room", "<u4"),
            ("held", "<u4"),
            ("busy", "<u4"),
            ("kind", "<u4"),
            ("flags", "<u4"),
            ("command", "<u8"),
            ("commander", "<u8"),
            ("position_m", "<f4", 3),
            ("yaw_rad", "<f4"),
            ("head_pitch_rad", "<f4"),
            ("eye_m", "<f4", 3),
        ]
    ),
    "objects": np.dtype(
        [
            ("object", "<u4"),
            ("flags", "<u4"),
            ("class", "<u2"),
            ("room", "u1"),
            ("color", "u1"),
            ("fluid", "u1"),
            ("hidden", "u1"),
            ("in_mission", "u1"),
            ("reserved", "u1"),
            ("parent", "<u4"),
            ("held_by", "<u4"),
            ("works", "<u4"),
            ("position_m", "<f4", 3),
            ("rotation", "<f4", 4),
            ("instance_bytes", "<u2"),
            ("instance", "S62"),
        ]
    ),
    "goals": np.dtype(
        [("number", "<i8"), ("met", "<u4"), ("hidden", "<u4"), ("description_bytes", "<u2"), ("description", "S238")]
    ),
}
"""What a row of each list is. ``class`` is an index into ``CLASSES``, ``room`` into ``ROOMS``."""


def records(state: _native.State, name: str) -> npt.NDArray[Any]:
    """The ``bodies``, ``objects`` or ``goals`` of a state as a read-only structured array."""
    size, plain = state.records(name)
    kind = DTYPES[name]
    if kind.itemsize != size:
        raise _native.Error(f"a record of `{name}` has {size} bytes, and this package knows {kind.itemsize}")
    return plain.view(kind)
