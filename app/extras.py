"""Optional libraries: those of this distribution's extras."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from .errors import UserError


def needed(module: str, what: str, extra: str, *, package: str | None = None) -> Any:
    """An optional library; raises UserError, with the remedy, if it is missing.

    what: needs it ("--passes"). extra: of this distribution, which brings it. package: what brings
    the module, if it is called otherwise.
    """
    name = f"{what} needs {package or module}"
    try:
        return import_module(module)
    except ModuleNotFoundError:
        raise UserError(f"{name}; install it in the checkout: pip install '.[{extra}]'") from None
    except ImportError as error:  # a library of the system that it stands on, say
        raise UserError(f"{name}, which is installed but does not load: {error}") from None
