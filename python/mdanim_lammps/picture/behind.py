# SPDX-License-Identifier: GPL-2.0-only
"""The part of a picture drawn before the surface of the liquid, for the shader of the surface to look up."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .pieces import Lookup, gl_matrix, texture


class Behind:
    """Colour and depth of all pixels of a window.

    Args:
        size: width and height of the window in pixels.
    """

    def __init__(self, size: tuple[int, int]):
        from vtkmodules.vtkCommonCore import vtkFloatArray, vtkUnsignedCharArray

        self._size = width, height = size
        self._color, self._values = vtkUnsignedCharArray(), vtkFloatArray()
        self._color.SetNumberOfComponents(3)
        self._color.SetNumberOfTuples(width * height)
        self._depth = Lookup(-(-width // 4) * 4, height, packed=True)
        self._image, self._texture = texture(self._color, width, height, smooth=True)

    def look_up(self, actors: Sequence) -> None:
        """Hand shaders the textures; once."""
        for actor in actors:
            actor.GetProperty().SetTexture("behindColor", self._texture)
            actor.GetProperty().SetTexture("behindDepth", self._depth.texture)

    def take(self, window, camera, actors: Sequence) -> None:
        """Read what is drawn in a window with a camera, and tell the shaders of actors where pixels lie in space."""
        from vtkmodules.util.numpy_support import vtk_to_numpy

        width, height = self._size
        window.GetPixelData(0, 0, width - 1, height - 1, 0, self._color, 0)
        window.GetZbufferData(0, 0, width - 1, height - 1, self._values)
        self._color.Modified()
        self._image.Modified()
        self._depth.numbers[:, :width] = vtk_to_numpy(self._values).reshape(height, width)
        self._depth.changed()
        found = camera.GetCompositeProjectionTransformMatrix(width / height, -1.0, 1.0)
        matrix = np.array([[found.GetElement(i, j) for j in range(4)] for i in range(4)])
        for actor in actors:
            uniforms = actor.GetShaderProperty().GetFragmentCustomUniforms()
            uniforms.SetUniformMatrix("pictureMatrix", gl_matrix(matrix))
            uniforms.SetUniformMatrix("pictureInverse", gl_matrix(np.linalg.inv(matrix)))
            uniforms.SetUniform2f("pictureSize", [float(width), float(height)])
