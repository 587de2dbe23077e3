# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The Ruga authors
#
# The program as a user meets it: test_app.py RUGA BUILD_DIR SOURCE_DIR [unittest arguments].
# Results are compared with h5py where it is there, otherwise with h5diff.
import csv
import glob
import json
import math
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

try:
    import h5py
except ImportError:
    h5py = None

RUGA, BUILD, SOURCE = (os.path.abspath(path) for path in sys.argv[1:4])

# The smallest sheet that wrinkles: 9 edges per wavelength, 10 frames of about 50 ms.
# In motion, with creases that yield and one that comes later.
MOVING = """\
mesh: {make: {shape: sheet, size: [40 cm, 30 cm], cells: [12, 9], pattern: diagonal}}
skin: {model: springs, motion: dynamic, thickness: 1 mm, young: 0.5 MPa, density: 300 kg/m^3, damping: 0.1 ms}
interior: none
creases:
  - curve: {polyline: [[-0.5 m, 0.01 m, 0 m], [0.5 m, -0.013 m, 0 m]]}
    hinge: {stiffness: 1 mN, rest: 60 deg, yield: 10 deg, rate: 5 1/s, hardening: 0.1}
  - curve: {polyline: [[-0.19 m, -0.5 m, 0 m], [-0.199 m, 0.5 m, 0 m]]}
    hinge: {stiffness: 2 mN, rest: 90 deg, yield: 30 deg}
    start: 0.25 s
time: {step: 40 ms, frames: 12}
gravity: [0, 0, -9.81]
handles:
  - {region: {box: [[0.19, -1, -1], [1, 1, 1]]}, move: {translate: [0, 0, 5 cm]}, during: [0 s, 0.2 s]}
"""

SCENE = """\
mesh:       {make: {shape: sheet, size: [14 cm, 4 cm], edge: 4.2 mm}}
skin:       {thickness: 2 mm, young: 40 MPa}
interior:   {young: 0.5 MPa, motion: prescribed}
lattice:    {fill: box}
prescribed: [{time: 0 s}, {time: 0.2 s, stretch: [0.95, 1, 1]}]
time:       {step: 20 ms, frames: 10}
"""

# Interior and skin move each other, with inertia.
COUPLED = """\
mesh:     {make: {shape: slab, size: [12 cm, 5 cm, 4 cm], edge: 9 mm}}
skin:     {thickness: 2 mm, young: 10 MPa}
interior: {young: 50 kPa, density: 100 kg/m^3, damping: 5 1/s}
lattice:  {cells: 3}
time:     {step: 10 ms, frames: 8}
gravity:  [0, 0, -9.81]
handles:
  - {region: {plane: {center: [-6 cm, 0, 0], normal: [-1, 0, 0]}}, fix: true}
  - {region: {plane: {center: [6 cm, 0, 0], normal: [1, 0, 0]}}, move: {translate: [-6 mm, 0, 0]}, during: [0 s, 80 ms]}
"""


# A square of paper with two creases that cross, folded from flat by the pattern's angles.
FOLDED = """\
mesh:     {file: cross.fold, scale: 0.1, remesh: {edge: 12 mm}}
skin:     {thickness: 0.3 mm, young: 1 GPa}
interior: none
creases:
  - curve: {fold: cross.fold}
    hinge: {stiffness: 0.02 N, rest: assigned, animate: [{time: 0 s, scale: 0}, {time: 0.2 s, scale: 0.9}]}
time:     {step: 20 ms, frames: 10}
"""
CROSS = """\
{"vertices_coords": [[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0], [1, 0.5], [0.5, 1], [0, 0.5], [0.5, 0.5]],
 "edges_vertices": [[0, 4], [4, 1], [1, 5], [5, 2], [2, 6], [6, 3], [3, 7], [7, 0], [4, 8], [5, 8], [6, 8], [7, 8]],
 "edges_assignment": ["B", "B", "B", "B", "B", "B", "B", "B", "M", "V", "V", "V"],
 "faces_vertices": [[0, 4, 8, 7], [4, 1, 5, 8], [8, 5, 2, 6], [7, 8, 6, 3]]}
"""


def ruga(*arguments, cwd, **more):
    return subprocess.run([RUGA, *map(str, arguments)], cwd=cwd, capture_output=True, text=True, timeout=120, **more)


def datasets(path):
    """All datasets but the timings, as bytes; None without h5py."""
    found = {}

    def visit(name, item):
        if isinstance(item, h5py.Dataset) and "seconds_" not in name:
            found[name] = (str(item.dtype), item.shape, item[()].tobytes() if item.dtype.kind != "O" else str(item[()]))

    with h5py.File(path, "r") as file:
        file.visititems(visit)
    return found


def difference(a, b):
    """Names of datasets that differ in a bit."""
    if h5py:
        left, right = datasets(a), datasets(b)
        return sorted(name for name in left.keys() | right.keys() if left.get(name) != right.get(name))
    if not shutil.which("h5diff"):
        return []
    timings = ["seconds_" + part for part in ("total", "interior", "assembly", "factor", "solve", "other")]
    exclude = [word for name in timings for word in ("--exclude-path", "/stats/" + name)]
    done = subprocess.run(["h5diff", *exclude, a, b], capture_output=True, text=True)
    return [line for line in done.stdout.splitlines() if line.startswith("dataset")] if done.returncode else []


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="ruga_test_")
        self.addCleanup(shutil.rmtree, self.folder)
        self.scene = self.write("scene.yaml", SCENE)

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)
        return self.path(name)

    def ruga(self, *arguments, status=0, **more):
        done = ruga(*arguments, cwd=self.folder, **more)
        self.assertEqual(done.returncode, status, f"{arguments}\n{done.stdout}\n{done.stderr}")
        if status in (2, 3):
            self.assertRegex(done.stderr, r"\Aruga: .+\n\Z", arguments)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        return done

    def refused(self, *arguments, saying):
        self.assertRegex(self.ruga(*arguments, status=2).stderr, saying)

    def json(self, *arguments, status=0):
        return json.loads(self.ruga(*arguments, "--json", status=status).stdout)


