"""People and robots in a simulated office: join a session, read its frames in place, train in lock-step.

- :class:`Env` and :class:`ParallelEnv` play missions in lock-step, in this process.
- :func:`join` joins a running session.
"""

from __future__ import annotations

import gymnasium as _gymnasium

from ._native import (
    FLAGS,
    ROOMS,
    STATUSES,
    VERBS,
    VERSION,
    Body,
    Command,
    Error,
    Frame,
    Goal,
    Heard,
    Object,
    Outcome,
    Seen,
    State,
)
from ._native import class_ids as _class_ids
from .actions import Action, Drive, GoTo, Highlight, Interact, Look, LookAround, Move, PickUp, Place, Rotate, Stop
from .env import Env
from .office import CHOICES, PLANES
from .parallel import ParallelEnv
from .records import records
from .session import Session, join

__version__ = VERSION

CLASSES: tuple[str, ...] = tuple(_class_ids())
"""The ids of all classes of objects, by their numbers."""

__all__ = [
    "CHOICES",
    "CLASSES",
    "FLAGS",
    "PLANES",
    "ROOMS",
    "STATUSES",
    "VERBS",
    "Action",
    "Body",
    "Command",
    "Drive",
    "Env",
    "Error",
    "Frame",
    "GoTo",
    "Goal",
    "Heard",
    "Highlight",
    "Interact",
    "Look",
    "LookAround",
    "Move",
    "Object",
    "Outcome",
    "ParallelEnv",
    "PickUp",
    "Place",
    "Rotate",
    "Seen",
    "Session",
    "State",
    "Stop",
    "join",
    "records",
]

_gymnasium.register("Cohabit/Mission-v0", entry_point="cohabit.env:Env")
_gymnasium.register("Cohabit/MissionState-v0", entry_point="cohabit.env:Env", kwargs={"planes": ()})
