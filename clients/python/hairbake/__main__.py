"""python3 -m hairbake: those commands of the program hairbake that talk to a service, for machines with only Python."""
from __future__ import annotations

import argparse
import difflib
import errno
import json
import os
import re
import shlex
import signal
import sys
from pathlib import Path
from typing import Any, Callable, Dict, List, Optional

from ._client import Bake, Client, check_files
from ._errors import BakeCancelled, BakeFailed, HairbakeError, OutOfResources, Refused, UsageError, plain, words_of
from ._fetch import check_outside, check_result_folder, prove_writable
from ._http import identifier

EPILOG = """exit codes: 0 done, 2 usage, 3 bad input, 4 the disk is full, 5 interrupted (the bake continues on the server), 6 server
unreachable, 7 refused, 8 bake failed, 9 bake cancelled on the server"""
Arguments = argparse.Namespace
#: Fields of the block irradiance in the first version, and their places now.
MOVED = {"model": "fiber.model", "exponent": "fiber.kajiya_kay.exponent",
         **{name: f"environment_settings.{name}" for name in
            ("layout", "latlong", "rotation_deg", "exposure_stops", "tint", "invalid_radiance")}}
NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")  #: also those that JSON does not know: .5, 1., +5
MOST_ASKED = 100  #: bakes whose manifest is asked for, where the result is not fetched
LIGHTING_BLOCKS = ("irradiance", "environment_settings", "fiber")  #: of the request: `rebake` may change them


def output_failure(error: OSError) -> HairbakeError:
    """The error for a standard output that cannot be written. Nothing more is written to it: Python would try again at its
    end, and end with a code of its own."""
    try:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    except OSError:
        pass
    kind = OutOfResources if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG) else HairbakeError
    return kind(f"standard output cannot be written: {error.strerror or error}")


def print_line(text: str) -> None:
    try:
        print(text, flush=True)
    except OSError as error:
        raise output_failure(error) from error


def columns() -> int:
    """Characters in a line: COLUMNS where that is a number from 1 to 10000, else the terminal's own number, else 80."""
    text = os.environ.get("COLUMNS", "")
    if text.isascii() and text.isdigit() and 1 <= int(text) <= 10000:
        return int(text)
    try:
        return os.get_terminal_size(sys.stderr.fileno()).columns or 80
    except OSError:
        return 80


class Display:
    """A bar on a terminal that knows escape codes, JSON lines, or nothing."""

    def __init__(self, mode: str) -> None:
        knows_codes = sys.stderr.isatty() and os.environ.get("TERM", "") not in ("", "dumb")
        self.json, self.bar = mode == "json", mode == "auto" and knows_codes

    def __call__(self, stage: str, fraction: float) -> None:
        if self.json:
            self.event("progress", phase=stage, phase_fraction=round(fraction, 4))
        elif self.bar:
            words = f"{100 * fraction:3.0f} %  {stage}"
            room = columns() - 1  # a full line would make some terminals begin another one
            width = min(32, room - len(words) - 3)
            filled = round(width * min(1.0, fraction))
            bar = f"[{'#' * filled + '.' * (width - filled)}] " if width >= 8 else ""
            print(f"\r{(bar + words)[:max(0, room)]}\033[K", end="", file=sys.stderr, flush=True)

    def warn(self, texts: List[str], bake: str = "") -> None:
        """Prints warnings of a bake on standard error; `bake` is its id where there are several."""
        if self.bar and texts:
            print("\r\033[K", end="", file=sys.stderr, flush=True)
        for text in texts:
            print(f"hairbake: warning: {f'bake {bake}: ' if bake else ''}{text}", file=sys.stderr)

    def event(self, event: str, **facts: Any) -> None:
        print_line(json.dumps({"event": event, **facts}))

    def line(self, text: str, event: str, **facts: Any) -> None:
        """Prints `text`, or the event in the mode json."""
        if self.bar:
            print("\r\033[K", end="", file=sys.stderr, flush=True)
        if self.json:
            self.event(event, **facts)
        else:
            print_line(text)