def contents(path):
    with open(path, "rb") as file:
        return file.read()


class Help(Case):
    def test_help_teaches_a_session_that_runs(self):
        text = self.ruga("--help").stdout
        lines = [line[4:] for line in text.splitlines() if re.match(r"    [a-z]+: +[\[{]", line)]
        self.write("sheet.yaml", "\n".join(lines))
        session = [line.split()[1:] for line in text.splitlines() if line.startswith("    ruga ")]
        self.assertEqual([words[0] for words in session], ["explain", "run", "measure"])
        self.ruga(*session[0])
        self.ruga(*session[1], "--frames", 1)
        self.ruga(*session[2])

    def test_every_command_explains_itself(self):
        text = self.ruga("--help").stdout
        for name in "make check remesh explain run measure export bake render".split():
            self.assertRegex(text, rf"(?m)^    {name} ")
            about = self.ruga(name, "--help").stdout
            self.assertIn(f"usage: ruga {name} ", about)
            self.assertIn("options:", about)
            self.assertRegex(about, rf"example:\n    ruga {name} ")
            self.assertEqual(about, self.ruga("help", name).stdout)

    def test_version_names_the_libraries(self):
        text = self.ruga("--version").stdout
        for name in ("ruga 0.", "SuiteSparse", "CHOLMOD", "Belos", "OpenVDB", "HDF5", "CGAL", "libyaml", "UDUNITS",
                     "cairo", "OpenEXR"):
            self.assertIn(name, text)
        self.assertNotRegex(text, r"(?m) $")

    def test_unknown_words_are_refused_with_the_nearest(self):
        self.refused(saying="no command")
        self.refused("exprot", saying="did you mean export")
        self.refused("mkae", saying="did you mean make")
        self.refused("--versoin", saying="did you mean --version")
        self.refused("frobnicate", saying="ruga --help")
        self.refused("make", "pilow", "-o", "a.obj", saying="did you mean pillow")
        self.refused("run", "a.yaml", "--thread", "2", saying="did you mean --threads")
        self.refused("run", "a.yaml", saying="-o RESULT.h5 is missing")
        self.refused("run", "a.yaml", "b.yaml", saying="both a.yaml and b.yaml")
        self.refused("run", "a.yaml", "-o", saying="wants a value")
        self.refused("check", saying="no MESH")


class Meshes(Case):
    def test_shapes_have_the_size_asked_for(self):
        shapes = {
            "sheet": ("20 cm,0.1", [0.2, 0.1, 0]),
            "slab": ("0.2,0.1,0.05", [0.2, 0.1, 0.05]),
            "bar": ("0.3,5cm,5cm", [0.3, 0.05, 0.05]),
            "pillow": ("20cm", [0.2, 0.2, 0.06]),
            "sphere": ("0.1", [0.1, 0.1, 0.1]),
            "skirt": ("10 cm,20 cm,360 deg", [0.4, 0.4, 0]),
        }
        for shape, (size, wanted) in shapes.items():
            name = shape + (".ply" if shape == "slab" else ".obj")
            self.ruga("make", shape, "--size", size, "--edge", "2cm", "-o", name)
            flat = wanted[2] == 0
            report = self.json("check", name, "--as", "shell" if flat else "embedded")
            for axis in range(3):
                self.assertAlmostEqual(report["max"][axis] - report["min"][axis], wanted[axis], delta=2e-3, msg=shape)
            self.assertEqual(report["watertight"], not flat)
            self.assertTrue(report["ok"])

    def test_make_refuses(self):
        self.refused("make", "sheet", "--size", "3 kg", "-o", "a.obj", saying="--size")
        self.refused("make", "sheet", "--size", "-1", "-o", "a.obj", saying="above 0")
        self.refused("make", "sheet", "--cells", "3", "-o", "a.obj", saying="two whole numbers")
        self.refused("make", "sheet", "--edge", "1mm", "--cells", "3,3", "-o", "a.obj", saying="exclude")
        self.refused("make", "sheet", "--size", "1,1", "--edge", "1 um", "-o", "a.obj", saying="vertices")
        self.refused("make", "sheet", "-o", "a.stl", saying="obj")
        self.refused("make", "sheet", "-o", "none/a.obj", saying="folder")
        self.refused("make", "miura", "-o", "a.obj", saying="written as .fold")
        self.refused("make", "miura", "--edge", "1mm", "-o", "a.fold", saying="is a crease pattern")
        self.refused("make", "sheet", "--fold", "10 deg", "-o", "a.obj", saying="is a mesh")
        self.refused("make", "pleats", "--cells", "50,1", "-o", "a.fold", saying="do not fit")
        self.refused("make", "arcs", "--size", "2,1", "-o", "a.fold", saying="outer radius")
        self.refused("creases", "scene.yaml", "-o", "a.fold", saying="scene.yaml")
        self.refused("creases", "scene.yaml", "--strength", "2", "-o", "a.fold", saying="not between")
        os.mkdir(self.path("folder.obj"))
        self.refused("make", "sheet", "-o", "folder.obj", saying="is a folder")
        self.assertEqual(sorted(os.listdir(self.folder)), ["folder.obj", "scene.yaml"])

    def test_check_finds_defects_with_their_places(self):
        # A tetrahedron without its last face, with a vertex that no face uses.
        mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 5 5 5\nf 1 3 2\nf 1 2 4\nf 2 3 4\n"
        self.write("open.obj", mesh)
        report = self.json("check", "open.obj", status=2)
        keys = ("vertices triangles edges components watertight genus area volume min max edge_min edge_mean edge_max "
                "angle_min defects errors warnings ok")
        self.assertEqual(set(report), set(keys.split()))
        kinds = {defect["kind"]: defect for defect in report["defects"]}
        self.assertEqual(kinds["open_edge"]["count"], 3)
        self.assertEqual(kinds["open_edge"]["severity"], "error")
        self.assertEqual(kinds["unused_vertex"]["severity"], "warning")
        edges = {tuple(sorted(place["vertices"])) for place in kinds["open_edge"]["places"]}
        self.assertEqual(edges, {(0, 2), (0, 3), (2, 3)})
        self.assertEqual(len(kinds["open_edge"]["places"][0]["position"]), 3)
        self.assertEqual((report["watertight"], report["ok"], report["genus"]), (False, False, None))
        text = self.ruga("check", "open.obj", status=2).stdout
        self.assertRegex(text, r"open_edge \(3\)")
        self.assertTrue(self.json("check", "open.obj", "--as", "shell")["ok"])
        self.assertEqual(self.ruga("check", "open.obj", "--quiet", status=2).stdout, "")

    def test_files_that_are_none(self):
        os.mkdir(self.path("folder"))
        self.refused("check", "missing.obj", saying="missing.obj cannot be read")
        self.refused("check", "folder", saying="is a folder")
        self.refused("run", "folder", "-o", "a.h5", saying="is a folder")
        self.refused("measure", "missing.h5", saying="missing.h5")
        self.refused("measure", "scene.yaml", saying="scene.yaml")
        self.refused("explain", "missing.yaml", saying="missing.yaml")

    def test_remesh_gives_the_edge_asked_for(self):
        self.ruga("make", "pillow", "--size", "20cm", "--edge", "2cm", "-o", "a.obj")
        self.ruga("remesh", "a.obj", "--edge", "12 mm", "-o", "b.ply")
        report = self.json("check", "b.ply")
        self.assertAlmostEqual(report["edge_mean"], 0.012, delta=0.0015)
        self.refused("remesh", "a.obj", "--edge", "0", "-o", "c.obj", saying="above 0")
        self.refused("remesh", "a.obj", "--edge", "5 m", "-o", "c.obj", saying="too long")
        self.refused("remesh", "a.obj", "--edge", "1cm", "--group", "none", "-o", "c.obj", saying="none")


