#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The Ruga authors
"""Draws the crease patterns of examples/ as FOLD files, in metres: python3 script/example_patterns.py

knife_pleats, box_pleats: radial creases of a skirt's ring, as `mesh.make` lays it (about the origin, from angle 0 on),
each within a column of quads of its own and off the lines of nodes, but for the seam of the box pleats.
paper_plane: a sheet of A4 folded to a dart.
"""
import json
import math
import os

EXAMPLES = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "examples")


def write(name, title, vertices, edges, faces=None):
    """edges: (vertex, vertex, assignment), with the angle in degrees where it is not the assignment's own."""
    fold = {
        "file_spec": 1.1, "file_creator": "script/example_patterns.py", "frame_title": title, "frame_unit": "m",
        "vertices_coords": [[round(x, 9), round(y, 9)] for x, y in vertices],
        "edges_vertices": [list(e[:2]) for e in edges],
        "edges_assignment": [e[2] for e in edges],
        "edges_foldAngle": [e[3] if len(e) > 3 else {"V": 180, "M": -180}.get(e[2], 0) for e in edges],
    }
    if faces:
        fold["faces_vertices"] = faces
    with open(os.path.join(EXAMPLES, name + ".fold"), "w", encoding="utf-8") as file:
        json.dump(fold, file, separators=(",", ":"))
        file.write("\n")


def pleats(name, title, inner, outer, columns, creases):
    """creases: (place in columns, assignment). The outline overhangs the mesh a little, so that creases reach its rims."""
    vertices, edges, faces = [], [], []
    inner, outer = 0.9 * inner, 1.1 * outer
    for k, (place, assignment) in enumerate(creases):
        phi = 2 * math.pi * place / columns
        vertices += [(r * math.cos(phi), r * math.sin(phi)) for r in (inner, outer)]
        following = 2 * ((k + 1) % len(creases))
        edges += [(2 * k, following, "B"), (2 * k + 1, following + 1, "B"), (2 * k, 2 * k + 1, assignment)]
        faces.append([2 * k, 2 * k + 1, following + 1, following])
    write(name, title, vertices, edges, faces)


def knife_creases(columns):
    """Two folds in five columns: 3.6 forth, 1.4 back."""
    return [(5 * p + place, kind) for p in range(columns // 5) for place, kind in ((2.3, "V"), (3.7, "M"))]


def box_creases(columns, pleats_count):
    """Four folds a pleat: forth, back behind, forth, back again; the last fold is the seam, on a line of nodes."""
    width = columns / pleats_count
    creases = []
    for p in range(pleats_count):
        for part, kind in ((0.37, "V"), (0.50, "M"), (0.87, "M"), (1.0, "V")):
            place = (p + part) * width
            column = math.floor(place)
            creases.append((column + min(max(place - column, 0.25), 0.75), kind))
    creases[-1] = (columns, "V")
    return creases


def paper_plane():
    """A dart of A4: corners fold to the middle line, both halves up, wings down again through both layers."""
    x, top, wing, body, down = 0.105, 0.1485, 0.03, 150, -75
    vertices = [(-x, -top), (x, -top), (x, top - x), (x, top - wing), (x, top), (0, top), (-x, top), (-x, top - wing),
                (-x, top - x), (0, -top), (wing, -top), (-wing, -top), (wing, top - wing), (-wing, top - wing)]
    rim = [0, 11, 9, 10, 1, 2, 3, 4, 5, 6, 7, 8]
    edges = [(a, b, "B") for a, b in zip(rim, rim[1:] + rim[:1])]
    edges.append((5, 9, "V", body))
    for side, far, corner, edge in ((12, 10, 2, 3), (13, 11, 8, 7)):
        edges += [(5, side, "V"), (side, corner, "V"), (side, far, "M", down), (side, edge, "V", -down)]
    write("paper_plane", "paper plane", vertices, edges)


if __name__ == "__main__":
    paper_plane()
    pleats("knife_pleats", "knife pleats", 0.28, 0.78, 150, knife_creases(150))
    pleats("box_pleats", "box pleats", 0.28, 0.78, 300, box_creases(300, 35))
