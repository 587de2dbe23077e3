# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The Ruga authors
#
# Every scene in examples/ says at its head what to see, and runs: test_examples.py RUGA SOURCE_DIR. So that this takes
# a minute for all of them, made and remeshed surfaces get edges as long as a run allows, and one frame is enough.
# Scenes whose surface is not part of Ruga are held to their head only; test_real.py runs them.
import glob
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest

RUGA, SOURCE = (os.path.abspath(path) for path in sys.argv[1:3])
EDGES = 3.2  # per wavelength; below 3 is refused
SCENES = sorted(glob.glob(os.path.join(SOURCE, "examples", "*.yaml")))


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def ruga(*arguments):
    return subprocess.run([RUGA, *arguments], capture_output=True, text=True, timeout=300)


def head(text):
    """The comment before the first key, without lines that are for script/gallery."""
    lines = []
    for line in text.splitlines():
        if not line.startswith("#"):
            break
        if not line.startswith("# gallery:"):
            lines.append(line[1:].strip())
    return " ".join(lines)


def coarser(facts):
    """What makes the triangles as large as a run allows; twice as large where nothing sets a wavelength."""
    values = {entry["key"]: entry["value"] for entry in facts["keys"]}
    key = next((key for key in ("mesh.remesh.edge", "mesh.make.edge") if key in values), None)
    edges = facts["edges_per_wavelength"]
    return ["--set", f"{key}={float(values[key]) * (edges / EDGES if edges else 2):.6g}"] if key else []


class Examples(unittest.TestCase):
    def test_there_are_at_least_ten(self):
        self.assertGreaterEqual(len(SCENES), 10)

    def test_each_says_what_to_see(self):
        for path in SCENES:
            text = head(read(path))
            self.assertGreater(len(text.split()), 8, f"{path}: no comment at its head says what to see")
            self.assertRegex(text, r"[.:]", path)

    def test_each_runs(self):
        ran = 0
        for path in SCENES:
            with self.subTest(path=path), tempfile.TemporaryDirectory() as folder:
                done = ruga("explain", path, "--json")
                if "cannot be read: No such file" in done.stderr:
                    self.assertRegex(read(path), r"(?s)\A#.*not part of Ruga", path)
                    continue
                self.assertEqual(done.returncode, 0, done.stderr)
                facts = json.loads(done.stdout)
                self.assertGreater(facts["memory_bytes"], 1e5, path)
                self.assertGreater(facts["seconds_per_frame"], 1e-3, path)
                self.assertNotIn("allow_coarse: true", read(path))
                sets = coarser(facts)
                done = ruga("run", path, "-o", os.path.join(folder, "result.h5"), "--frames", "1", "--threads", "1",
                            "--quiet", *sets)
                self.assertIn(done.returncode, (0, 1), f"{path} {sets}\n{done.stderr}")
                done = ruga("measure", os.path.join(folder, "result.h5"), "--json")
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual(json.loads(done.stdout)["frame"], 1)
                ran += 1
        self.assertGreaterEqual(ran, 6)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