class Scenes(Case):
    def test_explain(self):
        facts = self.json("explain", self.scene)
        self.assertAlmostEqual(facts["wavelength"], 0.03754, delta=1e-4)
        self.assertAlmostEqual(facts["critical_strain"], 0.028, delta=1e-4)
        self.assertAlmostEqual(facts["strain"], 0.05)
        self.assertAlmostEqual(facts["amplitude"], 2e-3 * (facts["strain"] / facts["critical_strain"] - 1) ** 0.5)
        self.assertGreater(facts["edges_per_wavelength"], 8)
        keys = {entry["key"]: entry for entry in facts["keys"]}
        self.assertFalse(keys["skin.thickness"]["default"])
        self.assertTrue(keys["skin.density"]["default"])
        self.assertEqual(facts["degrees_of_freedom"]["skin"], 3 * facts["vertices"])
        for key in "clusters elements superimposed memory_bytes seconds".split():
            self.assertGreaterEqual(facts[key], 0)
        stronger = self.json("explain", self.scene, "--strain", "10%")
        self.assertGreater(stronger["amplitude"], facts["amplitude"])
        self.assertRegex(self.ruga("explain", self.scene).stdout, r"skin.density +900 kg/m\^3 +\(default\)")
        cloth = self.write("cloth.yaml", "mesh: {make: {shape: sheet, size: [20 cm, 20 cm]}}\ninterior: none\n"
                           "skin: {motion: dynamic}\n")
        self.assertGreater(self.json("explain", cloth)["seconds"], 0)

    def test_a_coarse_mesh_is_warned_of_and_then_refused_but_explained(self):
        coarse = ("--set", "mesh.make.edge=7 mm")
        self.assertIn("warning: ", self.ruga("explain", self.scene, *coarse).stderr)
        worse = ("--set", "mesh.make.edge=2 cm")
        facts = self.json("explain", self.scene, *worse, status=2)
        self.assertLess(facts["edges_per_wavelength"], 3)
        self.assertFalse(facts["ok"])
        self.refused("run", self.scene, "-o", "a.h5", *worse, saying="edges per w")
        self.assertFalse(os.path.exists(self.path("a.h5")))

        coarse = self.json("explain", self.scene, *coarse)["warnings"]
        self.assertEqual(len(coarse), 1)
        self.assertIn("edges per wavelength", coarse[0])

    def test_what_only_the_model_refuses_has_its_line_too(self):
        scene = self.write("far.yaml", SCENE + "handles:\n  - {region: {sphere: {center: [9, 9, 9], radius: 1 cm}}, fix: true}\n")
        for command in (("explain", scene), ("run", scene, "-o", "a.h5")):
            self.refused(*command, saying=r"far\.yaml:8: handles\.0: the region \(sphere\) selects no material")
        self.refused("explain", self.scene, "--set", "prescribed.1.stretch=[0, 1, 1]", saying="above 0")
        self.ruga("explain", self.scene, "--set", "prescribed.1={time: 1 s, matrix: [[0, 0, 0], [0, 1, 0], [0, 0, 1]]}")
        self.refused("explain", self.scene, "--strain", "105%", saying="--strain")

    def test_broken_scenes_end_with_a_sentence(self):
        bad = sorted(glob.glob(os.path.join(SOURCE, "tests", "scenes", "bad", "*.yaml")))
        for path in bad:
            with self.subTest(os.path.basename(path)):
                done = self.ruga("run", path, "-o", "bad.h5", "--quiet", status=2)
                self.assertIn(os.path.basename(path), done.stderr)
                self.assertFalse(os.path.exists(self.path("bad.h5")))


