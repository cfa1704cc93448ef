"""Exceptions, one for each code of the library."""
import threading

from ._binding import constants, library


class Error(Exception):
    """Something failed. The text says what was tried, why it failed and what to do; `details` may be a compiler's log."""

    details = ""


class UsageError(Error, ValueError):
    """A mistake of the caller: an unknown setting, structure or value."""


class DeviceError(Error):
    """There is no such OpenCL device, or it cannot be opened."""


class ImportFailed(Error):
    """A file cannot be read."""


class KernelError(Error):
    """A kernel does not compile; `details` is the compiler's log."""


class ForkError(Error):
    """This process was forked from one that had used the library."""


class Cancelled(Error):
    """The function of `progress` returned False."""


_KINDS = {
    constants["CLARITY_FAILED"]: Error,
    constants["CLARITY_USAGE"]: UsageError,
    constants["CLARITY_NO_DEVICE"]: DeviceError,
    constants["CLARITY_IMPORT_FAILED"]: ImportFailed,
    constants["CLARITY_KERNEL_BUILD_FAILED"]: KernelError,
    constants["CLARITY_FORKED"]: ForkError,
    constants["CLARITY_CANCELLED"]: Cancelled,
}


def error_of(code):
    """The exception of the last call on this thread, which returned `code`."""
    if code == constants["CLARITY_ENDED"] and threading.current_thread() is not threading.main_thread():
        return SystemExit()  # ends a thread without a word
    error = _KINDS.get(code, Error)(library.clarity_error_text().decode(errors="replace"))
    error.details = library.clarity_error_details().decode(errors="replace")
    return error
