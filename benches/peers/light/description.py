"""What a scene is made of. Lengths are in scene units, colours in linear Rec. 709."""

from dataclasses import dataclass, field
from typing import Callable, Optional

import numpy as np

# A point, a direction or a colour.
Triple = tuple[float, float, float]


@dataclass(frozen=True)
class Material:
    """What a sphere is made of.

    `diffuse` reflects `color`, a `mirror` everything; the radiance of `emissive` is `color`.
    """

    kind: str  # diffuse, mirror, glass or emissive
    color: Triple = (1.0, 1.0, 1.0)
    index: float = 1.5  # of glass


@dataclass(frozen=True)
class Sphere:
    center: Triple
    radius: float
    material: str


@dataclass(frozen=True)
class Camera:
    eye: Triple
    target: Triple
    vertical_fov: float  # degrees
    aperture: float = 0.0  # the lens's diameter
    focus_distance: float = 1.0


@dataclass(frozen=True)
class Fog:
    """A homogeneous medium in a ball that holds the camera."""

    extinction: float
    albedo: Triple
    anisotropy: float
    center: Triple
    radius: float


@dataclass
class Scene:
    name: str
    tests: str  # what the scene is for
    camera: Camera
    max_bounces: int
    materials: dict[str, Material]
    spheres: list[Sphere] = field(default_factory=list)
    sky: Triple = (0.0, 0.0, 0.0)  # the same radiance from everywhere
    # The radiance from directions, an array of unit vectors; instead of `sky`.
    environment: Optional[Callable[[np.ndarray], np.ndarray]] = None
    fog: Optional[Fog] = None
    caustics: bool = False  # what only spherule has: light by one sphere is found exactly

    def add(self, center, radius, material):
        self.spheres.append(Sphere(tuple(map(float, center)), float(radius), material))
