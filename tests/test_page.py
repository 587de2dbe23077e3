#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The Ruga authors
"""The page of `ruga view` in headless Chromium, driven over the WebDriver protocol.

    test_page.py RUGA

Ends with 77, and says why, where chromium or chromedriver is not installed or ruga was built without npm.
Standard library only.
"""
import base64
import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.request
import zlib

from picture import colors, pixels

RUGA = os.path.abspath(sys.argv.pop(1))
SHEET = """
mesh:       {make: {shape: sheet, size: [12 cm, 4 cm], edge: 4 mm}}
skin:       {thickness: 2 mm, young: 40 MPa}
interior:   {young: 0.5 MPa, motion: prescribed}
lattice:    {fill: box}
prescribed: [{time: 0 s}, {time: 60 ms, stretch: [0.9, 1, 1]}]
time:       {step: 20 ms, frames: 3}
"""
SHELL = """
mesh:     {make: {shape: sheet, size: [12 cm, 4 cm], edge: 8 mm}}
skin:     {thickness: 1 mm, young: 1 MPa}
interior: none
gravity:  [0, 0, -9.81]
handles:  [{region: {plane: {center: [-5 cm, 0, 0], normal: [-1, 0, 0]}}, fix: true}]
time:     {step: 20 ms, frames: 1}
"""


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(77)


