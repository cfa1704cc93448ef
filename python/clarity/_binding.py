"""libclarity.so through ctypes. The header clarity.h, which lies beside this file, is read for prototypes, so that they stand in
one place; its digest has to be the library's."""
import ctypes
import glob
import hashlib
import os
import re
from struct import Struct as struct_format

_NUMBERS = {
    "int32_t": ctypes.c_int32,
    "uint32_t": ctypes.c_uint32,
    "int64_t": ctypes.c_int64,
    "uint64_t": ctypes.c_uint64,
    "uint8_t": ctypes.c_uint8,
    "float": ctypes.c_float,
    "double": ctypes.c_double,
}


class _Header:
    """What a header declares: constants, structs, and functions as (name, result, arguments)."""

    def __init__(self, text):
        text = re.sub(r"/\*.*?\*/", " ", text, flags=re.S)
        text = re.sub(r"^\s*#.*$", "", text, flags=re.M)
        text = text.replace('extern "C" {', "")
        self.constants = {}
        for body in re.findall(r"\benum\s*\{(.*?)\}", text, re.S):
            self.constants.update((name, int(value)) for name, value in re.findall(r"(\w+)\s*=\s*(-?\d+)", body))
        text = re.sub(r"\benum\s*\{.*?\}\s*;", "", text, flags=re.S)
        self.structs = {}
        for name, body in re.findall(r"typedef struct (\w+)\s*\{(.*?)\}\s*\w+\s*;", text, re.S):
            fields = [self._declared(line) for line in body.split(";") if line.strip()]
            self.structs[name] = type(name, (ctypes.Structure,), {"_fields_": fields})
        text = re.sub(r"typedef struct \w+\s*(\{.*?\})?\s*\w+\s*;", "", text, flags=re.S)
        self.functions = []
        for line in text.split(";"):
            found = re.match(r"\s*(.*?)\b(clarity_\w+)\s*\((.*)\)\s*$", line, re.S)
            if found:
                result, name, arguments = found.groups()
                arguments = re.sub(r"(\w+)\[\d+\]", r"*\1", arguments)  # arrays are passed as addresses
                arguments = [] if arguments.strip() == "void" else re.split(r",(?![^(]*\))", arguments)
                self.functions.append((name, self._type(result), [self._declared(a)[1] for a in arguments]))

    def _declared(self, text):
        """The name and the type of a member or an argument."""
        text = " ".join(text.split())
        function = re.fullmatch(r"(.*?)\(\*(\w+)\)\((.*)\)", text)
        if function:
            result, name, arguments = function.groups()
            return name, ctypes.CFUNCTYPE(self._type(result), *(self._declared(a)[1] for a in arguments.split(",")))
        kind, name, count = re.fullmatch(r"(.*?)(\w+)(?:\[(\d+)\])?", text).groups()
        return name, self._type(kind) * int(count) if count else self._type(kind)

    def _type(self, text):
        is_read = re.match(r"\s*const\b", text)  # then the bytes of a struct serve, too: see layout()
        text = re.sub(r"\b(const|volatile|struct)\b", " ", text)
        stars = text.count("*")
        base = text.replace("*", " ").strip()
        if base == "void":
            return ctypes.c_void_p if stars else None
        if base == "char":
            return ctypes.c_char_p if stars == 1 else ctypes.POINTER(ctypes.c_char_p)
        if base in _NUMBERS:
            return ctypes.c_void_p if stars else _NUMBERS[base]
        if base in self.structs and not is_read:
            return ctypes.POINTER(self.structs[base])
        return ctypes.c_void_p if stars == 1 else ctypes.POINTER(ctypes.c_void_p)  # a handle, or such bytes


def _library_files():
    """Where the library may be: CLARITY_LIBRARY, the folders `lib` of the build or the prefix that this package is in, the system."""
    if os.environ.get("CLARITY_LIBRARY"):
        return [os.environ["CLARITY_LIBRARY"]]
    files = []
    folder = os.path.dirname(os.path.abspath(__file__))
    for _ in range(5):
        folder = os.path.dirname(folder)
        for pattern in ("libclarity.so.1", "lib/libclarity.so.1", "lib/*/libclarity.so.1"):
            files += sorted(glob.glob(os.path.join(glob.escape(folder), pattern)))
    return files[:1] or ["libclarity.so.1"]


def _load():
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "clarity.h")
    with open(path, "rb") as file:
        text = file.read()
    header = _Header(text.decode())
    name = _library_files()[0]
    try:
        library = ctypes.CDLL(name)
    except OSError as error:
        raise ImportError(f"{name}: the library of clarity cannot be loaded: {error}; install it, or set CLARITY_LIBRARY") from None
    for function, result, arguments in header.functions:
        prototype = getattr(library, function, None)
        if prototype is None:
            raise ImportError(f"{name}: has no function {function}, which {path} declares: both must be of one version")
        prototype.restype, prototype.argtypes = result, arguments
    digest = library.clarity_header_digest().decode()
    if digest != hashlib.sha256(text).hexdigest():
        raise ImportError(f"{name}: was built with another header than {path}: both must be of one version")
    return header, library


header, library = _load()
constants = header.constants


def struct(name, **values):
    """A struct with its size and these members; all others are 0."""
    kind = header.structs[name]
    return kind(struct_bytes=ctypes.sizeof(kind), **values)


def layout(name):
    """Packs the bytes of a struct from all its members, 0 for a null pointer: a quarter of the time that ctypes takes."""
    kinds = [kind for _, kind in header.structs[name]._fields_]
    codes = (f"{kind._length_}{kind._type_._type_}" if hasattr(kind, "_length_") else kind._type_ for kind in kinds)
    return struct_format("".join(codes))


def texts(values):
    """An array of texts with NULL behind the last; _arguments.py has checked them."""
    return (ctypes.c_char_p * (len(values) + 1))(*(os.fsencode(value) for value in values), None)
