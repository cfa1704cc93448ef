"""Checks of arguments. Each message names the argument, what is expected and what was found. They come before any work."""
import operator
import os

import numpy as np

from ._errors import UsageError


def refuse(name, expected, found):
    raise UsageError(f"{name}: expected {expected}, found {_shown(found)}")


def _shown(value):
    """A value in a few words."""
    if isinstance(value, np.ndarray):
        return f"an array of {value.dtype} in the shape {value.shape}"
    if value is None or isinstance(value, (str, bytes, bool, int, float, complex, np.generic)):
        try:
            text = repr(value)
        except ValueError:  # of thousands of digits
            return "a huge number"
        return text if len(text) <= 60 else text[:57] + "..."
    kind = type(value).__name__
    return f"{'an' if kind[:1] in 'AEIOUaeiou' else 'a'} {kind}"


def encoded(text, name):
    """Text for C, which ends at its first 0."""
    try:
        data = os.fsencode(text)
    except UnicodeEncodeError:
        refuse(name, "a text of Unicode characters", text)
    if b"\0" in data:
        refuse(name, "a text without the character 0", text)
    return data


def text(value, name):
    if not isinstance(value, str):
        refuse(name, "a text", value)
    return encoded(value, name)


def choice(value, name):
    """Of a device or a structure. None: the best."""
    if value is not None and not isinstance(value, str):
        refuse(name, f'a text as of --{name}, such as {_EXAMPLES[name]}, or "" for the best', value)
    return encoded(value or "", name)


_EXAMPLES = {"device": '"gpu"', "accel": '"bvh4,max_leaf=4"'}


def file(value, name):
    if not isinstance(value, (str, bytes, os.PathLike)):
        refuse(name, "a file's name", value)
    path = os.fspath(value)
    encoded(path, name)
    return path


def flag(value, name):
    if not isinstance(value, (bool, np.bool_)):
        refuse(name, "True or False", value)
    return bool(value)


def whole(value, name, least, most=None):
    expected = f"a whole number from {least} to {most}" if most is not None else f"a whole number of at least {least}"
    try:
        number = operator.index(value)
    except TypeError:
        refuse(name, expected, value)
    if number < least or (most is not None and number > most):
        refuse(name, expected, value)
    return number


def mask(value):
    """0: None, all instances that rays see."""
    return 0 if value is None else whole(value, "mask", 1, 255)


def size(value, name):
    """A shape, as numpy takes it."""
    try:
        numbers = (value,) if hasattr(value, "__index__") else tuple(value)
        return tuple(whole(number, name, 0) for number in numbers)
    except TypeError:
        refuse(name, "a tuple of whole numbers", value)


def numbers(value, name):
    """A text as of --camera or --light, or numbers; None stays."""
    if value is None:
        return None
    if isinstance(value, str):
        return encoded(value, name)
    try:
        return _listed(value)
    except (TypeError, ValueError):
        refuse(name, f"a text as of --{name}, or a list of numbers", value)


def _listed(value):
    if isinstance(value, (bytes, dict, set)) or np.size(value) == 0 or np.iscomplexobj(value):
        raise TypeError
    return ",".join(repr(float(number)) for number in np.ravel(value)).encode()


def settings(given):
    """Texts as of `clarity --set`, from keyword arguments."""
    words = []
    for key, value in given.items():
        name = f"setting `{key}`"
        if not key or "=" in key:
            refuse(name, "a key without `=`", key)
        if isinstance(value, (bool, np.bool_)):
            word = encoded("true" if value else "false", name)
        elif isinstance(value, (str, int, float, np.number)):
            word = encoded(str(value), name)
        else:
            try:
                word = _listed(value if value is not None else ())
            except (TypeError, ValueError):
                refuse(name, "a text, a number, True or False, or a list of numbers", value)
        words.append(encoded(key, name) + b"=" + word)
    return words


def progress(value):
    """The function to call, True for a line on a terminal, or None."""
    if value is None or value is False:
        return None
    if value is not True and not callable(value):
        refuse("progress", "True, or a function of the stage and the fraction that is done", value)
    return value
