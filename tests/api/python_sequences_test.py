"""Sequences of calls that a seed draws: scenes, tracers, rays, hits that are read late, moves and wrong arguments, on one to four
threads. Hits are those of brute force in double precision.

scripts/fuzz python_sequences runs it for long, with sanitizers. CLARITY_SEQUENCES_SEED and CLARITY_SEQUENCES_SECONDS choose other
sequences and more of them; CLARITY_SEQUENCES_FIRST begins with another sequence: a fault tells its seed and number."""
import faulthandler
import gc
import os
import random
import sys
import threading
import time
import unittest

import numpy as np

import clarity
from python_case import Case, QUICK, brute_force, soup

SEED = int(os.environ.get("CLARITY_SEQUENCES_SEED", "1"))
FIRST = int(os.environ.get("CLARITY_SEQUENCES_FIRST", "0"))
SECONDS = float(os.environ.get("CLARITY_SEQUENCES_SECONDS", "8" if QUICK else "30"))
STEPS = 80  # of a sequence
STRUCTURES = ["bvh8", "linear"] if QUICK else ["bvh8", "linear", "bvh2,max_leaf=2", "grid"]


class Thing:
    """A scene or a tracer with what is known of it."""

    def __init__(self, **values):
        self.__dict__.update(values)


class Sequence:
    """What a sequence holds. Threads share it; what one of them takes stays alive until it lets it go."""

    def __init__(self, random, mesh_file):
        self.mesh_file = mesh_file
        self.scenes, self.tracers, self.packed, self.hits, self.lists = [], [], [], [], []
        self.threads = random.choice([1, 1, 2, 3, 4])


def taken(random, things):
    things = list(things)
    return random.choice(things) if things else None


def put(random, things, thing):
    if len(things) < 3:
        things.append(thing)
    else:
        things[random.randrange(3)] = thing


def as_view(random, array):
    """The same numbers in another layout or type."""
    kind = random.randrange(7)
    if kind == 0 and array.size:
        return array.tolist()
    if kind == 1:
        return np.asfortranarray(array)
    if kind == 2 and array.ndim == 2:
        wide = np.zeros((2 * len(array) + 1, array.shape[1] + 2), array.dtype)
        wide[: 2 * len(array) : 2, 1:-1] = array
        return wide[: 2 * len(array) : 2, 1:-1]
    if kind == 3:
        return array[::-1].copy()[::-1]
    if kind == 4:
        frozen = array.copy()
        frozen.flags.writeable = False
        return frozen
    return array


def rays(random, count):
    numbers = np.random.default_rng(random.getrandbits(32))
    origins = numbers.uniform(-1.5, 2.5, (count, 3)).astype(np.float32)
    directions = (numbers.random((count, 3)) - origins).astype(np.float32)
    t_min = t_max = None
    if random.random() < 0.3:
        t_min = numbers.random(count).astype(np.float32) if random.random() < 0.5 else np.float32(random.random())
    if random.random() < 0.3:
        t_max = numbers.uniform(0, 2, count).astype(np.float32) if random.random() < 0.5 else np.float32(2 * random.random())
    return origins, directions, t_min, t_max


def given(random, origins, directions, t_min, t_max):
    """As a caller gives them: views, lists, doubles, broadcast."""
    arrays = [as_view(random, origins), as_view(random, directions)]
    if random.random() < 0.2:
        arrays = [np.asarray(array, np.float64) for array in arrays]
    return arrays, {name: limit for name, limit in (("t_min", t_min), ("t_max", t_max)) if limit is not None}


def some_count(random):
    return random.choice([0, 1, 2, 5, 16, 17, 40, 200]) if random.random() < 0.95 else random.choice([4096, 5000, 20000])


WRONG_NUMBERS = [
    None, "text", object(), [[1, 2]], [[1, 2, 3], [1, 2]], np.zeros((2, 4)), np.zeros(3, complex), {}, b"bytes", np.array(["a", "b"]),
]


