"""The Python package in processes and threads: imports, ends, forks, Ctrl-C, the log, and its page."""
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
        for i in range(10 if QUICK else 50):
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

    def test_hear_ctrl_c_in_a_long_call(self):
        lines = """
import clarity, numpy, time
random = numpy.random.default_rng(1)
scene = clarity.Scene(random.random((30000, 3)), numpy.arange(30000).reshape(-1, 3))
rt = scene.on(accel="linear")
rt.any([0, 0, 0], [1, 1, 1])
rays = random.random((2000000, 3))
try:
    rt.closest([0, 0, 0], rays, progress=lambda stage, fraction: print("going", flush=True))
except KeyboardInterrupt:
    print("interrupted", time.monotonic(), flush=True)
print(bool(rt.any([0, 0, 0], [0, 0, -1])))
"""
        with subprocess.Popen([sys.executable, "-c", lines], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            self.assertEqual(process.stdout.readline(), "going\n")
            time.sleep(0.3)
            sent = time.monotonic()
            process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=120)
            took = time.monotonic() - sent
        words = out.replace("going\n", "").split()
        self.assertEqual((process.returncode, words[:1], words[2:], err), (0, ["interrupted"], ["False"], ""), out)
        heard = float(words[1]) - sent
        logging.getLogger(__name__).warning("Ctrl-C was heard after %.2f s, the end came after %.2f s", heard, took)
        self.assertLess(heard, 2)  # 0.5 s on a machine that does nothing else

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

    def test_follow_the_page(self):
        page = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../docs/python.md")
        with open(page) as file:
            blocks = re.findall(r"```python\n(.*?)```", file.read(), re.S)
        self.assertEqual(len(blocks), 1)
        result = self.run_python(blocks[0].replace("640, 480", "64, 48"), cwd=self.folder)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertRegex(result.stdout, r"79202 triangles(.|\n)*\(200, 200\) 1\.90(.|\n)*in shadow: 0\.4")
        depth = np.load(os.path.join(self.folder, "depth.npy"))
        self.assertTrue(depth.shape == (48, 64) and 0.2 < np.isfinite(depth).mean() < 0.3 and depth.min() > 1)

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
