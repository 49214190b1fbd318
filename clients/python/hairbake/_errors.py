"""What can go wrong, with the exit codes of the program hairbake."""
from __future__ import annotations


class HairbakeError(Exception):
    """`field` is the field of the request at fault, or empty."""

    exit_code = 3
    kind = "bad input"

    def __init__(self, message: str, field: str = "") -> None:
        super().__init__(message)
        self.field = field


class UsageError(HairbakeError):
    """What was asked for makes no sense: a folder in use, an address that is none."""

    exit_code, kind = 2, "usage"


class Unreachable(HairbakeError):
    """No answer within the client's patience, or a certificate that is not trusted."""

    exit_code, kind = 6, "server unreachable"


class ConnectionLost(Unreachable):
    """The same call may succeed a little later."""


class Refused(HairbakeError):
    """The server refuses, or answers what is not to be trusted. `status` is the HTTP status, or 0."""

    exit_code, kind = 7, "refused"

    def __init__(self, message: str, field: str = "", status: int = 0) -> None:
        super().__init__(message, field)
        self.status = status


class BakeFailed(HairbakeError):
    """The server tried; the message is the reason."""

    exit_code, kind = 8, "bake failed"


class BakeCancelled(HairbakeError):
    """Somebody cancelled the bake on the server."""

    exit_code, kind = 9, "bake cancelled"


def plain(text: object) -> str:
    """`text` for a terminal or a log: control characters become '?', and what is longer than 1000 is cut."""
    return "".join(c if c.isprintable() else "?" for c in str(text)[:1000])
