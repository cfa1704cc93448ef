"""Calls of the library that Ctrl-C ends, with progress; and the end of all calls."""
import atexit
import ctypes
import logging
import sys
import threading
import weakref

import numpy as np

from . import _arguments
from ._binding import constants, header, library, struct
from ._errors import error_of

_log = logging.getLogger("clarity")
_log.addHandler(logging.NullHandler())
_LEVELS = {
    constants["CLARITY_LOG_DEBUG"]: logging.DEBUG,
    constants["CLARITY_LOG_INFO"]: logging.INFO,
    constants["CLARITY_LOG_WARNING"]: logging.WARNING,
    constants["CLARITY_LOG_ERROR"]: logging.ERROR,
}


def check(code):
    if code:
        raise error_of(code)


def free_with(owner, function, handle):
    """Frees a handle with its owner. At the end of the interpreter handles stay: threads may still read arrays that lie in them."""
    weakref.finalize(owner, function, handle).atexit = False


_BOOLEANS = bool, np.bool_


class _Bar:
    """progress=True: a line on stderr, if that is a terminal or a notebook, which is none, but begins a line anew as terminals do."""

    def __init__(self):
        stream = sys.stderr
        self._shown = stream is not None and (stream.isatty() or type(stream).__module__.startswith("ipykernel."))
        self._width = 0

    def __call__(self, stage, fraction):
        if self._shown:
            line = stage + (f" {100 * fraction:3.0f} %" if fraction is not None else "")
            self._write("\r" + line.ljust(self._width))
            self._width = len(line)

    def end(self):
        if self._shown:
            self._write("\r" + " " * self._width + "\r")

    def _write(self, text):
        sys.stderr.write(text)
        sys.stderr.flush()


class _Watch:
    """Of one call: its cancel, and the function that hears of progress."""

    def __init__(self, progress):
        self.failure = None
        self._cancel = ctypes.c_int32(0)
        progress = _arguments.progress(progress)
        self._function = _Bar() if progress is True else progress
        told = dict(header.structs["clarity_watch"]._fields_)["progress"]
        self._told = told(self._tell) if self._function else told()
        self.struct = struct("clarity_watch", progress=self._told, cancel=ctypes.addressof(self._cancel))

    def cancel(self):
        self._cancel.value = 1

    def end(self):
        if isinstance(self._function, _Bar):
            self._function.end()

    def _tell(self, _user, stage, fraction):
        try:
            going = self._function(stage.decode(errors="replace"), fraction if fraction >= 0 else None)
            return 0 if type(going) in _BOOLEANS and not going else 1
        except BaseException as failure:  # passed on by the call
            self.failure = failure
            return 0


def call(function, *arguments, progress=None):
    """Calls a function whose last argument is a watch. Python handles signals on its main thread alone, between its own
    instructions: so there the library works on another thread, and a KeyboardInterrupt cancels it."""
    watch = _Watch(progress)
    if threading.current_thread() is not threading.main_thread() or _ended:
        code = function(*arguments, ctypes.byref(watch.struct))
        error = error_of(code) if code else None
    else:
        results = []
        done = threading.Event()

        def work():
            try:
                code = function(*arguments, ctypes.byref(watch.struct))
                results.append(error_of(code) if code else None)  # texts are those of this thread
            finally:
                done.set()

        thread = threading.Thread(target=work, name="clarity", daemon=True)
        try:
            thread.start()
            done.wait()
        except BaseException:
            watch.cancel()
            _wait_for(done, thread)
            watch.end()
            raise
        error = results[0]
    watch.end()
    if watch.failure:
        raise watch.failure
    if error:
        raise error


def _wait_for(done, thread):
    """Arrays must not go while the library writes to them, however often Ctrl-C is pressed. Not by Thread.join(), which takes a thread
    for ended once it was interrupted (Python 3.11)."""
    while not done.is_set() and thread in threading.enumerate():  # there is none if it could not be started
        try:
            done.wait(0.1)
        except KeyboardInterrupt:
            pass


def _on_log(_user, level, text):
    try:
        _log.log(_LEVELS.get(level, logging.INFO), "%s", text.decode(errors="replace"))
    except Exception:  # a handler of the user's must not disturb the library
        pass


_listener = library.clarity_set_log.argtypes[0](_on_log)


_ended = False


def _end():
    """At the interpreter's end, when daemon threads may still trace: their calls end, further ones end the threads, and nothing calls
    Python any more."""
    global _ended
    _ended = True
    library.clarity_end()
    library.clarity_set_log(library.clarity_set_log.argtypes[0](), None)


check(library.clarity_set_log(_listener, None))
atexit.register(_end)
