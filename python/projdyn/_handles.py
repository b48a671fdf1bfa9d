"""Ownership: objects of the library live as long as Python objects or arrays refer to them."""
from __future__ import annotations

import logging
import operator
import threading
import weakref
from ctypes import byref, c_void_p, sizeof
from typing import Any, Callable, Iterator, Optional

from ._library import lib
from ._paths import flag
from ._structs import Log, Options
from ._unique import Unique
from .errors import Error, InputError, error_of, wrong_type

_logger = logging.getLogger("projdyn")
_raised: list[BaseException] = []  # by messages of a call, raised at its end
_LEVELS = (logging.INFO, logging.WARNING)  # of pdyn_log_level


@Log
def _log(user: Any, level: int, message: bytes) -> None:
    try:
        _logger.log(_LEVELS[level], "%s", message.decode())
    except BaseException as error:  # ctypes would drop it; Ctrl-C during a step comes here first
        _raised.append(error)


def _free(free: Callable[[int], None], pointer: int, parent: Optional[Handle]) -> None:
    free(pointer)


def last_error() -> str:
    """The text of the last call of this thread that failed."""
    return lib.pdyn_last_error(None).decode()


def listed(kind: Any, get: Callable[..., None], *place: Any) -> Iterator[Any]:
    """The elements of a list of the library, one after the other in one structure of this kind.
    After the last element, the first member of the structure is NULL."""
    info, index = kind(), 0
    while True:
        get(*place, index, byref(info), sizeof(info))
        if getattr(info, kind._fields_[0][0]) is None:
            return
        yield info
        index += 1


class Handle(Unique):
    """An object of the library and the object that must outlive it: a writer has a simulation, a
    simulation and a scene have a context. The garbage collector frees the children first, because
    the finaliser of a child refers to its parent. Calls of several threads for one simulation and
    its writers, or for one scene, wait for each other."""

    def __init__(self, pointer: int, free: Callable[[int], None],
                 parent: Optional[Handle] = None) -> None:
        self.pointer = pointer
        self.parent = parent
        self.lock: Any = parent.lock if parent and parent.parent else threading.RLock()
        self.finalize = weakref.finalize(self, _free, free, pointer, parent)
        self.finalize.atexit = False

    def call(self, function: Callable[..., int], *arguments: Any) -> None:
        """Calls a function of this object that returns a status; raises Error unless it is 0."""
        if not self.finalize.alive:
            raise Error("the object is closed")
        with self.lock:
            status = function(self.pointer, *arguments)
            if _raised:
                raise _raised.pop()
            if status:
                raise error_of(status, last_error())

    def make(self, function: Callable[..., int], *arguments: Any) -> int:
        """Pointer to a new object that a function of this object makes."""
        out = c_void_p()
        self.call(function, *arguments, byref(out))
        return out.value or 0


def new_context(threads: int, allow_plugins: bool) -> Handle:
    """A context: the threads of a scene and its simulations."""
    try:
        threads = operator.index(threads)  # of numpy, too
    except TypeError:
        raise wrong_type("threads", "a whole number", threads) from None
    options, out = Options(), c_void_p()
    lib.pdyn_default_options_sized(byref(options), sizeof(options))
    options.threads, options.log = min(threads, 2**31 - 1), _log
    options.refuse_scene_plugins = not flag(allow_plugins, "allow_plugins")
    if lib.pdyn_create_sized(byref(options), sizeof(options), byref(out)):
        raise InputError(last_error())
    return Handle(out.value or 0, lib.pdyn_destroy)
