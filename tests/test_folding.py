#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The Ruga authors
"""Crease patterns from the command line to the folded sheet, against closed forms.

    test_folding.py RUGA BUILD_DIR

A Miura-ori that is made, meshed without regard to its creases and pressed together between two edges; patterns by
others, folded from flat by their rest angles (skipped where they are not there: RUGA_DATA). Exit status 77 where h5py
is missing.
"""
import csv
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

try:
    import h5py
    import numpy as np
except ImportError:
    sys.exit(77)

RUGA = os.path.abspath(sys.argv[1])
BUILD = os.path.abspath(sys.argv[2])
DATA = os.environ.get("RUGA_DATA", os.path.join(os.path.dirname(os.path.dirname(os.path.dirname(
    os.path.abspath(__file__)))), "shared", "data"))

CELLS, SIDE, GAMMA = 8, 0.02, math.radians(60)
STIFFNESS, DRAWN = 0.01, math.radians(25)  # N; slope at which the hinges rest

MIURA = """
ruga: 1
mesh: {file: %(file)s, remesh: {edge: 12 mm}}
skin: {thickness: 0.6 mm, young: 4 GPa, poisson: 0.3, density: 700 kg/m^3}
interior: none
creases:
  - curve: {fold: %(file)s}
    hinge: {stiffness: %(stiffness)s N, rest: assigned, animate: %(animate)s}
start: {fold: %(start)s}
time: {step: 100 ms, frames: 11}
solver: {tolerance: 1e-8}
handles:
  - {region: {plane: {center: [-%(end).9g, 0, 0], normal: [-1, 0, 0]}}, move: {translate: [%(way)s mm, 0, 0], axes: [x]},
     during: [0.1 s, 1.1 s]}
  - {region: {plane: {center: [%(end).9g, 0, 0], normal: [1, 0, 0]}}, move: {translate: [-%(way)s mm, 0, 0], axes: [x]},
     during: [0.1 s, 1.1 s]}
  # Three vertices of the pattern keep the sheet from drifting and turning: they are at one height at any fold.
  - {region: {sphere: {center: [0, %(near).9g, %(low).9g], radius: 0.1 mm}}, fix: [y, z]}
  - {region: {sphere: {center: [0, %(far).9g, %(low).9g], radius: 0.1 mm}}, fix: [z]}
  - {region: {sphere: {center: [%(aside).9g, %(near).9g, %(low).9g], radius: 0.1 mm}}, fix: [z]}
"""

PATTERN = """
ruga: 1
mesh: {file: %(file)s, scale: 0.2, remesh: {edge: %(edge)s}}
skin: {thickness: %(thickness)s, young: %(young)s, poisson: 0.3, density: 900 kg/m^3}
interior: none
creases:
  - curve: {fold: %(file)s}
    hinge: {stiffness: 0.02 N, rest: assigned, scale: %(scale)s, animate: [{time: 0 s, scale: 0}, {time: 1 s, scale: 1}]}
time: {step: 100 ms, frames: 10}
"""


def setUpModule():
    global FOLDER
    FOLDER = tempfile.mkdtemp(dir=BUILD)


def tearDownModule():
    shutil.rmtree(FOLDER)


def ruga(*arguments):
    done = subprocess.run([RUGA, *map(str, arguments)], cwd=FOLDER, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True)
    assert done.returncode == 0, (arguments, done.stdout, done.stderr)
    return done


def write(name, text):
    with open(os.path.join(FOLDER, name), "w", encoding="utf-8") as file:
        file.write(text)


def run(name, text):
    write(name + ".yaml", text)
    done = ruga("run", name + ".yaml", "-o", name + ".h5", "--threads", 1)
    return h5py.File(os.path.join(FOLDER, name + ".h5"), "r"), done


def largest_strain(file, frame):
    """Of the mesh's edges, but for those shorter than a tenth of the usual one."""
    triangle, rest, x = file["mesh/triangles"][:], file["mesh/rest"][:], file["shell/position"][frame]
    edges = np.vstack([triangle[:, [i, (i + 1) % 3]] for i in range(3)])
    before = np.linalg.norm(rest[edges[:, 0]] - rest[edges[:, 1]], axis=1)
    after = np.linalg.norm(x[edges[:, 0]] - x[edges[:, 1]], axis=1)
    long_enough = before > 0.1 * np.median(before)
    return np.abs(after / before - 1)[long_enough].max()