class Sequences(Case):
    def check(self, thing, hit, rays_of_hit, worlds):
        """Hits against brute force in one of the places where the scene may have been."""
        origins, directions, t_min, t_max = rays_of_hit
        t, prim = np.asarray(hit.t), np.asarray(hit.prim)
        some = slice(None) if len(origins) <= 500 else slice(None, None, 53)
        o, d = origins[some], directions[some]
        limits = [0 if t_min is None else t_min, np.inf if t_max is None else t_max]
        limits = [np.broadcast_to(np.float32(limit), len(origins))[some][:, None] for limit in limits]
        why = None
        for vertices in worlds:
            ray, found, at, narrow = brute_force(vertices, thing.faces, o, d, *limits)
            first = np.full(len(o), -1)
            nearest = np.full(len(o), np.inf)
            first[ray[::-1]], nearest[ray[::-1]] = found[::-1], at[::-1]
            sure = ~narrow
            why = None
            if not np.array_equal((prim[some] >= 0)[sure], (first >= 0)[sure]):
                why = "hit or miss"
            elif not np.allclose(t[some][sure], nearest[sure], rtol=1e-3, atol=1e-4):
                why = "distances"
            else:
                return
        self.fail(f"{thing.accel}: {why} of {len(origins)} rays are wrong")

    # Steps: each takes the sequence and a random source.

    def new_scene(self, s, random):
        vertices, faces = soup(random.randrange(1, 25), random.getrandbits(32))
        if random.random() < 0.3:
            vertices = vertices.astype(float)
        made = clarity.Scene(as_view(random, vertices), as_view(random, faces.astype(random.choice([np.int64, np.uint32, np.int32]))))
        self.assertEqual(made.info["triangles"], len(faces))
        put(random, s.scenes, Thing(scene=made, vertices=vertices.astype(np.float32), faces=faces, of_file=False))

    def wrong_scene(self, s, random):
        vertices, faces = soup(3, 1)
        bad = faces.copy()
        bad[1, 1] = random.choice([9, -1, 2**31, 2**40])
        infinite = vertices.copy()
        infinite[4, 1] = random.choice([np.nan, np.inf])
        wrong = random.choice(WRONG_NUMBERS)
        arguments = [(vertices, bad), (infinite, faces), (vertices, faces.astype(float)), (vertices[:, :2], faces), (vertices, faces[0])]
        with self.assertRaises((clarity.UsageError, TypeError)):
            clarity.Scene(*random.choice(arguments + [(wrong, faces), (vertices, wrong)]))

    def load(self, s, random):
        if random.random() < 0.5:
            with self.assertRaises(clarity.ImportFailed):
                clarity.load(s.mesh_file + ".missing.obj")
        elif random.random() < 0.2:
            put(random, s.scenes, Thing(scene=clarity.load(s.mesh_file), vertices=self.vertices, faces=self.faces, of_file=True))

    def new_tracer(self, s, random):
        of = taken(random, s.scenes)
        if of is None:
            return
        accel = random.choice(STRUCTURES)
        rt = of.scene.on(accel=accel, **random.choice([{}, {"poses": "refit"}, {"poses": "build"}]))
        # worlds: vertices of all moves so far; those from `moved` on are there, or will be at once.
        thing = Thing(rt=rt, scene=of.scene, faces=of.faces, accel=accel, of_file=of.of_file, worlds=[of.vertices], moved=0)
        thing.at, thing.shift, thing.moving = of.vertices, np.zeros(3, np.float32), threading.Lock()
        put(random, s.tracers, thing)

    def wrong_tracer(self, s, random):
        of = taken(random, s.scenes)
        if of:
            words = [{"accel": "no_such_tree"}, {"device": "no such device"}, {"no_such_setting": 1}, {"spp": "many"}, {"light.0": "off"}]
            with self.assertRaises((clarity.UsageError, clarity.DeviceError, ValueError)):
                of.scene.on(**random.choice(words))

    def traced(self, s, random, call):
        """A tracer, some rays, and what `call` gives for them, with the places that the scene may have had meanwhile."""
        thing = taken(random, s.tracers)
        if thing is None:
            return None
        some = rays(random, some_count(random))
        packed = taken(random, [p for p in s.packed if p.of is thing]) if random.random() < 0.3 else None
        before = thing.moved
        if packed:
            some, result = packed.rays, call(thing.rt, (packed.packed,), {})
        else:
            arrays, limits = given(random, *some)
            result = call(thing.rt, arrays, limits)
        return thing, some, result, thing.worlds[before:]

    def closest(self, s, random):
        brief = random.random() < 0.3
        found = self.traced(s, random, lambda rt, arrays, limits: rt.closest(*arrays, brief=brief, **limits))
        if found:
            thing, some, hit, worlds = found
            if random.random() < 0.6:
                self.check(thing, hit, some, worlds)
            put(random, s.hits, Thing(of=thing, hit=hit, rays=some, worlds=worlds, lock=threading.Lock()))

    def closest_again(self, s, random):
        """Into the arrays of an earlier call, some of which were read. A moved scene has other hits there."""
        kept = taken(random, s.hits)
        if kept is None or kept.hit.brief:
            return
        with kept.lock:
            for name in random.sample(["t", "prim", "instance", "uv"], random.randrange(5)):
                getattr(kept.hit, name)
            origins, directions, t_min, t_max = kept.rays
            limits = {name: limit for name, limit in (("t_min", t_min), ("t_max", t_max)) if limit is not None}
            before = kept.of.moved
            kept.of.rt.closest(origins, directions, out=kept.hit, **limits)
            kept.worlds = kept.of.worlds[before:]
            self.check(kept.of, kept.hit, kept.rays, kept.worlds)

    def read_late(self, s, random):
        kept = taken(random, s.hits)
        if kept is None:
            return
        with kept.lock:
            self.check(kept.of, kept.hit, kept.rays, kept.worlds)
            points = kept.hit.points()
            self.assertEqual(np.isnan(points).any(-1).tolist(), (~kept.hit.mask).tolist())
            self.assertIn("of", repr(kept.hit))
            if not kept.hit.brief:
                self.assertEqual(kept.hit.uv.shape, (*kept.hit.shape, 2))
                self.assertTrue((kept.hit.instance >= -1).all())

    def any(self, s, random):
        found = self.traced(s, random, lambda rt, arrays, limits: (rt.any(*arrays, **limits), rt.closest(*arrays, **limits)))
        if found and len(found[3]) == 1:
            np.testing.assert_array_equal(found[2][0], found[2][1].mask)

    def all(self, s, random):
        thing = taken(random, s.tracers)
        if thing is None:
            return
        some = rays(random, some_count(random))
        arrays, limits = given(random, *some)
        with thing.moving:  # three calls of one place
            counts, found, hit = thing.rt.count(*arrays, **limits), thing.rt.all(*arrays, **limits), thing.rt.closest(*arrays, **limits)
        np.testing.assert_array_equal(np.diff(found.first), counts)
        np.testing.assert_array_equal(found.t[found.first[:-1][counts > 0]], hit.t[counts > 0])
        self.assertEqual(len(found), counts.sum())
        put(random, s.lists, found)

    def read_list(self, s, random):
        found = taken(random, s.lists)
        if found is not None:
            ray, t, prim = found
            self.assertTrue((np.diff(ray) >= 0).all() and (prim >= 0).all() and np.isfinite(t).all())
            self.assertEqual(found.points().shape, (len(found), 3))

    def pack(self, s, random):
        thing = taken(random, s.tracers)
        if thing:
            some = rays(random, some_count(random))
            arrays, limits = given(random, *some)
            put(random, s.packed, Thing(packed=thing.rt.pack(*arrays, **limits), rays=some, of=thing))

    def packed_elsewhere(self, s, random):
        thing, packed = taken(random, s.tracers), taken(random, s.packed)
        if thing and packed and packed.of is not thing:
            with self.assertRaises(clarity.UsageError):
                thing.rt.closest(packed.packed)
        if packed:
            with self.assertRaises(clarity.UsageError):
                packed.of.rt.any(packed.packed, t_max=1)

    def wrong_rays(self, s, random):
        thing = taken(random, s.tracers)
        if thing is None:
            return
        origins, directions, _, _ = rays(random, 3)
        call = random.choice([thing.rt.closest, thing.rt.any, thing.rt.count, thing.rt.all])
        wrong = random.choice(WRONG_NUMBERS)
        arguments = [(wrong, directions), (origins, wrong), (origins[:2], directions), (origins, directions, np.zeros(2)), (origins, directions, "far")]
        with self.assertRaises((clarity.UsageError, TypeError)):
            call(*random.choice(arguments))
        with self.assertRaises((clarity.UsageError, TypeError)):
            call(origins, directions, mask=random.choice([0, 256, -1, 2**40, 1.5, "all"]))
        if call == thing.rt.any:
            with self.assertRaises(clarity.UsageError):
                call(origins, directions, out=random.choice([np.zeros(3), np.zeros(4, bool), [True], np.zeros(6, bool)[::2]]))

    def move(self, s, random):
        thing = taken(random, s.tracers)
        if thing is None:
            return
        with thing.moving:
            if thing.of_file:
                return  # vertices of files stay
            numbers = np.random.default_rng(random.getrandbits(32))
            at, shift, places = thing.at, thing.shift, {}
            if random.random() < 0.6:
                at = thing.worlds[0] + np.float32(0.1) * numbers.standard_normal(at.shape).astype(np.float32)
                places["vertices"] = as_view(random, at)
            if random.random() < 0.4 or not places:
                shift = numbers.uniform(-0.5, 0.5, 3).astype(np.float32)
                matrix = np.eye(4)[None]
                matrix[0, :3, 3] = shift
                places["instances"] = as_view(random, matrix) if random.random() < 0.5 else matrix[:, :3]
            thing.worlds.append(at + shift)
            if random.random() < 0.2:
                with self.assertRaises(clarity.Cancelled):
                    thing.rt.move(**places, progress=lambda stage, fraction: False)
                thing.worlds.append(thing.worlds[thing.moved])
            else:
                thing.rt.move(**places)
                thing.at, thing.shift = at, shift
            thing.moved = len(thing.worlds) - 1

    def wrong_move(self, s, random):
        thing = taken(random, s.tracers)
        if thing:
            places = [np.zeros((7, 3)), np.full((len(thing.worlds[0]), 3), np.nan), random.choice(WRONG_NUMBERS[1:])]
            places = [{}, {"instances": np.eye(4)}, {"instances": np.zeros((1, 3, 4))}] + [{"vertices": place} for place in places]
            with self.assertRaises((clarity.UsageError, TypeError)):
                thing.rt.move(**random.choice(places))

    def info(self, s, random):
        thing = taken(random, s.tracers)
        if thing:
            self.assertEqual(thing.rt.info["accel"], thing.accel.split(",")[0])
            self.assertEqual(thing.scene.bounds.shape, (2, 3))

    def cancelled(self, s, random):
        thing = taken(random, s.tracers)
        if thing:
            origins, directions, _, _ = rays(random, 100)
            with self.assertRaises(clarity.Cancelled):
                thing.rt.closest(origins, directions, progress=lambda stage, fraction: False)
            with self.assertRaises(ZeroDivisionError):
                thing.rt.count(origins, directions, progress=lambda stage, fraction: 1 // 0)

    def let_go(self, s, random):
        things = random.choice([s.scenes, s.tracers, s.packed, s.hits, s.lists])
        if things:
            things.pop()
        if random.random() < 0.2:
            gc.collect()

    CALLS = {
        "new_scene": 3, "wrong_scene": 1, "load": 0.05, "new_tracer": 3, "wrong_tracer": 0.5, "closest": 12, "closest_again": 6,
        "read_late": 6, "any": 4, "all": 4, "read_list": 3, "pack": 3, "packed_elsewhere": 1, "wrong_rays": 3, "move": 2,
        "wrong_move": 1, "info": 2, "cancelled": 0.5, "let_go": 4,
    }

    def run_sequence(self, number):
        source = random.Random(f"{SEED} {number}")
        sequence = Sequence(source, self.mesh_file)
        names, weights = list(self.CALLS), list(self.CALLS.values())
        steps = ["new_scene", "new_tracer"] + source.choices(names, weights, k=STEPS)
        seeds = [source.getrandbits(64) for _ in steps]
        failures = []

        def work(thread):
            for i in range(thread, len(steps), sequence.threads):
                try:
                    getattr(self, steps[i])(sequence, random.Random(seeds[i]))
                except BaseException as failure:
                    where = f"CLARITY_SEQUENCES_SEED={SEED} CLARITY_SEQUENCES_FIRST={number}, step {i}, {steps[i]}, {sequence.threads} threads"
                    failure.args = (f"{where}: {failure}",)
                    failures.append(failure)
                    return

        threads = [threading.Thread(target=work, args=(i,)) for i in range(1, sequence.threads)]
        for thread in threads:
            thread.start()
        work(0)
        for thread in threads:
            thread.join()
        if failures:
            raise failures[0]
        return len(steps)

    def test_give_right_hits_and_no_fault(self):
        faulthandler.dump_traceback_later(300 + SECONDS, exit=True)  # hangs
        begin, number, steps = time.monotonic(), FIRST, 0
        while number == FIRST or time.monotonic() < begin + SECONDS:
            steps += self.run_sequence(number)
            number += 1
        faulthandler.cancel_dump_traceback_later()
        print(f"{steps} steps of {number - FIRST} sequences in {time.monotonic() - begin:.1f} s", file=sys.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
