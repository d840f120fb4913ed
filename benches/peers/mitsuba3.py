"""Mitsuba 3 in its LLVM variant, which traces through the Embree that it embeds.

Every sphere is a separate shape, so loading is slow, and larger scenes are not run. Rays have no t_min
in Mitsuba: their origins are moved to it.
"""

import sys
import time

import numpy as np

from scene import KINDS, NEAREST, NONE, HIT, arguments, report

MOST = 100_000


def load(mi, scene):
    shapes = {
        f"s{i}": dict(type="sphere", center=[x, y, z], radius=r)
        for i, (x, y, z, r) in enumerate(scene.spheres.tolist())
    }
    return mi.load_dict(dict(type="scene", **shapes))


def sphere_ids(mi, dr, world):
    """The sphere's id for each of Mitsuba's shape numbers; 0 is no shape."""
    numbers = dr.reinterpret_array(mi.UInt32, world.shapes_dr()).numpy()
    ids = np.full(numbers.max() + 1, NONE, "<u4")
    ids[numbers] = [int(shape.id()[1:]) for shape in world.shapes()]
    return ids


def main():
    args = arguments(__doc__.splitlines()[0])
    scene = args.dir
    if len(scene.spheres) > MOST:
        sys.exit(f"every sphere is an object of its own: more than {MOST} take too long to load")
    try:
        import drjit as dr
        import mitsuba as mi

        mi.set_variant("llvm_ad_rgb")
    except ImportError as error:
        sys.exit(f"mitsuba: {error}")
    dr.set_thread_count(args.threads)

    start = time.perf_counter()
    world = load(mi, scene)
    build_s = time.perf_counter() - start
    ids = sphere_ids(mi, dr, world)

    kinds = {}
    for kind in KINDS:
        rays = scene.rays(kind)
        origin = rays[:, :3] + rays[:, 3:4] * rays[:, 4:7]
        reach = np.minimum(rays[:, 7] - rays[:, 3], np.finfo("f4").max)
        ray = mi.Ray3f(mi.Point3f(origin.T.copy()), mi.Vector3f(rays[:, 4:7].T.copy()), mi.Float(reach), 0, [])
        dr.eval(ray)
        coherent = kind == "primary"
        best = float("inf")
        for turn in range(args.repeat + 1):  # the first turn compiles
            dr.sync_thread()
            start = time.perf_counter()
            if kind in NEAREST:
                found = world.ray_intersect_preliminary(ray, coherent=coherent)
                dr.eval(found.t, found.shape)
            else:
                found = world.ray_test(ray, coherent=coherent)
                dr.eval(found)
            dr.sync_thread()
            if turn:
                best = min(best, time.perf_counter() - start)
        if kind in NEAREST:
            answers = np.empty(len(rays), HIT)
            shape = dr.reinterpret_array(mi.UInt32, found.shape).numpy()
            hit = np.isfinite(found.t.numpy()) & (shape != 0)
            answers["id"] = np.where(hit, ids[np.where(hit, shape, 0)], NONE)
            answers["t"] = found.t.numpy() + rays[:, 3]
        else:
            answers = found.numpy().astype("<u4")
            hit = answers
        if args.hits:
            answers.tofile(args.hits / f"{kind}.hits")
        kinds[kind] = dict(seconds=best, hits=int(hit.sum()))
    report("mitsuba", mi.__version__, scene, args.threads, build_s, kinds)


main()
