"""The Python package in processes and threads: imports, ends, forks, Ctrl-C, the log, and its page."""
import importlib.util
import logging
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
import unittest

import numpy as np

import clarity
from python_case import QUICK, Case, some_rays


class Processes(Case):
    def test_import_and_end_cleanly(self):
        lines = "import clarity"
        used = """
import clarity, numpy
scene = clarity.Scene(numpy.eye(3), [[0, 1, 2]])
rt = scene.on(accel="bvh2")
assert rt.any([0, 0, 0], [1, 1, 1])
"""
        for i in range(int(os.environ.get("CLARITY_TEST_IMPORTS", 10 if QUICK else 50))):
            result = self.run_python(used if i % 5 == 0 else lines)
            self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "", ""))

    def test_from_two_threads(self):
        origins, directions = some_rays(30000, 8)
        expected = clarity.Scene(self.vertices, self.faces).on(accel="bvh2").closest(origins, directions)
        found = {}

        def trace(name):
            rt = clarity.Scene(self.vertices, self.faces).on(accel="bvh2")
            found[name] = [rt.closest(origins, directions) for _ in range(4)]
            try:
                rt.any(origins, directions, t_max="far")
            except ValueError as error:
                found[name, "error"] = error

        threads = [threading.Thread(target=trace, args=(name,)) for name in ("a", "b")]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for name in ("a", "b"):
            self.assertIn((name, "error"), found)
            for hit in found[name]:
                self.equal(hit, expected)

    def test_that_are_spawned_trace(self):
        script = os.path.join(self.folder, "spawns.py")
        with open(script, "w") as file:
            file.write("""
import multiprocessing, numpy
import clarity
def trace(z):
    return bool(clarity.Scene(numpy.eye(3), [[0, 1, 2]]).on(accel="bvh2").any([0, 0, z], [1, 1, 1]))
if __name__ == "__main__":
    trace(0)
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        print(pool.map(trace, [0, 9]))
""")
        result = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=300)
        self.assertEqual((result.stdout, result.stderr), ("[True, False]\n", ""))

    def test_that_were_forked_are_refused(self):
        rt = clarity.Scene(self.vertices, self.faces).on(accel="bvh2")
        child = os.fork()
        if child == 0:
            code = 1
            try:
                rt.any([0, 0, 0], [1, 1, 1])
            except clarity.ForkError:
                code = 0
            finally:
                os._exit(code)
        self.assertEqual(os.waitpid(child, 0)[1], 0)
        self.assertFalse(rt.any([0, 0, 9], [0, 0, 1]))

    def test_hear_ctrl_c_in_every_long_call(self):
        # What is called is known to take longer than the signal: it must not come to its end. So that a kernel is compiled, no program
        # is kept from before.
        caches = {name: os.path.join(self.folder, "cold") for name in ("XDG_CACHE_HOME", "POCL_CACHE_DIR")}
        big = os.path.join(self.folder, "big.obj")
        with open(big, "w") as file:
            file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + "f 1 2 3\n" * 3000000)
        setup = """
random = numpy.random.default_rng(1)
corners = random.random((10000, 1, 3)) + 0.1 * random.standard_normal((10000, 3, 3))
scene = clarity.Scene(corners.reshape(-1, 3), numpy.arange(30000).reshape(-1, 3))
"""
        linear = setup + "rt = scene.on(accel='linear')\nrt.any([0, 0, 0], [1, 1, 1])\nrays = random.random((2000000, 3))\n"
        for name, prepare, stage, call, times in (
            ("import", "", "", f"clarity.load({big!r}, progress=tell)", 1),
            ("build", setup.replace("10000", "200000").replace("30000", "600000"), "building bvh2", "scene.on(accel='bvh2,builder=spatial', progress=tell)", 1),
            ("compile", setup, "compiling", "scene.on(accel='bvh2').render(64, 64, tracer='path', progress=tell)", 1),
            ("compile for rays", setup + "rt = scene.on(accel='bvh2')", "tracing", "rt.closest([0, 0, 0], [1, 1, 1], progress=tell)", 1),
            ("render", setup + "rt = scene.on(accel='linear')", "rendering", "rt.render(800, 600, spp=64, progress=tell)", 1),
            ("trace", linear, "tracing", "rt.closest([0, 0, 0], rays, progress=tell)", 1),
            ("trace, impatiently", linear, "tracing", "rt.closest([0, 0, 0], rays, progress=tell)", 5),
        ):
            if QUICK and name not in ("import", "trace, impatiently"):
                continue
            lines = f"""
import clarity, numpy, signal, time
def tell(stage, fraction):
    if stage.startswith({stage!r}):
        print("going", flush=True)
{prepare}
try:
    {call}
    print("ended", 0)
except KeyboardInterrupt:
    print("interrupted", time.monotonic())
signal.signal(signal.SIGINT, signal.SIG_IGN)  # those of impatient people that come too late
print(bool(clarity.Scene(numpy.eye(3), [[0, 1, 2]]).on(accel='bvh2').any([0, 0, 0], [1, 1, 1])))
"""
            with self.subTest(name=name), subprocess.Popen(
                [sys.executable, "-c", lines], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={**os.environ, **caches}
            ) as process:
                self.assertEqual(process.stdout.readline(), "going\n", process.poll() and process.stderr.read())
                time.sleep(0.1)
                sent = time.monotonic()
                for _ in range(times):
                    process.send_signal(signal.SIGINT)
                    time.sleep(0.02 * (times > 1))
                out, err = process.communicate(timeout=120)
                words = out.replace("going\n", "").split()
                self.assertEqual((process.returncode, words[:1], words[2:], err), (0, ["interrupted"], ["True"], ""), out)
                heard = float(words[1]) - sent
                logging.getLogger(__name__).warning("%s: Ctrl-C was heard after %.2f s", name, heard)
                if "CLARITY_TEST_CLOCKS" in os.environ:  # as in tests/support/clock.hpp
                    self.assertLess(heard, 2)  # 0.5 s on a machine that does nothing else
            shutil.rmtree(caches["XDG_CACHE_HOME"], ignore_errors=True)

    def test_of_another_version_are_refused(self):
        package = os.path.join(self.folder, "other", "clarity")
        shutil.copytree(os.path.dirname(clarity.__file__), package)
        with open(os.path.join(package, "clarity.h"), "a") as file:
            file.write("/* another version */\n")
        library = clarity._binding.library._name
        environment = {**os.environ, "PYTHONPATH": os.path.dirname(package), "CLARITY_LIBRARY": library}
        result = self.run_python("import clarity", env=environment)
        self.assertIn("ImportError", result.stderr)
        self.assertIn("was built with another header", result.stderr)

    @unittest.skipIf(QUICK, "compiles all programs of the page")
    def test_follow_the_page(self):
        page = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../docs/python.md")
        with open(page) as file:
            blocks = re.findall(r"```python\n(.*?)```", file.read(), re.S)
        self.assertEqual(len(blocks), 4)
        plots = importlib.util.find_spec("matplotlib") is not None
        lines = "".join(blocks if plots else blocks[:-1]).replace("640, 480", "64, 48").replace("1000000", "10000")
        result = self.run_python(lines, cwd=self.folder)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertRegex(result.stdout, r"79202 triangles(.|\n)*\(200, 200\) 1\.90(.|\n)*in shadow: 0\.4")
        depth = np.load(os.path.join(self.folder, "depth.npy"))
        self.assertTrue(depth.shape == (48, 64) and 0.35 < np.isfinite(depth).mean() < 0.5 and depth.min() > 1)
        self.assertEqual(os.path.exists(os.path.join(self.folder, "structures.png")), plots)

    def test_log_to_logging(self):
        lines = """
import logging, os
logging.basicConfig(level=logging.WARNING, format="%(name)s %(levelname)s %(message)s")
os.environ["CLARITY_PLUGIN_PATH"] = "/no_such_folder"
import clarity
clarity.Scene([[0, 0, 0]] * 3, [[0, 1, 2]])
"""
        self.assertRegex(self.run_python(lines).stderr, "clarity WARNING .*/no_such_folder")


if __name__ == "__main__":
    unittest.main(verbosity=2)