def move_deprecated(request: Dict[str, Any], source: str) -> None:
    """Moves fields from the places of the first version to their own. Prints a warning for each."""
    old = request.get("irradiance") or {}
    for name in [name for name in MOVED if isinstance(old, dict) and name in old]:
        *blocks, last = MOVED[name].split(".")
        block = request
        for part in blocks:
            block = block.setdefault(part, {})
        if last in block:
            raise UsageError(f"{source}: {MOVED[name]} is given twice, also as irradiance.{name}; allowed is once", MOVED[name])
        block[last] = old.pop(name)
        print(f"hairbake: warning: {source}: irradiance.{name} is deprecated: the field is now {MOVED[name]}",
              file=sys.stderr)


def set_field(request: Dict[str, Any], setting: str) -> None:
    path, sign, value = setting.partition("=")
    if not sign:
        raise UsageError(f"--set {setting} is not of the form path=value", "set")
    try:
        parsed = json.loads(value)
    except (ValueError, RecursionError):
        parsed = float(value) if NUMBER.fullmatch(value) else value
    if isinstance(parsed, float) and parsed.is_integer():
        parsed = int(parsed)  # the service takes no 7.0 for a whole number
    first, _, name = path.partition(".")
    if first == "irradiance" and name in MOVED:
        print(f"hairbake: warning: {path} is deprecated: the field is now {MOVED[name]}", file=sys.stderr)
        path = MOVED[name]
    *blocks, last = path.split(".")
    for block in blocks:
        request = request.setdefault(block, {})
        if not isinstance(request, dict):
            raise UsageError(f"--set {setting}: {block} is no block of the request", "set")
    request[last] = parsed


def make_request(arguments: Arguments) -> Dict[str, Any]:
    """Takes the request file, then the flags, then --set. Later ones win."""
    request: Dict[str, Any] = {}
    if arguments.request:
        try:
            request = json.loads(Path(arguments.request).read_text(encoding="utf-8"))
        except OSError as error:
            raise HairbakeError(words_of(error, arguments.request), "request") from error
        except (ValueError, RecursionError) as error:
            raise HairbakeError(f"{arguments.request} is not JSON: {error}", "request") from error
        if not isinstance(request, dict):
            raise UsageError(f"{arguments.request} is not a JSON object", "request")
        move_deprecated(request, arguments.request)
    for field in ("environment", "occluder", "receiver"):
        if getattr(arguments, field):
            request[field] = getattr(arguments, field)
    if arguments.outputs:
        request["outputs"] = arguments.outputs.split(",")
    for setting in arguments.set:
        set_field(request, setting)
    return {name: value for name, value in request.items() if value is not None}


def short_name(hair: str) -> str:
    return hair[7:19] if hair.startswith("sha256:") else Path(hair[5:] if hair.startswith("name:") else hair).stem


def tell_ended(client: Client, display: Display, bakes: List[Bake], folder_of: Callable[[str], Optional[Path]],
               inputs: Optional[Dict[str, str]] = None) -> None:
    """Fetches the bakes that are done, into folders without the `inputs`. Prints one line for each bake. Raises if some
    are not done."""
    lost = [bake for bake in bakes if bake.state != "done"]
    asked = 0  # manifests, for their warnings alone
    for bake in bakes:
        reason = client.with_paths(bake.message)
        folder = folder_of(bake.id)
        name = bake.id if len(bakes) > 1 else ""
        if bake.state != "done":
            display.line(f"{bake.id} {bake.state} {reason}".rstrip(), bake.state, id=bake.id, message=reason)
        elif folder:
            check_outside(folder, inputs or {})
            result = client.fetch(bake, folder)
            warnings = [client.with_paths(text) for text in result.warnings()]
            display.warn(warnings, name)
            display.line(f"{bake.id} done; {folder}: {result.received} bytes received", "done", id=bake.id,
                         folder=str(folder), received_bytes=result.received, warnings=warnings)
        else:
            asked += 1
            warnings = client.warnings(bake) if asked <= MOST_ASKED else []
            display.warn(warnings, name)
            display.line(f"{bake.id} done", "done", id=bake.id, warnings=warnings)
    if asked > MOST_ASKED:
        print(f"hairbake: the warnings of the first {MOST_ASKED} bakes are shown; \"wait ID\" shows others", file=sys.stderr)
    if lost:
        failed = [bake for bake in lost if bake.state == "failed"]
        words = f"{len(lost)} of {len(bakes)} bakes "
        if failed:
            raise BakeFailed(words + "failed: " + client.with_paths(failed[0].message), failed[0].field)
        raise BakeCancelled(words + "were cancelled")