class Browser:
    def __init__(self, folder):
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        self.base = f"http://127.0.0.1:{port}"
        self.driver = subprocess.Popen(["chromedriver", f"--port={port}"], stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL)
        arguments = ["--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
                     "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage", "--hide-scrollbars",
                     "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
                     "--window-size=920,400", f"--user-data-dir={folder}/profile"]
        wanted = {"browserName": "chrome", "goog:loggingPrefs": {"browser": "ALL"},
                  "goog:chromeOptions": {"args": arguments, "binary": shutil.which("chromium")}}
        for _ in range(100):
            try:
                self.call("GET", "/status")
                break
            except OSError:
                time.sleep(0.1)
        self.session = "/session/" + self.call("POST", "/session", {"capabilities": {"alwaysMatch": wanted}})["sessionId"]

    def call(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.base + path, data, {"Content-Type": "application/json"}, method=method)
        with urllib.request.urlopen(request, timeout=120) as answer:
            return json.load(answer)["value"]

    def open(self, path):
        self.call("POST", self.session + "/url", {"url": "file://" + path})
        for _ in range(300):
            if self.run("return document.body.dataset.ready === 'yes' || !document.getElementById('trouble').hidden"):
                return
            time.sleep(0.1)
        raise AssertionError("the page did not become ready in 30 s")

    def run(self, script):
        return self.call("POST", self.session + "/execute/sync", {"script": script, "args": []})

    def log(self):
        return self.call("POST", self.session + "/se/log", {"type": "browser"})

    def picture(self):
        """The canvas, once what was asked for is drawn."""
        self.run("document.querySelectorAll('.caption').forEach((c) => { c.style.visibility = 'hidden'; })")
        self.call("POST", self.session + "/execute/async", {"args": [], "script":
                  "const done = arguments[0]; requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 50)))"})
        found = self.call("POST", self.session + "/element", {"using": "css selector", "value": "#stage > canvas"})
        shot = self.call("GET", f"{self.session}/element/{next(iter(found.values()))}/screenshot")
        return pixels(base64.b64decode(shot))

    def close(self):
        try:
            self.call("DELETE", self.session)
        finally:
            self.driver.terminate()
            self.driver.wait()


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.browser = Browser(cls.scratch.name)
        for name, scene in (("sheet", SHEET), ("shell", SHELL)):
            path = os.path.join(cls.scratch.name, name)
            with open(path + ".yaml", "w", encoding="utf-8") as file:
                file.write(scene)
            subprocess.run([RUGA, "run", path + ".yaml", "-o", path + ".h5", "--quiet"], check=False, timeout=120)
            subprocess.run([RUGA, "view", path + ".h5", "-o", path + ".html", "--quiet"], check=True, timeout=120)

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()
        cls.scratch.cleanup()

    def open(self, name):
        self.browser.log()
        self.browser.open(os.path.join(self.scratch.name, name))
        self.assertEqual([entry for entry in self.browser.log() if entry["level"] in ("SEVERE", "WARNING")
                          and "GPU stall" not in entry["message"]], [])
        self.assertEqual(self.browser.run("return document.body.dataset.ready"), "yes")

    def scrub(self, frame):
        self.browser.run("const s = document.getElementById('scrub');"
                         f"s.value = {frame}; s.dispatchEvent(new Event('input'))")

    def drawn(self, picture):
        """How many pixels differ from the background, in the picture's corner."""
        seen = colors(picture)
        return sum(max(abs(a - b) for a, b in zip(c, seen[0])) > 12 for c in seen)

    def differ(self, one, other):
        return sum(max(abs(a - b) for a, b in zip(c, d)) > 12 for c, d in zip(colors(one), colors(other)))

    def test_page_loads_alone_and_shows_the_skin(self):
        self.open("sheet.html")
        self.assertEqual(self.browser.run("return performance.getEntriesByType('resource')"
                                          ".filter((e) => !e.name.startsWith('data:')).map((e) => e.name)"), [])
        picture = self.browser.picture()
        self.assertGreater(self.drawn(picture), 0.05 * len(colors(picture)))
        self.assertEqual(self.browser.run("return document.getElementById('scene').textContent.includes('40 MPa')"), True)
        self.assertGreaterEqual(self.browser.run("return document.querySelectorAll('.plot').length"), 4)

    def test_a_page_without_data_is_seen_to_be_blank(self):
        """The check above fails where it should: with the skin's positions all in one place."""
        with open(os.path.join(self.scratch.name, "sheet.html"), encoding="utf-8") as file:
            text = file.read()
        begin = text.index('id="wrinkled">') + len('id="wrinkled">')
        size = json.loads(text.split('id="meta">')[1].split("</script>")[0])
        nothing = base64.b64encode(zlib.compress(bytes(6 * size["vertices"] * size["frames"]))).decode()
        with open(os.path.join(self.scratch.name, "blank.html"), "w", encoding="utf-8") as file:
            file.write(text[:begin] + nothing + text[text.index("</script>", begin):])
        self.browser.open(os.path.join(self.scratch.name, "blank.html"))
        self.assertLess(self.drawn(self.browser.picture()), 20)
        self.browser.log()

    def test_scrubbing_and_playing_change_the_picture(self):
        self.open("sheet.html")
        last = self.browser.picture()
        self.scrub(0)
        first = self.browser.picture()
        self.assertGreater(self.differ(first, last), 500)
        self.scrub(3)
        self.assertEqual(self.differ(self.browser.picture(), last), 0)
        self.scrub(0)
        self.browser.run("document.getElementById('play').click()")
        for _ in range(100):  # it begins again after 80 ms: one look that finds another frame is enough
            shown = self.browser.run("return document.getElementById('scrub').value")
            if shown != "0":
                break
            time.sleep(0.05)
        self.assertNotEqual(shown, "0")

    def test_dragging_turns_the_skin(self):
        self.open("sheet.html")
        before = self.browser.picture()
        self.browser.call("POST", self.browser.session + "/actions", {"actions": [
            {"type": "pointer", "id": "mouse", "actions": [
                {"type": "pointerMove", "x": 150, "y": 150}, {"type": "pointerDown", "button": 0},
                {"type": "pointerMove", "x": 250, "y": 190, "duration": 100}, {"type": "pointerUp", "button": 0}]}]})
        time.sleep(0.3)
        self.assertGreater(self.differ(self.browser.picture(), before), 500)

    def test_displacement_is_coloured_and_stands_beside_the_embedded_surface(self):
        self.open("sheet.html")
        self.browser.run("const c = document.getElementById('color'); c.value = 'displacement';"
                         "c.dispatchEvent(new Event('change')); document.getElementById('both').click()")
        rows, n = self.browser.picture()
        half = len(rows[0]) // n // 2 * n
        left = colors(([row[:half] for row in rows], n))
        right = colors(([row[half:] for row in rows], n))
        self.assertGreater(sum(c[0] > c[2] + 60 for c in left), 50)  # red
        self.assertGreater(sum(c[2] > c[0] + 60 for c in left), 50)  # blue
        self.assertEqual(sum(c[2] > c[0] + 60 for c in right), 0)
        self.assertGreater(sum(max(abs(a - b) for a, b in zip(c, right[0])) > 12 for c in right), 300)

    def test_each_frame_has_its_own_displacement(self):
        """Of the first frame, which is flat, none; of the last, up to the largest of all."""
        with open(os.path.join(self.scratch.name, "sheet.html"), encoding="utf-8") as file:
            text = file.read()
        size = json.loads(text.split('id="meta">')[1].split("</script>")[0])
        packed = text.split('id="displacement">')[1].split("</script>")[0]
        values = zlib.decompress(base64.b64decode(packed))
        first, last = values[:size["vertices"]], values[-size["vertices"]:]
        self.assertEqual(len(values), size["vertices"] * size["frames"])
        self.assertLessEqual(max(abs(value - 128) for value in first), 1)
        self.assertGreater(max(abs(value - 128) for value in last), 120)

    def test_a_shell_without_an_interior_has_a_page_too(self):
        self.open("shell.html")
        self.assertTrue(self.browser.run("return document.getElementById('both').disabled"))
        self.assertGreater(self.drawn(self.browser.picture()), 300)


if __name__ == "__main__":
    for program in ("chromium", "chromedriver"):
        if not shutil.which(program):
            skip(f"{program} is not installed")
    answer = subprocess.run([RUGA, "view", "nothing.h5", "-o", "/tmp/ruga-no-page.html"], capture_output=True, text=True,
                            check=False)
    if "without npm" in answer.stderr:
        skip("ruga was built without npm")
    unittest.main()
