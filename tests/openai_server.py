"""An OpenAI-compatible HTTP server on 127.0.0.1 that answers from a script.

with OpenAIServer(["first reply", Status(500), lambda request: "third"]) as server:
    lm = dspy.LM("openai/test", api_base=server.url, api_key="none", cache=False)
"""

import json
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any


@dataclass(frozen=True)
class Status:
    """An error reply."""

    code: int
    message: str = "scripted error"


@dataclass(frozen=True)
class Raw:
    """A reply with status 200 whose body is not a completion."""

    body: bytes


@dataclass(frozen=True)
class Hang:
    """A reply that comes late."""

    seconds: float
    reply: Any = ""


@dataclass(frozen=True)
class Drop:
    """No reply: the connection is closed."""


@dataclass
class OpenAIServer:
    """The server.

    Attributes:
        script: Replies in order: a text, one of the classes above, or a function of the request.
        default: The reply when the script is over.
        requests: The bodies of the requests so far.
    """

    script: list[Any] = field(default_factory=list)
    default: Any = Status(500, "the script is over")
    requests: list[dict[str, Any]] = field(default_factory=list)

    def __enter__(self) -> "OpenAIServer":
        self._lock = threading.Lock()
        self._http = ThreadingHTTPServer(("127.0.0.1", 0), _handler(self))
        self._http.daemon_threads = True
        self._thread = threading.Thread(target=self._http.serve_forever, args=(0.01,), daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *exc: object) -> None:
        self._http.shutdown()
        self._http.server_close()
        self._thread.join()

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self._http.server_port}/v1"

    @property
    def prompts(self) -> list[str]:
        """The text of each request."""
        return ["\n".join(_text(m["content"]) for m in r["messages"]) for r in self.requests]

    def reply(self, request: dict[str, Any]) -> Any:
        with self._lock:
            self.requests.append(request)
            found = self.script.pop(0) if self.script else self.default
        return found(request) if isinstance(found, Callable) else found

    def lm(self, **options: Any) -> Any:
        """A dspy.LM that talks to this server, without a cache and without retries."""
        import dspy

        options = {"cache": False, "num_retries": 0, **options}
        return dspy.LM("openai/test", api_base=self.url, api_key="none", **options)


def prompt_of(request: dict[str, Any]) -> str:
    """The text of a request."""
    return "\n".join(_text(m["content"]) for m in request["messages"])


def _text(content: Any) -> str:
    return content if isinstance(content, str) else "".join(p.get("text", "") for p in content)


def completion(request: dict[str, Any], text: str) -> bytes:
    """A chat completion; a token is a word."""
    sent, received = len(prompt_of(request).split()), len(text.split())
    message = {"role": "assistant", "content": text}
    body = {
        "id": "chatcmpl-1",
        "object": "chat.completion",
        "created": 0,
        "model": request["model"],
        "choices": [{"index": 0, "message": message, "finish_reason": "stop"}],
        "usage": {
            "prompt_tokens": sent,
            "completion_tokens": received,
            "total_tokens": sent + received,
        },
    }
    return json.dumps(body).encode()


def _handler(server: OpenAIServer) -> type[BaseHTTPRequestHandler]:
    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            request = json.loads(self.rfile.read(int(self.headers["content-length"])))
            if not self.path.endswith("/chat/completions"):
                return self.send(404, b'{"error": {"message": "no such path"}}')
            self.answer(request, server.reply(request))

        def answer(self, request: dict[str, Any], reply: Any) -> None:
            match reply:
                case Hang(seconds, later):
                    time.sleep(seconds)
                    self.answer(request, later)
                case Drop():
                    self.close_connection = True
                case Status(code, message):
                    self.send(code, json.dumps({"error": {"message": message}}).encode())
                case Raw(body):
                    self.send(200, body)
                case _:
                    self.send(200, completion(request, reply))

        def send(self, code: int, body: bytes) -> None:
            self.send_response(code)
            self.send_header("content-type", "application/json")
            self.send_header("content-length", str(len(body)))
            self.end_headers()
            with suppress(BrokenPipeError, ConnectionResetError):  # the client has left
                self.wfile.write(body)

        def log_message(self, *args: Any) -> None:
            pass

    return Handler