class Runs(Case):
    def run_scene(self, name, *more, status=0):
        self.ruga("run", self.scene, "-o", name, *more, status=status)
        return self.path(name)

    def assert_same(self, a, b):
        self.assertEqual(difference(a, b), [])

    def test_progress_results_and_their_use(self):
        done = self.ruga("run", self.scene, "-o", "a.h5")
        lines = [line for line in done.stderr.splitlines() if line.startswith("frame ")]
        self.assertEqual(len(lines), 11)
        self.assertRegex(lines[3], r"^frame 3/10  t 0\.06 s  minimum  \d+ iterations  \d+\.\d\d s .*left ")
        self.assertIn("a.h5: frames 0 to 10", done.stdout)

        m = self.json("measure", "a.h5")
        keys = ("frame time wavelength wavelength_fft wavelength_predicted amplitude outcome residual_shell "
                "residual_coupled constraint_residual volume energy crossings creases")
        self.assertEqual(set(m), set(keys.split()))
        self.assertEqual(set(m["energy"]), set("membrane bending hinge foundation interior kinetic external".split()))
        self.assertEqual((m["frame"], m["outcome"], m["creases"]), (10, "minimum", []))
        self.assertAlmostEqual(m["wavelength"], m["wavelength_predicted"], delta=0.12 * m["wavelength_predicted"])
        self.assertGreater(m["amplitude"], 1e-3)
        self.assertEqual(self.json("measure", "a.h5", "--frame", "0")["time"], 0)
        self.refused("measure", "a.h5", "--frame", "11", saying="from 0 to 10")

        self.check_export()
        self.ruga("render", "a.h5", "--frames", "9:10", "--width", 64, "--height", 48, "-o", "p%d.png",
                  "--color", "displacement")
        for name in ("p9.png", "p10.png"):
            with open(self.path(name), "rb") as file:
                self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")

    def check_export(self):
        self.ruga("export", "a.h5", "--format", "obj", "--frames", "9:10", "-o", "f_%04d.obj")
        self.assertTrue(os.path.exists(self.path("f_0009.obj")))
        facts = self.json("explain", self.scene)
        report = self.json("check", "f_0010.obj", "--as", "shell")
        self.assertEqual((report["vertices"], report["triangles"]), (facts["vertices"], facts["triangles"]))
        self.assertAlmostEqual(report["max"][0] - report["min"][0], 0.95 * 0.14, delta=3e-3)
        self.ruga("export", "a.h5", "--format", "ply", "--subdivide", "1", "--unit", "mm", "-o", "last.ply")
        fine = self.json("check", "last.ply", "--as", "shell")
        self.assertEqual(fine["triangles"], 4 * facts["triangles"])
        self.assertAlmostEqual(fine["max"][0], 1e3 * report["max"][0], delta=2)
        self.refused("export", "a.h5", "--format", "obj", "--frames", "0:3", "-o", "one.obj", saying="%04d")
        self.refused("export", "a.h5", "--format", "obj", "--frames", "3:11", "-o", "a%d.obj", saying="0:10")
        self.refused("export", "a.h5", "--format", "obj", "--frames", "4:3", "-o", "a%d.obj", saying="range")
        self.ruga("export", "a.h5", "-o", "plain.fold")  # without creases: all lines are flat
        self.refused("export", "a.h5", "--unit", "mm", "-o", "b.fold", saying="in metres")
        self.refused("creases", "a.h5", "--min-length", "3 m", "-o", "c.fold", saying="no ridge")
        self.refused("creases", "a.h5", "-o", "c.obj", saying=".fold or .svg")
        self.refused("measure", "a.h5", "--curve", "none/c.csv", saying="folder")
        self.refused("export", "a.h5", "--unit", "kg", "-o", "a.obj", saying="--unit")

    @unittest.skipUnless(h5py, "needs h5py")
    def test_the_result_names_vertices_of_the_file_and_the_libraries(self):
        # A square in two groups, of which one is taken and remeshed: two of its corners are vertices 1 and 2 of the file.
        self.write("two.obj", "v 0 0 0\nv 20 0 0\nv 20 4 0\nv 0 4 0\nv 10 0 0\nv 10 4 0\n"
                   "g left\nf 1 5 6 4\ng right\nf 5 2 3 6\n")
        scene = self.write("two.yaml", """\
mesh:       {file: two.obj, unit: cm, groups: [right], remesh: {edge: 4 mm}}
interior:   {young: 0.5 MPa}
lattice:    {fill: box}
prescribed: [{time: 0 s}]
time:       {frames: 1}
""")
        self.ruga("run", scene, "-o", "two.h5")
        with h5py.File(self.path("two.h5"), "r") as file:
            source, rest = file["mesh/source_vertex"][:], file["mesh/rest"][:]
            versions = file.attrs["library_versions"]
        self.assertEqual(sorted(source[source >= 0]), [1, 2, 4, 5])
        self.assertTrue((abs(rest[source == 2] - [0.2, 0.04, 0]) < 1e-12).all())
        for name in ("HDF5 1.", "CHOLMOD", "Belos", "OpenVDB", "CGAL"):
            self.assertIn(name, versions)
        self.assertIsNone(self.json("measure", "two.h5")["volume"])  # nothing is enclosed
        self.assertRegex(self.ruga("measure", "two.h5").stdout, r"volume +-\n")

    def test_existing_results_and_resume(self):
        whole = self.run_scene("whole.h5")
        part = self.run_scene("part.h5", "--frames", 4)
        self.refused("run", self.scene, "-o", part, saying="exists already")
        self.refused("run", self.scene, "-o", part, "--resume", "--force", saying="give one")
        self.refused("run", self.scene, "-o", part, "--resume", "--set", "skin.thickness=1.9 mm", saying="scene")
        self.refused("run", self.scene, "-o", part, "--resume", "--set", "mesh.make.edge=4 mm", saying="mesh")
        self.run_scene("part.h5", "--resume")
        self.assert_same(whole, part)
        before = os.stat(part).st_mtime_ns
        self.assertIn("complete", self.ruga("run", self.scene, "-o", part, "--resume").stdout)
        self.assertEqual(os.stat(part).st_mtime_ns, before)
        fresh = self.run_scene("fresh.h5", "--resume", "--frames", 2)
        self.run_scene("fresh.h5", "--force")
        self.assert_same(whole, fresh)

    def test_ctrl_c_ends_at_a_whole_frame_that_is_resumed_to_the_same_bits(self):
        whole = self.run_scene("whole.h5")
        command = [RUGA, "run", self.scene, "-o", "cut.h5"]
        with subprocess.Popen(command, cwd=self.folder, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL,
                              text=True) as process:
            said = ""
            while "frame 3/" not in said:
                said = process.stderr.readline()
                self.assertTrue(said, "the run ended too early")
            process.send_signal(signal.SIGINT)
            rest = process.stderr.read()
        self.assertEqual(process.returncode, 130)
        hint = re.search(r"ruga: stopped after frame (\d+) of 10; to go on: ruga (run .*--resume)\n", rest)
        self.assertTrue(hint, rest)
        self.assertLess(int(hint[1]), 10)
        self.assertEqual(self.json("measure", "cut.h5")["frame"], int(hint[1]))
        self.ruga(*hint[2].split())
        self.assert_same(whole, self.path("cut.h5"))

    def kill_and_resume(self, scene, kills, whole):
        """SIGKILL at seeded random moments of runs that each resume the one before."""
        random_numbers, cut, frames = random.Random(7), self.path("killed.h5"), 0
        for _ in range(kills):
            with subprocess.Popen([RUGA, "run", scene, "-o", cut, "--resume", "--quiet"], cwd=self.folder) as process:
                time.sleep(random_numbers.uniform(0.02, 0.9))
                process.kill()
            if h5py and os.path.exists(cut):
                try:
                    file = h5py.File(cut, "r", swmr=True)
                except (OSError, ValueError):
                    file = h5py.File(cut, "r")
                with file:
                    now = len(file["/frames/time"])
                    self.assertGreaterEqual(now, max(frames, 1))
                    self.assertGreaterEqual(len(file["/shell/position"]), now)
                    frames = now
        self.ruga("run", scene, "-o", cut, "--resume")
        self.assert_same(whole, cut)
        os.remove(cut)

    def test_twenty_kills_cost_no_whole_frame_and_no_bit(self):
        self.kill_and_resume(self.scene, 20, self.run_scene("whole.h5"))

    def test_kills_of_a_coupled_run_cost_no_bit(self):
        scene = self.write("coupled.yaml", COUPLED)
        self.ruga("run", scene, "-o", "coupled.h5")
        self.kill_and_resume(scene, 10, self.path("coupled.h5"))

    def test_creases_along_the_ridges_of_a_result(self):
        bent = self.write("bent.yaml", """\
mesh:     {make: {shape: sheet, size: [20 cm, 12 cm], edge: 8 mm}}
skin:     {thickness: 0.3 mm, young: 1 GPa}
interior: none
handles:
  - {region: {plane: {center: [-9.9 cm, 0, 0], normal: [-1, 0, 0]}}, fix: true}
  - {region: {plane: {center: [9.9 cm, 0, 0], normal: [1, 0, 0]}}, move: {translate: [-3 cm, 0, 1 cm]}, during: [0 s, 60 ms]}
time:     {frames: 3}
""")
        self.ruga("run", bent, "-o", "bent.h5")
        ridge = "creases=[{curve: {stress: {result: bent.h5, from: bending}}, hinge: {rest: assigned}}]"
        facts = self.json("explain", bent, "--set", ridge, "--set", "mesh.make.edge=7 mm")  # other triangles
        self.assertEqual(facts["creases"]["curves"], 1)
        self.refused("explain", bent, "--set", ridge, "--set", "mesh.make={shape: pillow, size: 20 cm}", "--set",
                     "handles=[]", saying=r"creases\.0\.curve: bent\.h5 has another surface at rest")

    def test_a_shell_that_nothing_holds_stays_where_it_is_or_is_refused(self):
        scene = self.write("free.yaml", """\
mesh:     {make: {shape: sphere, size: 20 cm, edge: 2 cm}}
skin:     {thickness: 1 mm, young: 1 MPa}
interior: none
handles:  [{region: all, press: -100 Pa}]
time:     {frames: 1}
""")
        self.ruga("run", scene, "-o", "free.h5")  # exit status 0: a minimum, not a saddle for its rigid motions
        # Radius R p R (1 - nu) / (2 E h) more, to first order.
        volume = [self.json("measure", "free.h5", "--frame", k)["volume"] for k in (0, 1)]
        self.assertAlmostEqual((volume[1] / volume[0]) ** (1 / 3) - 1, 0.0035, delta=2e-4)
        self.ruga("run", scene, "-o", "free.h5", "--force", "--set", "handles=[]")
        self.ruga("run", scene, "-o", "free.h5", "--force", "--set", "handles=[{region: all, fix: [z]}]")
        self.ruga("run", scene, "-o", "free.h5", "--force", "--set", "handles=[{region: {vertices: [3]}, fix: true}]")
        saying = "has no equilibrium"
        self.refused("run", scene, "-o", "x.h5", "--set", "handles=[]", "--set", "gravity=[0, 0, -1]", saying=saying)
        self.refused("explain", scene, "--set", "handles=[{region: all, force: [1 N, 0, 0]}]", saying=saying)
        # Two balls, of which one is held.
        self.ruga("make", "sphere", "--size", "20cm", "--edge", "4cm", "-o", "a.obj")
        with open(self.path("a.obj"), encoding="utf-8") as file:
            lines = [line.split() for line in file if line[:2] in ("v ", "f ")]
        vertices = [line[1:] for line in lines if line[0] == "v"]
        faces = [[int(word.split("/")[0]) for word in line[1:]] for line in lines if line[0] == "f"]
        text = "".join(f"v {float(x) + dx} {y} {z}\n" for dx in (0, 1) for x, y, z in vertices)
        text += "".join("f " + " ".join(str(v + k * len(vertices)) for v in face) + "\n" for k in (0, 1) for face in faces)
        self.write("two.obj", text)
        self.ruga("run", scene, "-o", "free.h5", "--force", "--set", "mesh={file: two.obj}", "--set",
                  "handles=[{region: {sphere: {radius: 20 cm}}, fix: true}]")

    def test_neither_kills_nor_threads_cost_a_bit_of_cloth_in_motion(self):
        scene = self.write("moving.yaml", MOVING)
        self.ruga("run", scene, "-o", "moving.h5", "--threads", 1)
        self.ruga("run", scene, "-o", "threads.h5", "--threads", 2)
        self.assert_same(self.path("moving.h5"), self.path("threads.h5"))
        self.kill_and_resume(scene, 4, self.path("moving.h5"))
        self.refused("run", scene, "-o", "wild.h5", "--quiet", "--set", "gravity=[0, 0, -1e9]",
                     saying="cannot be stepped")

    def test_creases_from_a_pattern(self):
        self.write("cross.fold", CROSS)
        scene = self.write("folded.yaml", FOLDED)
        facts = self.json("explain", scene)
        self.assertEqual(facts["creases"]["curves"], 4)
        self.assertGreater(facts["creases"]["pieces"], facts["creases"]["triangles"])
        self.assertIn("freedom full: it meets another", self.ruga("explain", scene).stdout)
        self.ruga("run", scene, "-o", "folded.h5")
        self.assertEqual(self.json("measure", "folded.h5")["outcome"], "minimum")
        self.ruga("export", "folded.h5", "--format", "obj", "--frames", "0:0", "-o", "folded.obj")
        shown = self.json("check", "folded.obj", "--as", "shell")
        self.assertEqual((shown["vertices"], shown["triangles"]), (facts["vertices"], facts["triangles"]))
        self.kill_and_resume(scene, 6, self.path("folded.h5"))
        if h5py:
            with h5py.File(self.path("folded.h5"), "r") as file:
                creases = file["creases"]
                self.assertEqual(creases["names"].asstr()[0], "cross.fold edge 8")
                self.assertEqual(sorted(set(bytes(creases["assignment"][()]).decode())), ["M", "V"])
                self.assertAlmostEqual(sum(creases["length"][()]), 0.2, delta=1e-12)
                self.assertLess(max(creases["gap"][()]), 1e-14)
                signs = [1 if letter == ord("V") else -1 for letter in creases["assignment"][()]]
                for sign, angle in zip(signs, creases["angle"][10]):
                    self.assertGreater(sign * angle, 0.9 * 162 * math.pi / 180)
                rest = file["mesh/rest"][()]
                for (a, b), length in zip(creases["segments"][()], creases["length"][()]):
                    self.assertAlmostEqual(math.dist(rest[a], rest[b]), length, delta=1e-15)
        self.ruga("run", scene, "-o", "other.h5", "--frames", 2, "--threads", 1)
        self.refused("run", scene, "-o", "other.h5", "--resume", "--set", "creases.0.hinge.scale=0.5", saying="scene")

    def test_creases_are_added_to_a_result(self):
        crease = ("  - curve: {{polyline: [[{0}, -1, 0], [{1}, 1, 0]]}}\n"
                  "    hinge: {{stiffness: 0.2 N, rest: {2} deg, yield: 5 deg}}\n    start: {3} s\n")
        text = ("ruga: 1\nmesh: {make: {shape: sheet, size: [20 cm, 14 cm], edge: 15 mm}}\n"
                "skin: {thickness: 0.3 mm, young: 1 GPa}\ninterior: none\ntime: {step: 0.1 s, frames: 4}\n"
                "handles: [{region: {box: [[-1, -1, -1], [-9.9 cm, 1, 1]]}, fix: true}]\ncreases:\n")
        text += crease.format("-4 cm", "-3 cm", 60, 0.15)
        scene = self.write("adds.yaml", text)
        self.ruga("run", scene, "-o", "adds.h5")
        before = contents(self.path("adds.h5"))
        for more, saying in ((crease.format("2 cm", "3 cm", -80, 0.3), "creases.1 comes at 0.3 s"),
                             (crease.format("-60 cm", "53 cm", 80, 0.4), "creases.1, or a crease behind it, needs"),
                             (crease.format("2 cm", "3 cm", 80, 0.4).replace("yield: 5", "yield: 6") + "gravity: [0, 0, -1]\n",
                              "another scene")):
            self.write("adds.yaml", text + more)
            self.refused("run", scene, "-o", "adds.h5", "--resume", "--frames", 6, saying=saying)
            self.assertEqual(contents(self.path("adds.h5")), before)
        self.write("adds.yaml", text + crease.format("2 cm", "3 cm", -80, 0.4))
        self.ruga("run", scene, "-o", "adds.h5", "--resume", "--frames", 5)
        self.write("adds.yaml", text + crease.format("2 cm", "3 cm", -80, 0.4) + crease.format("6 cm", "6.5 cm", 70, 0.55))
        self.ruga("run", scene, "-o", "adds.h5", "--resume", "--frames", 8)
        self.ruga("run", scene, "-o", "whole.h5", "--frames", 8)
        self.assert_same(self.path("whole.h5"), self.path("adds.h5"))
        angles = [c["angle_mean"] for c in self.json("measure", "adds.h5")["creases"]]
        for angle, wanted in zip(angles, (60, -80, 70), strict=True):
            self.assertAlmostEqual(angle, wanted * math.pi / 180, delta=0.05)

    def test_same_bits_for_any_number_of_threads(self):
        first = self.run_scene("0.h5", "--threads", 1, "--frames", 6)
        for k in range(1, 10):
            self.assert_same(first, self.run_scene(f"{k}.h5", "--threads", 1 + k % 2, "--frames", 6, "--quiet"))

    def test_not_converged_is_exit_status_1(self):
        done = self.ruga("run", self.scene, "-o", "a.h5", "--frames", 1, "--set", "solver.tolerance=1e-30", status=1)
        self.assertRegex(done.stdout, r"[1-9]\d* not converged|[1-9]\d* on a saddle")
        self.ruga("run", self.scene, "-o", "a.h5", "--frames", 1, "--set", "solver.tolerance=1e-30", "--resume",
                  status=1)

    def test_quiet_and_json(self):
        done = self.ruga("run", self.scene, "-o", "a.h5", "--frames", 1, "--quiet")
        self.assertEqual((done.stdout, done.stderr), ("", ""))
        summary = self.json("run", self.scene, "-o", "b.h5", "--frames", 2)
        self.assertEqual((summary["frames"], summary["minimum"], summary["saddle"]), (2, 3, 0))

    def test_output_that_cannot_be_written_is_exit_status_3(self):
        if not os.path.exists("/dev/full"):
            self.skipTest("no /dev/full")
        with open("/dev/full", "w", encoding="utf-8") as full:
            done = subprocess.run([RUGA, "--help"], stdout=full, stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 3)
        self.assertRegex(done.stderr, r"\Aruga: the standard output cannot be written: .+\n\Z")
        reader, writer = os.pipe()
        os.close(reader)
        done = subprocess.run([RUGA, "--help"], stdout=writer, stderr=subprocess.PIPE, text=True)
        os.close(writer)
        self.assertEqual(done.returncode, 3)
        self.assertIn("pipe", done.stderr)


