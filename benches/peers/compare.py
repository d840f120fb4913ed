"""Compares a peer's answers with spherule's, and explains the differences."""

import numpy as np

from scene import KINDS, NEAREST, NONE

TANGENT = 1e-4  # of the radius: a ray whose closest approach is this near to the radius is nearly tangent
ROUNDING = 1e-5  # of the distance: values of t this close count as equal
SAME_POINT = 1e-2  # of the radius: two hits of a sphere that are farther apart are two roots
LOOKED_AT = 200  # rays that are tested with all spheres; further ones count as "other"


def approach(rays, spheres):
    """For rays and spheres that broadcast: closest approach over radius, and both roots."""
    rays, spheres = np.asarray(rays, float), np.asarray(spheres, float)
    to_center, direction, radius = spheres[..., :3] - rays[..., :3], rays[..., 4:7], spheres[..., 3]
    dd = (direction * direction).sum(-1)
    middle = (to_center * direction).sum(-1) / dd
    foot = to_center - middle[..., None] * direction
    square = (foot * foot).sum(-1)
    half = np.sqrt(np.maximum(radius * radius - square, 0) / dd)
    return np.sqrt(square) / radius, middle - half, middle + half


def unit(rays):
    """The error of t that counts as rounding, for each ray: a share of the coordinates' size."""
    size = np.abs(rays[..., :3]).max(-1) + 1
    return ROUNDING * size / np.linalg.norm(rays[..., 4:7], axis=-1)


def explain_any(ray, spheres):
    """Why two answers to "is there a hit" may differ, in 64-bit floats over all spheres."""
    off, near, far = approach(ray, spheres)
    eps = unit(ray)
    inside = lambda t, slack: (t >= ray[3] - slack) & (t < ray[7] + slack)
    surely = off < 1 - TANGENT
    if (surely & (inside(near, -eps) | inside(far, -eps))).any():
        return "other"  # certainly a hit: one of the two is wrong
    if ((np.abs(off - 1) <= TANGENT) & (inside(near, eps) | inside(far, eps))).any():
        return "tangent"
    if (surely & (inside(near, eps) | inside(far, eps))).any():
        return "rounding"
    return "other"


def explain_nearest(rays, spheres, ours, theirs):
    """Why nearest hits may differ, from the two spheres alone, for many rays at once."""
    tangent = np.zeros(len(rays), bool)
    exact = []
    for hits in (ours, theirs):
        known = hits["id"] != NONE
        off, near, far = approach(rays, spheres[np.where(known, hits["id"], 0)])
        tangent |= known & (np.abs(off - 1) <= TANGENT)
        t = np.where(near >= rays[:, 3], near, far)
        exact.append(np.where(known, t, rays[:, 7]))
    with np.errstate(invalid="ignore"):
        rounding = np.abs(exact[0] - exact[1]) <= unit(rays.astype(float)) * (1 + np.abs(exact[0]))
    return np.where(tangent, "tangent", np.where(rounding, "rounding", "other"))


def count(reasons, differing):
    reasons = list(reasons)
    found = {reason: reasons.count(reason) for reason in ("tangent", "rounding")}
    return dict(differ=int(differing), **found, other=int(differing) - sum(found.values()))


def compare_nearest(scene, rays, ours, theirs):
    differ = ours["id"] != theirs["id"]
    both = (ours["id"] != NONE) & (theirs["id"] != NONE)
    radius = scene.spheres[np.where(both, ours["id"], 0), 3]
    length = np.linalg.norm(rays[:, 4:7], axis=1)
    with np.errstate(invalid="ignore"):
        differ |= both & (np.abs(ours["t"] - theirs["t"]) * length > SAME_POINT * radius)
    at = np.flatnonzero(differ)
    reasons = explain_nearest(rays[at], scene.spheres, ours[at], theirs[at])
    return count(reasons, len(at))


def compare_any(scene, rays, ours, theirs):
    at = np.flatnonzero((ours != 0) != (theirs != 0))
    spheres = scene.spheres.astype(float)
    reasons = [explain_any(rays[i].astype(float), spheres) for i in at[:LOOKED_AT]]
    return count(reasons, len(at))


def compare(scene, folder, kinds=KINDS):
    """Counts of differing answers for each kind of rays; `primary` may hold hits without ids."""
    result = {}
    for kind in kinds:
        rays, ours = scene.rays(kind), scene.answers(kind)
        mask = folder / f"{kind}.mask"
        if mask.exists():
            theirs = np.fromfile(mask, "<u4")
            ours = (ours["id"] != NONE).astype("<u4")
        else:
            theirs = scene.answers(kind, folder)
        if len(theirs) != len(ours):
            raise ValueError(f"{kind}: {len(theirs)} answers to {len(ours)} rays")
        nearest = kind in NEAREST and not mask.exists()
        result[kind] = (compare_nearest if nearest else compare_any)(scene, rays, ours, theirs)
    return result
