"""Optional libraries, which this distribution's extras install."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from .errors import UserError


def optional_import(module: str, what: str, extra: str, *, package: str | None = None) -> Any:
    """Import an optional library; raise UserError, with the remedy, if it is missing.

    what: the feature that needs it ("--passes"). extra: this distribution's extra that installs it.
    package: the package of the module, if its name differs.
    """
    name = f"{what} needs {package or module}"
    try:
        return import_module(module)
    except ModuleNotFoundError:
        raise UserError(f"{name}; install it in the checkout: pip install '.[{extra}]'") from None
    except ImportError as error:  # for example a missing system library
        raise UserError(f"{name}, which is installed but does not load: {error}") from None
