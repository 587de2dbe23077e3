# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The Ruga authors
#
# Surfaces that nobody here made, from the file to the wrinkled surface without a hand: check, remesh, run, measure,
# export. test_real.py RUGA SOURCE_DIR [unittest arguments]; the surfaces are in $RUGA_DATA or ../shared/data.
import glob
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

SKIPPED = 77
RUGA, SOURCE = (os.path.abspath(path) for path in sys.argv[1:3])
DATA = os.environ.get("RUGA_DATA") or os.path.join(SOURCE, "..", "shared", "data")
SURFACES = os.path.join(DATA, "surface")


def read_obj(path):
    """Vertices and faces (polygons, from 0)."""
    vertices, faces = [], []
    with open(path, encoding="utf-8") as file:
        for line in file:
            words = line.split()
            if words and words[0] == "v":
                vertices.append(tuple(float(word) for word in words[1:4]))
            elif words and words[0] == "f":
                count = len(vertices)
                corners = [int(word.split("/")[0]) for word in words[1:]]
                faces.append([c - 1 if c > 0 else count + c for c in corners])
    return vertices, faces


def watertight(faces):
    """Every edge once in each direction."""
    edges = {}
    for face in faces:
        for edge in zip(face, face[1:] + face[:1]):
            edges[edge] = edges.get(edge, 0) + 1
    return bool(edges) and all(count == 1 and edges.get(edge[::-1]) == 1 for edge, count in edges.items())


def distance(a, b):
    return math.dist(a, b)


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="ruga_real_")
        self.addCleanup(shutil.rmtree, self.folder)

    def ruga(self, *arguments, status=0):
        done = subprocess.run([RUGA, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True,
                              timeout=600)
        self.assertEqual(done.returncode, status, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done

    def json(self, *arguments):
        return json.loads(self.ruga(*arguments, "--json").stdout)

    def simulate(self, scene, mesh, *settings, frames, group=None):
        """check, remesh where the scene asks for it, run, measure and export; what explain and measure said."""
        path = os.path.join(SURFACES, mesh)
        self.assertTrue(self.json("check", path, *(["--group", group] if group else []))["watertight"])
        changes = [word for setting in (f"mesh.file={path}", *settings) for word in ("--set", setting)]
        scene = os.path.join(SOURCE, "examples", scene)
        plan = self.json("explain", scene, *changes)
        # Exit status 0: every frame is a minimum.
        self.ruga("run", scene, "-o", "result.h5", "--frames", frames, *changes)
        for frame in range(1, frames + 1):
            found = self.json("measure", "result.h5", "--frame", frame)
            self.assertEqual(found["outcome"], "minimum")
        self.ruga("export", "result.h5", "--subdivide", 1, "-o", "fine.obj")
        self.ruga("export", "result.h5", "-o", "last.obj")
        self.ruga("export", "result.h5", "--frame", 0, "-o", "first.obj")
        vertices, faces = self.read("last.obj")
        fine_vertices, fine_faces = self.read("fine.obj")
        self.assertEqual(len(fine_faces), 4 * len(faces))
        self.assertEqual(len(fine_vertices), len(vertices) + 3 * len(faces) // 2)
        self.assertTrue(watertight(faces) and watertight(fine_faces))
        return plan, found

    def read(self, name):
        return read_obj(os.path.join(self.folder, name))

    def wrinkled(self, found, thickness):
        """The wavelength of the formula, which knows neither curvature nor handles, within a factor of two."""
        self.assertGreater(found["wavelength"], found["wavelength_predicted"] / 2)
        self.assertLess(found["wavelength"], found["wavelength_predicted"] * 2)
        print(f"wavelength {found['wavelength'] / found['wavelength_predicted']:.3f} of the formula, "
              f"amplitude {found['amplitude'] / thickness:.3f} h")
        self.assertGreater(found["amplitude"], thickness / 4)


class Real(Case):
    def test_market_pillow_wrinkles_where_it_is_squeezed(self):
        _, found = self.simulate("market_pillow.yaml", "market_pillow_watertight.obj", frames=1)
        self.wrinkled(found, 2e-3)

    def test_sofa_cushion_gives_way_under_a_sitter(self):
        _, found = self.simulate("sofa_cushion.yaml", "market_sofa_watertight.obj", frames=5, group="part1")
        self.wrinkled(found, 2.5e-3)

    def test_teddy_lets_its_head_be_pushed_down(self):
        _, found = self.simulate("teddy.yaml", "sh3d_teddyBear_body_watertight.obj", frames=2)
        self.wrinkled(found, 1.5e-3)
        self.assertLess(found["volume"], 6.4e-3)

    def test_head_opens_its_mouth(self):
        plan, _ = self.simulate("head_jaw.yaml", "makehuman_head_watertight.obj", frames=3)
        self.assertGreaterEqual(plan["superimposed"], 1)
        first, last = self.read("first.obj")[0], self.read("last.obj")[0]
        # The lips' facing vertices near the middle, in the file's decimetres.
        middle = [v for v, x in enumerate(first) if abs(x[0]) < 0.03 and x[2] > 1.5]
        lower = [v for v in middle if 6.59 < first[v][1] < 6.607]
        upper = [v for v in middle if 6.607 < first[v][1] < 6.63]
        self.assertTrue(lower and upper)
        gaps = [min(distance(x[a], x[b]) for a in lower for b in upper) for x in (first, last)]
        print(f"lips: {100 * gaps[0]:.2f} mm apart at rest, {100 * gaps[1]:.2f} mm when opened")
        self.assertLess(100 * gaps[0], 2)
        self.assertGreater(100 * (gaps[1] - gaps[0]), 3)


class Unfit(Case):
    def test_surfaces_with_holes_or_crossings_are_refused_in_one_sentence(self):
        seen = 0
        for path in sorted(glob.glob(os.path.join(SURFACES, "*.obj")) + glob.glob(os.path.join(DATA, "fold", "*.obj")) +
                           glob.glob(os.path.join(DATA, "tet", "*.obj"))):
            name = os.path.basename(path)
            if watertight(read_obj(path)[1]):
                continue
            seen += 1
            with self.subTest(name):
                self.ruga("check", path, status=2)
                scene = os.path.join(self.folder, "scene.yaml")
                with open(scene, "w", encoding="utf-8") as file:
                    file.write(f"mesh: {{file: {path}}}\n")
                done = self.ruga("run", scene, "-o", "result.h5", status=2)
                sentences = [line for line in done.stderr.splitlines() if not line.startswith("ruga: warning: ")]
                self.assertEqual(len(sentences), 1, done.stderr)
                self.assertTrue(sentences[0].startswith("ruga: "), done.stderr)
                self.assertIn(name, sentences[0])
                self.assertFalse(os.path.exists(os.path.join(self.folder, "result.h5")))
        self.assertGreaterEqual(seen, 5)


if __name__ == "__main__":
    if not os.path.isdir(SURFACES):
        print(f"skipped: no real meshes at {SURFACES} (set RUGA_DATA)")
        sys.exit(SKIPPED)
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