class Sweeps(Case):
    GRID = ("--set", "skin.young=[30 MPa, 4e7]", "--set", "skin.thickness=[2 mm, 0.0025]")

    def sweep(self, *more, status=0, grid=GRID, frames=2):
        return self.ruga("sweep", self.scene, *grid, "--set", f"time.frames={frames}", "-o", "map", *more, status=status)

    def rows(self):
        with open(self.path("map/sweep.csv"), newline="", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def test_the_table_holds_what_was_set_and_measured(self):
        done = self.sweep("--jobs", 2)
        self.assertEqual(done.stderr.count("\n"), 4, done.stderr)
        self.assertRegex(done.stderr, r"(?m)^4/4  skin\.young=.+, skin\.thickness=.+: minimum, .+  left")
        rows = self.rows()
        self.assertEqual([(float(r["skin.young"]), float(r["skin.thickness"])) for r in rows],
                         [(3e7, 2e-3), (3e7, 2.5e-3), (4e7, 2e-3), (4e7, 2.5e-3)])
        self.assertEqual([r["skin.young_given"] for r in rows], ["30 MPa", "30 MPa", "4e7", "4e7"])
        for row in rows:
            measured = self.json("measure", os.path.join("map", row["result"]))
            self.assertEqual(measured["frame"], 2)
            for key in ("wavelength", "wavelength_fft", "wavelength_predicted", "amplitude", "residual_shell"):
                self.assertEqual(float(row[key]), measured[key], key)
            self.assertEqual(float(row["energy_membrane"]), measured["energy"]["membrane"])
            self.assertEqual((row["outcome"], row["status"], row["error"]), ("minimum", "0", ""))
        self.ruga("run", self.scene, "-o", "alone.h5", "--frames", 2, "--set", "skin.young=4e7", "--set",
                  "skin.thickness=2 mm")
        self.assertEqual(difference(self.path("alone.h5"), self.path(os.path.join("map", rows[2]["result"]))), [])

    @unittest.skipUnless(h5py, "h5py is not there")
    def test_both_tables_say_the_same(self):
        self.sweep("--quiet")
        rows = self.rows()
        with h5py.File(self.path("map/sweep.h5"), "r") as file:
            self.assertEqual(sorted(file), sorted(rows[0]))
            for name, column in file.items():
                for row, value in zip(rows, column[()]):
                    if isinstance(value, bytes):
                        self.assertEqual(value.decode(), row[name])
                    elif row[name] == "":  # what is not measured here, such as crossings of a body
                        self.assertTrue(math.isnan(value), name)
                    else:
                        self.assertEqual(float(value), float(row[name]))

    def test_complete_points_are_not_run_again_and_keep_their_place(self):
        self.sweep()
        first = {row["result"]: os.stat(self.path("map/" + row["result"])).st_mtime_ns for row in self.rows()}
        again = self.sweep()
        self.assertIn("4 are complete already", again.stdout)
        self.assertEqual(again.stderr, "")
        more = self.sweep(grid=("--set", "skin.young=[30 MPa, 35 MPa, 4e7]", "--set", "skin.thickness=[2 mm, 2.5 mm]"))
        self.assertIn("4 are complete already", more.stdout)
        rows = self.rows()
        self.assertEqual(len(rows), 6)
        self.assertLess(first.keys(), {row["result"] for row in rows})
        for name, written in first.items():
            self.assertEqual(os.stat(self.path("map/" + name)).st_mtime_ns, written)

    def test_ctrl_c_stops_all_runs_and_the_same_command_goes_on(self):
        command = [RUGA, "sweep", self.scene, *self.GRID, "-o", "map", "--jobs", "2"]
        with subprocess.Popen(command, cwd=self.folder, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL,
                              text=True) as process:
            end = time.monotonic() + 60
            while not glob.glob(self.path("map/points/*.h5")) and time.monotonic() < end:
                time.sleep(0.01)
            process.send_signal(signal.SIGINT)
            said = process.stderr.read()
        self.assertEqual(process.returncode, 130, said)
        self.assertIn("the same command goes on", said)
        self.assertIn("not run to its end yet", {row["error"] for row in self.rows()})
        self.ruga(*command[1:])
        rows = self.rows()
        self.assertEqual({row["error"] for row in rows}, {""})
        self.ruga("run", self.scene, "-o", "alone.h5", "--set", "skin.young=30 MPa", "--set", "skin.thickness=2 mm")
        self.assertEqual(difference(self.path("alone.h5"), self.path("map/" + rows[0]["result"])), [])

    def test_a_killed_sweep_leaves_no_run_behind(self):
        command = [RUGA, "sweep", self.scene, *self.GRID, "-o", "map", "--jobs", "2", "--quiet"]

        def runs():
            found = 0
            for name in glob.glob("/proc/[0-9]*/cmdline"):
                try:
                    with open(name, "rb") as file:
                        words = file.read()
                    found += b"\0run\0" in words and self.folder.encode() in words
                except OSError:
                    pass
            return found

        with subprocess.Popen(command, cwd=self.folder) as process:
            end = time.monotonic() + 60
            while not glob.glob(self.path("map/points/*.h5")) and time.monotonic() < end:
                time.sleep(0.01)
            self.assertGreater(runs(), 0)
            process.kill()
        while runs() and time.monotonic() < end:
            time.sleep(0.05)
        self.assertEqual(runs(), 0)
        self.ruga(*command[1:])
        self.assertEqual({row["error"] for row in self.rows()}, {""})

    def test_a_point_starts_afresh_where_its_mesh_has_changed(self):
        self.ruga("make", "sheet", "--size", "14cm,4cm", "--edge", "4.2mm", "-o", "sheet.obj")
        made = "{make: {shape: sheet, size: [14 cm, 4 cm], edge: 4.2 mm}}"
        self.scene = self.write("scene.yaml", SCENE.replace(made, "{file: sheet.obj}"))
        self.sweep()
        old = self.rows()
        self.ruga("make", "sheet", "--size", "14cm,4cm", "--edge", "4mm", "-o", "sheet.obj")
        self.assertIn("0 are complete already", self.sweep().stdout)
        for before, after in zip(old, self.rows()):
            self.assertEqual((before["result"], after["error"]), (after["result"], ""))
            self.assertLess(float(before["edges_per_wavelength"]), float(after["edges_per_wavelength"]))

    def test_bad_input_is_found_before_anything_is_run(self):
        for word, saying in (("skin.young=[]", "no entries"), ("skin.yung=[1, 2]", "did you mean skin.young"),
                             ("skin.young=[1 MPa, 2 mm]", "a length"), ("skin.young=[1 MPa, 1e6]", "the same scene"),
                             ("skin.young=1 MPa", "gives a list"), ("mesh.make.size=[10 cm, 4 cm]", "gives a list"),
                             ("skin.young=[1 MPa", "not valid YAML"), ("skin.young", "key="),
                             ("=[1, 2]", "key=")):
            self.refused("sweep", self.scene, "--set", word, "-o", "map", saying=saying)
            self.assertFalse(os.path.exists(self.path("map")), word)
        self.refused("sweep", self.scene, *self.GRID, "--set", "skin.young=1 MPa", "-o", "map", saying="given twice")
        self.refused("sweep", self.scene, *self.GRID, saying="-o DIR is missing")
        self.refused("sweep", self.scene, *self.GRID, "-o", self.scene, saying="is a file")

    def test_a_point_that_fails_is_told_and_the_others_go_on(self):
        done = self.sweep(grid=("--set", "skin.thickness=[0.1 mm, 2 mm]"), status=1)
        self.assertIn("1 failed", done.stdout)
        rows = self.rows()
        self.assertRegex(rows[0]["error"], "edges per wrinkle wavelength")
        self.assertEqual((rows[0]["status"], rows[0]["outcome"]), ("2", ""))
        self.assertEqual((rows[1]["status"], rows[1]["error"]), ("0", ""))

    def test_lists_of_lists_are_swept_where_the_key_takes_a_list(self):
        done = self.ruga("sweep", self.scene, "--set", "mesh.make.size=[[14 cm, 4 cm], [10 cm, 4 cm]]", "--set",
                         "time.frames=1", "-o", "map", "--json", "--quiet")
        self.assertEqual(done.stderr, "")
        table = json.loads(done.stdout)
        self.assertEqual([p["mesh.make.size"] for p in table["points"]], ["[0.14, 0.04]", "[0.1, 0.04]"])
        self.assertEqual((table["minimum"], table["failed"], table["not_run"]), (2, 0, 0))


class Library(Case):
    def test_all_that_the_headers_declare_is_exported_and_nothing_else(self):
        declared = set()
        for name in ("base.h", "types.h", "ruga.h"):
            with open(os.path.join(SOURCE, "include", "ruga", name), encoding="utf-8") as file:
                declared |= set(re.findall(r"RUGA_API [^;(]*?(ruga_\w+)\(", file.read()))
        symbols = subprocess.run(["nm", "-D", "--defined-only", os.path.join(BUILD, "libruga.so")],
                                 capture_output=True, text=True, check=True).stdout
        self.assertEqual({line.split()[-1] for line in symbols.splitlines()}, declared)

    def test_the_example_is_compiled_against_the_installed_library(self):
        prefix = self.path("prefix")
        subprocess.run(["cmake", "--install", BUILD, "--prefix", prefix], check=True, capture_output=True)
        found = glob.glob(prefix + "/lib/**/ruga.pc", recursive=True)
        self.assertEqual(len(found), 1)
        environment = dict(os.environ, PKG_CONFIG_PATH=os.path.dirname(found[0]))
        flags = subprocess.run(["pkg-config", "--cflags", "--libs", "ruga"], env=environment, check=True,
                               capture_output=True, text=True).stdout.split()
        sanitize = [flag for flag in os.environ.get("RUGA_TEST_CFLAGS", "").split() if flag]
        subprocess.run(["cc", "-std=c17", "-Wall", "-Wextra", "-Wpedantic", "-Werror", *sanitize,
                        os.path.join(SOURCE, "examples", "library.c"), *flags, "-o", "library"],
                       cwd=self.folder, check=True)
        environment["LD_LIBRARY_PATH"] = os.path.dirname(os.path.dirname(found[0]))
        done = subprocess.run(["./library"], cwd=self.folder, env=environment, check=True, capture_output=True,
                              text=True)
        heights = [float(z) for z in re.findall(r"step \d+: z = (-?[\d.]+) mm\n", done.stdout)]
        self.assertEqual(len(heights), 10)
        self.assertTrue(abs(heights[0]) < 0.1 and 0.5 < abs(heights[-1]) < 6, heights)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[4:])