def reached(file):
    """Angle over rest angle in the last frame: of each segment, and the mean of each crease."""
    group = file["creases"]
    angle, rest, crease, length = group["angle"][-1], group["rest_angle"][-1], group["segment_crease"][:], group["length"][:]
    return angle / rest, np.array([np.average((angle / rest)[crease == c], weights=length[crease == c])
                                   for c in np.unique(crease)])


class Miura(unittest.TestCase):
    """Schenk and Guest 2013."""

    @classmethod
    def setUpClass(cls):
        size = "%.17g,%.17g" % (CELLS * SIDE * math.sin(GAMMA), (CELLS + math.cos(GAMMA)) * SIDE)
        ruga("make", "miura", "--cells", "%d,%d" % (CELLS, CELLS), "--size", size, "--fold", "25 deg", "-o", "miura.fold")
        # Hinges that rest at one slope before anything is pressed, which tells the sheet the way.
        cls.file, _ = run("miura", cls.scene("miura.fold", 0, STIFFNESS, "[{time: 0 s, scale: 0}, {time: 0.1 s, scale: 1}]"))
        # Free hinges, of a sheet that is folded to that slope.
        cls.free, _ = run("free", cls.scene("miura.fold", 0, 0, "[]", start=1, way=14))

    @classmethod
    def scene(cls, file, theta, stiffness, animate, start=0, way=16.91):
        """Pressed from where the mesh has the slope theta."""
        corners = cls.corners(theta)
        near, far, aside = corners[4, 4], corners[4, 6], corners[6, 4]
        return MIURA % {"file": file, "stiffness": stiffness, "animate": animate, "start": start, "way": way,
                        "end": corners[-1, 0, 0] - 1e-6, "near": near[1], "far": far[1], "aside": aside[0], "low": near[2]}

    @classmethod
    def tearDownClass(cls):
        cls.file.close()
        cls.free.close()

    @staticmethod
    def vertex(i, j, theta):
        slope, rise = math.cos(theta) * math.tan(GAMMA), math.sin(theta) * math.sin(GAMMA)
        q = math.sqrt(1 + slope ** 2)
        return np.array([i * SIDE * slope / q, j * SIDE * math.sqrt(1 - rise ** 2) + i % 2 * SIDE / q, j % 2 * SIDE * rise])

    @staticmethod
    def slope_of(s):
        """The slope at which a cell is s wide: S = b cos t tan g / q, so cos t tan g = (S/b) / sqrt(1 - (S/b)^2)."""
        part = s / SIDE
        return math.acos(min(1, part / math.sqrt(1 - part ** 2) / math.tan(GAMMA)))

    @staticmethod
    def hinge_energy(theta):
        def angles(t):
            return 2 * t, 2 * math.atan(math.cos(GAMMA) * math.tan(t))
        length = CELLS * (CELLS - 1) * SIDE
        return sum(0.5 * STIFFNESS * length * (a - b) ** 2 for a, b in zip(angles(theta), angles(DRAWN)))

    @classmethod
    def corners(cls, theta):
        """Of the panels, about the middle of what they are in."""
        x = np.array([[cls.vertex(i, j, theta) for j in range(CELLS + 1)] for i in range(CELLS + 1)])
        return x - (x.min(axis=(0, 1)) + x.max(axis=(0, 1))) / 2

    def grid(self, file, theta=0):
        off = np.linalg.norm(file["mesh/rest"][:] - self.corners(theta)[:, :, None], axis=3)
        self.assertLess(off.min(axis=2).max(), 1e-12)
        return off.argmin(axis=2)

    def sizes(self, file, theta=0):
        """S, L and H of each frame from 2 on, where it is pressed."""
        grid, x = self.grid(file, theta), file["shell/position"][2:]
        s = (x[:, grid[-1], 0] - x[:, grid[0], 0]).mean(axis=1) / CELLS
        l = (x[:, grid[:, -1], 1] - x[:, grid[:, 0], 1]).mean(axis=1) / CELLS
        h = x[:, grid[:, 1::2], 2].mean(axis=(1, 2)) - x[:, grid[:, 0::2], 2].mean(axis=(1, 2))
        return s, l, h

    def keeps_to_its_one_freedom(self, file, theta=0):
        self.assertTrue((file["stats/outcome"][:] == 0).all())
        s, l, h = self.sizes(file, theta)
        exact = np.array([self.vertex(0, 1, self.slope_of(width))[1:] for width in s])
        self.assertGreater(math.degrees(self.slope_of(s[-1])), 58)
        self.assertLess(np.abs(l / exact[:, 0] - 1).max(), 1e-8)
        self.assertLess(np.abs(h / exact[:, 1] - 1).max(), 1e-8)
        self.assertLess(file["creases/gap"][:].max(), 1e-12 * SIDE)
        self.assertLess(np.abs(file["stats/handle_force"][:]).max(), 1e-6)
        # -(dL/L)/(dS/S) = -cos^2 theta tan^2 gamma: between frames, its mean along the way is compared.
        measured, mean = np.diff(np.log(l)) / np.diff(np.log(s)), np.diff(np.log(exact[:, 0])) / np.diff(np.log(s))
        self.assertLess(np.abs(measured / mean - 1).max(), 1e-7)
        for k, width in enumerate(s):  # and that mean is the formula's where the way is short
            theta, step = self.slope_of(width), 1e-5
            near = [self.vertex(1, 1, theta + d) - self.vertex(0, 0, 0) for d in (-step, step)]
            cell = [self.vertex(0, 1, theta + d) for d in (-step, step)]
            ratio = math.log(cell[1][1] / cell[0][1]) / math.log(near[1][0] / near[0][0])
            self.assertAlmostEqual(ratio, (math.cos(theta) * math.tan(GAMMA)) ** 2, delta=1e-7, msg=k)

    def test_with_free_hinges_it_keeps_to_its_one_freedom(self):
        self.keeps_to_its_one_freedom(self.free)

    def test_a_folded_form_is_a_rest_shape(self):
        """Panels, and a mesh of them that knows the folds; in the file nothing but lines that fold."""
        face = [[i * 9 + j, i * 9 + j + 9, i * 9 + j + 10, i * 9 + j + 1] for i in range(CELLS) for j in range(CELLS)]
        edges = [tuple(sorted((f[k], f[k - 1]))) for f in face for k in range(4)]
        with open(os.path.join(FOLDER, "folded_miura.fold"), "w", encoding="utf-8") as out:
            json.dump({"file_spec": 1.1, "frame_classes": ["foldedForm"], "frame_unit": "m",
                       "vertices_coords": self.corners(DRAWN).reshape(-1, 3).tolist(), "faces_vertices": face, "edges_vertices": sorted(set(edges)),
                       "edges_assignment": ["B" if edges.count(e) == 1 else "U" for e in sorted(set(edges))]}, out)
        text = self.scene("folded_miura.fold", DRAWN, 0, "[]", way=14).replace("rest: assigned, ", "")
        file, _ = run("folded_form", text)
        self.addCleanup(file.close)
        self.assertEqual(len(file["creases/names"]), 2 * CELLS * (CELLS - 1))
        self.keeps_to_its_one_freedom(file, DRAWN)

    def test_the_force_is_the_slope_of_the_hinges_energy(self):
        s, _, _ = self.sizes(self.file)
        force = self.file["stats/handle_force"][2:]
        self.assertLess(np.abs(force[:, 0, 0] + force[:, 1, 0]).max(), 1e-6)
        for k, width in enumerate(s):
            step = 1e-6 * SIDE
            slope = (self.hinge_energy(self.slope_of(width + step)) - self.hinge_energy(self.slope_of(width - step))) / (
                2 * step * CELLS)
            self.assertAlmostEqual(force[k, 0, 0], -slope, delta=0.02 * abs(slope))

    def test_panels_stay_flat(self):
        self.assertTrue((self.file["stats/outcome"][:] == 0).all())
        hinge, bending = self.file["stats/energy_hinge"][2:], self.file["stats/energy_bending"][2:]
        self.assertLess((bending / hinge).max(), 0.01)
        self.assertLess(largest_strain(self.file, -1), 1e-4)

    def test_measure_says_what_the_creases_do(self):
        m = json.loads(ruga("measure", "miura.h5", "--json").stdout)
        self.assertEqual(len(m["creases"]), 2 * CELLS * (CELLS - 1))
        self.assertAlmostEqual(sum(c["hinge_energy"] for c in m["creases"]), m["energy"]["hinge"],
                               delta=1e-9 * m["energy"]["hinge"])
        self.assertEqual(m["crossings"], 0)
        gap, crease = self.file["creases/segment_gap"][-1], self.file["creases/segment_crease"][:]
        self.assertEqual([c["gap"] for c in m["creases"]], [gap[crease == c].max() for c in np.unique(crease)])
        self.assertEqual(gap.max(), self.file["creases/gap"][-1])
        theta = self.slope_of(self.sizes(self.file)[0][-1])
        for c in m["creases"]:
            self.assertAlmostEqual(c["length"], SIDE, delta=1e-9)
            self.assertTrue(c["angle_min"] <= c["angle_mean"] <= c["angle_max"])
            self.assertEqual(c["angle_mean"] > 0, c["assignment"] == "V")
            self.assertLess(c["gap"], 1e-13)
            near = min((2 * theta, 2 * math.atan(math.cos(GAMMA) * math.tan(theta))), key=lambda a: abs(a - abs(c["angle_mean"])))
            self.assertAlmostEqual(abs(c["angle_mean"]), near, delta=0.01)
        self.assertIn("deg", ruga("measure", "miura.h5", "--frame", 3).stdout)

    def test_forces_over_frames_are_a_table(self):
        ruga("measure", "miura.h5", "--curve", "force.csv")
        with open(os.path.join(FOLDER, "force.csv"), encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 12)
        self.assertAlmostEqual(float(rows[-1]["size_x"]), CELLS * self.sizes(self.file)[0][-1], delta=1e-8)
        self.assertAlmostEqual(float(rows[7]["force_1_x"]), self.file["stats/handle_force"][7, 1, 0], delta=1e-8)
        self.assertAlmostEqual(float(rows[7]["energy_hinge"]), self.file["stats/energy_hinge"][7], delta=1e-9)

    def test_folded_frames_are_read_back(self):
        ruga("export", "miura.h5", "--frames", "1:11", "-o", "folded.fold")
        with open(os.path.join(FOLDER, "folded.fold"), encoding="utf-8") as file:
            fold = json.load(file)
        self.assertEqual(len(fold["file_frames"]), 10)
        self.assertTrue((np.array(fold["file_frames"][-1]["vertices_coords"]) == self.file["shell/position"][-1]).all())
        angle = {frozenset(e): a for e, a in zip(fold["edges_vertices"], fold["file_frames"][-1]["edges_foldAngle"])}
        letter = {frozenset(e): a for e, a in zip(fold["edges_vertices"], fold["edges_assignment"])}
        creases = self.file["creases"]
        for ends, wanted in zip(creases["segments"][:], creases["angle"][-1]):
            self.assertAlmostEqual(math.radians(angle[frozenset(ends.tolist())]), wanted, delta=1e-12)
            self.assertEqual(letter[frozenset(ends.tolist())], "V" if wanted > 0 else "M")
        # The angles of the last frame, as the rest angles of a new scene on the flat sheet's own curves.
        write("again.yaml", "ruga: 1\nmesh: {file: folded.fold}\ninterior: none\n"
                            "creases: [{curve: {fold: folded.fold}, hinge: {rest: assigned}}]\ntime: {step: 1 s, frames: 1}\n")
        self.assertIn("creases", ruga("explain", "again.yaml").stdout)