def wait_for(arguments: Arguments, which: List[str], wait: Callable[[], List[Bake]]) -> List[Bake]:
    """Waits. On an interrupt it prints the commands that resume the wait or cancel the bakes."""
    try:
        return wait()
    except KeyboardInterrupt:
        given = [("--server", arguments.server), ("--token-file", arguments.token_file),
                 ("--ca-file", arguments.ca_file)]
        rest = shlex.join([*which, *(word for flag, value in given if value for word in (flag, value))])
        print(f'\nhairbake: the bake continues on the server; "python3 -m hairbake wait {rest}" resumes the wait. '
              f'"python3 -m hairbake cancel {rest}" cancels it.', file=sys.stderr)
        raise


def submit(client: Client, arguments: Arguments, display: Display) -> None:
    request = make_request(arguments)
    hairs: List[Optional[str]] = arguments.hair or [request.pop("hair", None)]
    request.pop("hair", None)
    names = [short_name(hair) for hair in hairs if hair]
    if arguments.fetch and len(hairs) > 1 and len(set(names)) < len(names):
        raise UsageError("two results would be fetched into the same folder", "fetch")
    targets = [Path(arguments.fetch, name) if len(hairs) > 1 else Path(arguments.fetch)
               for name in names or [""]] if arguments.fetch else []
    files = {field: request[field] for field in ("environment", "occluder", "receiver") if request.get(field)}
    for target in targets:
        check_result_folder(target)
        for file in filter(None, hairs):
            check_outside(target, {"hair": file, **files, **({"--request": arguments.request} if arguments.request else {})})
        prove_writable(target)
    bakes = [client.submit(hair, priority=arguments.priority, **request) for hair in hairs]
    for hair, bake in zip(hairs, bakes):
        if bake.state == "done" and not (arguments.wait or targets):
            display.warn(client.warnings(bake), bake.id if len(bakes) > 1 else "")
        if not (arguments.wait or targets) or display.json:
            display.line(f"{bake.id} {bake.state} {hair or ''}".rstrip(), "submitted", id=bake.id, state=bake.state)
    if arguments.wait or targets:
        folders = dict(zip([bake.id for bake in bakes], targets))
        ended = wait_for(arguments, list(dict.fromkeys(bake.id for bake in bakes)), lambda: client.wait_ended(bakes))
        tell_ended(client, display, ended, folders.get)


def input_text(view: Dict[str, Any], field: str) -> str:
    """The name that a request used for an input, with its version; else the beginning of its digest; else nothing."""
    name = (view.get("names") or {}).get(field)
    if isinstance(name, dict):
        return plain(f"{name.get('path', '')}@{name['version']}" if "version" in name else name.get("path", ""))
    return plain(view.get("model" if field == "hair" else field) or "")[:12]


def status_text(bake: Bake) -> str:
    """As `hairbake status` prints it: state, time left, title, inputs by name, times, the reason of a failure."""
    view = bake.view
    text = f"{bake.id} {bake.state}" + (f" {100 * bake.fraction:.0f} %" if bake.state == "running" else "")
    if isinstance(view.get("seconds_left"), (int, float)):
        text += f", {view['seconds_left']:.0f} s left"
    text += f'; "{plain(view["title"])}"' if view.get("title") else ""
    inputs = [(field, input_text(view, field)) for field in ("hair", "environment", "occluder", "receiver")]
    times = [(time, plain(view.get(time) or "")) for time in ("created", "finished")]
    text += "".join(f"; {name} {value}" for name, value in inputs + times if value)
    return f"{text}: {bake.message}" if bake.message else text


