"""A server that stands for a language model: it answers the questions of the agent `vlm` by a script.

    python -m tests.helpers.chat_server 8321

It chooses the first place and believes each candidate. No model is behind it.
"""

from __future__ import annotations

import json
import sys
import threading
from collections.abc import Callable, Iterable
from typing import Any

from tests.helpers.services import Handler, Server, send

Question = dict[str, Any]
"""JSON of a request."""


def completion(content: Any, **others: Any) -> bytes:
    """Returns a reply of the endpoint with this text."""
    choice = {"index": 0, "message": {"role": "assistant", "content": content}, "finish_reason": "stop"}
    usage = {"prompt_tokens": 900, "completion_tokens": 20, "total_tokens": 920}
    return json.dumps({"id": "1", "object": "chat.completion", "choices": [choice], "usage": usage} | others).encode()


def text_of(question: Question) -> str:
    """Returns the text of the last message."""
    return question["messages"][-1]["content"][0]["text"]


def pictures_of(question: Question) -> list[str]:
    """Returns the data URLs of the pictures of the last message."""
    return [part["image_url"]["url"] for part in question["messages"][-1]["content"][1:]]


def believing(question: Question) -> str:
    """Chooses the first place, and believes each candidate."""
    if '"found"' in text_of(question):
        return '{"found": true, "reason": "It is."}'
    return '{"choice": 1, "reason": "Near."}'


def scripted(script: Callable[[Question], Any] | Iterable[Any] = believing) -> Handler:
    """Answers with the text that a function returns for each question, or with recorded texts one after the other."""
    recorded = None if callable(script) else iter(script)

    def answer(handler: Any, body: bytes) -> None:
        assert handler.path.endswith("/chat/completions")
        question = json.loads(body)
        send(handler, completion(next(recorded) if recorded is not None else script(question)))  # type: ignore[operator]

    return answer


if __name__ == "__main__":
    server = Server(scripted(), int(sys.argv[1]))
    sys.stdout.write(f"{server.url}/v1\n")
    sys.stdout.flush()
    threading.Event().wait()
