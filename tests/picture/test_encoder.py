# SPDX-License-Identifier: GPL-2.0-only
"""Pictures as the encoder takes them."""

from __future__ import annotations

import numpy as np
from mdanim_lammps.picture.encoder import Yuv


def bt709(picture):
    """Brightness and colours by the definition, as far as they are not rounded; first row below."""
    rgb = picture[..., :3] / 255.0
    bright = rgb @ [0.2126, 0.7152, 0.0722]
    colours = [(rgb[..., k] - bright) / (2.0 * (1.0 - share)) for k, share in ((2, 0.0722), (0, 0.2126))]
    mean = [c.reshape(c.shape[0] // 2, 2, -1, 2).mean(axis=(1, 3)) for c in colours]
    return 16.0 + 219.0 * bright, *(128.0 + 224.0 * c for c in mean)


def test_pictures_are_those_of_the_standard_whatever_came_before():
    """Numbers of BT.709, to the rounding, with the first row on top, of pictures that differ from the last one in parts."""
    rng = np.random.default_rng(1)
    picture, yuv = rng.integers(0, 256, (70, 46, 4), dtype=np.uint8), Yuv()
    for changed in (np.s_[:, :], np.s_[:0], np.s_[33:34, 7:8], np.s_[60:, 3:30], np.s_[5:50, 45:]):
        picture[changed] = rng.integers(0, 256, picture[changed].shape, dtype=np.uint8)
        planes = np.split(yuv.of(picture), [70 * 46, 70 * 46 + 35 * 23])
        for plane, wanted in zip(planes, bt709(picture), strict=True):
            np.testing.assert_allclose(plane.reshape(wanted.shape)[::-1], wanted, atol=0.51)
    again = Yuv().of(picture[:64, :40].copy())
    np.testing.assert_array_equal(again, yuv.of(picture[:64, :40]))
