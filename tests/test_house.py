#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The Ruga authors
"""The rules of the house (CONTRIBUTING.md) that a program can check. Prints every breach and fails on any.

    test_house.py [SOURCE_DIR [BUILD_DIR]]

Without a build directory the symbols are not looked at; objects that are not built yet are not either.
Before it judges the tree it judges a small one full of faults, so that a rule that sees nothing is noticed.
Standard library only, and nm of binutils.
"""
import os
import re
import subprocess
import sys
import tempfile

# Who may know whom: a file includes its own folder and folders of smaller rank. Equal ranks do not know each other.
RANK = {"core": 0, "mesh": 1, "lattice": 2, "shell": 2, "crease": 3, "contact": 3, "constraints": 4, "solver": 5,
        "io": 6, "view": 6, "app": 7}
FOLDERS = [*RANK, "include", "tests", "examples"]
SOURCE = (".c", ".h", ".cpp", ".hpp")
HEADER = (".h", ".hpp")

FILE_LINES = 800
HEADER_LINES = 150
# Longer ones, each with its reason.
LONG = {
    "include/ruga/types.h": "every def and its documentation on one page; half of it is prose",
    "tests/test_lattice.c": "the flooded reference bodies are shared by all of its properties",
    "tests/test_mesh_file.c": "one program for all formats: each property is tested on each of them",
}

