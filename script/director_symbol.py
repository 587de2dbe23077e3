#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The Ruga authors
"""Energy of a plane wave by the bending element of shell/directors.c on equilateral triangles of edge 1, over
that of a plate: what its file head says of c and beta. A note with a program; nothing in the build needs it.

A wave exp(i k.x) is carried by one vertex for each cell of the lattice, and by one rotation f for each of the
three edges. Each triangle's b is linear in the changes t of the hinges' angles and in f; f is eliminated."""
import numpy as np

AXES = np.array([[1, 0], [0.5, np.sqrt(0.75)]])  # of the lattice
AREA = np.sqrt(3) / 4
UP = [(0, 0), (1, 0), (0, 1)]
EDGES = [((0, 0), (1, 0)), ((0, 0), (0, 1)), ((1, 0), (0, 1))]
# The two triangles at each edge.
SIDES = [(UP, [(1, -1), (1, 0), (0, 0)]), (UP, [(0, 0), (0, 1), (-1, 1)]), (UP, [(1, 0), (1, 1), (0, 1)])]


def point(corner):
    return np.array(corner) @ AXES


def gradients(triangle):
    """Of the corner opposite to each edge."""
    result = []
    for i in range(3):
        p, q, r = (point(triangle[(i + j) % 3]) for j in range(3))
        normal = np.array([p[1] - q[1], q[0] - p[0]])
        result.append(normal / (normal @ (r - p)))
    return result


def edge_of(u, v):
    """Number of an edge, and the cell that it belongs to."""
    for number, (a, b) in enumerate(EDGES):
        for p, q in ((u, v), (v, u)):
            if (q[0] - p[0], q[1] - p[1]) == (b[0] - a[0], b[1] - a[1]):
                return number, (p[0] - a[0], p[1] - a[1])
    raise ValueError((u, v))


def ratio(k, poisson, beta):
    """Energy over |k|^4 / 2, that of a plate with D = 1."""
    phase = lambda corner: np.exp(1j * k @ point(corner))
    plate = np.array([[1, poisson, 0], [poisson, 1, 0], [0, 0, 2 * (1 - poisson)]])

    def slope(triangle):
        g = gradients(triangle)
        return sum(g[i] * phase(triangle[(i + 2) % 3]) for i in range(3))

    def form(triangle, first):
        """b by t (columns 0 .. 2) and f (3 .. 5)."""
        b = np.zeros((3, 6), complex)
        for i, g in enumerate(gradients(triangle)):
            number, cell = edge_of(triangle[i], triangle[(i + 1) % 3])
            column = 2 / np.linalg.norm(g) * np.array([g[0] ** 2, g[1] ** 2, g[0] * g[1]]) * phase(cell)
            b[:, number] += column / 2
            b[:, 3 + number] += column if first else -column
        return b

    t, energy = [], np.zeros((6, 6), complex)
    for triangle, first in ((UP, True), (SIDES[2][1], False)):
        b = form(triangle, first)
        energy += AREA * b.conj().T @ plate @ b
    for (start, end), (one, other) in zip(EDGES, SIDES):
        jump = form(one, True) - form(other, False)
        energy += beta * 2 * AREA / 3 * jump.conj().T @ plate @ jump
        along = point(end) - point(start)
        normal = np.array([-along[1], along[0]])
        inward = normal @ (sum(point(c) for c in one) / 3 - point(start))
        t.append((slope(one) - slope(other)) @ normal * np.sign(inward))
    t = np.array(t)
    cross = energy[:3, 3:]
    settled = energy[:3, :3] - cross @ np.linalg.solve(energy[3:, 3:], cross.conj().T)
    return (t.conj() @ settled @ t).real / (2 * AREA) / (k @ k) ** 2


def coefficient(angle, poisson, beta):
    """c of ratio = 1 - c k^2 + O(k^4), extrapolated."""
    direction = np.array([np.cos(angle), np.sin(angle)])
    a, b, c = ((1 - ratio(k * direction, poisson, beta)) / k**2 for k in (0.6, 0.3, 0.15))
    return (16 * (4 * c - b) / 3 - (4 * b - a) / 3) / 15


def main():
    print("nu, angle: c by the element, by the formula; c with beta; energy at 8 edges per wavelength")
    for poisson in (-0.4, 0, 0.3, 0.45):
        beta = np.sqrt((3 + poisson) ** 3 / (128 * (1 - poisson**2)))
        for degrees in (0, 15, 30):
            angle = np.radians(degrees)
            anisotropy = (1 - poisson) ** 3 * np.cos(6 * angle)
            formula = ((3 + poisson) ** 3 - anisotropy) / (192 * (1 - poisson**2))
            k = np.pi / 4 * np.array([np.cos(angle), np.sin(angle)])
            print("%5.2f %3d: %.5f %.5f; %+.5f; %.4f without, %.4f with beta = %.4f" %
                  (poisson, degrees, coefficient(angle, poisson, 0), formula, coefficient(angle, poisson, beta),
                   ratio(k, poisson, 0), ratio(k, poisson, beta), beta))


if __name__ == "__main__":
    main()
