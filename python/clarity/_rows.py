"""What `clarity bench` and `clarity check` find, as lists of dictionaries."""
import ctypes
import json
import os

import numpy as np

from . import _arguments
from ._binding import library, texts
from ._calls import call


def bench(*what, progress=None, **options):
    """Measures structures: clarity.bench("quick", accel=["bvh2", "bvh8,max_leaf=2"], device="cpu", only="bunny/"). what: suites or scene
    files. options: those of `clarity bench`, with _ for -; True for one without a value, a list for one that may be repeated.
    Returns the records of its --json. Some may be refused: see their `status` and `why`."""
    return _rows("bench", what, options, progress)


def check(*plugins, progress=None, **options):
    """Says whether plugins are right: clarity.check("./my_tree.so", quick=True). options: those of `clarity check`, as of bench().
    Returns a dictionary for each check: `check`, `status`, `found`, `repeat`, ... A plugin that crashes has a row that says so."""
    return _rows("check", plugins, options, progress)


def _rows(command, what, options, progress):
    words = [command]
    for key, value in options.items():
        name = "--" + key.replace("_", "-")
        for one in value if isinstance(value, (list, tuple)) else [value]:
            if one is True:
                words.append(name)
            elif isinstance(one, (str, bytes, int, float, np.number, os.PathLike)) and one is not False:
                words += [name, _arguments.file(one if isinstance(one, (bytes, os.PathLike)) else str(one), key)]
            elif one is not None and one is not False:
                _arguments.refuse(key, "a text, a number, True, or a list of them", one)
    words += ["--"] + [_arguments.file(one, command) for one in what]
    rows = []

    def on_row(_user, text):
        rows.append(json.loads(text))

    listener = library.clarity_rows.argtypes[1](on_row)
    array = texts(words)

    def run(watch):
        return library.clarity_rows(array, listener, None, watch)

    call(run, progress=progress)
    return rows
