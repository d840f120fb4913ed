"""The scenes, made of what both programs model alike: diffuse, white mirrors, clear glass."""

import numpy as np

from description import Camera, Fog, Material, Scene

GROUND_RADIUS = 200.0


def add_ground(scene, color=(0.5, 0.5, 0.5)):
    """A huge sphere whose top is at y = 0."""
    scene.materials["ground"] = Material("diffuse", color)
    scene.add((0, -GROUND_RADIUS, 0), GROUND_RADIUS, "ground")


def height_on_ground(x, z, radius):
    """The y of a sphere's centre that lies on the ground at (x, z)."""
    return np.sqrt((GROUND_RADIUS + radius) ** 2 - x * x - z * z) - GROUND_RADIUS


def add_diffuse(scene, random, count, least=0.2, most=0.8):
    """Adds diffuse materials d0, d1, … of random colours."""
    for i in range(count):
        scene.materials[f"d{i}"] = Material("diffuse", tuple(np.round(random.uniform(least, most, 3), 3).tolist()))


def scatter_balls(scene, random, count, radius, reach, kinds):
    """Lays balls on the ground that do not touch, in the square from -reach to reach."""
    placed = []
    while len(placed) < count:
        x, z = random.uniform(-reach, reach, 2)
        size = radius * random.uniform(0.6, 1.4)
        if all((x - a) ** 2 + (z - b) ** 2 > (size + c) ** 2 for a, b, c in placed):
            placed.append((x, z, size))
            scene.add((x, height_on_ground(x, z, size), z), size, str(random.choice(kinds)))


def one_weekend():
    scene = Scene(
        name="one-weekend",
        tests="some 400 spheres, diffuse, mirrors and glass, on a ground under an even sky",
        camera=Camera((13, 2, 3), (0, 0.4, 0), 24),
        max_bounces=30,
        materials={"mirror": Material("mirror"), "glass": Material("glass")},
        sky=(0.7, 0.8, 1.0),
    )
    random = np.random.default_rng(1)
    add_ground(scene)
    add_diffuse(scene, random, 12)
    for x, material in ((-4, "d0"), (0, "glass"), (4, "mirror")):
        scene.add((x, height_on_ground(x, 0, 1), 0), 1, material)
    kinds = [f"d{i}" for i in range(12)] + ["mirror", "mirror", "glass"]
    for column in range(-10, 11):
        for line in range(-10, 11):
            x, z = np.array((column, line)) + random.uniform(0.1, 0.9, 2)
            if all(np.hypot(x - a, z) > 1.25 for a in (-4, 0, 4)):
                scene.add((x, height_on_ground(x, z, 0.2), z), 0.2, str(random.choice(kinds)))
    return scene


def box():
    scene = Scene(
        name="box",
        tests="interreflection: a closed box of six huge spheres, lit by a ball at its ceiling",
        camera=Camera((0, 1, 3.4), (0, 0.98, 0), 38),
        max_bounces=16,
        materials={
            "white": Material("diffuse", (0.73, 0.73, 0.73)),
            "red": Material("diffuse", (0.63, 0.06, 0.05)),
            "green": Material("diffuse", (0.14, 0.45, 0.09)),
            "lamp": Material("emissive", (18, 15, 11)),
        },
    )
    r = 100.0
    scene.add((-1 - r, 1, 0), r, "red")
    scene.add((1 + r, 1, 0), r, "green")
    scene.add((0, -r, 0), r, "white")
    scene.add((0, 2 + r, 0), r, "white")
    scene.add((0, 1, -1 - r), r, "white")
    scene.add((0, 1, 4 + r), r, "white")
    scene.add((0, 1.7, 0), 0.18, "lamp")
    scene.add((-0.4, 0.4, -0.3), 0.4, "white")
    scene.add((0.4, 0.35, 0.25), 0.35, "white")
    return scene


def soft_light():
    scene = Scene(
        name="soft-light",
        tests="soft shadows: 60 diffuse balls under three small lamps",
        camera=Camera((0, 3.5, 8), (0, 0.3, 0), 34),
        max_bounces=4,
        materials={
            "warm": Material("emissive", (120, 90, 60)),
            "cold": Material("emissive", (30, 45, 70)),
            "dim": Material("emissive", (20, 20, 20)),
        },
    )
    random = np.random.default_rng(2)
    add_ground(scene)
    add_diffuse(scene, random, 8)
    scatter_balls(scene, random, 60, 0.22, 3, [f"d{i}" for i in range(8)])
    scene.add((-3, 4, 1), 0.3, "warm")
    scene.add((3.5, 3, 2), 0.3, "cold")
    scene.add((0, 5, -4), 0.5, "dim")
    return scene


