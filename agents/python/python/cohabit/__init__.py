"""People and robots in a simulated office: join a session, read its frames in place, train in lock-step.

- :class:`Env` and :class:`ParallelEnv` play missions in lock-step, in this process; :class:`VectorEnv` many at once.
- :func:`suite` and :func:`generate` have missions by the thousand; :func:`evaluate` scores a policy on them, and
  :func:`sample_actions` is one that does what may be tried, by chance.
- :func:`tools` describes what a body can do to language models.
- :func:`join` joins a running session.
- :func:`steps` tells a recorded session step by step, and :func:`rerun` goes on from one of them otherwise.
"""

from __future__ import annotations

import gymnasium as _gymnasium

from . import _pickling as _pickling
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
from ._native import builtin_missions as _builtin_missions
from ._native import class_ids as _class_ids
from .actions import Action, Drive, GoTo, Highlight, Interact, Look, LookAround, Move, PickUp, Place, Rotate, Stop
from .body_tools import Tools, tools
from .env import Env
from .evaluation import Evaluation, evaluate
from .missions import Mission, Suite, generate, suite
from .parallel import ParallelEnv
from .recorded import rerun, steps
from .records import records
from .sensing import CHOICES, PLANES, sample_actions
from .session import Session, join
from .vector import VectorEnv

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
    "Evaluation",
    "Frame",
    "GoTo",
    "Goal",
    "Heard",
    "Highlight",
    "Interact",
    "Look",
    "LookAround",
    "Mission",
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
    "Suite",
    "Tools",
    "VectorEnv",
    "evaluate",
    "generate",
    "join",
    "records",
    "rerun",
    "sample_actions",
    "steps",
    "suite",
    "tools",
]



def _register(name: str, **arguments: object) -> None:
    entry, vector = "cohabit.env:Env", "cohabit.vector:VectorEnv"
    _gymnasium.register(f"Cohabit/{name}-v0", entry_point=entry, vector_entry_point=vector, kwargs=dict(arguments))


_register("Mission")
_register("MissionState", planes=())
for _mission in _builtin_missions():
    # Such as `Cohabit/MakeCereal-v0`.
    _register("".join(word.capitalize() for word in _mission.split("_")), mission=_mission)
