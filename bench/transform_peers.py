#!/usr/bin/env python3
"""The shapes of transform_bench by scipy and scikit-fmm (python3-scipy, python3-scikit-fmm).

usage: bench/transform_peers.py [DIM] [MARCH_DIM]

Speed is samples by the processor's seconds, best of two; errors in voxels against the exact distance.
"""
import sys
import time

import numpy
import scipy.ndimage

try:
    import skfmm
except ImportError:
    skfmm = None


def distance_to_ball(n, radius):
    axis = numpy.arange(n) - 0.5 * (n - 1)
    x, y, z = numpy.meshgrid(axis + 0.13, axis + 0.29, axis - 0.31, indexing="ij", sparse=True)
    return numpy.sqrt(x * x + y * y + z * z) - radius


def measure(name, work, samples, repetitions=2):
    best = 1e300
    for _ in range(repetitions):
        start = time.process_time()
        result = work()
        best = min(best, time.process_time() - start)
    print(f"{name:<46} {1e-6 * samples / best:9.2f} Mvoxel/s", flush=True)
    return result


def main():
    n = int(sys.argv[1]) if len(sys.argv) > 1 else 512
    m = int(sys.argv[2]) if len(sys.argv) > 2 else 256
    outside = distance_to_ball(n, 0.4 * n) >= 0
    measure(f"scipy distance_transform_edt {n}^3 ball",
            lambda: scipy.ndimage.distance_transform_edt(outside), outside.size, 1)
    measure(f"scipy distance_transform_cdt {n}^3 ball",
            lambda: scipy.ndimage.distance_transform_cdt(outside), outside.size, 1)
    del outside
    if skfmm is None:
        print("scikit-fmm is not installed")
        return
    exact = distance_to_ball(m, 0.3 * m)
    for order in (1, 2):
        got = measure(f"skfmm.distance order {order} {m}^3 ball",
                      lambda order=order: skfmm.distance(exact, order=order), exact.size, 1)
        error = numpy.abs(got - exact)
        print(f"    L1 {error.mean():.4f} max {error.max():.3f}")


if __name__ == "__main__":
    main()
