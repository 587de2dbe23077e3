# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The Ruga authors
#
# What ruga export writes, read by parsers of our own and, where they are installed, by other programs: Blender, the
# Khronos validator (npm), ParaView or XDMF's own library. test_export.py RUGA BUILD_DIR SOURCE_DIR [unittest arguments].
import json
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml
import zlib

try:
    import h5py
    import numpy as np
except ImportError:
    print("skipped: python3-h5py is not installed")
    sys.exit(77)

RUGA, BUILD, SOURCE = (os.path.abspath(path) for path in sys.argv[1:4])
FRAMES = 4
SCENE = """\
mesh:       {file: sheet.obj, unit: cm}
skin:       {thickness: 2 mm, young: 40 MPa}
interior:   {young: 0.5 MPa, motion: prescribed}
lattice:    {fill: box}
prescribed: [{time: 0 s}, {time: 60 ms, stretch: [0.95, 1, 1]}]
time:       {step: 20 ms, frames: 3}
"""


def run(*words, cwd, status=0, timeout=300):
    done = subprocess.run([str(word) for word in words], cwd=cwd, capture_output=True, text=True, timeout=timeout)
    if status is not None and done.returncode != status:
        raise AssertionError(f"{words} ended with {done.returncode}: {done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done


def write_sheet(folder):
    """A sheet in cm with two groups, one of an odd name, and uvs with a seam between them."""
    run(RUGA, "make", "sheet", "--size", "14cm,4cm", "--edge", "4.2mm", "-o", "plain.ply", cwd=folder)
    run(RUGA, "make", "sheet", "--size", "14cm,4cm", "--edge", "4.2mm", "-o", "plain.obj", cwd=folder)
    with open(os.path.join(folder, "plain.obj")) as file:
        lines = file.read().split("\n")
    v = np.array([line.split()[1:] for line in lines if line.startswith("v ")], float)
    f = np.array([[w.split("/")[0] for w in line.split()[1:]] for line in lines if line.startswith("f ")], int) - 1
    side = v[f].mean(axis=1)[:, 0] > 0
    with open(os.path.join(folder, "sheet.obj"), "w") as file:
        for p in v:
            file.write("v %.17g %.17g %.17g\n" % tuple(100 * p))
        for shift in (0, 0.5):
            for p in v:
                file.write("vt %.17g %.17g\n" % (0.25 + shift + 1.5 * p[0], 0.5 + 10 * p[1]))
        for s, name in ((False, "left side"), (True, "2-nd \"side\"")):
            file.write(f"g {name}\n")
            for t in f[side == s]:
                file.write("f " + " ".join(f"{i + 1}/{i + 1 + s * len(v)}" for i in t) + "\n")


class Case(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="ruga-export-")
        write_sheet(cls.folder)
        with open(os.path.join(cls.folder, "s.yaml"), "w") as file:
            file.write(SCENE)
        run(RUGA, "run", "s.yaml", "-o", "s.h5", "--quiet", cwd=cls.folder, status=None)
        with h5py.File(os.path.join(cls.folder, "s.h5")) as file:
            cls.position = file["shell/position"][()]
            cls.triangle = file["mesh/triangles"][()]
            cls.uv, cls.uv_triangle = file["mesh/uv"][()], file["mesh/uv_triangles"][()]
            cls.group = file["mesh/face_group"][()]
            cls.names = [n.decode() if isinstance(n, bytes) else n for n in file["mesh/group_names"][()]]
            cls.time = file["frames/time"][()]
        assert cls.position.shape[0] == FRAMES

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def export(self, name, *words, status=0):
        return run(RUGA, "export", "s.h5", *words, "-o", name, cwd=self.folder, status=status)

    def path(self, name):
        return os.path.join(self.folder, name)

    def bytes(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()


# ---- our own parsers ---------------------------------------------------------------------------------------

class Glb:
    """A binary glTF with everything that the specification demands of what is in it checked."""
    WIDTH = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}
    TYPE = {5125: "<u4", 5126: "<f4"}

    def __init__(self, data):
        magic, version, length = struct.unpack_from("<4sII", data)
        assert (magic, version, length) == (b"glTF", 2, len(data))
        size, kind = struct.unpack_from("<I4s", data, 12)
        assert kind == b"JSON" and size % 4 == 0
        self.root = json.loads(data[20:20 + size])
        binary, kind = struct.unpack_from("<I4s", data, 20 + size)
        assert kind == b"BIN\0" and 28 + size + binary == length and binary % 4 == 0
        assert self.root["buffers"] == [{"byteLength": binary}]
        self.data = data[28 + size:]
        end = 0
        for view in self.root["bufferViews"]:
            assert view["byteOffset"] == end and view["byteLength"] > 0
            end += view["byteLength"]
        assert end == binary

    def view(self, number, dtype, width, count, offset=0):
        view = self.root["bufferViews"][number]
        assert offset + count * width * 4 <= view["byteLength"]
        return np.frombuffer(self.data, dtype, count * width, view["byteOffset"] + offset).reshape(count, width)

    def accessor(self, number):
        a = self.root["accessors"][number]
        dtype, width, count = self.TYPE[a["componentType"]], self.WIDTH[a["type"]], a["count"]
        value = np.zeros((count, width), dtype)
        if "bufferView" in a:
            value = self.view(a["bufferView"], dtype, width, count).copy()
        if "sparse" in a:
            s = a["sparse"]
            index = self.view(s["indices"]["bufferView"], "<u4", 1, s["count"])[:, 0]
            assert np.all(np.diff(index.astype(np.int64)) > 0) and index[-1] < count
            value[index] = self.view(s["values"]["bufferView"], dtype, width, s["count"])
        assert np.all(np.isfinite(value))
        if "min" in a:
            assert np.array_equal(value.min(axis=0), np.array(a["min"], dtype))
            assert np.array_equal(value.max(axis=0), np.array(a["max"], dtype))
        return value


class Files(Case):
    def test_obj_and_ply_sequences_hold_the_frames_bit_by_bit(self):
        self.export("f_%02d.obj", "--unit", "m")
        self.export("f_%02d.ply", "--format", "ply", "--unit", "m")
        self.export("said.obj", "--unit", "mm", "--up", "y", "--fps", "12.5", "--name", "my bag")
        self.export("said.ply", "--unit", "mm", "--up", "y", "--fps", "12.5", "--name", "my bag")
        for name in ("said.obj", "said.ply"):
            head = self.bytes(name)[:400].decode(errors="replace")
            self.assertIn("my bag, frame 3, t = 0.06 s, unit 0.001 m, y up, 12.5 frames per second", head)
        for k in range(FRAMES):
            lines = self.bytes(f"f_{k:02d}.obj").decode().split("\n")
            v = np.array([line.split()[1:] for line in lines if line.startswith("v ")], float)
            np.testing.assert_array_equal(v, self.position[k])
            data = self.bytes(f"f_{k:02d}.ply")
            body = data[data.index(b"end_header\n") + 11:]
            row = 8 * len(re.findall(rb"property double", data[:data.index(b"element face")]))
            v = np.array([struct.unpack_from("<3d", body, row * i) for i in range(len(v))])
            np.testing.assert_array_equal(v, self.position[k])
        self.assertEqual([line[2:] for line in lines if line.startswith("g ")], self.names)
        vt = np.array([line.split()[1:] for line in lines if line.startswith("vt ")], float)
        np.testing.assert_array_equal(vt, self.uv)
        vn = np.array([line.split()[1:] for line in lines if line.startswith("vn ")], float)
        np.testing.assert_allclose(np.linalg.norm(vn, axis=1), 1, atol=1e-12)
        self.assertIn("z up", lines[0])

    def test_gltf_is_sound_and_its_targets_are_the_frames(self):
        self.export("a.glb", "--fps", "25", "--name", "sheet")
        g = Glb(self.bytes("a.glb"))
        node, mesh = g.root["nodes"][0], g.root["meshes"][0]
        self.assertEqual((node["name"], node["scale"]), ("sheet", [0.01] * 3))
        self.assertAlmostEqual(node["rotation"][0], -0.5 ** 0.5)
        self.assertEqual([m["name"] for m in g.root["materials"]], self.names)
        first = mesh["primitives"][0]
        base = g.accessor(first["attributes"]["POSITION"]).astype(float)
        uv = g.accessor(first["attributes"]["TEXCOORD_0"])
        normal = g.accessor(first["attributes"]["NORMAL"])
        np.testing.assert_allclose(np.linalg.norm(normal, axis=1), 1, atol=1e-6)
        index = np.concatenate([g.accessor(p["indices"]).reshape(-1, 3) for p in mesh["primitives"]])
        order = np.concatenate([np.flatnonzero(self.group == k) for k in range(2)])
        for k in range(FRAMES):
            now = base + (g.accessor(first["targets"][k - 1]["POSITION"]) if k else 0)
            np.testing.assert_allclose(0.01 * now[index], self.position[k][self.triangle[order]], atol=2e-8)
        st = self.uv[self.uv_triangle[order]]
        np.testing.assert_allclose(uv[index], np.stack([st[..., 0], 1 - st[..., 1]], axis=-1), atol=1e-7)
        sampler = g.root["animations"][0]["samplers"][0]
        np.testing.assert_allclose(g.accessor(sampler["input"])[:, 0], np.arange(FRAMES) / 25, rtol=1e-6)
        np.testing.assert_array_equal(g.accessor(sampler["output"]).reshape(FRAMES, FRAMES - 1),
                                      np.eye(FRAMES, dtype="f4")[:, 1:])

    def test_gltf_of_one_frame_and_of_still_frames(self):
        self.export("one.glb", "--frame", "2")
        g = Glb(self.bytes("one.glb"))
        self.assertNotIn("animations", g.root)
        self.assertNotIn("targets", g.root["meshes"][0]["primitives"][0])
        with open(self.path("still.yaml"), "w") as file:
            file.write(SCENE.replace("0.95", "1"))
        run(RUGA, "run", "still.yaml", "-o", "still.h5", "--quiet", cwd=self.folder, status=None)
        run(RUGA, "export", "still.h5", "-o", "still.glb", cwd=self.folder)
        g = Glb(self.bytes("still.glb"))
        moved = [a.get("sparse", {}).get("count", 0) for a in g.root["accessors"] if "bufferView" not in a]
        self.assertEqual(len(moved), 2 * (FRAMES - 1))  # but for round-off nothing moves
        self.assertLess(max(moved), 0.1 * self.position.shape[1])

    def test_our_reader_reads_the_gltf(self):
        self.export("r.glb", "--frame", "3", "--up", "y")
        run(RUGA, "remesh", "r.glb", "--edge", "5mm", "-o", "r.obj", cwd=self.folder)
        facts = json.loads(run(RUGA, "check", "r.glb", "--as", "shell", "--json", cwd=self.folder).stdout)
        self.assertEqual((facts["vertices"], facts["triangles"]), (self.position.shape[1], len(self.triangle)))
        np.testing.assert_allclose(facts["max"], self.position[3].max(axis=0), atol=1e-7)

    def test_point_caches_hold_the_frames(self):
        self.export("a.pc2", "--frames", "1:3")
        data = self.bytes("a.pc2")
        self.assertEqual(struct.unpack_from("<12siiffi", data),
                         (b"POINTCACHE2\0", 1, self.position.shape[1], 1, 1, 3))
        value = np.frombuffer(data, "<f4", offset=32).reshape(3, -1, 3)
        np.testing.assert_array_equal(value, (self.position[1:] / 0.01).astype("f4"))
        self.export("a.mdd", "--unit", "mm", "--fps", "10")
        data = self.bytes("a.mdd")
        self.assertEqual(struct.unpack_from(">ii", data), (FRAMES, self.position.shape[1]))
        np.testing.assert_allclose(np.frombuffer(data, ">f4", FRAMES, 8), np.arange(FRAMES) / 10, rtol=1e-6)
        value = np.frombuffer(data, ">f4", offset=8 + 4 * FRAMES).reshape(FRAMES, -1, 3)
        np.testing.assert_array_equal(value, (self.position / 0.001).astype("f4"))

    def test_usda_says_everything(self):
        self.export("a.usda", "--up", "y")
        text = self.bytes("a.usda").decode()
        self.assertTrue(text.startswith("#usda 1.0\n("))
        for pattern in (r"metersPerUnit = 0\.01\b", r'upAxis = "Y"', r"timeCodesPerSecond = 50", r"endTimeCode = 3",
                        r'defaultPrim = "s"', r'def Mesh "s"', r'def GeomSubset "left_side"',
                        r'def GeomSubset "_2_nd__side_"', r'name = "2-nd \\"side\\""', r'elementType = "face"'):
            self.assertRegex(text, pattern)
        self.assertEqual(text.count("{"), text.count("}"))
        self.assertEqual(text.count("["), text.count("]"))

        def numbers(name):
            return np.array(re.findall(r"[-+\d.e]+", re.search(re.escape(name) + r" = \[(.*)\]", text).group(1)), float)

        def samples(name):
            block = re.search(re.escape(name) + r"\.timeSamples = \{\n(.*?)\n    \}", text, re.S).group(1)
            rows = [re.match(r"\s+(\d+): \[(.*)\],$", line).groups() for line in block.split("\n")]
            self.assertEqual([int(k) for k, _ in rows], list(range(FRAMES)))
            return np.array([re.findall(r"[-+\d.e]+", row) for _, row in rows], float).reshape(FRAMES, -1, 3)

        points = samples("points")
        np.testing.assert_array_equal(points.astype("f4"), (self.position / 0.01).astype("f4"))
        np.testing.assert_allclose(np.linalg.norm(samples("normals"), axis=2), 1, atol=1e-6)
        np.testing.assert_allclose(samples("extent"), np.stack([points.min(axis=1), points.max(axis=1)], 1), rtol=1e-7)
        np.testing.assert_array_equal(numbers("faceVertexIndices").reshape(-1, 3), self.triangle)
        np.testing.assert_array_equal(numbers("primvars:st:indices").reshape(-1, 3), self.uv_triangle)
        np.testing.assert_allclose(numbers("primvars:st").reshape(-1, 2)[:-1], self.uv, atol=1e-8) \
            if "primvars:st = [" in text else self.fail("no uvs")

    def test_xdmf_names_datasets_that_are_there(self):
        self.export("a.xdmf", "--frames", "1:3")
        grids = xml.parse(self.path("a.xdmf")).getroot().findall("./Domain/Grid/Grid")
        self.assertEqual([float(g.find("Time").get("Value")) for g in grids], list(self.time[1:]))
        with h5py.File(self.path("s.h5")) as file:
            for item in xml.parse(self.path("a.xdmf")).getroot().iter("DataItem"):
                if item.get("Format") == "HDF":
                    name, place = item.text.split(":")
                    self.assertEqual(name, "s.h5")
                    self.assertEqual(list(file[place].shape), [int(n) for n in item.get("Dimensions").split()])
        os.makedirs(self.path("other"), exist_ok=True)
        self.export("other/a.xdmf")
        self.assertIn(os.path.realpath(self.path("s.h5")) + ":/mesh", self.bytes("other/a.xdmf").decode())

    def test_refusals_leave_nothing_behind(self):
        before = sorted(os.listdir(self.folder))
        for words, saying in (
                (("x.glb", "--fps", "0"), "above 0"), (("x.glb", "--fps", "fast"), "--fps"),
                (("x_%d.glb",), "one file"), (("x.gltf", "--format", "gltf"), "glb"), (("x.stl",), "which format"),
                (("x.xdmf", "--unit", "mm"), "stay as they are"), (("x.pc2", "--up", "w"), "y"),
                (("x.mdd", "--frames", "2:9"), "0:3"), (("nowhere/x.usda",), "nowhere"), (("x.obj", "--frames", "0:2"), "%04d")):
            done = self.export(*words, status=2)
            self.assertIn(saying, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1)
        self.assertEqual(sorted(os.listdir(self.folder)), before)
        if os.path.exists("/dev/full") and os.access("/dev/full", os.W_OK):
            run("sh", "-c", f"ulimit -f 8; exec {RUGA} export s.h5 -o x.glb", cwd=self.folder, status=None)
            self.assertEqual(sorted(n for n in os.listdir(self.folder) if n == "x.glb"), [])


# ---- the other way: a moving surface in, wrinkles out ------------------------------------------------------------

FOLLOW = """\
mesh:     {file: sheet.obj, unit: cm}
skin:     {thickness: 2 mm, young: 40 MPa}
interior: {young: 0.5 MPa}
lattice:  {fill: box}
follow:   {file: NAME, rate: 25 1/s}
time:     {step: 20 ms, frames: 4}
"""


class Follow(Case):
    """The sheet pushed together by 5 % and turned, as three samples at 25 per second: frames 0, 2 and 4."""
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        with open(os.path.join(cls.folder, "sheet.obj")) as file:
            lines = file.read().split("\n")
        cls.rest = np.array([line.split()[1:] for line in lines if line.startswith("v ")], float)
        cls.moved = np.array([cls.move(cls.rest, s) for s in (0, 0.5, 1)])
        cls.write_pc2("body.pc2", cls.moved)
        with open(os.path.join(cls.folder, "body.mdd"), "wb") as file:
            file.write(struct.pack(">ii3f", 3, len(cls.rest), 0, 0.04, 0.08) + cls.moved.astype(">f4").tobytes())
        for k, frame in enumerate(cls.moved):
            with open(os.path.join(cls.folder, f"body_{k + 1:03d}.obj"), "w") as file:
                file.write("\n".join(["v %.17g %.17g %.17g" % tuple(p) for p in frame]
                                     + [line for line in lines if line.startswith(("vt ", "f "))]) + "\n")

    @staticmethod
    def move(x, s):
        c, n = np.cos(0.7 * s), np.sin(0.7 * s)
        return (x * [1 - 0.05 * s, 1, 1]) @ np.array([[c, n, 0], [-n, c, 0], [0, 0, 1]]) + [0, 3 * s, -s]

    @classmethod
    def write_pc2(cls, name, samples):
        with open(os.path.join(cls.folder, name), "wb") as file:
            file.write(struct.pack("<12siiffi", b"POINTCACHE2", 1, samples.shape[1], 1, 1, len(samples))
                       + samples.astype("<f4").tobytes())

    def scene(self, name, cache, *changes):
        text = FOLLOW.replace("NAME", cache)
        for old, new in changes:
            self.assertIn(old, text)
            text = text.replace(old, new)
        with open(self.path(name + ".yaml"), "w") as file:
            file.write(text)
        return name + ".yaml"

    def simulate(self, name, cache, *changes):
        run(RUGA, "run", self.scene(name, cache, *changes), "-o", name + ".h5", "--force", cwd=self.folder)
        with h5py.File(self.path(name + ".h5")) as file:
            return (file["mesh/rest"][()], file["shell/embedded"][()], file["shell/position"][()])

    def test_each_kind_of_file_moves_the_interior_and_wrinkles_the_skin(self):
        for name, cache, changes in (("pc2", "body.pc2", ()), ("mdd", "body.mdd", ((", rate: 25 1/s", ""),)),
                                     ("obj", "body_%03d.obj", ())):
            rest, embedded, position = self.simulate(name, cache, *changes)
            for frame in (0, 2, 4):
                np.testing.assert_allclose(embedded[frame], 0.01 * self.move(100 * rest, frame / 4), atol=2e-8)
            np.testing.assert_allclose(embedded[1], (embedded[0] + embedded[2]) / 2, atol=1e-9)
            height = (position - embedded)[4, :, 2]
            self.assertGreater(np.ptp(height), 3e-3)  # wrinkles
            facts = json.loads(run(RUGA, "measure", name + ".h5", "--json", cwd=self.folder).stdout)
            self.assertAlmostEqual(facts["wavelength"], facts["wavelength_predicted"],
                                   delta=0.12 * facts["wavelength_predicted"])
        facts = json.loads(run(RUGA, "explain", "pc2.yaml", "--json", cwd=self.folder).stdout)
        self.assertAlmostEqual(facts["strain"], 0.05, places=5)

    def test_a_remeshed_surface_is_carried_by_the_one_it_came_from(self):
        rest, embedded, _ = self.simulate("fine", "body.pc2", ("unit: cm", "unit: cm, remesh: {edge: 3.4 mm}"))
        self.assertNotEqual(len(rest), len(self.rest))
        for frame in (0, 2, 4):
            np.testing.assert_allclose(embedded[frame], 0.01 * self.move(100 * rest, frame / 4), atol=1e-7)

    def test_a_part_of_the_mesh_takes_its_points(self):
        rest, embedded, _ = self.simulate("part", "body.pc2", ("unit: cm", "unit: cm, groups: [left side]"))
        self.assertLess(len(rest), len(self.rest))
        np.testing.assert_allclose(embedded[4], 0.01 * self.move(100 * rest, 1), atol=2e-8)

    def test_resumed_bits_are_the_same_and_another_cache_is_refused(self):
        self.simulate("whole", "body.pc2")
        run(RUGA, "run", "whole.yaml", "-o", "broken.h5", "--frames", 2, cwd=self.folder)
        run(RUGA, "run", "whole.yaml", "-o", "broken.h5", "--resume", cwd=self.folder)
        with h5py.File(self.path("whole.h5")) as a, h5py.File(self.path("broken.h5")) as b:
            np.testing.assert_array_equal(a["shell/position"][()], b["shell/position"][()])
        self.write_pc2("other.pc2", self.moved * 1.001)
        self.write_pc2("same.pc2", self.moved)
        self.scene("whole", "other.pc2")
        done = run(RUGA, "run", "whole.yaml", "-o", "broken.h5", "--resume", cwd=self.folder, status=2)
        self.assertIn("another scene", done.stderr)

    def test_what_does_not_fit_is_refused_with_its_place(self):
        self.write_pc2("few.pc2", self.moved[:, 1:])
        self.write_pc2("nan.pc2", np.where(np.arange(3)[:, None, None] == 1, np.nan, self.moved))
        with open(self.path("cut.pc2"), "wb") as file:
            file.write(self.bytes("body.pc2")[:-7])
        with open(self.path("back.mdd"), "wb") as file:
            file.write(struct.pack(">ii3f", 3, len(self.rest), 1, 2, 2) + self.moved.astype(">f4").tobytes())
        for cache, changes, saying in (
                ("few.pc2", (), r"few.pc2 has \d+ points, and sheet.obj \d+ vertices"), ("nan.pc2", (), "sample 1"),
                ("cut.pc2", (), "the file has"), ("back.mdd", ((", rate: 25 1/s", ""),), "time of sample 2"),
                ("body.mdd", (), "times of its own"), ("none.pc2", (), "cannot be read"),
                ("no_%d.obj", (), "number 0 or 1"), ("body.abc", (), r"read from .pc2"),
                ("body.pc2", (("follow:", "prescribed: [{time: 0 s}]\nfollow:"),), "keep one"),
                ("body.pc2", (("MPa}\nlattice", "MPa, motion: dynamic}\nlattice"),), "prescribed interior only"),
                ("body.pc2", (("rate: 25", "rate: -25"),), "above 0"), ("body.pc2", (("rate", "ratio"),), "follow")):
            done = run(RUGA, "run", self.scene("bad", cache, *changes), "-o", "bad.h5", cwd=self.folder, status=2)
            self.assertRegex(done.stderr, r"bad\.yaml:\d+: ")
            self.assertRegex(done.stderr, saying)
            self.assertFalse(os.path.exists(self.path("bad.h5")))
        done = run(RUGA, "explain", self.scene("long", "body.pc2", ("frames: 4", "frames: 9")), cwd=self.folder)
        self.assertIn("it is held", done.stderr)
        done = run(RUGA, "explain", self.scene("unit", "body.pc2", ("unit: cm", "unit: m, scale: 0.01")),
                   cwd=self.folder)
        self.assertNotIn("its unit", done.stderr)
        self.write_pc2("mm.pc2", 10 * self.moved)
        done = run(RUGA, "explain", self.scene("unit", "mm.pc2"), cwd=self.folder)
        self.assertIn("10 times as large", done.stderr)


# ---- maps ------------------------------------------------------------------------------------------------------

def read_exr(data):
    """Scan lines compressed by ZIP, as the format's description has it: [height][width][3] as R, G, B."""
    assert struct.unpack_from("<II", data) == (20000630, 2)
    at, head = 8, {}
    while data[at]:
        name, kind, rest = data[at:].split(b"\0", 2)
        at += len(name) + len(kind) + 2
        (size,) = struct.unpack_from("<i", data, at)
        head[name.decode()] = data[at + 4:at + 4 + size]
        at += 4 + size
    at += 1
    assert head["compression"] == b"\3"  # ZIP, 16 lines a block
    left, top, right, bottom = struct.unpack("<4i", head["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    names = re.findall(rb"([A-Z])\0(.)\0\0\0", head["channels"], re.S)
    assert [name for name, _ in names] == [b"B", b"G", b"R"]
    dtype = {b"\1": "<f2", b"\2": "<f4"}[names[0][1]]
    pixel = np.zeros((height, 3, width), dtype)
    for offset in struct.unpack_from(f"<{(height + 15) // 16}Q", data, at):
        y, size = struct.unpack_from("<ii", data, offset)
        packed, lines = data[offset + 8:offset + 8 + size], min(16, height - y)
        raw = lines * 3 * width * np.dtype(dtype).itemsize
        if size < raw:
            d = np.frombuffer(zlib.decompress(packed), np.uint8).astype(int)
            d[1:] -= 128
            d = (np.cumsum(d) & 255).astype(np.uint8)
            whole = np.empty(raw, np.uint8)
            whole[0::2], whole[1::2] = d[:(raw + 1) // 2], d[(raw + 1) // 2:]
            packed = whole.tobytes()
        pixel[y:y + lines] = np.frombuffer(packed, dtype).reshape(lines, 3, width)
    return pixel.transpose(0, 2, 1)[:, :, ::-1].astype(float), head


def read_png16(data):
    width, height, depth, color = struct.unpack_from(">IIBB", data, 16)
    assert (depth, color) == (16, 2)
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack_from(">I4s", data, at)
        packed += data[at + 8:at + 8 + size] if kind == b"IDAT" else b""
        at += size + 12
    raw, row, rows = zlib.decompress(packed), 6 * width, []
    before = np.zeros(row, int)
    for y in range(height):
        kind, line = raw[y * (row + 1)], np.frombuffer(raw, np.uint8, row, y * (row + 1) + 1).astype(int)
        if kind == 1:
            line = (np.cumsum(line.reshape(-1, 6), axis=0) & 255).ravel()
        elif kind == 2:
            line = (line + before) & 255
        elif kind > 2:
            for i in range(row):
                a, b, c = (line[i - 6] if i >= 6 else 0), before[i], (before[i - 6] if i >= 6 else 0)
                p = a + b - c
                pick = (a + b) // 2 if kind == 3 else min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
                line[i] = (line[i] + pick) & 255
        rows.append(line)
        before = line
    return np.array(rows, np.uint8).reshape(height, width, 3, 2).astype(int) @ [256, 1]


def read_png_texts(data):
    """The tEXt chunks; every chunk's check sum is looked at."""
    at, texts = 8, {}
    while at < len(data):
        size, kind = struct.unpack_from(">I4s", data, at)
        assert struct.unpack_from(">I", data, at + 8 + size)[0] == zlib.crc32(data[at + 4:at + 8 + size])
        if kind == b"tEXt":
            key, text = data[at + 8:at + 8 + size].split(b"\0")
            texts[key.decode()] = text.decode()
        at += size + 12
    return texts


def read_exr_scale(head):
    return (*struct.unpack("<dd", head["valueScale"] + head["valueOffset"]), head["valueUnit"].decode())


class Bake(Case):
    SIZE = 128

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        with h5py.File(os.path.join(cls.folder, "s.h5")) as file:
            cls.embedded, cls.rest = file["shell/embedded"][()], file["mesh/rest"][()]

    def bake(self, name, *words, status=0):
        return run(RUGA, "bake", "s.h5", "--size", self.SIZE, "-o", name, *words, cwd=self.folder, status=status)

    def wanted(self, value):
        """Texels whose centre lies in a triangle, and the value [V][..] there."""
        corners = self.uv[self.uv_triangle]
        corners = np.concatenate([corners, np.ones(corners.shape[:2] + (1,))], axis=2)
        inverse = np.linalg.inv(corners.transpose(0, 2, 1))
        row, column = (n.ravel() for n in np.mgrid[:self.SIZE, :self.SIZE])
        u, v = (column + 0.5) / self.SIZE, 1 - (row + 0.5) / self.SIZE
        near = (np.minimum(abs(u - 0.2), abs(u - 0.8)) < 0.06) & (abs(v - 0.5) < 0.21)
        row, column, at = row[near], column[near], np.stack([u[near], v[near], np.ones(near.sum())])
        w = inverse @ at  # [F][3][texels]
        f = w.min(axis=1).argmax(axis=0)
        w = w[f, :, np.arange(len(f))]
        inside = w.min(axis=1) >= 0
        found = np.einsum("ti,tik->tk", w, value[self.triangle[f]])
        return row[inside], column[inside], found[inside]

    def test_displacements_are_those_of_the_result(self):
        # The sheet is flat and stretched along its axes: tangent x, bitangent y, normal z.
        rows, columns, d = self.wanted(self.position[3] - self.embedded[3])
        self.assertGreater(len(rows), 500)
        self.bake("d.exr", "--unit", "m")
        pixel, head = read_exr(self.bytes("d.exr"))
        np.testing.assert_allclose(pixel[rows, columns], d, atol=2e-8)
        self.assertIn(b"unit 1 m", head["comments"])
        self.assertEqual(read_exr_scale(head), (1, 0, "m"))
        self.bake("d_cm.exr", "--half")
        pixel, head = read_exr(self.bytes("d_cm.exr"))
        self.assertEqual(read_exr_scale(head), (0.01, 0, "m"))
        np.testing.assert_allclose(pixel[rows, columns], 100 * d, rtol=1e-3, atol=1e-5)
        said = self.bake("d.png", "--range", "4 mm").stdout
        self.assertIn("-4 to 4 mm", said)
        self.assertRegex(said, r"normal alone leaves \d")
        pixel = read_png16(self.bytes("d.png"))
        np.testing.assert_allclose((pixel[rows, columns] / 65535 - 0.5) * 8e-3, d, atol=1e-7)
        texts = read_png_texts(self.bytes("d.png"))
        scale, offset = float(texts["valueScale"]), float(texts["valueOffset"])
        self.assertEqual((scale, offset, texts["valueUnit"]), (8e-3, -4e-3, "m"))
        np.testing.assert_allclose(offset + scale * pixel[rows, columns] / 65535, d, atol=1e-7)
        self.bake("d_own.png")  # the range of the largest that occurs is known from the file alone
        texts = read_png_texts(self.bytes("d_own.png"))
        own = read_png16(self.bytes("d_own.png"))[rows, columns] / 65535
        np.testing.assert_allclose(float(texts["valueOffset"]) + float(texts["valueScale"]) * own, d, atol=1e-7)
        self.assertIn("displacement along tangent", texts["Comment"])
        border = pixel[0]  # far from any chart: no displacement
        np.testing.assert_array_equal(border, np.full_like(border, 32768))

    def test_normals_tension_and_occlusion(self):
        rows, columns, _ = self.wanted(self.rest)
        self.bake("n.png", "--map", "normal")
        texts = read_png_texts(self.bytes("n.png"))
        self.assertEqual((texts["valueScale"], texts["valueOffset"], texts["valueUnit"]), ("2", "-1", "1"))
        n = read_png16(self.bytes("n.png"))[rows, columns] / 65535 * 2 - 1
        np.testing.assert_allclose(np.linalg.norm(n, axis=1), 1, atol=1e-4)
        self.assertGreater(n[:, 2].min(), 0.5)
        self.assertGreater(np.ptp(n[:, 0]), 0.1)
        self.bake("t.exr", "--map", "tension")
        t, head = read_exr(self.bytes("t.exr"))
        self.assertEqual(read_exr_scale(head), (1, 0, "1"))
        np.testing.assert_allclose(t[rows, columns], np.full((len(rows), 3), [0, -0.05, -0.05]), atol=1e-6)
        self.bake("a.exr", "--map", "ao", "--frame", "0", "--samples", "16")
        a, _ = read_exr(self.bytes("a.exr"))
        np.testing.assert_array_equal(a[rows, columns], np.ones((len(rows), 3)))  # a flat sheet sees all of the sky
        self.bake("a.exr", "--map", "ao", "--samples", "16")
        a, _ = read_exr(self.bytes("a.exr"))
        self.assertTrue(0.5 < a[rows, columns].min() < 0.99)

    def test_a_target_is_carried_along_and_met_by_rays(self):
        # Two quads with the sheet's uvs and seam, in the sheet's unit.
        with open(self.path("low.obj"), "w") as file:
            for x in (-7, 0, 7):
                file.write(f"v {x} -2 0\nv {x} 2 0\n")
            for x, shift in ((-7, 0), (0, 0), (0, 0.5), (7, 0.5)):
                for y in (-2, 2):
                    file.write(f"vt {0.25 + shift + 0.015 * x} {0.5 + 0.1 * y}\n")
            file.write("f 1/1 3/3 4/4 2/2\nf 3/5 5/7 6/8 4/6\n")
        self.bake("low.exr", "--target", "low.obj", "--unit", "m")
        pixel, _ = read_exr(self.bytes("low.exr"))
        # A ray meets the sheet straight above: the height there, not the displacement of one material point.
        self.bake("own.exr", "--unit", "m")
        own, _ = read_exr(self.bytes("own.exr"))
        rows, columns, d = self.wanted(self.position[3] - self.embedded[3])
        np.testing.assert_allclose(pixel[rows, columns, :2], 0, atol=1e-7)
        rise = np.abs(pixel[rows, columns, 2] - own[rows, columns, 2])
        self.assertLess(rise.max(), 0.3 * np.ptp(d[:, 2]))
        self.assertGreater(np.corrcoef(pixel[rows, columns, 2], own[rows, columns, 2])[0, 1], 0.99)

    def test_a_few_maps_and_weights_stand_for_all_frames(self):
        self.bake("w_%d.exr", "--maps", "2", "--unit", "m")
        self.bake("f_%d.exr", "--frames", "0:3", "--unit", "m")
        facts = json.loads(self.bytes("w_weights.json"))
        self.assertEqual((facts["maps"], facts["frames"], facts["map"]), (["w_0.exr", "w_1.exr"], [0, 1, 2, 3],
                                                                          "displacement"))
        np.testing.assert_array_equal(facts["times"], self.time)
        weights = np.array(facts["weights"])
        self.assertGreaterEqual(weights.min(), 0)
        np.testing.assert_allclose(weights.max(axis=0), 1)
        maps = np.array([read_exr(self.bytes(name))[0] for name in facts["maps"]])
        frames = np.array([read_exr(self.bytes(f"f_{k}.exr"))[0] for k in range(FRAMES)])
        size = np.linalg.norm(frames.reshape(FRAMES, -1), axis=1).max()
        for k in range(FRAMES):
            left = np.linalg.norm(np.tensordot(weights[k], maps, 1) - frames[k]) / size
            self.assertAlmostEqual(left, facts["errors"][k], delta=0.02)
        self.assertLess(max(facts["errors"]), 0.3)
        for kind in ("normal", "ao"):
            self.bake("k_%d.png", "--map", kind, "--maps", "1", "--samples", "4")
            self.assertEqual(json.loads(self.bytes("k_weights.json"))["map"], kind)

    def test_same_bits_for_any_number_of_threads(self):
        for threads in ("1", "3"):
            for kind in ("displacement", "ao"):
                done = subprocess.run([RUGA, "bake", "s.h5", "--size", "64", "--map", kind, "-o", f"{kind}{threads}.exr"],
                                      cwd=self.folder, env={**os.environ, "RUGA_THREADS": threads}, capture_output=True)
                self.assertEqual(done.returncode, 0)
        for kind in ("displacement", "ao"):
            self.assertEqual(self.bytes(f"{kind}1.exr"), self.bytes(f"{kind}3.exr"))

    def test_refusals(self):
        self.write("nouv.obj", "v -7 -2 0\nv 7 -2 0\nv 0 2 0\nf 1 2 3\n")
        self.write("out.obj", "v -7 -2 0\nv 7 -2 0\nv 0 2 0\nvt 0 0\nvt 2 0\nvt 0 1\nf 1/1 2/2 3/3\n")
        self.write("far.obj", "v -7 -2 900\nv 7 -2 900\nv 0 2 900\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n")
        self.write("twice.obj", "v -7 -2 0\nv 7 -2 0\nv 0 2 0\nv 0 -4 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                                "f 1/1 2/2 3/3\nf 2/1 1/2 4/3\n")
        before = sorted(os.listdir(self.folder))
        for words, saying in (
                (("x.tif",), ".exr or .png"), (("x.exr", "--map", "bump"), "displacement"),
                (("x.exr", "--range", "1mm"), "the numbers themselves"), (("x.png", "--map", "ao", "--range", "1"), "of their own"),
                (("x_%d.png", "--frames", "1:2"), "one range"), (("x.exr", "--frames", "1:2"), "%04d"),
                (("x.exr", "--maps", "1"), "%d"), (("x_%d.exr", "--maps", "5"), "5 maps of 4 frames"),
                (("x.png", "--half"), "16 bits"), (("x.exr", "--target", "nouv.obj"), "no texture coordinates"),
                (("x.exr", "--target", "out.obj"), "outside 0 to 1"), (("x.exr", "--target", "twice.obj"), "overlap"),
                (("x.exr", "--target", "far.obj"), "place and unit"), (("x.exr", "--target", "none.obj"), "none.obj"),
                (("x.exr", "--size", "1"), "--size"), (("x.exr", "--sky", "0"), "above 0")):
            done = self.bake(*words, status=2) if "--size" not in words else run(
                RUGA, "bake", "s.h5", "-o", *words, cwd=self.folder, status=2)
            self.assertIn(saying, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        self.assertEqual(sorted(os.listdir(self.folder)), before)

    def write(self, name, text):
        with open(self.path(name), "w") as file:
            file.write(text)


# ---- other programs ----------------------------------------------------------------------------------------

BLENDER = r"""
import bpy, json, sys, numpy as np
if "bool" not in vars(np):
    np.bool = bool  # the importer of Debian 12's Blender was written for an older numpy
folder, frames = sys.argv[-2], int(sys.argv[-1])
scene = bpy.context.scene
scene.render.fps = 25
scene.render.fps_base = 1

def evaluated(thing, frame):
    scene.frame_set(frame)
    graph = bpy.context.evaluated_depsgraph_get()
    mesh = thing.evaluated_get(graph).to_mesh()
    co = np.empty(3 * len(mesh.vertices), "f4")
    mesh.vertices.foreach_get("co", co)
    world = np.array(thing.matrix_world)
    return co.reshape(-1, 3).astype(float) @ world[:3, :3].T + world[:3, 3]

def meshes():
    return [o for o in bpy.data.objects if o.type == "MESH"]

def clear():
    for o in list(bpy.data.objects):
        bpy.data.objects.remove(o)

clear()
bpy.ops.import_scene.gltf(filepath=folder + "/b.glb")
(thing,) = meshes()
np.save(folder + "/gltf.npy", np.array([evaluated(thing, k) for k in range(frames)]))
loops = np.array([[thing.data.loops[i].vertex_index for i in p.loop_indices] for p in thing.data.polygons])
np.save(folder + "/gltf_faces.npy", loops)
info = {"gltf": thing.name, "materials": [m.name for m in thing.data.materials], "uv": len(thing.data.uv_layers)}
for kind in ("pc2", "mdd"):
    clear()
    bpy.ops.wm.obj_import(filepath=folder + "/b_0.obj", forward_axis="Y", up_axis="Z")
    (thing,) = meshes()
    np.save(folder + "/obj.npy", evaluated(thing, 0))
    cache = thing.modifiers.new("cache", "MESH_CACHE")
    cache.cache_format = kind.upper()
    cache.filepath = folder + "/b." + kind
    cache.forward_axis, cache.up_axis, cache.frame_start = "POS_Y", "POS_Z", 0
    np.save(folder + "/" + kind + ".npy", np.array([evaluated(thing, k) for k in range(frames)]))
image = bpy.data.images.load(folder + "/b.exr")
np.save(folder + "/exr.npy", np.array(image.pixels[:]).reshape(image.size[1], image.size[0], 4)[::-1, :, :3])
json.dump(info, open(folder + "/info.json", "w"))
"""

PARAVIEW = r"""
import sys, numpy as np
from paraview import simple, servermanager
from vtkmodules.util.numpy_support import vtk_to_numpy
path, into = sys.argv[-2:]
source = simple.XDMFReader(FileNames=[path])
source.UpdatePipelineInformation()
times = list(source.TimestepValues)
found = {"time": np.array(times)}
for k, time in enumerate(times):
    source.UpdatePipeline(time)
    data = servermanager.Fetch(source)
    while data.IsA("vtkMultiBlockDataSet"):
        data = data.GetBlock(0)
    found[f"position{k}"] = vtk_to_numpy(data.GetPoints().GetData())
    for i in range(data.GetPointData().GetNumberOfArrays()):
        array = data.GetPointData().GetArray(i)
        found[f"{array.GetName()}{k}"] = vtk_to_numpy(array)
    found[f"group{k}"] = vtk_to_numpy(data.GetCellData().GetArray("group"))
    found[f"faces{k}"] = np.array([[data.GetCell(f).GetPointId(i) for i in range(3)] for f in range(data.GetNumberOfCells())])
    bending = data.GetFieldData().GetArray("energy_bending")
    found[f"energy{k}"] = vtk_to_numpy(bending) if bending else np.zeros(0)
np.savez(into, **found)
"""

# Made for browsers: node is told to pass for one.
TINYUSDZ = r"""
import fs from "fs";
const web = new URL("./node_modules/tinyusdz/", import.meta.url);
Object.defineProperty(process, "type", {value: "renderer"});
globalThis.window = globalThis;
globalThis.document = {currentScript: null};
let usd;
try {
    const start = (await import(new URL("tinyusdz.js", web))).default;
    usd = await start({wasmBinary: fs.readFileSync(new URL("tinyusdz.wasm", web))});
} catch (trouble) {
    console.error(trouble);
    process.exit(7);
}
const data = new Uint8Array(fs.readFileSync(process.argv[2]));
const scene = new usd.TinyUSDZLoaderNative(), layer = new usd.TinyUSDZLoaderNative();
if (!scene.loadFromBinary(data, "u.usda") || scene.numMeshes() !== 1) {
    throw new Error("no mesh: " + scene.error());
}
if (!layer.loadAsLayerFromBinary(data, "u.usda")) {
    throw new Error("no layer: " + layer.error());
}
fs.writeFileSync(process.argv[3], layer.layerToString());
"""


class Programs(Case):
    def test_paraview_shows_the_same_bits(self):
        if not shutil.which("pvpython"):
            self.skipTest("paraview is not installed")
        self.export("p.xdmf", "--frames", "1:3")
        with open(self.path("p.py"), "w") as file:
            file.write(PARAVIEW)
        with h5py.File(self.path("s.h5")) as file:
            embedded, rest = file["shell/embedded"][()], file["mesh/rest"][()]
            energy = file["stats/energy_bending"][()]
        run("pvpython", self.path("p.py"), self.path("p.xdmf"), self.path("p.npz"), cwd=self.folder)
        found = np.load(self.path("p.npz"))
        np.testing.assert_array_equal(found["time"], self.time[1:])
        for k in range(FRAMES - 1):
            np.testing.assert_array_equal(found[f"position{k}"], self.position[k + 1])
            np.testing.assert_array_equal(found[f"embedded{k}"], embedded[k + 1])
            np.testing.assert_array_equal(found[f"rest{k}"], rest)
            np.testing.assert_array_equal(found[f"faces{k}"], self.triangle)
            np.testing.assert_array_equal(found[f"group{k}"].ravel(), self.group)
            self.assertEqual(found[f"energy{k}"].ravel()[0], energy[k + 1])

    def npm(self, package):
        """The folder that has a package of npm, brought there by npm itself."""
        home = os.path.join(BUILD, "npm")
        if not os.path.isdir(os.path.join(home, "node_modules", package)):
            if not shutil.which("npm"):
                self.skipTest("npm is not installed")
            os.makedirs(home, exist_ok=True)
            try:
                run("npm", "install", "--no-audit", "--no-fund", package, cwd=home, timeout=90)
            except (AssertionError, subprocess.TimeoutExpired) as trouble:
                self.skipTest(f"npm cannot bring {package}: {str(trouble)[:80]}")
        return home

    def test_tinyusdz_reads_the_usda(self):
        home = self.npm("tinyusdz")
        self.export("u.usda", "--unit", "m")
        with open(os.path.join(home, "usda.mjs"), "w") as file:
            file.write(TINYUSDZ)
        done = run("node", "usda.mjs", self.path("u.usda"), self.path("back.usda"), cwd=home, status=None)
        if done.returncode == 7:
            self.skipTest("tinyusdz does not start in this node")
        self.assertEqual(done.returncode, 0, done.stderr[-500:])
        text = self.bytes("back.usda").decode()
        block = re.search(r"points\.timeSamples = \{(.*?)\n\s*\}", text, re.S).group(1)
        points = [re.findall(r"[-+\d.e]+", row) for row in re.findall(r"\d+: \[(.*?)\]", block, re.S)]
        np.testing.assert_allclose(np.array(points, float).reshape(self.position.shape), self.position, atol=2e-8)
        for pattern in (r'upAxis = "Z"', "metersPerUnit = 1", 'def GeomSubset "left_side"', "normals.timeSamples",
                        "primvars:st:indices"):
            self.assertRegex(text, pattern)

    def test_khronos_validator_finds_no_error(self):
        home = self.npm("gltf-validator")
        self.export("v.glb")
        self.export("v1.glb", "--frame", "1", "--subdivide", "1")
        script = ("const v = require('gltf-validator'), fs = require('fs');"
                  "v.validateBytes(new Uint8Array(fs.readFileSync(process.argv[1])))"
                  ".then(r => console.log(JSON.stringify(r.issues)));")
        for name in ("v.glb", "v1.glb"):
            issues = json.loads(run("node", "-e", script, self.path(name), cwd=home).stdout)
            self.assertEqual((issues["numErrors"], issues["numWarnings"]), (0, 0), issues["messages"][:3])

    def test_blender_sees_the_same_positions(self):
        if not shutil.which("blender"):
            self.skipTest("blender is not installed")
        self.export("b.glb", "--fps", "25", "--name", "sheet")
        self.export("b.pc2", "--unit", "m")
        self.export("b.mdd", "--unit", "m", "--fps", "25")
        self.export("b_%d.obj", "--unit", "m")
        run(RUGA, "bake", "s.h5", "--size", "64", "-o", "b.exr", cwd=self.folder)
        with open(self.path("b.py"), "w") as file:
            file.write(BLENDER)
        done = run("blender", "-b", "--factory-startup", "--python-exit-code", "9", "--python", self.path("b.py"), "--", self.folder,
                   FRAMES, cwd=self.folder)
        self.assertTrue(os.path.exists(self.path("info.json")), done.stdout[-2000:])
        info = json.loads(self.bytes("info.json"))
        self.assertEqual((info["gltf"], info["uv"]), ("sheet", 1))
        self.assertEqual(info["materials"], self.names)
        np.testing.assert_allclose(np.load(self.path("obj.npy")), self.position[0], atol=1e-7)
        for kind in ("pc2", "mdd"):
            np.testing.assert_allclose(np.load(self.path(kind + ".npy")), self.position, atol=1e-7)
        np.testing.assert_allclose(np.load(self.path("exr.npy")), read_exr(self.bytes("b.exr"))[0], atol=1e-7)
        order = np.concatenate([np.flatnonzero(self.group == k) for k in range(2)])
        corners, faces = self.position[:, self.triangle[order]], np.load(self.path("gltf_faces.npy"))
        np.testing.assert_allclose(np.load(self.path("gltf.npy"))[:, faces], corners, atol=1e-7)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2)
