# SPDX-License-Identifier: Apache-2.0
"""Files of a git repository as they were in a revision (docs/comparison.md#revisions).

The files of the revision are written into a temporary folder, with an index of its own: neither the working tree nor
the index of the repository changes. Files that are too large to be read as a model are left out.
"""

from __future__ import annotations

import os
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager

from roaml.disk import MAX_BYTES
from roaml.record import Record


class RevisionError(ValueError):
    """Raised if git has no such file or revision. The message contains the reason."""


class ModelVersion(Record, frozen=True):
    """A model to compare.

    Attributes:
        name: as the user has written it.
        path: where its file is.
        root: the temporary folder with the files of the revision; "" if the file was not read from git.
    """

    name: str
    path: str
    root: str = ""

    def shown(self, path: str) -> str:
        """A path for people: that within the repository, behind the revision, for files from git."""
        inside = os.path.relpath(path, self.root) if self.root else ""
        if not inside or inside.startswith(os.pardir):
            return path
        return f"{self.name.partition(':')[0]}:{inside.replace(os.sep, '/')}"


@contextmanager
def model_version(text: str) -> Iterator[ModelVersion]:
    """The model that a path, or `REVISION:PATH`, names. As in git, `PATH` begins at the root of the repository, and at
    the current folder if it begins with `./`; a path that exists only from the current folder is accepted as well.

    Raises:
        RevisionError: git does not know the revision or the file, or is not installed.
    """
    revision, colon, path = text.partition(":")
    if not colon or os.path.exists(text) or not revision or not path:
        yield ModelVersion(text, text)
        return
    top = os.path.realpath(_git("rev-parse", "--show-toplevel").strip())
    unknown = f"git knows no revision `{revision}`, and there is no file `{text}`"
    named = f"{revision}^{{commit}}"
    commit = _git("rev-parse", "--verify", "--quiet", "--end-of-options", named, problem=unknown).strip()
    here = os.path.relpath(os.path.realpath(path), top)
    listed = _git("ls-tree", "-r", "-l", "-z", "--full-tree", commit).split("\0")
    entries = [entry.partition("\t") for entry in listed if entry]
    sizes = {name: head.split()[3] for head, _, name in entries}
    candidates = [here] if path.startswith(("./", "../")) else [os.path.normpath(path), here]
    inside = next((c for c in (c.replace(os.sep, "/") for c in candidates) if c in sizes), None)
    if inside is None:
        raise RevisionError(f"the revision `{revision}` has no file `{path}`")
    with tempfile.TemporaryDirectory(prefix="as2fm-") as folder:
        root = os.path.join(os.path.realpath(folder), "files")
        index = {"GIT_INDEX_FILE": os.path.join(folder, "index")}
        names = [name for name, size in sizes.items() if size.isdigit() and int(size) <= MAX_BYTES]
        _git("read-tree", commit, environment=index, folder=top)
        given = "".join(f"{name}\0" for name in names)
        _git("checkout-index", "-z", "--stdin", f"--prefix={root}/", environment=index, folder=top, given=given)
        yield ModelVersion(text, os.path.join(root, *inside.split("/")), root)


def _git(
    *arguments: str,
    environment: dict[str, str] | None = None,
    folder: str | None = None,
    given: str = "",
    problem: str = "",
) -> str:
    """The output of a git command.

    Args:
        environment: further variables of the environment.
        problem: the message if the command fails; by default, that of git.
    """
    try:
        done = subprocess.run(
            ["git", *arguments],
            cwd=folder,
            input=given,
            capture_output=True,
            check=False,
            encoding="utf-8",
            errors="surrogateescape",
            env={**os.environ, **(environment or {})},
        )
    except OSError as error:
        raise RevisionError(f"git cannot be started: {error.strerror or error}") from None
    if done.returncode:
        raise RevisionError(problem or f"git {arguments[0]}: {done.stderr.strip() or 'failed'}")
    return done.stdout
