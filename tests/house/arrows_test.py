"""Each kind of breach that scripts/arrows is there for is told, by planting it among the sources of today."""
import importlib.machinery
import importlib.util
import os
import sys

root = sys.argv[1]
os.chdir(root)
loader = importlib.machinery.SourceFileLoader("arrows", "scripts/arrows")
sys.dont_write_bytecode = True
spec = importlib.util.spec_from_loader("arrows", loader)
arrows = importlib.util.module_from_spec(spec)
loader.exec_module(arrows)

texts = arrows.sources()
PLANTED = [  # what is told, file, its text
    ("", "host/base/text.hpp", texts["host/base/text.hpp"]),
    ("base does not include scene", "host/base/new.hpp", '#include "scene/scene.hpp"\n'),
    ("base does not include scene", "host/base/files/new.hpp", '#include "../../scene/scene.hpp"\n'),
    ("plugins does not include base", "plugins/accel/linear/new.cpp", '#include "base/text.hpp"\n'),
    ("frames does not include tools/check", "host/frames/new.cpp", '#include "tools/check/check.hpp"\n'),
    ("tools/bench does not include tools/check", "tools/bench/run/new.cpp", '#include "tools/check/check.hpp"\n'),
    ("api does not include cli", "api/new.cpp", '#include "cli/commands.hpp"\n'),
    ("base does not include tests", "host/base/new.cpp", '#include "tests/support/quick.hpp"\n'),
    ("are seen from outside, and at most", "cli/new.cpp", '#include "kernels/kernel_source.hpp"\n'),
    ("are seen from outside, and at most", "host/stand/levels.hpp", '#include "structures/memory_plan.hpp"\n'),
    ("its folder is in no room", "host/new_room/new.cpp", ""),
    ("its folder is in no room", "new_room/new.hpp", ""),
    ("its folders on_device and on_host include each other", "host/moving/on_host/new.cpp", '#include "moving/on_device/%s"\n'),
]
failed = 0
for told, path, text in PLANTED:
    if "%s" in text:  # a header of the other folder, which gets an arrow back
        header = next(os.path.basename(p) for p in texts if p.startswith("host/moving/on_device/") and p.endswith(".hpp"))
        back = next(os.path.basename(p) for p in texts if p.startswith("host/moving/on_host/") and p.endswith(".hpp"))
        changed = {**texts, path: text % header, "host/moving/on_device/new.cpp": f'#include "moving/on_host/{back}"\n'}
    else:
        changed = {**texts, path: text}
    found = arrows.breaches(changed)
    if not (any(told in sentence for sentence in found) if told else not found):
        print(f"{path}: expected {told or 'nothing'!r}, found {found}")
        failed = 1
table = [(name, of.replace("base", "base cli") if name == "worker" else of, holds) for name, of, holds in arrows.ROOMS]
if not any("worker: the table names cli" in sentence for sentence in arrows.breaches(texts, table)):
    print("a row that names a room above it is not told")
    failed = 1
with open("docs/architecture.md", encoding="utf-8") as page:
    if arrows.table() not in page.read():
        print("docs/architecture.md does not have the table that `scripts/arrows --table` prints")
        failed = 1
sys.exit(failed)
