#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The Ruga authors
"""`ruga render`, `plot`, `view` and `run --preview` as a user calls them.

    test_pictures.py RUGA SOURCE_DIR
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy

from picture import pixels

RUGA, SOURCE = (os.path.abspath(path) for path in (sys.argv.pop(1), sys.argv.pop(1)))
SCENE = """
mesh:       {make: {shape: sheet, size: [12 cm, 4 cm], edge: 4 mm}}
skin:       {thickness: 2 mm, young: 40 MPa}
interior:   {young: 0.5 MPa, motion: prescribed}
lattice:    {fill: box}
prescribed: [{time: 0 s}, {time: 60 ms, stretch: [0.92, 1, 1]}]
time:       {step: 20 ms, frames: 3}
"""
SHELL = """
mesh:     {make: {shape: sheet, size: [12 cm, 4 cm], edge: 8 mm}}
skin:     {thickness: 1 mm, young: 1 MPa}
interior: none
gravity:  [0, -9.81, 0]
handles:  [{region: {plane: {center: [-5 cm, 0, 0], normal: [-1, 0, 0]}}, fix: true}]
time:     {step: 20 ms, frames: 1}
"""
FOLDED = """
mesh:     {make: {shape: sheet, size: [12 cm, 4 cm], edge: 8 mm}}
skin:     {thickness: 0.2 mm, young: 10 MPa}
interior: none
creases:
  - curve: {polyline: [[-2 cm, -3 cm, 0], [-2 cm, 3 cm, 0]]}
    hinge: {stiffness: 0.5 N, animate: [{time: 0 s, angle: 0 deg}, {time: 40 ms, angle: 40 deg}]}
  - curve: {polyline: [[2 cm, -3 cm, 0], [2 cm, 3 cm, 0]]}
    hinge: {stiffness: 0.5 N, animate: [{time: 0 s, angle: 0 deg}, {time: 40 ms, angle: -30 deg}]}
handles:  [{region: {sphere: {center: [0, 0, 0], radius: 9 mm}}, fix: true}]
time:     {step: 20 ms, frames: 2}
"""
CUT = """
mesh:     {make: {shape: sheet, size: [12 cm, 4 cm], edge: 8 mm}}
skin:     {thickness: 0.2 mm, young: 10 MPa}
interior: none
gravity:  [0, -9.81, 0]
creases:  [{curve: {polyline: [[1 mm, -3 cm, 0], [1 mm, 3 cm, 0]]}, cut: true}]
handles:
  - {region: {plane: {center: [0, 0, 0], normal: [-1, 0, 0]}}, fix: true}
  - {region: {plane: {center: [2 mm, 0, 0], normal: [1, 0, 0]}}, move: {translate: [4 cm, 0, 0]}, during: [0 s, 20 ms]}
