# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The Ruga authors
#
# docs/guide.md does what it says: its shell commands are run, in order, in an empty folder, with the files that it
# tells the reader to save. What takes long is made short by more options. test_guide.py RUGA SOURCE_DIR
import glob
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

RUGA, SOURCE = (os.path.abspath(path) for path in sys.argv[1:3])
CONCEPTS = os.path.join(SOURCE, "docs", "concepts")
SHORTER = {"run": " --frames 1 --threads 1", "render": " --width 320 --height 240"}
PICTURE_MAX = 150_000  # bytes
SEEN = 0.04  # part of a picture that shows something, which is never grey


def read(*path):
    with open(os.path.join(SOURCE, *path), encoding="utf-8") as file:
        return file.read()


def colored_part(path):
    """Part of the pixels of a PNG with a palette that are no grey: the studio's floor is."""
    with open(path, "rb") as file:
        data = file.read()
    width, height, depth, kind = struct.unpack_from(">IIBB", data, 16)
    at, packed, palette = 8, b"", b""
    while at < len(data):
        size, name = struct.unpack_from(">I4s", data, at)
        packed += data[at + 8:at + 8 + size] if name == b"IDAT" else b""
        palette += data[at + 8:at + 8 + size] if name == b"PLTE" else b""
        at += size + 12
    if kind != 3:
        raise AssertionError(f"{path} has no palette: install pngquant and draw it again")
    row = 1 + (width * depth + 7) // 8
    rows = zlib.decompress(packed)
    if any(rows[::row]):
        raise AssertionError(f"{path} has filtered rows")
    colored = [max(palette[i:i + 3]) - min(palette[i:i + 3]) > 20 for i in range(0, len(palette), 3)] + 256 * [False]
    seen = [sum(colored[byte >> shift & (1 << depth) - 1] for shift in range(0, 8, depth)) for byte in range(256)]
    return sum(seen[byte] for y in range(height) for byte in rows[y * row + 1:(y + 1) * row]) / (width * height)


class Guide(unittest.TestCase):
    guide = read("docs", "guide.md")

    def blocks(self, language):
        return re.findall(rf"^```{language}\n(.*?)^```", self.guide, re.M | re.S)

    def test_every_command_works(self):
        folder = tempfile.mkdtemp(prefix="ruga_guide_")
        self.addCleanup(shutil.rmtree, folder)
        scenes = self.blocks("yaml")
        names = re.findall(r"Save this as `([\w.]+)`", self.guide)
        self.assertEqual(len(names), len(scenes))
        for name, scene in zip(names, scenes):
            with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                file.write(scene)
        os.symlink(RUGA, os.path.join(folder, "ruga"))
        commands = [line for block in self.blocks("sh") for line in block.splitlines()]
        self.assertEqual({command.split()[1] for command in commands},
                         {"make", "check", "remesh", "explain", "run", "measure", "render", "view", "export"})
        self.assertRegex(self.guide, r"(?m)^    ruga bake first\.h5 ")  # wants a mesh with texture coordinates
        for command in commands:
            self.assertTrue(command.startswith("ruga "), command)
            short = command.replace("--edge 5mm", "--edge 7mm") + SHORTER.get(command.split()[1], "")
            done = subprocess.run(["sh", "-c", short], cwd=folder, capture_output=True, text=True, timeout=300,
                                  env=dict(os.environ, PATH=folder + os.pathsep + os.environ["PATH"]))
            if command.startswith("ruga view") and "without npm" in done.stderr:
                continue
            self.assertEqual(done.returncode, 0, f"{command}\n{done.stderr}")
            output = re.search(r"-o (\S+)", command)
            if output:
                path = os.path.join(folder, output[1].replace("%04d", "0001"))
                self.assertGreater(os.path.getsize(path), 1000, command)

    def test_its_pictures_are_of_its_scene(self):
        scene = self.blocks("yaml")[0].splitlines()[2:]
        first = read("docs", "concepts", "scenes", "guide_first.yaml").splitlines()
        thick = read("docs", "concepts", "scenes", "guide_thick.yaml").splitlines()
        self.assertEqual(first[-len(scene):], scene)
        thickness = re.search(r'ruga run .*"skin.thickness=([^"]+)"', self.guide)[1]
        self.assertEqual(thick[-len(scene):], [re.sub(r"thickness: [^,]+", f"thickness: {thickness}", line)
                                               for line in scene])

    def test_numbers_are_those_of_explain(self):
        text = subprocess.run([RUGA, "explain", os.path.join(CONCEPTS, "scenes", "guide_first.yaml")],
                              capture_output=True, text=True, check=True).stdout
        facts = dict(re.findall(r"^    (wavelength|critical strain|edges per wavelength) +([\d.]+)", text, re.M))
        for number, words in ((f"{float(facts['wavelength']):.0f}", r"a \*\*wavelength\*\* of {} mm"),
                              (f"{float(facts['critical strain']):.1f}", r"a \*\*critical strain\*\* of {} %"),
                              (f"{float(facts['edges per wavelength']):.1f}", r"{} \*\*edges per wavelength\*\*")):
            self.assertRegex(" ".join(self.guide.split()), words.format(re.escape(number)))


class Concepts(unittest.TestCase):
    def test_every_scene_is_read_has_its_picture_and_is_shown(self):
        pages = "".join(read("docs", "concepts", os.path.basename(path))
                        for path in glob.glob(os.path.join(CONCEPTS, "*.md"))) + read("docs", "guide.md")
        for path in sorted(glob.glob(os.path.join(CONCEPTS, "scenes", "*.yaml"))):
            name = os.path.basename(path)[:-5]
            self.assertTrue(os.path.exists(os.path.join(CONCEPTS, name + ".png")), f"script/figures {name} is due")
            self.assertIn(name + ".png)", pages)
            done = subprocess.run([RUGA, "explain", path], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)

    def test_pictures_are_small_and_have_a_scene(self):
        for path in sorted(glob.glob(os.path.join(CONCEPTS, "*.png"))):
            self.assertLess(os.path.getsize(path), PICTURE_MAX, path)
            self.assertGreater(colored_part(path), SEEN, path)
            self.assertTrue(os.path.exists(os.path.join(CONCEPTS, "scenes", os.path.basename(path)[:-4] + ".yaml")))

    def test_pictures_of_the_gallery_are_small_and_not_empty(self):
        for path in sorted(glob.glob(os.path.join(SOURCE, "docs", "gallery", "*.png"))):
            self.assertLess(os.path.getsize(path), PICTURE_MAX, path)
            self.assertGreater(colored_part(path), SEEN, path)
            self.assertTrue(os.path.exists(os.path.join(SOURCE, "examples", os.path.basename(path)[:-4] + ".yaml")))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
