"""Rows of `clarity bench` and `clarity check`, and plugins that crash."""
import os
import signal
import subprocess
import sys
import time
import unittest

import clarity
from python_case import Case


class Rows(Case):
    def test_of_check_are_those_of_the_program(self):
        rows = clarity.check("bvh2", quick=True, only=["builds.parameters", "builds.refs"])
        self.assertEqual([(row["check"], row["status"]) for row in rows], [("builds.refs", "passed"), ("builds.parameters", "passed")])
        self.assertEqual({row["plugin"] for row in rows}, {"bvh2"})

    def test_of_bench_are_those_of_the_program(self):
        stages = []
        rows = clarity.bench(
            "accel", self.mesh_file, accel=["bvh2", "grid"], no_peers=True, only="/build", time_limit=20, progress=lambda *told: stages.append(told)
        )
        self.assertEqual([row["accel"] for row in rows], ["bvh2", "grid"])
        for row in rows:
            self.assertEqual((row["triangles"], row["suite"]), (300, "accel"))
            self.assertTrue(row["status"] == "refused" or row["build_ms"] > 0, row)
        self.assertIn(("clarity bench", None), stages)

    def test_errors_are_those_of_the_program(self):
        for words, wrong in (
            ("no_such: no plugin of this id", lambda: clarity.check("no_such")),
            ("no such suite", lambda: clarity.bench("no_suite")),
            ("plugins is required", lambda: clarity.check()),
            ("--frobnicate", lambda: clarity.check("bvh2", frobnicate=True)),
            ("--quiet", lambda: clarity.check("--quiet")),  # is no option here
        ):
            with self.subTest(words=words), self.assertRaisesRegex(clarity.UsageError, words):
                wrong()
        with self.assertRaises(clarity.Cancelled):
            clarity.bench("accel", self.mesh_file, progress=lambda stage, fraction: False)

    def test_of_a_plugin_that_crashes_leave_python_alive(self):
        library = os.environ["CLARITY_CRASHING_PLUGIN"]
        with self.assertRaisesRegex(clarity.Error, "crashes_when_loaded.so: .* crashed the process that opened it"):
            clarity.check(library, quick=True)
        self.assertFalse(clarity.Scene(self.vertices, self.faces).on(accel="bvh2").any([0.5, 0.5, 9], [0, 0, 1]))

    def test_of_a_builder_that_crashes_are_an_exception(self):
        # Also after a build of the same library that came to its end, in this process and in an earlier one.
        lines = """
import clarity, numpy
scene = clarity.Scene(numpy.eye(3), [[0, 1, 2]])
for defect in ("crashes", "none", "crashes", "throws"):
    try:
        scene.on(accel="bad_builder,defect=" + defect)
        print("built")
    except clarity.Error as error:
        print(error)
print(scene.on(accel="bvh2").any([0, 0, 0], [1, 1, 1]))
"""
        environment = self.with_bad_builder("plugins")
        for _ in range(2):
            result = subprocess.run([sys.executable, "-c", lines], capture_output=True, text=True, timeout=300, env=environment)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            crash = "accel bad_builder: the builder crashed .segmentation fault.*\n"
            self.assertRegex(result.stdout, f"^{crash}built\n{crash}accel bad_builder: .*thrown by the builder.*\nTrue\n$")

    def test_of_a_kernel_that_overruns_its_stack_are_an_exception(self):
        # Its stack grows with the scene: the small one on which kernels are tried needs little of it.
        lines = """
import clarity, numpy
for count in (20, 6000):
    scene = clarity.Scene(numpy.eye(3), [[0, 1, 2]] * count)
    try:
        print(scene.on(accel="bad_builder,defect=deep_stack", lanes=1).closest([0, 0, 0], [1, 1, 1]).t.round(3))
    except clarity.KernelError as error:
        print(error)
print(scene.on(accel="bvh2").any([0, 0, 0], [1, 1, 1]))
"""
        result = self.run_python(lines, env=self.with_bad_builder("deep"))
        self.assertEqual((result.returncode, result.stderr), (0, ""), result.stdout)
        self.assertRegex(result.stdout, r"^0\.333\nkernels were tried in a worker first, and crashed \(segmentation fault(.|\n)*\nTrue\n$")

    def with_bad_builder(self, name):
        folder = os.path.join(self.folder, name)
        os.mkdir(folder)
        os.symlink(os.environ["CLARITY_BAD_BUILDER"], os.path.join(folder, "bad_builder.so"))
        return {**os.environ, "CLARITY_PLUGIN_PATH": folder}

    def test_end_by_ctrl_c_with_their_process(self):
        lines = f"""
import clarity
try:
    clarity.bench("accel", {self.mesh_file!r}, progress=lambda stage, fraction: print("going", flush=True))
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""
        with subprocess.Popen([sys.executable, "-c", lines], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            self.assertEqual(process.stdout.readline(), "going\n")
            while not (children := self.children_of(process.pid)):  # it starts one for what it is asked
                time.sleep(0.05)
            self.assertEqual(len(children), 1)
            process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=120)
        self.assertEqual((process.returncode, out.replace("going\n", ""), err), (0, "interrupted\n", ""))
        self.assertFalse(os.path.exists(f"/proc/{children[0]}"))

    def children_of(self, pid):
        children = []
        for task in os.listdir(f"/proc/{pid}/task"):
            with open(f"/proc/{pid}/task/{task}/children") as file:
                children += file.read().split()
        return children


if __name__ == "__main__":
    unittest.main(verbosity=2)
