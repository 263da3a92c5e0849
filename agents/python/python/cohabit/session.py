"""A running session, joined as one of its bodies."""

from __future__ import annotations

from collections.abc import Iterator
from types import TracebackType
from typing import Optional

from . import _native
from .actions import Action


class Session:
    """A session of this machine, as one body takes part in it.

    Everything that waits lets other threads run, and ends at Ctrl-C. Frames come in shared memory: their planes are
    read-only arrays over what the simulator rendered, and nothing is copied.
    """

    def __init__(self, name: str, body: int = 0, timeout: float = 5.0) -> None:
        self.body = body
        self.peer = _native.Session(name, timeout)

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

    def act(self, action: Action) -> _native.Command:
        """Has the body do something; what it was doing ends. ``.wait(timeout)`` waits for the outcome."""
        return self.peer.act(self.body, action.plain(self.state(), self.body))

    def do(self, action: Action, timeout: Optional[float] = None) -> _native.Outcome:
        """The same, and waits for the outcome."""
        return self.act(action).wait(timeout)

    def say(self, text: str) -> None:
        """Says something as the body: to the log, and to all who listen."""
        self.peer.say(self.body, text)

    def listen(self, timeout: Optional[float] = None) -> Iterator[_native.Heard]:
        """What is told and said from when the session was joined: events, and dialog. Ends after ``timeout`` seconds of
        silence. Of what nobody listens to, the last 1024 are kept."""
        while (heard := self.peer.hear(timeout)) is not None:
            yield heard

    def close(self) -> None:
        """Lets go of all cameras; arrays that are still held stay as they are."""
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


def join(name: str, body: int = 0, timeout: float = 5.0) -> Session:
    """Joins a session of this machine as one of its bodies, and waits up to ``timeout`` seconds for its simulator.

    Raises :class:`cohabit.Error` if there is no such session.
    """
    return Session(name, body, timeout)
