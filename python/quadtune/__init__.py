# SPDX-License-Identifier: Apache-2.0
"""Control gains for small multirotors: the commands of quadtune as functions.

    import quadtune
    hover = quadtune.fly("mambo")
    print(hover.passed, hover.metrics["tracking_rms"])

Results have named fields with NumPy arrays. to_dict() and to_json() give what `quadtune VERB --json`
prints, print() shows what the command prints, save() writes the JSON.
"""

from . import _quadtune
from ._quadtune import *  # noqa: F403
from ._arguments import explained as _explained
from ._quadtune import __version__

__all__ = sorted(name for name in vars(_quadtune) if not name.startswith("_"))

# Messages and help say quadtune.Flight and not quadtune._quadtune.Flight.
for _name in __all__:
    _value = vars(_quadtune)[_name]
    if isinstance(_value, type):
        _value.__module__ = __name__
    elif callable(_value):
        globals()[_name] = _explained(_value)
del _name, _value
