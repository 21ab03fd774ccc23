# SPDX-License-Identifier: Apache-2.0
"""The part of GitHub's interface that comments on pull requests, as a local server."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread
from typing import Any
from urllib.parse import parse_qs, urlsplit

PULL_REQUEST = "7"
REPOSITORY = "owner/robots"


class FakeGithub:
    """The comments of one pull request. `refusal` is the HTTP status with which it refuses to write."""

    def __init__(self) -> None:
        self.address = ""
        self.comments: list[dict[str, Any]] = []
        self.refusal: int | None = None

    def answer(self, method: str, path: str, content: dict[str, str]) -> tuple[int, Any]:
        parts = urlsplit(path)
        issues = f"/repos/{REPOSITORY}/issues"
        if method == "GET" and parts.path == f"{issues}/{PULL_REQUEST}/comments":
            query = parse_qs(parts.query)
            size, page = int(query["per_page"][0]), int(query["page"][0])
            return 200, self.comments[size * (page - 1) : size * page]
        if self.refusal is not None:
            return self.refusal, {"message": "Resource not accessible by integration"}
        if method == "POST" and parts.path == f"{issues}/{PULL_REQUEST}/comments":
            self.add(content["body"], "Bot")
            return 201, self.comments[-1]
        for comment in self.comments:
            if method == "PATCH" and parts.path == f"{issues}/comments/{comment['id']}":
                comment["body"] = content["body"]
                return 200, comment
        return 404, {"message": "Not Found"}

    def add(self, body: str, author: str) -> None:
        self.comments.append({"id": 100 + len(self.comments), "body": body, "user": {"type": author}})


@contextmanager
def fake_github() -> Iterator[FakeGithub]:
    github = FakeGithub()

    class Handler(BaseHTTPRequestHandler):
        def _answer(self) -> None:
            content = self.rfile.read(int(self.headers.get("Content-Length", 0)))
            status, answer = github.answer(self.command, self.path, json.loads(content or b"{}"))
            body = json.dumps(answer).encode()
            self.send_response(status)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        do_GET = do_POST = do_PATCH = _answer  # noqa: N815 - the names that http.server calls

        def log_message(self, *_: object) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    github.address = f"http://127.0.0.1:{server.server_port}"
    thread = Thread(target=server.serve_forever)
    thread.start()
    try:
        yield github
    finally:
        server.shutdown()
        thread.join()
        server.server_close()