def status(client: Client, arguments: Arguments, display: Display) -> None:
    if arguments.batch:
        batch = client.batch(arguments.batch)
        counts = ", ".join(f"{count} {state}" for state, count in batch.states.items() if count)
        created = f"; created {batch.created}" if batch.created else ""
        display.line(f"{batch.id}: {counts}{created}", "status", batch=batch.id, bakes=batch.bakes, states=batch.states)
    bakes = [client.status(id) for id in arguments.id]
    if not bakes and not arguments.batch:
        bakes = client.list(newest=20, **({"state": arguments.state} if arguments.state else {}))
    for bake in bakes:
        display.line(status_text(bake), "status", bake=bake.view)


def wait(client: Client, arguments: Arguments, display: Display) -> None:
    if bool(arguments.id) == bool(arguments.batch):
        raise UsageError("wait needs ids of bakes, or --batch")
    which = arguments.id or ["--batch", arguments.batch]
    ended = wait_for(arguments, which, lambda: client.wait_ended(arguments.id) if arguments.id
                     else client.wait_batch(arguments.batch))
    tell_ended(client, display, ended, lambda bake: None)


def fetch(client: Client, arguments: Arguments, display: Display) -> None:
    result = client.fetch(arguments.id, arguments.out)
    display.warn(result.warnings())
    display.line(f"{arguments.out}: {result.received} bytes received", "done", id=arguments.id, folder=arguments.out,
                 received_bytes=result.received, warnings=result.warnings())


def cancel(client: Client, arguments: Arguments, display: Display) -> None:
    if bool(arguments.id) == bool(arguments.batch):
        raise UsageError("cancel needs ids of bakes, or --batch")
    ids = arguments.id or [bake.id for state in ("queued", "running")
                           for bake in client.list(batch=identifier(arguments.batch), state=state)]
    for bake in ids:
        client.cancel(bake)
        display.line(f"{bake} cancelled", "cancelled", id=bake)


def rebake(client: Client, arguments: Arguments, display: Display) -> None:
    which: Dict[str, Any] = {"bakes": arguments.bake, "replaces": arguments.replaces, "name": arguments.name,
                             "models": arguments.model}
    which = {name: value for name, value in which.items() if value}
    if len(which) != 1:
        raise UsageError("exactly one of --bake, --replaces, --name and --model is needed", "bakes")
    for block in LIGHTING_BLOCKS:
        text = getattr(arguments, block)
        try:
            which.update({block: dict(json.loads(text))} if text else {})
        except (ValueError, TypeError, RecursionError) as error:
            raise UsageError(f"{block} is {text}; allowed is a JSON object", block) from error
    if arguments.fetch:
        prove_writable(Path(arguments.fetch, "any-bake"))
    if arguments.dry_run:
        forecast = client.rebake_forecast(arguments.environment, **which)
        return display.line(json.dumps(forecast), "forecast", **forecast)
    batch = client.rebake(arguments.environment, priority=arguments.priority, **which)
    waiting = arguments.wait or arguments.fetch
    if not waiting or display.json:
        display.line(f"{batch.id} {batch.bakes} bakes", "submitted", id=batch.id, bakes=batch.bakes)
    if waiting:
        ended = wait_for(arguments, ["--batch", batch.id], lambda: client.wait_batch(batch))
        tell_ended(client, display, ended, lambda bake: Path(arguments.fetch, bake) if arguments.fetch else None,
                   {"environment": arguments.environment, **{f"model {model}": model for model in arguments.model or ()}})


