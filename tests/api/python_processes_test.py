"""The Python package in processes and threads: imports, ends, forks, Ctrl-C, the log, and its page."""
import copy
import importlib.util
import logging
import os
import pickle
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
import types
import unittest

import numpy as np

import clarity
from python_case import QUICK, Case, some_rays


class Mine(clarity.Scene):
    """Of a user."""


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

    def test_of_pools_take_scenes_and_give_hits(self):
        script = os.path.join(self.folder, "pools.py")
        with open(script, "w") as file:
            file.write("""
import multiprocessing, sys
import numpy as np
import clarity
def hit(scene):
    origins = np.full((5000, 3), 0.3)  # hits of so many rays stay on the device
    origins[:, 2] = 9
    hit = scene.on(accel="bvh2").closest(origins, [0, 0, -1])
    hit.label = scene.label
    return hit
def fail(scene):
    scene.on(accel="no_tree")
if __name__ == "__main__":
    scenes = clarity.Scene(np.eye(3) - [.1, .1, 0], [[0, 1, 2]]), clarity.load(sys.argv[1])
    for scene in scenes:
        scene.label = repr(scene)
    with multiprocessing.get_context(sys.argv[2]).Pool(2) as pool:
        for found in pool.map(hit, scenes):
            print(found.label, found.shape, found.mask.all(), found.points()[4999, :2])
        for scene, rt in [(scenes[0], scenes[0].on(accel="bvh2"))]:
            try:
                pool.map(fail, [scene])
            except clarity.UsageError as error:
                print(type(error).__name__, "no_tree" in str(error))
            try:
                pool.map(rt.any, [[0, 0, 0]])
            except TypeError as error:
                print(error)
""")
        expected = (
            "<clarity.Scene: 1 triangle> (5000,) True [0.3 0.3]\n"
            "<clarity.Scene: 300 triangles, 1 sphere, 1 plane> (5000,) True [0.3 0.3]\n"
            "UsageError True\n"
            "a clarity.Tracer cannot be pickled or copied: it lies on a device; send its scene, and call scene.on(accel='bvh2') there\n"
        )
        for method in ("spawn",) if QUICK else ("spawn", "forkserver"):
            with self.subTest(method=method):
                words = [sys.executable, script, os.path.relpath(self.scene_file), method]
                result = subprocess.run(words, capture_output=True, text=True, timeout=300)
                self.assertEqual((result.stdout, result.stderr), (expected, ""))

    def test_get_copies_of_all_that_can_be_copied(self):
        folder = os.getcwd()
        vertices, faces = self.vertices.copy(), self.faces.astype(np.uint32)
        mine = Mine(vertices, faces)
        mine.label = "mine"
        os.chdir(self.folder)
        try:
            scenes = mine, clarity.Scene(np.repeat(vertices, 20, 0).astype(float), np.repeat(20 * faces, 20, 0)), clarity.load("mixed.scene")
        finally:
            os.chdir(folder)
        origins, directions = some_rays(6000, 30)
        ways = {"pickle": lambda thing: pickle.loads(pickle.dumps(thing)), "copy": copy.copy, "deepcopy": copy.deepcopy}
        for way, again in ways.items():
            for scene in scenes:
                other = again(scene)
                self.assertEqual((type(other), repr(other), getattr(other, "label", None)), (type(scene), repr(scene), getattr(scene, "label", None)))
                np.testing.assert_array_equal(other.bounds, scene.bounds)
            rt = scenes[0].on(accel="bvh2")
            for count in (1, 100, 6000):
                for brief in (False, True):
                    for rays in (origins[:count], directions[:count]), (rt.pack(origins[:count], directions[:count]),):
                        hit = rt.closest(*rays, brief=brief)
                        other = again(hit)
                        self.equal(other, hit)
                        np.testing.assert_array_equal(other.points(), hit.points())
                        self.assertEqual((other.brief, other.shape), (brief, (count,)))
                        if way != "copy":
                            other.t[:] = 7
                            self.assertTrue((hit.t != 7).all())
                        self.assertIs(rt.closest(*rays, out=other), other)
                        self.equal(other, hit)
            every = rt.all(origins, directions)
            other = again(every)
            for name in ("first", "ray", "t", "prim", "instance", "uv"):
                np.testing.assert_array_equal(getattr(other, name), getattr(every, name))
            np.testing.assert_array_equal(other.points(), every.points())
            self.assertFalse(other.t.flags.writeable)
            one = again(rt.closest(origins[0], directions[0]))
            self.assertEqual((one.shape, one.t), ((), rt.closest(origins[0], directions[0]).t))
            for words, held in ((r"scene.on\(accel='bvh2'\)", rt), (r"pack\(\)", rt.pack(origins, directions))):
                with self.assertRaisesRegex(TypeError, words):
                    again(held)
            mesh = types.SimpleNamespace(vertices=vertices, faces=faces)
            mesh.ray = clarity.trimesh.RayMeshIntersector(mesh, accel="bvh2")
            first = mesh.ray.intersects_first(origins[:50], directions[:50])
            np.testing.assert_array_equal(again(mesh).ray.intersects_first(origins[:50], directions[:50]), first)
            for kind in (clarity.Error, clarity.UsageError, clarity.DeviceError, clarity.ImportFailed, clarity.KernelError, clarity.ForkError, clarity.Cancelled):
                error = kind("text")
                error.details = "details"
                other = again(error)
                self.assertEqual((type(other), str(other), other.details), (kind, "text", "details"))
        scene = clarity.Scene(np.repeat(vertices, 20, 0), faces)
        lent = scene._lent[0]
        lent += 1  # not allowed; the scene cannot be what it was
        with self.assertRaisesRegex(clarity.UsageError, "vertices: the array was changed"):
            pickle.dumps(scene)

    def test_that_were_forked_after_the_import_trace(self):
        lines = """
import os, sys, clarity
child = os.fork()
if child == 0:
    print(clarity.Scene([[1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2]]).on(accel="bvh2").any([0, 0, 0], [1, 1, 1]), flush=True)
    sys.exit(3)
print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""
        result = self.run_python(lines)
        self.assertEqual((result.returncode, result.stdout, result.stderr), (0, "True\n3\n", ""))

    def test_end_while_daemon_threads_work(self):
        # Each thread repeats a call. The process ends while all of them do, without a word, whatever the call holds.
        lines = """
