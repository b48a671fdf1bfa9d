"""Ownership: objects of the library live as long as Python objects or arrays refer to them."""
from __future__ import annotations

import logging
import operator
import threading
import weakref
from ctypes import byref, c_void_p, sizeof
from typing import Any, Callable, NoReturn, Optional

from ._library import lib
from ._structs import Log, Options
from .errors import BAD_CALL, Error, InputError, error_of, wrong_type

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


class Handle:
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

    @property
    def context(self) -> int:
        """The context at the root."""
        return self.parent.context if self.parent else self.pointer

    def call(self, function: Callable[..., int], *arguments: Any) -> None:
        """Calls a function of this object that returns a status; raises Error unless it is 0."""
        if not self.finalize.alive:
            raise Error("the object is closed")
        with self.lock:
            before = lib.pdyn_last_error(self.context)
            status = function(self.pointer, *arguments)
            if _raised:
                raise _raised.pop()
            if status:
                text = lib.pdyn_last_error(self.context)
                if status == BAD_CALL and text == before:
                    text = self._text_of(function, *arguments)
                raise error_of(status, (text or lib.pdyn_status_text(status)).decode())

    def _text_of(self, function: Callable[..., int], *arguments: Any) -> bytes:
        """The text of a bad call, which changes nothing. It may set none and leave the text of an
        error before: it is called again after an error with another text."""
        lib.pdyn_scene_open(self.context, b"", byref(c_void_p()))
        other = lib.pdyn_last_error(self.context)
        function(self.pointer, *arguments)
        text = lib.pdyn_last_error(self.context)
        return b"" if text == other else text

    def __reduce__(self) -> NoReturn:
        raise TypeError("objects of projdyn cannot be copied or pickled: write a scene to a file "
                        "(Scene.write), save a state (Simulation.save), and load them there")

    def make(self, function: Callable[..., int], *arguments: Any) -> int:
        """Pointer to a new object that a function of this object makes."""
        out = c_void_p()
        self.call(function, *arguments, byref(out))
        return out.value or 0


def new_context(threads: int, allow_plugins: bool) -> Handle:
    """A context: threads and error text of a scene and its simulations."""
    try:
        threads = operator.index(threads)  # of numpy, too
    except TypeError:
        raise wrong_type("threads", "a whole number", threads) from None
    options, out = Options(), c_void_p()
    lib.pdyn_default_options_sized(byref(options), sizeof(options))
    options.threads, options.log, options.refuse_scene_plugins = threads, _log, not allow_plugins
    status = lib.pdyn_create_sized(byref(options), sizeof(options), byref(out))
    if status:
        raise InputError(f"threads: expected 0 to 1024, found {threads}")
    return Handle(out.value or 0, lib.pdyn_destroy)
