"""What the images of many seeds tell: their relative variance, and whether two programs agree.

A stack of images has the axes seed, row, column and, where there are colours, channel.
"""

import numpy as np

TILE = 16  # pixels
TRIM = 0.05  # of the tiles at either end
DARKEST = 0.01  # of the image's mean: what is darker counts as this bright
ROUNDING = 1e-5  # of the brightness
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # Rec. 709


def luminance(stack):
    return np.asarray(stack, np.float64) @ LUMINANCE


def tiles(images, size=TILE):
    """Means over square tiles of the last two axes; what is left at the edges is dropped."""
    height, width = (n // size * size for n in images.shape[-2:])
    cut = images[..., :height, :width]
    return cut.reshape(*images.shape[:-2], height // size, size, width // size, size).mean((-3, -1))


def trimmed_mean(values):
    values = np.sort(values, axis=None)
    cut = int(len(values) * TRIM)
    return values[cut : len(values) - cut].mean()


def relative_variance(stack, reference):
    """The variance of a pixel over the seeds, in units of the squared brightness of its tile.

    `reference` is the mean image of all programs. The result is the mean over the tiles without the
    5 % where it is least and the 5 % where it is most.
    """
    variance = tiles(stack.var(0, ddof=1))
    bright = np.maximum(tiles(reference), DARKEST * reference.mean())
    return trimmed_mean(variance / bright**2)


def with_error(stack, reference):
    """The relative variance and its relative standard error, by leaving out one seed at a time."""
    n = len(stack)
    without = np.array([relative_variance(np.delete(stack, i, 0), reference) for i in range(n)])
    error = np.sqrt((n - 1) / n * ((without - without.mean()) ** 2).sum())
    whole = relative_variance(stack, reference)
    return whole, error / whole


def standard_scores(a, b):
    """Differences of the means over seeds, in units of their standard error.

    Where there is hardly any noise, rounding counts as noise.
    """
    variance = a.var(0, ddof=1) / len(a) + b.var(0, ddof=1) / len(b)
    variance += (ROUNDING * (np.abs(a).mean(0) + np.abs(b).mean(0))) ** 2
    return (a.mean(0) - b.mean(0)) / np.sqrt(np.maximum(variance, np.finfo(float).tiny))
