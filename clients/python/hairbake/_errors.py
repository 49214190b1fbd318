"""The errors of the client, with the exit codes of the program hairbake."""
from __future__ import annotations

from typing import Any, Dict, Optional


class HairbakeError(Exception):
    """`field` is the field of the request at fault, or empty."""

    exit_code = 3
    kind = "bad input"

    def __init__(self, message: str, field: str = "") -> None:
        super().__init__(message)
        self.field = field


class UsageError(HairbakeError):
    """The call is wrong, for example a folder in use or an invalid address."""

    exit_code, kind = 2, "usage"


class OutOfResources(HairbakeError):
    """The disk is full."""

    exit_code, kind = 4, "out of resources"


class Unreachable(HairbakeError):
    """No answer within the client's patience, or a certificate that is not trusted."""

    exit_code, kind = 6, "server unreachable"


class ConnectionLost(Unreachable):
    """The connection failed or was lost. A retry of the call may succeed."""


class Refused(HairbakeError):
    """The server refuses, or its answer cannot be trusted. `status` is the HTTP status, or 0. `needed_by` holds what
    refers to an input that is not deleted: {"bakes": {"count": n, "first": [...]}, "names": {...}}."""

    exit_code, kind = 7, "refused"

    def __init__(self, message: str, field: str = "", status: int = 0,
                 needed_by: Optional[Dict[str, Any]] = None) -> None:
        super().__init__(message, field)
        self.status = status
        self.needed_by = needed_by or {}


class BakeFailed(HairbakeError):
    """The bake failed on the server; the message is the reason."""

    exit_code, kind = 8, "bake failed"


class BakeCancelled(HairbakeError):
    """Somebody cancelled the bake on the server."""

    exit_code, kind = 9, "bake cancelled"


def words_of(error: OSError, name: object) -> str:
    """The system's reason, with the name of the file as it was given."""
    return f"{name}: {error.strerror or error}"


def plain(text: object) -> str:
    """`text` for a terminal or a log: control characters become '?', and the text is cut after 1000 characters."""
    return "".join(c if c.isprintable() else "?" for c in str(text)[:1000])