class Found(unittest.TestCase):
    def test_a_fold_is_found_from_what_bends(self):
        """A sheet folded about a slanting line; the curve found, folded about in turn, folds the other sheet alike."""
        scene = ("ruga: 1\nmesh: {make: {shape: sheet, size: [20 cm, 15 cm], edge: 8 mm}}\ninterior: none\n"
                 "skin: {thickness: 0.5 mm, young: 1 GPa}\ntime: {step: 1 s, frames: 1}\n"
                 "creases: [{curve: %s, hinge: {stiffness: 1 N, rest: 60 deg}}]\n")
        run("drawn", scene % "{polyline: [[-0.1, -0.03, 0], [0.1, 0.04, 0]]}")[0].close()
        done = ruga("creases", "drawn.h5", "-o", "found.svg")
        self.assertIn("found.svg: 1 curves\n  valley", done.stdout)
        ruga("creases", "drawn.h5", "-o", "found.fold")
        with open(os.path.join(FOLDER, "found.fold"), encoding="utf-8") as file:
            fold = json.load(file)
        ends = [e for e, a in zip(fold["edges_vertices"], fold["edges_assignment"]) if a == "V"]
        points = np.array(fold["vertices_coords"])[np.unique(ends)]
        way = np.array([0.2, 0.07]) / math.hypot(0.2, 0.07)
        off = (points - [0, 0.005]) @ [-way[1], way[0]]
        self.assertLess(np.abs(off).max(), 8e-3)
        self.assertGreater(np.ptp(points @ way), 0.19)
        again, _ = run("again", scene % "{fold: found.fold}")
        self.assertAlmostEqual(again["creases/angle"][-1].mean(), math.radians(60), delta=0.05)
        again.close()