SPDX = re.compile(r"// SPDX-License-Identifier: MIT\n// Copyright \(c\) \d{4} The Ruga authors\n")
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*(["<])([^">]+)[">]', re.M)
GUARD = re.compile(r"^#ifndef (\w+)\n#define \1\b", re.M)
API = re.compile(r"^RUGA_API\b[^;(]*?\b(ruga_\w+)\s*\(", re.M)


def read(root, path):
    with open(os.path.join(root, path), encoding="utf-8") as file:
        return file.read()


def sources(root):
    """All C and C++ files of the tree, as paths from its root. Build trees and hidden folders are left out."""
    found = []
    for folder, folders, names in os.walk(root):
        folders[:] = sorted(f for f in folders if not f.startswith(".")
                            and not (folder == root and f.startswith("build")))
        found += [os.path.relpath(os.path.join(folder, n), root) for n in sorted(names) if n.endswith(SOURCE)]
    return found


# ---- source files ------------------------------------------------------------------------------------------

def check_place(root, path):
    folder = path.split("/")[0]
    if folder not in FOLDERS:
        yield f"{path}: is in no folder of the layout"
    if path.endswith((".cpp", ".cc", ".cxx")) and not path.endswith("_shim.cpp"):
        yield f"{path}: C++ is allowed in *_shim.cpp only"
    if path.endswith("_shim.cpp") and not os.path.exists(os.path.join(root, path[:-4] + ".h")):
        yield f"{path}: a shim has a plain C header of the same name"
    if path.endswith(".hpp") and path != "core/shim.hpp":
        yield f"{path}: core/shim.hpp is the only C++ header"


def check_head(root, path):
    if not SPDX.match(read(root, path)):
        yield f"{path}: does not begin with the two SPDX lines of core/status.c"


def check_guard(root, path):
    if not path.endswith(HEADER):
        return
    name = re.sub(r"^include/ruga/", "", path)
    wanted = "RUGA_" + re.sub(r"[^A-Za-z0-9]", "_", name).upper()
    found = GUARD.search(read(root, path))
    if not found:
        yield f"{path}: has no include guard {wanted}"
    elif found.group(1) != wanted:
        yield f"{path}: its include guard is {found.group(1)}, not {wanted}"


def check_size(root, path):
    if path in LONG:
        return
    lines = read(root, path).count("\n")
    limit = HEADER_LINES if path.endswith(HEADER) else FILE_LINES
    if lines > limit:
        yield f"{path}: {lines} lines, more than {limit}; split it, or list it in tests/test_house.py with a reason"


def line_of(text, place):
    return text.count("\n", 0, place) + 1


def check_includes(root, path):
    text = read(root, path)
    folder = path.split("/")[0]
    for match in INCLUDE.finditer(text):
        kind, name = match.groups()
        at = f"{path}:{line_of(text, match.start())}"
        public = name.startswith("ruga/")
        if folder == "examples":
            if (kind == '"' or "/" in name) and not (kind == "<" and public):
                yield f"{at}: an example includes <ruga/...> and the standard library only, not {name}"
            continue
        if kind == "<":
            if public or name.split("/")[0] in RANK:
                yield f'{at}: our own headers are included as "{name}"'
            continue
        base = os.path.join(root, "include") if public else root
        if not os.path.exists(os.path.join(base, name)):
            yield f'{at}: "{name}" is not a path from the root of the tree'
            continue
        yield from check_direction(at, folder, "include" if public else name.split("/")[0], name)


def check_direction(at, folder, target, name):
    if target == "include" or folder == "tests":
        return
    if folder == "include":
        yield f'{at}: a public header includes public headers only, not "{name}"'
    elif target != folder and RANK.get(target, 99) >= RANK.get(folder, -1):
        yield f'{at}: {folder}/ may not know {target}/ ("{name}")'


def check_file(root, path):
    for check in (check_place, check_head, check_guard, check_size, check_includes):
        yield from check(root, path)


# ---- lists that must agree ---------------------------------------------------------------------------------

def check_source_lists(root):
    """Every source of a module stands in its CMakeLists.txt."""
    for folder in RANK:
        if not os.path.isdir(os.path.join(root, folder)):
            continue
        units = [n for n in sorted(os.listdir(os.path.join(root, folder))) if n.endswith((".c", ".cpp"))]
        lists = os.path.join(folder, "CMakeLists.txt")
        listed = set(re.findall(r"[\w./-]+", read(root, lists))) if os.path.exists(os.path.join(root, lists)) else set()
        for name in units:
            if name not in listed:
                yield f"{folder}/{name}: is not listed in {lists}"


def packages(root):
    lines = read(root, "script/packages.txt").splitlines()
    return [line.strip() for line in lines if line.strip() and not line.startswith("#")]


def check_readme(root):
    """README names every package, and its C program is examples/library.c, which is built and run as a test."""
    readme = read(root, "README.md")
    for package in packages(root):
        if f"`{package}`" not in readme:
            yield f"README.md: does not say what the package {package} is for"
    blocks = re.findall(r"^```c\n(.*?)^```", readme, re.M | re.S)
    if not os.path.exists(os.path.join(root, "examples/library.c")):
        yield "examples/library.c: is missing"
    elif blocks != [read(root, "examples/library.c")]:
        yield ("README.md: its C program is not examples/library.c, line by line; "
               "RUGA_WRITE_DOCS=1 test_house.py copies it")


def check_links(root):
    """What the documents name is there: relative links, scripts and examples."""
    documents = [n for n in sorted(os.listdir(root)) if n.endswith(".md")]
    for folder in ("docs", *RANK):
        path = os.path.join(root, folder)
        documents += [f"{folder}/{n}" for n in sorted(os.listdir(path)) if n.endswith(".md")] \
            if os.path.isdir(path) else []
    for document in documents:
        text = read(root, document)
        here = os.path.dirname(document)
        named = {os.path.normpath(os.path.join(here, n)) for n in re.findall(r"\]\(([^)#:\s]+)[)#]", text)}
        named |= set(re.findall(r"(?<![\w/.])(?:script|examples)/\w[\w.]*\w", text))
        for name in sorted(named):
            if not os.path.exists(os.path.join(root, name)):
                yield f"{document}: names {name}, which does not exist"


def write_readme(root):
    """Copies the C program into README; with RUGA_WRITE_DOCS=1, as for docs/scene.md."""
    text = read(root, "README.md")
    program = read(root, "examples/library.c")
    with open(os.path.join(root, "README.md"), "w", encoding="utf-8") as file:
        file.write(re.sub(r"^```c\n.*?^```", lambda _: f"```c\n{program}```", text, flags=re.M | re.S))


# ---- symbols -----------------------------------------------------------------------------------------------

def symbols(path, *options):
    """Names that a binary defines for others, without versions."""
    run = subprocess.run(["nm", "-P", "--defined-only", *options, path], capture_output=True, text=True, check=True)
    names = [line.split()[0] for line in run.stdout.splitlines() if line and not line.endswith(":")]
    return {name.split("@")[0] for name in names}


def objects(build):
    """Object files of the modules: <build>/<folder>/CMakeFiles/ruga_<folder>.dir/*.o"""
    for folder in RANK:
        place = os.path.join(build, folder, "CMakeFiles", f"ruga_{folder}.dir")
        for name in sorted(os.listdir(place)) if os.path.isdir(place) else []:
            # Objects of sources that are gone may lie in an old build.
            if name.endswith(".o"):
                yield f"{folder}/{name[:-2]}", os.path.join(place, name)


def check_objects(root, build):
    """Names that the linker sees begin with ruga_; mangled C++ and names of the compiler (with __) aside."""
    for source, path in objects(build):
        if not os.path.exists(os.path.join(root, source)):
            continue
        for name in sorted(symbols(path, "-g")):
            if not name.startswith(("ruga_", "_Z", "__", "DW.ref.")) and name != "main":
                yield f"{source}: {name} is external without the prefix ruga_; make it static or give it the prefix"


def public_functions(root):
    folder = os.path.join(root, "include", "ruga")
    return {name for header in os.listdir(folder) for name in API.findall(read(folder, header))}


def check_library(root, build):
    """libruga.so exports what the public headers mark with RUGA_API, and nothing else."""
    for folder, folders, names in os.walk(build):
        folders[:] = [f for f in folders if f != "CMakeFiles"]
        if "libruga.so" not in names:
            continue
        exported = symbols(os.path.join(folder, "libruga.so"), "-D", "-g")
        for name in sorted(public_functions(root) - exported):
            yield f"libruga.so: {name} is marked RUGA_API but not exported"
        extra = sorted(exported - public_functions(root))
        for name in extra[:10]:
            yield f"libruga.so: exports {name}, which no public header marks with RUGA_API"
        if len(extra) > 10:
            yield f"libruga.so: exports {len(extra) - 10} more of that kind"


def breaches(root, build=None):
    for path in sources(root):
        yield from check_file(root, path)
    yield from check_source_lists(root)
    yield from check_readme(root)
    yield from check_links(root)
    if build:
        yield from check_objects(root, build)
        yield from check_library(root, build)


# ---- the rules themselves ----------------------------------------------------------------------------------

HEAD = "// SPDX-License-Identifier: MIT\n// Copyright (c) 2026 The Ruga authors\n"
PROGRAM = HEAD + "#include <ruga/ruga.h>\n"
GUARDED = HEAD + "#ifndef {0}\n#define {0}\n{1}#endif\n"
GOOD = {
    "include/ruga/ruga.h": GUARDED.format("RUGA_RUGA_H", "RUGA_API int ruga_step(void);\n"),
    "core/memory.h": GUARDED.format("RUGA_CORE_MEMORY_H", ""),
    "mesh/mesh.c": HEAD + '#include "core/memory.h"\n#include "ruga/ruga.h"\n#include <math.h>\n',
    "mesh/CMakeLists.txt": "ruga_module(mesh SOURCES mesh.c)\n",
    "examples/library.c": PROGRAM,
    "README.md": f"`gcc`\n```c\n{PROGRAM}```\n",
    "script/packages.txt": "# comment\ngcc\n",
}
# A change to the good tree, and a part of the sentence that it must bring.
FAULTS = [
    ("core/list.c", HEAD + '#include "mesh/mesh.c"\n', "core/ may not know mesh/"),
    ("shell/a.c", HEAD + '#include "lattice/b.h"\n', "not a path from the root"),
    ("shell/a.c", HEAD + '#include "lattice/b.c"\n', "shell/ may not know lattice/"),
    ("mesh/mesh.c", HEAD + '#include "memory.h"\n', "not a path from the root"),
    ("mesh/mesh.c", HEAD + "#include <ruga/ruga.h>\n", "our own headers"),
    ("include/ruga/ruga.h", GUARDED.format("RUGA_RUGA_H", '#include "core/memory.h"\n'), "public headers only"),
    ("mesh/tool.cpp", HEAD, "C++ is allowed"),
    ("mesh/tool_shim.cpp", HEAD, "plain C header"),
    ("mesh/mesh.c", "int a;\n" + HEAD, "SPDX"),
    ("core/memory.h", GUARDED.format("MEMORY_H", ""), "include guard is MEMORY_H"),
    ("core/memory.h", HEAD, "no include guard"),
    ("core/memory.h", GUARDED.format("RUGA_CORE_MEMORY_H", "\n" * 150), "more than 150"),
    ("mesh/mesh.c", HEAD + "\n" * 799, "more than 800"),
    ("mesh/other.c", HEAD, "not listed"),
    ("view/alone.c", HEAD, "not listed"),
    ("tools/other.c", HEAD, "no folder of the layout"),
    ("script/packages.txt", "gcc\ncmake\n", "package cmake"),
    ("README.md", f"`gcc`\n```c\n{PROGRAM}\n```\n", "line by line"),
    ("docs/a.md", "see [b](b.md)", "names docs/b.md"),
    ("docs/a.md", "call script/nothing.", "names script/nothing,"),
    ("examples/library.c", HEAD + '#include "core/memory.h"\n', "an example includes"),
]


def write_tree(root, files):
    for path, text in files.items():
        os.makedirs(os.path.dirname(os.path.join(root, path)) or root, exist_ok=True)
        with open(os.path.join(root, path), "w", encoding="utf-8") as file:
            file.write(text)


def check_rules():
    for path, text, wanted in [("README.md", GOOD["README.md"], None), *FAULTS]:
        with tempfile.TemporaryDirectory() as root:
            write_tree(root, {**GOOD, "lattice/b.c": HEAD, "lattice/CMakeLists.txt": "b.c", path: text})
            found = list(breaches(root))
        if wanted is None and found:
            yield f"test_house.py: finds fault with a good tree: {found}"
        elif wanted and not any(wanted in sentence for sentence in found):
            yield f"test_house.py: does not see the fault put into {path} ({wanted})"


def main():
    here = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    root = os.path.abspath(sys.argv[1]) if len(sys.argv) > 1 else here
    build = sys.argv[2] if len(sys.argv) > 2 else None
    if os.environ.get("RUGA_WRITE_DOCS"):
        write_readme(root)
    found = [*check_rules(), *breaches(root, build)]
    for sentence in found:
        print(sentence)
    print(f"{len(sources(root))} files, {len(found)} breaches of the house's rules")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
