"""One V-g sweep with modes in NumPy: matrices, eig with vectors, tracking by eigenvalue and MAC; gives the last frequencies."""

import numpy as np


def prepare(d):
    A, B, C, E0, E1, E2, M, R, K = (
        np.array(d[k]) for k in ("a", "b", "c", "e0", "e1", "e2", "mass", "damping", "stiffness")
    )
    width, rho = d["width"], d["density"]
    force = np.diag([width, width**2])
    motion = np.diag([1 / width, 1.0])
    n, nx = 2, A.shape[0]
    P0, P1, P2 = (force @ e @ motion for e in (E0, E1, E2))
    inverse = np.linalg.inv(M - 0.5 * rho * width**2 * P2)
    FC, BM = force @ C, B @ motion

    def matrix(v):
        a = np.zeros((2 * n + nx, 2 * n + nx))
        a[:n, n : 2 * n] = np.eye(n)
        a[n : 2 * n, :n] = inverse @ (0.5 * rho * v**2 * P0 - K)
        a[n : 2 * n, n : 2 * n] = inverse @ (0.5 * rho * v * width * P1 - R)
        a[n : 2 * n, 2 * n :] = 0.5 * rho * v**2 * inverse @ FC
        a[2 * n :, :n] = v / width * BM
        a[2 * n :, 2 * n :] = v / width * A
        return a

    def sweep():
        previous = None
        curves = []
        for v in d["speeds"]:
            values, vectors = np.linalg.eig(matrix(v))
            upper = values.imag > 0
            values, shapes = values[upper], vectors[:n, upper]
            shapes = shapes / np.linalg.norm(shapes, axis=0)
            if previous is None:
                chosen = [np.argmin(abs(values - 2j * np.pi * f)) for f in (2.0, 5.0)]
            else:
                chosen = []
                for value, shape in previous:
                    mac = abs(shape.conj() @ shapes) ** 2
                    chosen.append(np.argmin(abs(values - value) / abs(value) + 1 - mac))
            previous = [(values[i], shapes[:, i]) for i in chosen]
            curves.append([(v, abs(x.imag) / 2 / np.pi, -x.real / abs(x)) for x, _ in previous])
        return curves

    def work():
        return sorted(curve[1] for curve in sweep()[-1])

    return work