class Others(unittest.TestCase):
    """scale: part of the file's angles; stiffness of panels and thickness as parts of the sheet's size."""

    def fold(self, name, scale, edges, thickness, rigidity):
        path = os.path.join(DATA, "fold", name + ".fold")
        if not os.path.exists(path):
            self.skipTest(path + " is not there (set RUGA_DATA)")
        with open(path, encoding="utf-8") as file:
            corner = 0.2 * np.array(json.load(file)["vertices_coords"])
        size = math.sqrt(np.prod(np.ptp(corner[:, :2], axis=0)))
        h = thickness * size
        young = rigidity * 0.02 * size * 12 * (1 - 0.3 ** 2) / h ** 3
        file, done = run(name, PATTERN % {"file": path, "scale": scale, "edge": size / edges, "thickness": h, "young": young})
        self.addCleanup(file.close)
        self.assertLess(file["creases/gap"][:].max(), 1e-12)
        self.assertTrue((file["stats/outcome"][:] == 0).all())
        return file, done

    def test_a_vertex_of_four_creases_folds_over(self):
        file, _ = self.fold("simpleVertex", 0.9, 10, 0.02, 0.05)
        self.assertGreater(reached(file)[0].min(), 0.95)

    def test_miura_folds(self):
        file, _ = self.fold("miura-ori", 0.9, 11, 0.01, 10)
        self.assertGreater(reached(file)[0].min(), 0.95)
        self.assertLess(largest_strain(file, -1), 1e-4)

    def test_waterbombs_fold(self):
        file, _ = self.fold("waterbomb", 0.9, 22, 0.06, 0.5)
        self.assertGreater(reached(file)[0].min(), 0.95)

    def test_curved_creases_fold_without_stretching(self):
        file, done = self.fold("wavy_pleats", 0.3, 30, 0.0008, 0.01)
        each, _ = reached(file)
        self.assertLess(np.abs(each - 1).max(), 0.1)
        self.assertLess(largest_strain(file, -1), 1e-3)
        self.assertIn("cannot fold flat", done.stderr)

    def test_cuts_open(self):
        file, _ = self.fold("honeycombKiri", 0.9, 25, 0.01, 0.1)
        rest, x = file["mesh/rest"][:], file["shell/position"][-1]
        # The two sides of a cut coincide at rest and part.
        order = np.lexsort(np.round(rest[:, :2], 9).T)
        same = np.linalg.norm(np.diff(rest[order], axis=0), axis=1) < 1e-9
        apart = np.linalg.norm(x[order[1:]] - x[order[:-1]], axis=1)[same]
        self.assertGreater(same.sum(), 100)
        self.assertGreater(np.median(apart), 1e-3)
        self.assertGreater(reached(file)[0].min(), 0.95)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]] + sys.argv[3:])
