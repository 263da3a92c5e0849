"""Has worlds and states of this process be pickled and copied: they go on as the original would have."""

from __future__ import annotations

import copyreg
from typing import Any

from . import _native


def _stage(made_of: tuple[Any, ...], moment: tuple[Any, ...]) -> _native.Stage:
    stage = _native.Stage(*made_of)
    stage.load(*moment)
    return stage


def _reduce_stage(stage: _native.Stage) -> tuple[Any, ...]:
    return _stage, (stage.made_of(), stage.save())


def _reduce_state(state: _native.State) -> tuple[Any, ...]:
    return _state, (state.payload(), state.tick, state.world)


def _state(payload: bytes, tick: int, world: list[str]) -> _native.State:
    return _native.State.of_payload(payload, tick, world)


copyreg.pickle(_native.Stage, _reduce_stage)
copyreg.pickle(_native.State, _reduce_state)