import atexit, logging, sys, threading, time
import numpy as np, clarity
logging.basicConfig(level=logging.DEBUG, stream=open({log!r}, "w"))
random = np.random.default_rng(1)
vertices, faces = random.random((3000, 3)).astype(np.float32), np.arange(3000).reshape(-1, 3)
ray, rays = ([.5, .5, 9], [0, 0, -1]), (random.random((200000, 3)), [0, 0, -1])
scene = clarity.Scene(vertices, faces)
rt = scene.on(accel="bvh2")
rt.closest(*ray), rt.any(*ray)
def tell(stage, fraction):
    time.sleep(0)
calls = [lambda: rt.closest(*ray), lambda: rt.closest(*rays, progress=tell).points(), lambda: rt.any(*rays),
         lambda: clarity.Scene(vertices, faces, progress=tell).on(accel="bvh2", progress=tell), lambda: clarity.load({file!r}).info]
going = [0] * len(calls)
def repeat(number):
    while True:
        calls[number]()
        going[number] += 1
for number in range(len(calls)):
    threading.Thread(target=repeat, args=(number,), daemon=True).start()
atexit.register(lambda: print(rt.any(*ray), clarity.Scene(vertices, faces).on(accel="bvh2").any(*rays).any(), flush=True))
deadline = time.monotonic() + 60
while min(going) < 2 and time.monotonic() < deadline:
    time.sleep(0.01)
print(min(going) >= 2, flush=True)
{end}
""".replace("{file!r}", repr(self.mesh_file)).replace("{log!r}", repr(os.path.join(self.folder, "log.txt")))
        for end, code in (("", 0), ("sys.exit(5)", 5), ("raise KeyboardInterrupt", -signal.SIGINT)):
            for _ in range(1 if QUICK else 5):
                with self.subTest(end=end):
                    result = self.run_python(lines.replace("{end}", end))
                    self.assertEqual((result.returncode, result.stdout.split()), (code, ["True", "True", "True"]), result.stderr)
                    self.assertEqual(re.sub(r"(?s)^Traceback.*\nKeyboardInterrupt\n$", "", result.stderr), "")

    def test_end_by_an_exit_inside_of_a_pool_of_threads(self):
        lines = """
import sys, concurrent.futures
import numpy as np, clarity
rt = clarity.Scene(np.eye(3), [[0, 1, 2]]).on(accel="bvh2")
def leave(z):
    sys.stdout.write(f"{rt.any([0, 0, z], [1, 1, 1])}\\n")
    sys.exit(4)
with concurrent.futures.ThreadPoolExecutor(4) as pool:
    futures = [pool.submit(leave, 0) for _ in range(8)]
sys.exit(futures[7].exception().code)
"""
        result = self.run_python(lines)
        self.assertEqual((result.returncode, result.stdout, result.stderr), (4, "True\n" * 8, ""))

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