time:     {step: 20 ms, frames: 1}
"""
SIZE = ("--width", "120", "--height", "90")


class Pictures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = cls.scratch.name
        for name, text in (("sheet", SCENE), ("shell", SHELL), ("folded", FOLDED)):
            with open(cls.path(name + ".yaml"), "w", encoding="utf-8") as file:
                file.write(text)
            done = cls.call("run", name + ".yaml", "-o", name + ".h5", "--quiet")
            assert done.returncode in (0, 1), done.stderr

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    @classmethod
    def call(cls, *words, **more):
        return subprocess.run([RUGA, *map(str, words)], cwd=cls.folder, capture_output=True, text=True, timeout=300,
                              check=False, **more)

    def ruga(self, *words, **more):
        done = self.call(*words, **more)
        self.assertEqual(done.returncode, 0, f"{words}\n{done.stderr}")
        return done.stdout

    def refused(self, *words, saying, **more):
        done = self.call(*words, **more)
        self.assertEqual(done.returncode, 2, f"{words}\n{done.stdout}{done.stderr}")
        self.assertRegex(done.stderr, r"\Aruga: .+\n\Z")
        self.assertRegex(done.stderr, saying)

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    # ---- render ----------------------------------------------------------------------------------------

    def test_each_colouring_has_its_picture_and_says_its_scale(self):
        saying = {"clay": r"\A\S+png\n\Z", "displacement": r"colours from -\S+ to \S+: displacement, mm",
                  "stress": r"colours from 0 to \S+: von Mises stress, [kM]Pa", "clusters": r"\d+ clusters, ",
                  "elements": r"\d+ elements of \S+ x \S+ x \S+ mm, 0 of them superimposed"}
        seen = set()
        for color, text in saying.items():
            self.assertRegex(self.ruga("render", "sheet.h5", "--color", color, *SIZE, "-o", color + ".png"), text)
            seen.add(self.read(color + ".png"))
        self.assertRegex(self.ruga("render", "folded.h5", "--color", "creases", *SIZE, "-o", "creases.png"),
                         r"colours from -(\S+) to \1: fold angle, deg")
        seen.add(self.read("creases.png"))
        for more in ("--wireframe", "--plain", "--camera=top", "--up=x"):
            self.ruga("render", "sheet.h5", more, *SIZE, "-o", "more.png")
            seen.add(self.read("more.png"))
        self.assertEqual(len(seen), 10)

    def test_what_a_result_has_not_is_refused(self):
        self.refused("render", "sheet.h5", "--color", "creases", "-o", "a.png", saying="no creases")
        self.refused("render", "sheet.h5", "--color", "young", "-o", "a.png", saying="does not vary")
        for color in ("displacement", "clusters", "elements"):
            self.refused("render", "shell.h5", "--color", color, "-o", "a.png", saying="no interior")
        self.refused("render", "sheet.h5", "--color", "mud", "-o", "a.png", saying="none of clay")
        self.refused("render", "sheet.h5", "--camera", "there", "-o", "a.png", saying="azimuth,elevation")
        self.refused("render", "sheet.h5", "--camera", "0deg,120deg", "-o", "a.png", saying="-90 and 90")
        self.refused("render", "sheet.h5", "--turntable", "3", "-o", "a.png", saying="%04d")
        self.refused("render", "sheet.h5", saying="-o PNG is missing")
        self.assertFalse(os.path.exists(self.path("a.png")))

    def test_odd_results_end_with_one_sentence(self):
        """Frames that are no places, far ones, a single one, a point; nothing may be left behind."""
        def change(name, edit):
            shutil.copy(self.path("sheet.h5"), self.path(name))
            with h5py.File(self.path(name), "r+") as file:
                edit(file)

        def keep_one(file):
            frames = file["frames/time"].shape[0]
            found = []
            file.visititems(lambda _, item: found.append(item) if isinstance(item, h5py.Dataset) else None)
            for item in found:
                if item.maxshape[:1] == (None,) and item.shape[0] == frames:
                    item.resize(1, axis=0)

        def put(value, where=(3, 7, 2), name="shell/position"):
            def edit(file):
                file[name][where] = value
            return edit

        os.makedirs(self.path("out"))
        commands = (("render", *SIZE, "-o", "out/a_%d.png"),
                    ("render", *SIZE, "--color", "displacement", "-o", "out/b.png"),
                    ("plot", "-o", "out/c.svg"), ("measure", "--json"), ("view", "-o", "out/d.html"),
                    ("export", "-o", "out/e.obj"), ("export", "-o", "out/f.glb"), ("measure", "--curve", "out/g.csv"))
        for value, name, some in ((numpy.nan, "position", commands), (1e300, "position", commands[:1] + commands[4:5]),
                                  (-numpy.inf, "embedded", commands[1:5])):
            change("odd.h5", put(value, name="shell/" + name))
            for command, *words in some:
                self.refused(command, "odd.h5", *words, saying=r"frame 3.*: coordinate z of vertex 7 is")
                self.assertEqual([f for f in os.listdir(self.path("out")) if not f.startswith("a_")], [], command)
            self.ruga("render", "odd.h5", *SIZE, "--frame", "2", "-o", "whole.png")  # another frame is shown
        change("odd.h5", put(numpy.nan, name="mesh/rest", where=(7, 2)))
        self.refused("measure", "odd.h5", saying="/mesh/rest: coordinate z of vertex 7 is nan")
        change("odd.h5", put(numpy.nan, name="frames/time", where=1))  # of the last one: it is not there yet
        self.refused("export", "odd.h5", "-o", "out/f.glb", saying="frame 1: its time is nan")
        for edit, some in ((put(1e20), commands[:2]), (put(0.0, ...), commands[:3]), (keep_one, commands)):
            change("odd.h5", edit)
            for command, *words in some:
                done = self.call(command, "odd.h5", *words)
                self.assertTrue(done.returncode == 0 or "without npm" in done.stderr, f"{words} {done.stderr}")
        for size in (1e-7, 1e7):
            shutil.copy(self.path("folded.h5"), self.path("odd.h5"))
            with h5py.File(self.path("odd.h5"), "r+") as file:
                for name in ("mesh/rest", "shell/position"):
                    file[name][...] *= size
            self.ruga("render", "odd.h5", *SIZE, "-o", "size.png")
            self.assertGreater(len(self.read("size.png")), 2000)
        self.refused("render", "sheet.h5", "--width", "0", "-o", "x.png", saying="--width: 0 is not")
        self.refused("render", "sheet.h5", "--frame", "-1", "-o", "x.png", saying="--frame: -1 is not")
        self.refused("render", "sheet.h5", "--frames", "0:99999999999", "-o", "x_%d.png", saying="0:3")
        self.refused("render", "sheet.h5", "-o", "x.jpg", saying=".png")
        self.assertFalse(os.path.exists(self.path("x.jpg")))

    def test_names_with_blanks_and_letters_of_any_script(self):
        folder = "zwei Wörter/図"
        os.makedirs(self.path(folder))
        shutil.copy(self.path("sheet.h5"), self.path(folder + "/erste Falte ö.h5"))
        for name, *words in (("Bild 1 é.png", "render", *SIZE), ("Kurve é.svg", "plot"), ("Netz é.obj", "export"),
                             ("Netz é.glb", "export"), ("Netz é.usda", "export"), ("Netz é.xdmf", "export")):
            self.ruga(words[0], folder + "/erste Falte ö.h5", *words[1:], "-o", f"{folder}/{name}")
            self.assertGreater(len(self.read(f"{folder}/{name}")), 500, name)
        self.assertIn("erste Falte ö.h5", self.read(folder + "/Netz é.xdmf").decode())
        self.ruga("run", "sheet.yaml", "-o", folder + "/Lauf ö.h5", "--frames", "1", "--quiet", "--preview",
                  folder + "/Bilder ö")
        self.assertEqual(len(os.listdir(self.path(folder + "/Bilder ö"))), 2)

    def test_frames_and_turntables_have_numbered_pictures(self):
        self.ruga("render", "sheet.h5", "--frames", "1:2", *SIZE, "-o", "f%d.png")
        self.assertFalse(os.path.exists(self.path("f0.png")))
        self.assertNotEqual(self.read("f1.png"), self.read("f2.png"))
        self.ruga("render", "sheet.h5", "--turntable", "4", *SIZE, "-o", "t%d.png")
        self.assertEqual(len({self.read(f"t{i}.png") for i in range(4)}), 4)
        self.assertFalse(os.path.exists(self.path("t4.png")))

    def test_threads_do_not_change_a_picture(self):
        for threads in (1, 2, 3):
            self.ruga("render", "sheet.h5", "--threads", threads, "--color", "stress", *SIZE, "-o", f"n{threads}.png")
        self.assertEqual(self.read("n1.png"), self.read("n2.png"))
        self.assertEqual(self.read("n1.png"), self.read("n3.png"))

    def test_films_need_ffmpeg_and_hold_every_frame(self):
        self.refused("render", "sheet.h5", "--movie", "no.mp4", saying="ffmpeg", env={**os.environ, "PATH": "/nowhere"})
        self.assertFalse(os.path.exists(self.path("no.mp4")) or os.path.exists(self.path("no.mp4.part")))
        if not shutil.which("ffmpeg"):
            self.skipTest("ffmpeg is not installed")
        self.ruga("render", "sheet.h5", "--movie", "a.mp4", "--width", "121", "--height", "91")
        said = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-show_entries",
                               "stream=nb_read_frames,width,height,r_frame_rate", "-of", "default=nw=1",
                               self.path("a.mp4")], capture_output=True, text=True, check=True).stdout
        self.assertEqual(dict(line.split("=") for line in said.split()),
                         {"width": "122", "height": "92", "r_frame_rate": "50/1", "nb_read_frames": "4"})

    # ---- plot ------------------------------------------------------------------------------------------

    def test_plots_of_a_result(self):
        self.ruga("plot", "sheet.h5", "-o", "all.svg")
        self.ruga("plot", "sheet.h5", "--what", "energy", "-o", "one.svg")
        self.ruga("plot", "folded.h5", "--what", "angle,force", "-o", "fold.png")
        self.assertGreater(len(self.read("all.svg")), 3 * len(self.read("one.svg")))
        self.assertEqual(self.read("fold.png")[:8], b"\x89PNG\r\n\x1a\n")
        before = self.read("all.svg")
        self.ruga("plot", "sheet.h5", "--what", "energy,residual,iterations,wavelength,amplitude", "-o", "all.svg")
        again = self.read("all.svg")
        self.assertNotEqual(again, before)  # without the seconds
        self.ruga("plot", "sheet.h5", "--what", "energy,residual,iterations,wavelength,amplitude", "-o", "all.svg")
        self.assertEqual(self.read("all.svg"), again)
        self.refused("plot", "sheet.h5", "--what", "angle", "-o", "a.svg", saying="nothing of it")
        self.refused("plot", "shell.h5", "--what", "wavelength", "-o", "a.svg", saying="nothing of it")
        self.refused("plot", "sheet.h5", "--what", "engery", "-o", "a.svg", saying="did you mean energy")
        self.refused("plot", "sheet.h5", "-o", "a.gif", saying=".svg or .png")

    def test_plots_of_a_table(self):
        with open(self.path("t.csv"), "w", encoding="utf-8") as file:
            file.write("thickness,young,outcome,wavelength\n" + "".join(
                f"{k},{k * k},minimum,{3 * k}\n" for k in (1, 2, 4)))
        self.ruga("plot", "t.csv", "-o", "t.svg")
        self.ruga("plot", "t.csv", "--x", "young", "--what", "thickness+wavelength,wavelength", "--log", "xy", "-o", "u.svg")
        with open(self.path("wide.csv"), "w", encoding="utf-8") as file:  # more than a page holds
            file.write(",".join(f"c{k}" for k in range(20)) + "\n" + "".join(
                ",".join(str(row * (k % 3)) for k in range(20)) + "\n" for row in (1, 2, 3)))
        self.assertIn("7 of its 19 columns", self.call("plot", "wide.csv", "--x", "c1", "-o", "w.svg").stderr)
        self.refused("plot", "t.csv", "--what", "wavelengt", "-o", "v.svg", saying="did you mean wavelength")
        self.refused("plot", "t.csv", "--what", "outcome", "-o", "v.svg", saying="no point to draw")
        self.refused("plot", "none.csv", "-o", "v.svg", saying="cannot be read")
        self.assertFalse(os.path.exists(self.path("v.svg")))

    # ---- the rest --------------------------------------------------------------------------------------

    def test_previews_come_with_the_frames_and_change_nothing(self):
        self.ruga("run", "sheet.yaml", "-o", "seen.h5", "--preview", "seen", "--quiet")
        self.assertEqual(sorted(os.listdir(self.path("seen"))), [f"frame_000{k}.png" for k in range(4)])
        with h5py.File(self.path("seen.h5")) as a, h5py.File(self.path("sheet.h5")) as b:
            self.assertTrue(numpy.array_equal(a["shell/position"][:], b["shell/position"][:]))
        self.refused("run", "sheet.yaml", "-o", "x.h5", "--preview", "no/such/place", saying="--preview")
        self.assertFalse(os.path.exists(self.path("x.h5")))

    def test_previews_show_the_sheet_as_it_is_cut(self):
        with open(self.path("cut.yaml"), "w", encoding="utf-8") as file:
            file.write(CUT)
        self.ruga("run", "cut.yaml", "-o", "cut.h5", "--preview", "cut", "--quiet")
        parts = []
        for frame in range(2):
            rows, n = pixels(self.read(f"cut/frame_000{frame}.png"))
            clay = [any(row[i] > row[i + 2] + 30 for row in rows) for i in range(0, len(rows[0]), n)]
            parts.append(sum(now and not before for before, now in zip([False] + clay, clay)))
        self.assertEqual(parts, [1, 2])

    def test_view_writes_a_page_or_says_why_not(self):
        done = self.call("view", "sheet.h5", "-o", "page.html")
        if "without npm" in done.stderr:
            self.assertEqual(done.returncode, 2)
            self.skipTest("ruga was built without npm")
        self.assertEqual(done.returncode, 0, done.stderr)
        page = self.read("page.html").decode()
        self.assertNotRegex(page, r"""(?i)(?:src|href)\s*=\s*["']?https?:""")
        self.assertEqual(len(re.findall(r'<script type="application/octet-stream" id="', page)), 4)
        shutil.copy(self.path("sheet.h5"), self.path("no utf \udcff.h5"))
        self.ruga("view", "no utf \udcff.h5", "-o", "page.html")
        self.ruga("view", "folded.h5", "-o", "folded.html")
        facts = json.loads(re.search(r'<script type="application/json"[^>]*>(.*?)</script>',
                                     self.read("folded.html").decode(), re.S).group(1))
        (angles,) = (panel for panel in facts["panels"] if panel["axis"] == "fold angle, deg")
        self.assertEqual([s["name"] for s in angles["series"]], ["creases.0", "creases.1"])
        self.assertGreater(angles["series"][0]["y"][-1], 20)
        self.assertLess(angles["series"][1]["y"][-1], -20)
        self.refused("view", "sheet.h5", "--frames", "2:9", "-o", "p.html", saying="0:3")

    def test_gallery_script_remakes_one_picture(self):
        root = self.path("tree")
        os.makedirs(os.path.join(root, "examples"))
        os.makedirs(os.path.join(root, "script"))
        shutil.copy(os.path.join(SOURCE, "script/gallery"), os.path.join(root, "script/gallery"))
        for name, head in (("one", "# A sheet, squeezed. More of it."), ("two", "# Another one\n# gallery: none")):
            with open(os.path.join(root, "examples", name + ".yaml"), "w", encoding="utf-8") as file:
                file.write(head + "\n" + SCENE)
        with open(os.path.join(root, "README.md"), "w", encoding="utf-8") as file:
            file.write("before\n<!-- gallery -->\nold\n<!-- end of the gallery -->\nafter\n")
        done = subprocess.run(["script/gallery"], cwd=root, capture_output=True, text=True, check=False, timeout=300,
                              env={**os.environ, "RUGA": RUGA})
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(os.listdir(os.path.join(root, "docs/gallery")), ["one.png"])
        with open(os.path.join(root, "README.md"), encoding="utf-8") as file:
            text = file.read()
        self.assertIn("[one](examples/one.yaml): A sheet, squeezed |", text)
        self.assertTrue(text.startswith("before\n") and text.endswith("after\n") and "old" not in text)


if __name__ == "__main__":
    unittest.main()
