# SPDX-License-Identifier: Apache-2.0
"""The program as a separate process that starts at once, as a fork of a process that has already imported it.

`command()` replaces `(sys.executable, "-m", "as2fm_lsp")`. It starts a small program, the caller, which passes its
standard streams, arguments, folder and environment to a process that has imported everything, the keeper. A fork of the
keeper runs the program, and the caller ends with the same status. If the caller is killed, the fork is killed, too.

This does not test what the interpreter does at its start and end: encoding, buffering and closing of the standard
streams, signals, and imports. Tests of these start the real program. `PYTHONUNBUFFERED` and the limit of file sizes
have an effect.
"""

from __future__ import annotations

import json
import os
import resource
import select
import signal
import socket
import struct
import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any  # not imported by the caller, which is to start at once

_SIZE = struct.Struct("!I")
_STATUS = struct.Struct("!i")
_STREAMS = (0, 1, 2)
_COMMANDS = ("check", "debug", "draw", "explain", "format", "init", "migrate", "serve", "simulate")
_MODULES = ("server", "debug.adapter", "trust", *(f"cli.{name}" for name in (*_COMMANDS, "translate", "verify")))


# -------------------------------------------------------------------------- tests


def command() -> tuple[str, ...]:
    """The command that replaces the program, before its arguments."""
    return (sys.executable, "-I", "-S", __file__, _Keeper.address())


class _Keeper:
    """The process that has imported everything, one for each process that runs tests. It ends with that process."""

    _address = ""

    @classmethod
    def address(cls) -> str:
        """The address of the socket on which it receives requests."""
        if not cls._address:
            import atexit  # noqa: PLC0415 - the caller, too, runs this file, and is to start at once
            import shutil  # noqa: PLC0415
            import subprocess  # noqa: PLC0415
            import tempfile  # noqa: PLC0415

            folder = tempfile.mkdtemp()
            atexit.register(shutil.rmtree, folder, ignore_errors=True)
            address = os.path.join(folder, "keeper")
            pipe = subprocess.PIPE
            process = subprocess.Popen([sys.executable, __file__, address, "keep"], stdin=pipe, stdout=pipe)
            assert process.stdout is not None
            assert process.stdout.readline() == b"ready\n"
            cls._address = address
            cls._process = process  # its standard input is open as long as this process lives
        return cls._address


# ------------------------------------------------------------------------- caller


def call(address: str, arguments: list[str]) -> None:
    """Let the keeper run the program with the streams of this process, and end with the same status."""
    connection = socket.socket(socket.AF_UNIX)
    connection.connect(address)
    request = {
        "arguments": arguments,
        "folder": os.getcwd(),
        "environment": dict(os.environ),
        "file size": resource.getrlimit(resource.RLIMIT_FSIZE),
    }
    body = json.dumps(request).encode()
    socket.send_fds(connection, [_SIZE.pack(len(body))], _STREAMS)
    connection.sendall(body)
    for stream in _STREAMS:
        os.close(stream)  # so that who reads them sees their end when the program ends
    (status,) = _STATUS.unpack(_received(connection, _STATUS.size))
    if status < 0:
        signal.signal(-status, signal.SIG_DFL)
        os.kill(os.getpid(), -status)
    os._exit(status)


def _received(connection: socket.socket, size: int) -> bytes:
    data = b""
    while len(data) < size:
        piece = connection.recv(size - len(data))
        if not piece:
            raise EOFError
        data += piece
    return data


# ------------------------------------------------------------------------- keeper


def keep(address: str) -> None:
    """Handle requests until standard input ends."""
    import gc  # noqa: PLC0415
    import importlib  # noqa: PLC0415

    for name in _MODULES:
        importlib.import_module(f"as2fm_lsp.{name}")
    gc.collect()
    gc.freeze()
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody asks for the status of the watchers
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(address)
        listener.listen(64)
        os.write(1, b"ready\n")
        while sys.stdin not in select.select([listener, sys.stdin], [], [])[0]:
            connection, _ = listener.accept()
            if os.fork() == 0:
                listener.close()
                _watch(connection)
            connection.close()


def _watch(connection: socket.socket) -> None:
    """Run the program in a fork of this process. End with it, and end it if the caller ends."""
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    head, streams, _, _ = socket.recv_fds(connection, _SIZE.size, len(_STREAMS))
    request = json.loads(_received(connection, _SIZE.unpack(head)[0]))
    ended, alive = os.pipe()
    program = os.fork()
    if program == 0:
        connection.close()
        os.close(ended)
        _run(request, streams)
    for handle in (*streams, alive, *_STREAMS):
        os.close(handle)
    if connection in select.select([connection, ended], [], [])[0]:
        os.kill(program, signal.SIGKILL)
    _, status = os.waitpid(program, 0)
    connection.sendall(_STATUS.pack(os.waitstatus_to_exitcode(status)))
    os._exit(0)


def _run(request: dict[str, Any], streams: list[int]) -> None:
    """Run the program in its own process."""
    import atexit  # noqa: PLC0415
    import io  # noqa: PLC0415
    import runpy  # noqa: PLC0415
    import threading  # noqa: PLC0415
    import traceback  # noqa: PLC0415

    status = 1
    try:
        for stream, handle in zip(_STREAMS, streams, strict=True):
            os.dup2(handle, stream)
            os.close(handle)
        os.chdir(request["folder"])
        os.environ.clear()
        os.environ.update(request["environment"])
        sys.dont_write_bytecode = bool(os.environ.get("PYTHONDONTWRITEBYTECODE"))
        resource.setrlimit(resource.RLIMIT_FSIZE, tuple(request["file size"]))
        is_unbuffered = bool(os.environ.get("PYTHONUNBUFFERED"))
        sys.stdin = os.fdopen(0, encoding="utf-8", closefd=False)
        sys.stdout, sys.stderr = (
            io.TextIOWrapper(
                os.fdopen(stream, "wb", buffering=0 if is_unbuffered else -1, closefd=False),
                encoding="utf-8",
                errors=errors,
                line_buffering=stream == 2 or os.isatty(stream),
                write_through=is_unbuffered,
            )
            for stream, errors in ((1, "strict"), (2, "backslashreplace"))
        )
        sys.argv = ["as2fm-lsp", *request["arguments"]]
        runpy.run_module("as2fm_lsp", run_name="__main__", alter_sys=True)
        status = 0
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else int(end.code is not None)
    except BaseException:
        traceback.print_exc()
    finally:
        try:
            threading._shutdown()  # type: ignore[attr-defined]
            atexit._run_exitfuncs()
            sys.stderr.flush()
            sys.stdout.flush()
        except OSError:
            status = 120  # as of an interpreter that cannot flush
        finally:
            os._exit(status)


if __name__ == "__main__":
    _, where, *rest = sys.argv
    if rest == ["keep"]:
        keep(where)
    else:
        call(where, rest)