def upload(client: Client, arguments: Arguments, display: Display) -> None:
    if arguments.name and (len(arguments.file) != 1 or not arguments.kind):
        raise UsageError("--name needs exactly one file and --as", "name")
    check_files({f"file {file}": file for file in arguments.file})
    for file in arguments.file:
        reference = client.upload(file, arguments.kind, arguments.name, arguments.note)
        display.line(f"{reference} {file}", "stored", file=file, reference=reference)


def deletion_hint(refused: Refused) -> str:
    """What the flags of `delete` can do about a refused deletion."""
    if refused.field == "force":
        return "--force deletes it all the same"
    kinds = {"models": "model", "environments": "environment", "blobs": "mesh"} if refused.field == "kind" else {}
    return next((f"--as {kind} deletes it" for place, kind in kinds.items()
                 if f"DELETE /v1/{place}/" in str(refused)), "")


def delete(client: Client, arguments: Arguments, display: Display) -> None:
    for reference in arguments.input:
        try:
            client.delete(reference, arguments.kind, arguments.force)
        except Refused as refused:
            hint = deletion_hint(refused)
            if not hint:
                raise
            raise Refused(f"{refused}\n{hint}", refused.field, refused.status, refused.needed_by) from None
        display.line(f"{reference} deleted", "deleted", reference=reference)


class Parser(argparse.ArgumentParser):
    """argparse passes over a help that cannot be written."""

    def print_help(self, file: Any = None) -> None:
        if file:
            super().print_help(file)
        else:
            print_line(self.format_help().rstrip())


def connection_options() -> Parser:
    common = Parser(add_help=False)
    common.add_argument("--server", default=os.environ.get("HAIRBAKE_SERVER"),
                        help="http://HOST:PORT (HAIRBAKE_SERVER)")
    common.add_argument("--token-file", default=os.environ.get("HAIRBAKE_TOKEN_FILE"),
                        help="file with the token (HAIRBAKE_TOKEN_FILE)")
    common.add_argument("--ca-file", help="certificates (PEM) to trust instead of the system's")
    common.add_argument("--patience", type=float, default=120, help="seconds of retries; default 120")
    common.add_argument("--progress", choices=("auto", "json", "none"), default="auto",
                        help="a bar on a terminal, JSON lines on standard output, or nothing; default auto")
    return common


def priority_options() -> Parser:
    priority = Parser(add_help=False)
    priority.add_argument("--priority", type=int, default=0, help="-10 to 10: higher ones are baked first; default 0")
    priority.add_argument("--wait", action="store_true", help="wait until the bakes have ended")
    priority.add_argument("--fetch", metavar="DIR",
                          help="wait, then fetch; several bakes: each into its own folder in DIR")
    return priority


