"""The combined finite-discrete element method: bodies of any shape that fall, collide, deform and come to rest.

Units are SI: m, kg, s, N, J, Pa. Poses are rows ``x, y, z, qw, qx, qy, qz`` that take the coordinates of a shape to the
world. Results are the same bits as those of the program ``femdem``, for any number of threads.

- :class:`Shape` and :class:`World`: bodies that you step yourself.
- :class:`ContactBatch`: contacts for a host that moves the bodies.
- :func:`pack` and :func:`run`: what the program does with ``femdem pack`` and ``femdem run``.
- :func:`resume`, :func:`analyse`, :func:`report`, :func:`resolve`, :func:`stresses`, :func:`pores`, :func:`command`: its
  other commands.
- :class:`Result`: a folder of results, with its bodies and contacts as arrays.
"""

from ._batch import ContactBatch
from ._commands import analyse, command, pack, pores, report, resolve, resume, run, stresses
from ._femdem import FemdemError, __version__, set_threads
from ._result import Result
from ._shape import Shape
from ._world import World

__all__ = [
    "ContactBatch",
    "FemdemError",
    "Result",
    "Shape",
    "World",
    "__version__",
    "analyse",
    "command",
    "pack",
    "pores",
    "report",
    "resolve",
    "resume",
    "run",
    "set_threads",
    "stresses",
]
