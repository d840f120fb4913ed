"""Reads and writes images with Mitsuba's own reader and writer."""

import mitsuba as mi
import numpy as np

if mi.variant() is None:
    mi.set_variant("scalar_rgb")

SKY_WIDTH, SKY_HEIGHT = 1024, 512


def read(path):
    """The red, green and blue of an EXR image, as an array of rows."""
    return np.array(mi.Bitmap(str(path)), dtype=np.float32)[..., :3]


def write(image, path):
    """Writes an array of rows of colours as an EXR image."""
    mi.Bitmap(np.ascontiguousarray(image, dtype=np.float32)).write(str(path))


def sky_directions(program):
    """The unit vectors in which the program sees the middles of an image's texels.

    The image is equirectangular, with -z in its middle. spherule's rows are bands of equal height,
    while Mitsuba's first and last row lie at the poles.
    """
    across = (np.arange(SKY_WIDTH) + 0.5) / SKY_WIDTH * 2 * np.pi - np.pi
    rows = np.arange(SKY_HEIGHT)
    down = (rows + 0.5) / SKY_HEIGHT if program == "spherule" else rows / (SKY_HEIGHT - 1)
    down, across = np.meshgrid(down * np.pi, across, indexing="ij")
    return np.stack([np.sin(down) * np.sin(across), np.cos(down), -np.sin(down) * np.cos(across)], -1)


def write_sky(radiance, path, program):
    """Writes the radiance, a function of unit vectors, as the program reads it."""
    write(radiance(sky_directions(program)), path)