def parser() -> Parser:
    common, priority = connection_options(), priority_options()
    main_parser = Parser(prog="python3 -m hairbake", description=__doc__, epilog=EPILOG)
    commands = main_parser.add_subparsers(dest="command", required=True)

    def command(run: Callable[[Client, Arguments, Display], None], words: str,
                *parents: Parser) -> Parser:
        made = commands.add_parser(run.__name__, help=words, description=words, parents=[common, *parents],
                                   epilog=EPILOG)
        made.set_defaults(run=run)
        return made

    made = command(submit, "request bakes; inputs are files, sha256:DIGEST or name:NAME", priority)
    made.add_argument("--hair", action="append", help="may be given more than once: one bake for each")
    made.add_argument("--env", dest="environment")
    made.add_argument("--occluder")
    made.add_argument("--receiver")
    made.add_argument("--request", metavar="FILE",
                      help="JSON file with fields of the request, e.g. from hairbake presets NAME")
    made.add_argument("--outputs", help="npy,exr,hair ...")
    made.add_argument("--set", action="append", default=[], metavar="PATH=VALUE",
                      help="e.g. transmittance.method=trace")
    made = command(status, "show the states of bakes")
    made.add_argument("id", nargs="*", help="ids of bakes; default: the 20 newest")
    made.add_argument("--batch", help="counts of a batch")
    made.add_argument("--state", choices=("queued", "running", "done", "failed", "cancelled"),
                      help="of the newest, only those in this state")
    for run, words in ((wait, "wait until bakes have ended"), (cancel, "cancel bakes")):
        made = command(run, words)
        made.add_argument("id", nargs="*")
        made.add_argument("--batch")
    made = command(fetch, "fetch the result of a bake that is done")
    made.add_argument("id")
    made.add_argument("--out", required=True)
    made = command(rebake, "bake grooms again under a new environment", priority)
    made.add_argument("--env", dest="environment", required=True)
    made.add_argument("--bake", action="append")
    made.add_argument("--replaces")
    made.add_argument("--name")
    made.add_argument("--model", action="append")
    for block in LIGHTING_BLOCKS:
        made.add_argument(f"--{block.replace('_', '-')}", metavar="JSON")
    made.add_argument("--dry-run", action="store_true")
    made = command(upload, "send files that the server lacks")
    made.add_argument("file", nargs="+")
    made.add_argument("--as", dest="kind", choices=("model", "environment", "mesh"), default="")
    made.add_argument("--name", default="")
    made.add_argument("--note", default="")
    made = command(delete, "delete inputs; results that were baked from them stay")
    made.add_argument("input", nargs="+", help="sha256:DIGEST, as upload prints it")
    made.add_argument("--as", dest="kind", choices=("model", "environment", "mesh"), default="",
                      help="model or environment: the service lists it; mesh: it was sent only (default)")
    made.add_argument("--force", action="store_true",
                      help="also if done bakes or versions of names refer to it; without it they are listed")
    return main_parser


def interrupt(*_: object) -> None:
    raise KeyboardInterrupt


def parse(words: Optional[List[str]]) -> Arguments:
    main_parser = parser()
    arguments, left = main_parser.parse_known_args(words)
    if not left:
        return arguments
    unknown = next((word for word in left if word.startswith("-")), left[0])
    commands = next(action for action in main_parser._actions if isinstance(action, argparse._SubParsersAction))
    known = list(commands.choices[arguments.command]._option_string_actions)
    near = difflib.get_close_matches(unknown.partition("=")[0], known, 1)
    hint = f" (did you mean {near[0]}?)" if near else ""
    what = "option" if unknown.startswith("-") else "argument"
    main_parser.error(f"{arguments.command} has no {what} {unknown}{hint}")


def main(words: Optional[List[str]] = None) -> int:
    """Runs the command. Returns its exit code."""
    try:
        arguments = parse(words)
    except HairbakeError as error:  # of the help
        print(f"hairbake: error: {error}", file=sys.stderr)
        return error.exit_code
    return run(arguments)


def run(arguments: Arguments) -> int:
    display = Display(arguments.progress)
    for name in ("SIGTERM", "SIGHUP"):  # SIGHUP stays ignored where it is (nohup)
        if hasattr(signal, name) and signal.getsignal(getattr(signal, name)) != signal.SIG_IGN:
            signal.signal(getattr(signal, name), interrupt)
    try:
        if not arguments.server:
            raise UsageError("--server or HAIRBAKE_SERVER is needed", "server")
        client = Client(arguments.server, token_file=arguments.token_file, ca_file=arguments.ca_file,
                        patience_s=arguments.patience, progress=display)
        arguments.run(client, arguments, display)
        return 0
    except HairbakeError as error:
        print(f"hairbake: error: {error}", file=sys.stderr)
        if display.json:
            try:
                display.event("error", kind=error.kind, field=error.field, message=str(error))
            except HairbakeError:
                pass  # of the output itself: the first error counts
        return error.exit_code
    except OSError as error:
        print(f"hairbake: error: {words_of(error, error.filename or 'the system refuses')}", file=sys.stderr)
        return HairbakeError.exit_code
    except KeyboardInterrupt:
        return 5


if __name__ == "__main__":
    sys.exit(main())
