# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The Ruga authors
#
# Result files as h5py sees them: test_result.py PATH_OF_test_result
# Exit code 77 = skipped.
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time

try:
    import h5py
    import numpy as np
except ImportError as trouble:
    print(f"skipped: {trouble} (Debian: python3-h5py, with /usr/bin/python3)")
    sys.exit(77)

FRAMES = 140
KILLS = 20
PROGRAM = sys.argv[1]


def run(*arguments):
    subprocess.run([PROGRAM, *map(str, arguments)], check=True)


def position(frame):
    """The generator of test_result.c; sines of two C libraries may differ in the last bit."""
    return np.sin(frame * 10.0 + np.arange(900) * 0.001).reshape(300, 3)


def datasets(file):
    found = {}
    file.visititems(lambda name, item: found.update({name: item}) if isinstance(item, h5py.Dataset) else None)
    return found


def whole_frames(path, swmr=True):
    """Opens, reads every frame of every dataset, and gives their number."""
    with h5py.File(path, "r", swmr=swmr) as file:
        count = file["frames/time"].shape[0]
        assert np.array_equal(file["frames/time"][:], np.arange(count) * 0.02)
        for name, item in datasets(file).items():
            if name.startswith(("shell/", "stats/")) or name == "lattice/position":
                assert item.shape[0] >= count, (name, item.shape, count)
                item[:count]
        assert np.array_equal(file["stats/newton_iterations"][:count], np.arange(count))
        for frame in range(count):
            assert np.allclose(file["shell/position"][frame], position(frame), rtol=0, atol=1e-15)
        return count


def assert_equal_files(path, reference):
    with h5py.File(path, "r") as a, h5py.File(reference, "r") as b:
        sets, wanted = datasets(a), datasets(b)
        assert sets.keys() == wanted.keys()
        for name, item in sets.items():
            if "/seconds_" not in name:
                x, y = item[()], wanted[name][()]
                assert x.shape == y.shape and x.dtype == y.dtype, name
                assert x.dtype == object and (x == y).all() or x.tobytes() == y.tobytes(), name
        assert a.attrs.keys() == b.attrs.keys()
        for name, value in a.attrs.items():
            assert value == b.attrs[name], name


def check_layout(path):
    wanted = {
        "mesh/triangles": ("<i4", (200, 3)), "mesh/rest": ("<f8", (300, 3)), "mesh/uv": ("<f8", (4, 2)),
        "mesh/uv_triangles": ("<i4", (200, 3)), "mesh/face_group": ("<i4", (200,)),
        "mesh/source_vertex": ("<i4", (300,)), "frames/time": ("<f8", (FRAMES,)),
        "shell/position": ("<f8", (FRAMES, 300, 3)), "shell/embedded": ("<f8", (FRAMES, 300, 3)),
        "lattice/elements": ("<i4", (2, 8)), "lattice/nodes": ("<f8", (60, 3)),
        "lattice/position": ("<f8", (FRAMES, 60, 3)), "stats/outcome": ("|i1", (FRAMES,)),
        "stats/substeps": ("<i4", (FRAMES,)), "stats/energy_membrane": ("<f8", (FRAMES,)),
        "restart/vector": ("<f8", (2, 1000)), "restart/frame": ("<i8", (2,)),
    }
    with h5py.File(path, "r") as file:  # plainly: it is finished
        for name, (kind, shape) in wanted.items():
            assert (file[name].dtype.str, file[name].shape) == (kind, shape), (name, file[name])
        assert list(file["mesh/group_names"].asstr()) == ["cheek", "Stirn ä"]
        assert file.attrs["scene"] == "mesh: a.obj\n" and file.attrs["scene_hash"] == "fedcba9876543210"
        assert file.attrs["seed"] == -7 and file.attrs["library_versions"].startswith("HDF5 ")
        assert list(file["restart/frame"]) == [FRAMES - 2, FRAMES - 1]


def read_beside_the_writer(path):
    writer = subprocess.Popen([PROGRAM, "write", path, str(FRAMES), "5000"])
    counts = []
    while writer.poll() is None:
        if os.path.exists(path):
            counts.append(whole_frames(path))
    assert writer.returncode == 0
    assert counts == sorted(counts) and counts[0] >= 1 and len(set(counts)) > 3, counts
    print(f"{len(counts)} readings beside the writer, from {counts[0]} to {counts[-1]} frames")


def kill_and_resume(path, reference, seed):
    rng = random.Random(seed)
    kills, last = 0, 0
    for attempt in range(KILLS):
        # Half of them without pauses between the frames, where nearly every kill is in the midst of writing.
        command = [PROGRAM, "resume", path, str(FRAMES), rng.choice(["0", "1000"])]
        writer = subprocess.Popen(command, stderr=subprocess.PIPE)
        time.sleep(rng.uniform(0.005, 0.12))
        writer.kill()
        trouble = writer.communicate()[1]
        assert not trouble, trouble
        kills += writer.returncode == -9
        if os.path.exists(path):
            count = whole_frames(path)
            assert last <= count <= FRAMES, (last, count)
            run("check", path, count)  # bit for bit
            last = count
            if count == FRAMES:
                break
    run("resume", path, FRAMES, 0)
    assert_equal_files(path, reference)
    return kills


def main(folder):
    reference, path = os.path.join(folder, "reference.h5"), os.path.join(folder, "a.h5")
    run("write", reference, FRAMES, 0)
    assert whole_frames(reference, swmr=False) == FRAMES
    check_layout(reference)
    read_beside_the_writer(path)
    assert_equal_files(path, reference)
    kills, seed = 0, 0
    while kills < KILLS:
        os.remove(path)
        kills += kill_and_resume(path, reference, seed)
        seed += 1
    left = sorted(os.listdir(folder))
    assert left == ["a.h5", "reference.h5"], left
    print(f"{kills} kills in {seed} runs, no whole frame lost; all resumed to the same bits")


temporary = tempfile.mkdtemp(prefix="ruga_result_")
try:
    main(temporary)
finally:
    shutil.rmtree(temporary)