def glass_lamp():
    scene = Scene(
        name="glass-lamp",
        tests="a caustic: a ball of glass between a small lamp and a diffuse floor",
        camera=Camera((0, 3.2, 5.2), (0, 0.35, 0), 36),
        max_bounces=12,
        materials={"glass": Material("glass"), "lamp": Material("emissive", (80, 76, 68))},
        caustics=True,
    )
    add_ground(scene, (0.6, 0.6, 0.6))
    scene.add((0, 1.2, 0), 0.8, "glass")
    scene.add((-1.5, 4, -0.5), 0.35, "lamp")
    scene.materials["ball"] = Material("diffuse", (0.7, 0.3, 0.2))
    scene.add((1.6, height_on_ground(1.6, 0.5, 0.4), 0.5), 0.4, "ball")
    return scene


def sky_with_lamps(directions):
    """A blue sky, a bright patch that stands for the sun behind haze, and two windows' glow."""
    y = directions[..., 1:2]
    radiance = np.array([0.25, 0.4, 0.7]) * (0.5 + 0.5 * np.maximum(y, 0)) * (y > -0.2)
    radiance = radiance + np.array([0.10, 0.08, 0.06])
    patches = (((1, 1.2, 0.8), 400, (60, 52, 40)), ((-1, 0.4, 0.6), 60, (4, 2, 1)), ((0, 0.5, -1), 60, (1, 2, 4)))
    for toward, sharpness, color in patches:
        toward = np.array(toward) / np.linalg.norm(toward)
        cosine = directions @ toward
        radiance = radiance + np.exp(sharpness * (cosine - 1))[..., None] * np.array(color)
    return radiance


def environment():
    scene = Scene(
        name="environment",
        tests="an image as surroundings, with a small bright patch, on diffuse balls, mirrors and glass",
        camera=Camera((0, 2.5, 7), (0, 0.4, 0), 36),
        max_bounces=8,
        materials={"mirror": Material("mirror"), "glass": Material("glass")},
        environment=sky_with_lamps,
    )
    random = np.random.default_rng(3)
    add_ground(scene)
    add_diffuse(scene, random, 8)
    scatter_balls(scene, random, 40, 0.35, 3, [f"d{i}" for i in range(8)] + ["mirror", "glass"])
    return scene


def many_lamps():
    scene = Scene(
        name="many-lamps",
        tests="the choice of a light: 256 glowing balls of unlike power over diffuse balls",
        camera=Camera((0, 3.5, 9), (0, 0.7, 0), 36),
        max_bounces=4,
        materials={},
    )
    random = np.random.default_rng(4)
    add_ground(scene)
    add_diffuse(scene, random, 8)
    scatter_balls(scene, random, 60, 0.22, 3.5, [f"d{i}" for i in range(8)])
    for i in range(16):
        color = random.uniform(0.3, 1, 3) * 10 ** random.uniform(0, 1.5)
        scene.materials[f"lamp{i}"] = Material("emissive", tuple(np.round(color, 3).tolist()))
    for i in range(256):
        x, z = random.uniform(-4, 4, 2)
        y = random.uniform(0.8, 2.2)
        scene.add((x, y, z), random.uniform(0.02, 0.06), f"lamp{i % 16}")
    return scene


def fog():
    scene = Scene(
        name="fog",
        tests="a homogeneous medium that scatters forwards, with shadows of balls through it",
        camera=Camera((0, 1.7, 9), (0, 1.5, 0), 36),
        max_bounces=16,
        materials={
            "ball": Material("diffuse", (0.7, 0.65, 0.6)),
            "lamp": Material("emissive", (200, 170, 130)),
        },
        fog=Fog(0.12, (0.9, 0.93, 0.97), 0.35, (0, 2, 0), 14),
    )
    add_ground(scene, (0.4, 0.4, 0.42))
    scene.add((0, 3.2, -1.5), 0.2, "lamp")
    balls = ((-1.5, 0.7, 0.8, 0.7), (1.3, 1.2, -0.4, 0.6), (0.2, 0.4, 1.8, 0.4), (2.9, 0.8, 1.4, 0.8))
    for *center, radius in balls:
        scene.add(center, radius, "ball")
    return scene


def defocus():
    scene = Scene(
        name="defocus",
        tests="a thin lens: rows of diffuse balls and mirrors before and behind the plane in focus",
        camera=Camera((0, 1.6, 7), (0, 0.5, 0), 34, aperture=0.5, focus_distance=7),
        max_bounces=8,
        materials={"mirror": Material("mirror"), "sun": Material("emissive", (100, 94, 84))},
        sky=(0.5, 0.65, 0.9),
    )
    random = np.random.default_rng(5)
    add_ground(scene)
    add_diffuse(scene, random, 8)
    scatter_balls(scene, random, 60, 0.3, 4, [f"d{i}" for i in range(8)] + ["mirror"])
    scene.add((-30, 40, 20), 6, "sun")
    return scene


SCENES = {
    scene.name: scene
    for scene in (one_weekend(), box(), soft_light(), glass_lamp(), environment(), many_lamps(), fog(), defocus())
}
