"""A running session, joined as one of its bodies."""

from __future__ import annotations

import threading
import time
import weakref
from collections.abc import Iterator
from types import TracebackType
from typing import Optional

from . import _native
from .actions import Action

_ANSWER_S = 5.0
"""How long a claim may take to be answered."""

_LONG_TICKS = 60 * 240
"""Longer than any command takes."""


_TAKEN_OVER_S = 5.0
"""How long another thread may take to begin to play a body that this thread played."""

_JOINED: weakref.WeakSet[Session] = weakref.WeakSet()
"""The sessions of this process."""


class Session:
    """A session of this machine, as one body takes part in it.

    Everything that waits lets other threads run, and ends at Ctrl-C. Frames come in shared memory: their planes are
    read-only arrays over what the simulator rendered, and nothing is copied.
    """

    def __init__(self, name: str, body: int = 0, take_over: bool = False, timeout: float = 5.0) -> None:
        self.body = body
        self.peer = _native.Session(name, body, timeout)
        last = len(self.peer.state(timeout).bodies) - 1
        if body > last:
            adds = "`cohabit play --body robot` adds one"
            raise ValueError(f"session `{name}` has no body {body}: it has bodies 0 to {last}; {adds}")
        self.take_over = take_over
        self._claimed = False
        self._attends = False
        self._turn_of: Optional[int] = None
        """The thread whose turn it is, which the world waits for."""
        _JOINED.add(self)

    def state(self, timeout: float = 5.0) -> _native.State:
        """The world as it is now: bodies, objects, goals. Waits for the first state, at most ``timeout`` seconds."""
        return self.peer.state(timeout)

    def look(self, camera: Optional[str] = None, timeout: float = 5.0) -> _native.Frame:
        """The newest frame of a camera that was not handed out yet; waits for one, at most ``timeout`` seconds.

        Left out, the camera is the body's own eyes. A camera is rendered while somebody looks through it: from the first
        call until :meth:`close`. Eight of a camera's frames can be held at once, by their arrays too; ``frame.color.copy()``
        holds none.
        """
        return self.peer.look(camera or f"egocentric/{self.body}", timeout)

    def frames(self, camera: Optional[str] = None, timeout: float = 5.0) -> Iterator[_native.Frame]:
        """One frame after the other; those that came meanwhile are skipped."""
        while True:
            yield self.look(camera, timeout)

    def claim(self, take_over: bool = False) -> None:
        """Commands the body from now on; nobody else then does, until it is let go of or taken over.

        Raises :class:`cohabit.Error` if another commands it, unless it is to be taken over; it then goes back to that one
        with :meth:`release`. The first :meth:`act` does this by itself.
        """
        outcome = self.peer.claim(take_over).wait(_ANSWER_S)
        if not outcome:
            remedy = "" if take_over else " (`take_over=True` does that)"
            raise _native.Error(f"{outcome.detail}{remedy}")
        self._claimed = True

    def release(self) -> None:
        """Lets go of the body: it goes back to whom it was taken from."""
        self.peer.release()
        self._claimed = False

    def act(self, action: Action) -> _native.Command:
        """Has the body do something; what it was doing ends. ``.wait(timeout)`` waits for the outcome."""
        if not self._claimed:
            self.claim(self.take_over)
        return self.peer.act(action.plain(self.state(), self.body))

    def do(self, action: Action, timeout: Optional[float] = None) -> _native.Outcome:
        """The same, and waits for the outcome; in lock-step, has the world go on until then."""
        command = self.act(action)
        while self._attends:
            self.step(_LONG_TICKS, timeout)
            if (outcome := command.poll()) is not None:
                return outcome
        return command.wait(timeout)

    def attend(self, patience: Optional[float] = None, timeout: Optional[float] = None) -> int:
        """In a session in lock-step: has the world wait for this peer from now on, and waits for its first turn.

        Gives the tick. A turn may take ``patience`` seconds, or for ever. What the body sees and knows in a turn is of that
        very tick, and no time goes by until :meth:`step`.
        """
        if not self.peer.lock_step:
            raise _native.Error(f"session `{self.peer.name}` is not in lock-step: start it with `--lock-step`")
        self.peer.attend(patience)
        self._attends = True
        return self._turn(timeout)

    def step(self, ticks: int = 1, timeout: Optional[float] = None) -> int:
        """Ends this peer's turn, and waits for the next: ``ticks`` later, or earlier, with an outcome of its body.

        The world waits for everybody's turn to end. Raises :class:`cohabit.Error` if it waits for another body that this very
        thread plays, and so would wait for ever: bodies of one session in lock-step are played from threads of their own.
        """
        self.check_alone()
        self._turn_of = None
        self.peer.ready(ticks)
        return self._turn(timeout)

    def _turn(self, timeout: Optional[float]) -> int:
        tick = self.peer.turn(timeout)
        self._turn_of = threading.get_ident()
        return tick

    def check_alone(self) -> None:
        """Raises :class:`cohabit.Error` if it is the turn of another body that this thread plays in the same session.

        Where there are other threads, one of them may be about to play that body: it has some seconds to begin.
        """
        until = time.monotonic() + (_TAKEN_OVER_S if threading.active_count() > 1 else 0.0)
        while (other := self._other_turn()) is not None:
            if time.monotonic() >= until:
                raise _native.Error(
                    f"session `{self.peer.name}` would wait for ever: it is body {other}'s turn too, which this thread plays as "
                    f"well as body {self.body}; play each body from a thread or process of its own, or close the other first"
                )
            time.sleep(0.01)

    def _other_turn(self) -> Optional[int]:
        """Another body of the same session whose turn it is, and which this thread plays."""
        here = threading.get_ident()
        for other in list(_JOINED):
            if other is not self and other.peer.name == self.peer.name and other._turn_of == here:
                return other.body
        return None

    def leave(self) -> None:
        """Has the world wait for this peer no more."""
        self.peer.leave()
        self._attends = False
        self._turn_of = None

    def say(self, text: str) -> None:
        """Says something as the body: to the log, and to all who listen."""
        self.peer.say(text)

    def listen(self, timeout: Optional[float] = None) -> Iterator[_native.Heard]:
        """What is told and said from when the session was joined: events, and dialog. Ends after ``timeout`` seconds of
        silence. Of what nobody listens to, the last 1024 are kept."""
        while (heard := self.peer.hear(timeout)) is not None:
            yield heard

    def close(self) -> None:
        """Lets go of the body and of all cameras; arrays that are still held stay as they are."""
        if self._attends:
            self.leave()
        if self._claimed:
            self.release()
        for name, *_ in self.peer.cameras:
            self.peer.close_camera(name)

    def __enter__(self) -> Session:
        return self

    def __exit__(
        self,
        kind: Optional[type[BaseException]],
        error: Optional[BaseException],
        trace: Optional[TracebackType],
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<cohabit.Session {self.peer.name!r}, body {self.body}>"


def join(name: str, body: int = 0, take_over: bool = False, timeout: float = 5.0) -> Session:
    """Joins a session of this machine as one of its bodies, and waits up to ``timeout`` seconds for its simulator.

    Looking and listening is free to all; the body is claimed by the first command. If another commands it then, as the
    session's own agent does body 0, it has to be taken over (``take_over=True``), and goes back when this one lets go.

    Raises :class:`cohabit.Error` if there is no such session, and ``ValueError`` if it has no such body.
    """
    return Session(name, body, take_over, timeout)
